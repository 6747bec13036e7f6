/// Number of places at which one step of a search evaluates a function: two of the widest vectors.
pub(crate) const SECTIONS: usize = 16;

/// Narrows the bracket of a root until no number lies between its ends; returns the lower end.
///
/// The ends are (place, value) with positive places and values of opposite signs. `values` evaluates the function at
/// sixteen places between them; the function may be rough and infinite. For a smooth function the places lie around the
/// root of the straight line from end to end. Otherwise they divide the bracket evenly, a wide one logarithmically, so
/// that the width does not matter.
pub fn root(
    mut low: (f64, f64),
    mut high: (f64, f64),
    mut values: impl FnMut(&[f64; SECTIONS]) -> [f64; SECTIONS],
) -> f64 {
    let mut is_straight = true;
    while is_open(low.0, high.0) {
        let width = high.0 - low.0;
        let guess = low.0 + width * (low.1 / (low.1 - high.1));
        let is_guessed = is_straight && low.1.is_finite() && high.1.is_finite();
        let places = if is_guessed { around(guess, width) } else { places(low.0, high.0) };
        let places = places.map(|place| place.clamp(low.0, high.0));
        for (place, value) in places.into_iter().zip(values(&places)) {
            let is_between = low.0 < place && place < high.0;
            if is_between && value.is_sign_negative() == high.1.is_sign_negative() {
                high = (place, value);
                break;
            }
            if is_between {
                low = (place, value);
            }
        }
        if high.0 - low.0 >= width && !is_guessed {
            // Between the smallest numbers, steps have no length.
            break;
        }
        // Takes equal steps after a guess that narrows the bracket less than they would.
        let is_narrow = (high.0 - low.0) * (SECTIONS + 1) as f64 <= width;
        is_straight = !is_guessed || is_narrow;
    }
    low.0
}

/// True if a floating-point number lies between the two.
fn is_open(low: f64, high: f64) -> bool {
    let middle = low + 0.5 * (high - low);
    low < middle && middle < high
}

/// Eight places on either side of a guess, each sixteen times nearer than the one before.
fn around(guess: f64, width: f64) -> [f64; SECTIONS] {
    let mut places = [guess; SECTIONS];
    let mut distance = width;
    for k in 0..SECTIONS / 2 {
        distance *= 1.0 / 16.0;
        places[k] -= distance;
        places[SECTIONS - 1 - k] += distance;
    }
    places
}

/// Sixteen places between two ends: in equal steps, or in equal ratios if the ends are far apart.
fn places(low: f64, high: f64) -> [f64; SECTIONS] {
    let mut places = [high; SECTIONS];
    if high > 2.0 * low && low > 0.0 {
        // Square roots round alike everywhere, other powers do not. The last place is the higher end itself.
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

/// Places of a geometric scan from `low`, each `ratio` times the one before.
pub(crate) fn geometric_scan(low: f64, ratio: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(low), move |x| Some(x * ratio))
}

/// The next sixteen values of an endless sequence.
pub(crate) fn next_places(scan: &mut impl Iterator<Item = f64>) -> [f64; SECTIONS] {
    std::array::from_fn(|_| scan.next().unwrap_or(f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of steps to the root; asserts that the root is exact to the last bit.
    fn steps_to(exact: f64, (low, high): (f64, f64), value: impl Fn(f64) -> f64) -> usize {
        let mut steps = 0;
        let found = root((low, value(low)), (high, value(high)), |places| {
            assert!(places.is_sorted() && places[0] >= low && places[15] <= high, "{places:?}");
            steps += 1;
            places.map(&value)
        });
        assert!(found <= exact && exact <= found.next_up(), "{found} is not {exact}");
        steps
    }

    #[test]
    fn the_root_of_a_smooth_function_takes_few_steps_of_either_sign() {
        for sign in [1.0, -1.0] {
            let steps = steps_to(2.0_f64.sqrt(), (1.0, 2.0), |x| sign * (x * x - 2.0));
            assert!(steps <= 6, "{steps} steps");
            let near = steps_to(2.0_f64.sqrt(), (1.4, 1.42), |x| sign * (x * x - 2.0));
            assert!(near <= 4, "{near} steps");
        }
    }

    /// An infinite value that carries only a sign.
    fn side(is_above: bool) -> f64 {
        if is_above { f64::INFINITY } else { f64::NEG_INFINITY }
    }

    #[test]
    fn roots_are_found_to_the_last_bit_in_a_bracket_of_many_decades() {
        for square in [2.0, 1e-50, 3e70, 1.0 + 1e-15] {
            let mut steps = 0;
            let root = root((1e-30, side(false)), (1e40, side(true)), |places| {
                steps += 1;
                places.map(|x| side(x * x > square))
            });
            let above = root.next_up();
            assert!(root * root <= square && above * above > square, "{root} is not √{square}");
            assert!(steps < 20, "{steps} steps");
        }
    }

    #[test]
    fn a_bracket_of_the_least_numbers_is_no_search_without_end() {
        let high = f64::from_bits(2);
        let root =
            root((0.0, side(false)), (high, side(true)), |places| places.map(|x| side(x >= high)));
        assert_eq!(root.to_bits(), 0);
    }

    #[test]
    fn a_bracket_from_zero_is_cut_too() {
        let root =
            root((0.0, side(false)), (8.0, side(true)), |places| places.map(|x| side(x >= 5.0)));
        assert_eq!(root.to_bits(), 5.0_f64.to_bits() - 1);
    }

    #[test]
    fn the_root_of_a_rough_function_takes_no_more_than_twice_the_steps() {
        let values: [fn(f64) -> f64; 5] = [
            |x| if x < 1.3 { -1.0 } else { 1.0 },
            |x| if x < 1.3 { -1e-300 } else { 1e300 },
            |x| if x < 1.3 { -1e300 } else { 1e-300 },
            |x| if x < 1.3 { f64::NEG_INFINITY } else { f64::INFINITY },
            |x| (x - 1.3).powi(9),
        ];
        for value in values {
            let steps = steps_to(1.3, (1.0, 2.0), value);
            assert!(steps <= 28, "{steps} steps");
        }
    }
}
