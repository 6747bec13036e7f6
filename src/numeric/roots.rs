/// Places at which a bracket is looked at in one step: as many as the widest vectors hold twice.
pub const SECTIONS: usize = 16;

/// Cuts the bracket of a predicate that is false at `low` and true at `high` until no number lies
/// between, and returns the smaller end.
///
/// The predicate tells of sixteen places, ascending, at a time. The bracket is positive; it is cut
/// in the logarithm first, so its width does not matter.
pub fn section(
    mut low: f64,
    mut high: f64,
    mut are_above: impl FnMut(&[f64; SECTIONS]) -> [bool; SECTIONS],
) -> f64 {
    loop {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            return low;
        }
        let places = places(low, high);
        let above = are_above(&places);
        for (place, is_above) in places.into_iter().zip(above) {
            // Rounded, a place may fall on an end, of which the answer is known.
            if is_above && low < place {
                high = high.min(place);
                break;
            }
            if low < place && place < high {
                low = place;
            }
        }
    }
}

/// Sixteen places between two ends, in equal steps or, far apart, in equal ratios.
fn places(low: f64, high: f64) -> [f64; SECTIONS] {
    let mut places = [high; SECTIONS];
    if high > 2.0 * low && low > 0.0 {
        // Square roots are rounded alike everywhere, other powers are not. The last place is the
        // higher end itself.
        let ratio = (high.sqrt() / low.sqrt()).sqrt().sqrt().sqrt();
        let mut place = low;
        for x in &mut places[..SECTIONS - 1] {
            place *= ratio;
            *x = place;
        }
    } else {
        let step = (high - low) / (SECTIONS + 1) as f64;
        for (number, x) in places.iter_mut().enumerate() {
            *x = low + step * (number + 1) as f64;
        }
    }
    places
}

/// The grid points of a geometric scan from `low`, neighbours `ratio` apart.
pub fn geometric_scan(low: f64, ratio: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(low), move |x| Some(x * ratio))
}

/// The next sixteen of a sequence without end.
pub fn next_places(scan: &mut impl Iterator<Item = f64>) -> [f64; SECTIONS] {
    std::array::from_fn(|_| scan.next().unwrap_or(f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_reach_the_last_bit_from_a_bracket_of_many_decades() {
        for square in [2.0, 1e-50, 3e70, 1.0 + 1e-15] {
            let mut steps = 0;
            let root = section(1e-30, 1e40, |places| {
                steps += 1;
                places.map(|x| x * x > square)
            });
            let above = f64::from_bits(root.to_bits() + 1);
            assert!(root * root <= square && above * above > square, "{root} is not √{square}");
            assert!(steps < 20, "{steps} steps");
        }
    }

    #[test]
    fn a_bracket_from_zero_is_cut_too() {
        let root = section(0.0, 8.0, |places| places.map(|x| x >= 5.0));
        assert_eq!(root.to_bits(), 5.0_f64.to_bits() - 1);
    }
}
