//! Roots of a function of b = βL, found without the program's own search.

/// The first `count` sign changes of `f` on 0.05 < b < 20, ascending, bisected to the last bit.
pub(crate) fn roots(count: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    const STEP: f64 = 0.05;
    let is_negative = |b: f64| f(b) < 0.0;
    let bisect = |mut low: f64| {
        let (start, mut step) = (is_negative(low), STEP);
        while low + step > low {
            step *= 0.5;
            if is_negative(low + step) == start {
                low += step;
            }
        }
        low
    };
    (1..400)
        .map(|k| STEP * f64::from(k))
        .filter(|b| is_negative(*b) != is_negative(b + STEP))
        .take(count)
        .map(bisect)
        .collect()
}
