//! Uniform times in place of the times of a table.

use super::input::{Place, TableError};
use crate::numeric::{CubicSpline, SplineEnds};
use crate::recording::LARGEST_JITTER;
use crate::text::{given, significant};

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

    /// True if the times are the known ones, so that interpolation changes no value.
    pub(super) fn is_known(&self) -> bool {
        let is_same =
            |(time_s, known_s): (&f64, &f64)| (time_s - known_s).abs() <= SAME_TIME * self.step_s;
        self.times_s.len() == self.known_s.len()
            && self.times_s.iter().zip(self.known_s).all(is_same)
    }

    /// Interpolates values at the known times by a cubic spline. Beyond the last known time its value stays.
    pub(super) fn interpolated(&self, values: &[f64], ends: SplineEnds) -> Vec<f64> {
        let spline = CubicSpline::new(self.known_s, values, ends);
        let last_s = self.known_s[self.known_s.len() - 1];
        // The motion rests at its end, so that a twentieth of a step does not matter.
        let near_s = last_s - LARGEST_JITTER * self.step_s;
        let at = |t: &f64| if *t < near_s { *t } else { last_s };
        self.times_s.iter().map(|time| spline.value(at(time))).collect()
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

/// Number of whole steps from the first known time on, and the time in s from their end to the last known time. A
/// last time up to a twentieth of a step off is at the end of a step.
///
/// # Errors
/// [`TableError`] for a step that is not above 0, or gives too few samples or too many.
pub(super) fn steps_of(
    known_s: &[f64],
    step_s: f64,
    file: &str,
) -> Result<(usize, f64), TableError> {
    let place = Place { file, line: None };
    let duration_s = known_s[known_s.len() - 1] - known_s[0];
    let refuse = |must: String| place.refuse("resampling step", format!("{step_s} s"), must);
    if !(step_s.is_finite() && step_s > 0.0) {
        return Err(refuse("must be finite and above 0".to_owned()));
    }
    let ratio = duration_s / step_s;
    let steps = (ratio + LARGEST_JITTER).floor();
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
    let is_whole = ratio - steps <= LARGEST_JITTER;
    let left_s = if is_whole { 0.0 } else { duration_s - steps * step_s };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number from 3 to 1e7"
    )]
    Ok((steps as usize, left_s))
}

/// Description for the user of the time after the last whole step, which is left out.
pub(super) fn without_last(left_s: f64) -> Option<String> {
    let left = significant(left_s, 3);
    (left_s > 0.0).then(|| format!("without the last {left} s, less than a step"))
}
