//! Student's distribution: confidence interval of an estimate from few samples.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Half width of the interval with 95 % of normal deviates, in standard deviations.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Degrees of freedom above which the series in their inverse is exact to 1e-10.
const MANY: usize = 200;

/// Halvings of the bracket of an angle, down to its last digit.
const HALVINGS: usize = 60;

/// Quantile t of Student's distribution: a deviate lies within ±t with probability 0.95. Infinite for 0 degrees of
/// freedom.
///
/// ```
/// use flexlink::numeric::student_95;
/// assert!((student_95(1) - 12.706_204_736).abs() < 1e-9);
/// assert!((student_95(5) - 2.570_581_836).abs() < 1e-9);
/// ```
pub fn student_95(degrees_of_freedom: usize) -> f64 {
    if degrees_of_freedom == 0 {
        return f64::INFINITY;
    }
    if degrees_of_freedom >= MANY {
        return expanded(degrees_of_freedom as f64);
    }
    let [mut low, mut high] = [0.0, FRAC_PI_2];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let side = if within(middle, degrees_of_freedom) < 0.95 { &mut low } else { &mut high };
        *side = middle;
    }
    (degrees_of_freedom as f64).sqrt() * libm::tan(low)
}

/// Probability that a deviate lies within `±√ν tan θ` for ν degrees of freedom (Abramowitz and Stegun 26.7.3
/// and 26.7.4): a sum of ν/2 terms.
fn within(theta: f64, degrees_of_freedom: usize) -> f64 {
    let (sine, cosine) = (libm::sin(theta), libm::cos(theta));
    let is_odd = degrees_of_freedom % 2 == 1;
    let mut term = if is_odd { cosine } else { 1.0 };
    let mut sum = 0.0;
    for k in (if is_odd { 3 } else { 2 }..=degrees_of_freedom).step_by(2) {
        sum += term;
        term *= cosine * cosine * (k - 1) as f64 / k as f64;
    }
    if is_odd { FRAC_2_PI * (theta + sine * sum) } else { sine * sum }
}

/// Series of Fisher and Cornish in 1/ν (Abramowitz and Stegun 26.7.5).
fn expanded(n: f64) -> f64 {
    let z = NORMAL_95;
    let s = z * z;
    let first = (s + 1.0) * z / 4.0;
    let second = ((5.0 * s + 16.0) * s + 3.0) * z / 96.0;
    let third = (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) * z / 384.0;
    let fourth = ((((79.0 * s + 776.0) * s + 1482.0) * s - 1920.0) * s - 945.0) * z / 92_160.0;
    z + (first + (second + (third + fourth / n) / n) / n) / n
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference: the incomplete beta function with 30 digits (mpmath).
    #[test]
    fn quantiles_are_those_of_the_incomplete_beta_function() {
        for (degrees_of_freedom, exact) in [
            (1, 12.706_204_736_174_7),
            (2, 4.302_652_729_749_46),
            (3, 3.182_446_305_283_71),
            (4, 2.776_445_105_197_79),
            (5, 2.570_581_835_636_32),
            (6, 2.446_911_851_144_97),
            (30, 2.042_272_456_301_24),
            (99, 1.984_216_951_586_42),
            (199, 1.971_956_544_251_75),
            (200, 1.971_896_223_643_91),
            (500, 1.964_719_837_467_37),
            (4000, 1.960_557_228_793_73),
        ] {
            let found = student_95(degrees_of_freedom);
            assert!((found / exact - 1.0).abs() < 1e-10, "{degrees_of_freedom}: {found}");
        }
        assert!((student_95(1 << 40) - NORMAL_95).abs() < 1e-9);
        assert!(student_95(0).is_infinite());
    }
}
