/// Halves the bracket of a predicate that is false at `low` and true at `high` until no number
/// lies between, and returns the smaller end.
///
/// The bracket is positive; it is halved in the logarithm first, so its width does not matter.
pub fn bisect(mut low: f64, mut high: f64, mut is_above: impl FnMut(f64) -> bool) -> f64 {
    loop {
        let wide = high > 2.0 * low && low > 0.0;
        let middle = if wide { low.sqrt() * high.sqrt() } else { low + 0.5 * (high - low) };
        if middle <= low || middle >= high {
            return low;
        }
        if is_above(middle) { high = middle } else { low = middle }
    }
}

/// The grid points of a geometric scan from `low` to `high`, neighbours `ratio` apart.
pub fn geometric_scan(low: f64, high: f64, ratio: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(low), move |x| Some(x * ratio)).take_while(move |x| *x <= high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisection_reaches_the_last_bit_from_a_bracket_of_many_decades() {
        let root = bisect(1e-30, 1e40, |x| x * x > 2.0);
        assert!((root - 2.0_f64.sqrt()).abs() <= f64::EPSILON);
    }
}
