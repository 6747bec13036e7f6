//! Chebyshev series over a span of time.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::f64::consts::PI;

use crate::numeric::largest;

/// Number of Chebyshev points.
pub(super) const POINTS: usize = 48;

/// Coefficients below this share of the largest are cut off: the images are a small part of a signal.
const ROUNDING: f64 = 1e-11;

/// Number of times at which a series is evaluated at once.
pub(super) const SIDE_BY_SIDE: usize = 16;

/// A span of time, in s.
#[derive(Clone, Copy)]
pub(super) struct Span {
    pub(super) from_s: f64,
    pub(super) until_s: f64,
}

impl Span {
    /// The time at x in −1 … 1.
    pub(super) fn at(&self, x: f64) -> f64 {
        0.5 * (self.from_s + self.until_s) + 0.5 * (self.until_s - self.from_s) * x
    }

    /// x of a time, in −1 … 1.
    #[inline(always)]
    pub(super) fn scaled(&self, time_s: f64) -> f64 {
        (2.0 * time_s - self.from_s - self.until_s) / (self.until_s - self.from_s)
    }

    /// Series of the derivative by time of a Chebyshev series.
    pub(super) fn derivative(&self, series: &[f64]) -> Vec<f64> {
        let mut derived = vec![0.0; series.len() + 1];
        for j in (0..series.len() - 1).rev() {
            derived[j] = derived[j + 2] + 2.0 * (j + 1) as f64 * series[j + 1];
        }
        derived[0] *= 0.5;
        derived.truncate(series.len());
        let per_second = 2.0 / (self.until_s - self.from_s);
        derived.iter().map(|value| value * per_second).collect()
    }
}

/// Values of all Chebyshev polynomials below [`POINTS`] at the points of the last of them.
pub(super) struct Cosines([f64; 4 * POINTS]);

impl Cosines {
    pub(super) fn new() -> Self {
        Self(std::array::from_fn(|k| libm::cos(PI * k as f64 / (2 * POINTS) as f64)))
    }

    /// `T_j` at point `point`.
    pub(super) fn of(&self, j: usize, point: usize) -> f64 {
        self.0[j * (2 * point + 1) % (4 * POINTS)]
    }

    /// The series through values at the points.
    pub(super) fn series(&self, values: &[f64]) -> Vec<f64> {
        let coefficient = |j: usize| {
            let sum: f64 =
                values.iter().enumerate().map(|(point, value)| value * self.of(j, point)).sum();
            (if j == 0 { 1.0 } else { 2.0 }) / POINTS as f64 * sum
        };
        (0..POINTS).map(coefficient).collect()
    }
}

/// A series without the negligible coefficients at its end.
pub(super) fn trimmed(mut series: Vec<f64>) -> Vec<f64> {
    let least = ROUNDING * largest(&series);
    let counts = |c: &f64| c.abs() > least;
    series.truncate(series.iter().rposition(counts).map_or(1, |last| last + 1));
    series
}

/// Values of a Chebyshev series at x in −1 … 1, by Clenshaw's recurrence.
#[inline(always)]
pub(super) fn clenshaw(series: &[f64], x: [f64; SIDE_BY_SIDE]) -> [f64; SIDE_BY_SIDE] {
    let (mut above, mut this) = ([0.0; SIDE_BY_SIDE], [0.0; SIDE_BY_SIDE]);
    for coefficient in series[1..].iter().rev() {
        for k in 0..SIDE_BY_SIDE {
            (above[k], this[k]) = (this[k], 2.0 * x[k] * this[k] - above[k] + coefficient);
        }
    }
    std::array::from_fn(|k| x[k] * this[k] - above[k] + series[0])
}
