//! Uniform times in place of the times of a table.

use super::place::{Place, TableError};
use crate::numeric::{CubicSpline, SplineEnds};
use crate::recording::LARGEST_JITTER;
use crate::text::given;

/// Fewest samples of a table.
pub(super) const MIN_SAMPLES: usize = 4;

/// Largest number of samples of a resampled motion.
const MAX_SAMPLES: f64 = 1e7;

/// Difference of times, in steps, below which they are equal.
const SAME_TIME: f64 = 1e-6;

/// Uniform times that start at the first of known times.
#[expect(clippy::struct_field_names, reason = "their units end alike")]
pub(super) struct Uniform<'a> {
    known_s: &'a [f64],
    pub(super) step_s: f64,
    pub(super) times_s: Vec<f64>,
}

impl<'a> Uniform<'a> {
    /// As many uniform times as there are known ones, from the first of these to the last.
    pub(super) fn over(known_s: &'a [f64]) -> Self {
        let last = known_s.len() - 1;
        let mut uniform = Self::of(known_s, last, (known_s[last] - known_s[0]) / last as f64);
        uniform.times_s[last] = known_s[last];
        uniform
    }

    /// Times of this number of steps.
    pub(super) fn of(known_s: &'a [f64], steps: usize, step_s: f64) -> Self {
        let times_s = (0..=steps).map(|k| known_s[0] + k as f64 * step_s).collect();
        Self { known_s, step_s, times_s }
    }

    /// Interpolates values at the known times by a cubic spline.
    pub(super) fn interpolated(&self, values: &[f64], ends: SplineEnds) -> Vec<f64> {
        let spline = CubicSpline::new(self.known_s, values, ends);
        let (steps, last_s) = (self.times_s.len() - 1, self.known_s[self.known_s.len() - 1]);
        // The motion rests at its end, so that a twentieth of a step does not matter.
        let at = |(k, t): (usize, &f64)| if k == steps { last_s } else { t.min(last_s) };
        self.times_s.iter().enumerate().map(|time| spline.value(at(time))).collect()
    }

    /// For each time, the line of the last known time that is not later; empty for samples without lines.
    pub(super) fn lines(&self, lines: &[u64]) -> Vec<u64> {
        let line = |time_s: &f64| {
            let is_not_later = |known_s: &f64| *known_s <= time_s + SAME_TIME * self.step_s;
            lines.get(self.known_s.partition_point(is_not_later).saturating_sub(1)).copied()
        };
        self.times_s.iter().filter_map(line).collect()
    }
}

/// Number of steps from the first known time to the last.
///
/// # Errors
/// [`TableError`] unless it is whole.
pub(super) fn whole_steps(known_s: &[f64], step_s: f64, file: &str) -> Result<usize, TableError> {
    let place = Place { file, line: None };
    let duration_s = known_s[known_s.len() - 1] - known_s[0];
    let refuse = |must: String| place.refuse("resampling step", format!("{step_s} s"), must);
    if !(step_s.is_finite() && step_s > 0.0) {
        return Err(refuse("must be finite and above 0".to_owned()));
    }
    let ratio = duration_s / step_s;
    let steps = ratio.round();
    let fewest = (MIN_SAMPLES - 1) as f64;
    if steps < fewest {
        let longest = duration_s / fewest;
        let must =
            format!("must be at most {} s, which gives {MIN_SAMPLES} samples", given(longest));
        return Err(refuse(must));
    }
    if steps >= MAX_SAMPLES {
        let shortest = duration_s / (MAX_SAMPLES - 1.0);
        let must =
            format!("must be at least {} s, which gives {MAX_SAMPLES:e} samples", given(shortest));
        return Err(refuse(must));
    }
    if (ratio - steps).abs() > LARGEST_JITTER {
        let below = ratio.floor().max(fewest);
        let (long, short) = (duration_s / below, duration_s / (below + 1.0));
        let must = format!("must divide the motion's {} s into whole steps", given(duration_s));
        // With all digits, so that the user can copy one of them.
        let hint = format!("the nearest steps that do are {short} s and {long} s");
        return Err(refuse(must).with_hint(hint));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number from 3 to 1e7"
    )]
    Ok(steps as usize)
}
