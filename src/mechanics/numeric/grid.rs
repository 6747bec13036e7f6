use std::borrow::Cow;
use std::num::NonZeroUsize;

use thiserror::Error;

use super::scalar::rounded;

/// Uniform time grid: sample k is at `origin + (first + k)·step`.
///
/// A result's grid extends the one of its trajectory and keeps its origin, so that common samples have the same times
/// to the last bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeGrid {
    /// Time of the trajectory's first sample in s.
    pub origin_s: f64,
    /// Step in s, above 0.
    pub step_s: f64,
    /// Number of the first sample, counted from the origin; negative before the origin.
    pub first: i64,
    /// Number of samples.
    pub len: usize,
}

impl TimeGrid {
    /// Time of sample `k` in s.
    ///
    /// ```
    /// use flexlink::numeric::TimeGrid;
    /// let grid = TimeGrid { origin_s: 0.25, step_s: 0.5, first: -2, len: 4 };
    /// assert_eq!(grid.time_s(0), -0.75);
    /// assert_eq!(grid.time_s(3), 0.75);
    /// ```
    pub fn time_s(&self, k: usize) -> f64 {
        let steps = k as f64 + self.first as f64;
        self.origin_s + steps * self.step_s
    }

    /// Index of sample `k` in a period of `len` samples that begins at the origin.
    pub(crate) fn in_period(&self, k: usize, len: usize) -> usize {
        #[expect(
            clippy::cast_possible_wrap,
            clippy::cast_possible_truncation,
            reason = "samples stay far below 2^63, and the remainder is not negative"
        )]
        let number = (self.first + k as i64).rem_euclid(len as i64) as usize;
        number
    }

    /// Time of the last sample in s.
    pub fn end_s(&self) -> f64 {
        self.time_s(self.len.saturating_sub(1))
    }

    /// Time from the first sample to the last in s.
    pub fn duration_s(&self) -> f64 {
        self.len.saturating_sub(1) as f64 * self.step_s
    }

    /// Every `every`-th sample, beginning with the first.
    #[must_use]
    pub fn thinned(&self, every: NonZeroUsize) -> ThinnedGrid {
        ThinnedGrid { grid: *self, start: 0, every }
    }

    /// Samples whose number, counted from the origin, is a multiple of `every`. Grids of one origin share them.
    ///
    /// ```
    /// use flexlink::numeric::TimeGrid;
    /// let grid = TimeGrid { origin_s: 0.0, step_s: 0.5, first: -3, len: 7 };
    /// let rows = grid.multiples(2.try_into().unwrap());
    /// assert_eq!((rows.len(), rows.time_s(0), rows.time_s(2)), (3, -1.0, 1.0));
    /// ```
    #[must_use]
    pub fn multiples(&self, every: NonZeroUsize) -> ThinnedGrid {
        // Samples up to the next multiple of `every`.
        let back = every.get() - self.in_period(0, every.get());
        ThinnedGrid { grid: *self, start: back % every.get(), every }
    }

    /// The uniform grid through times in s, from the first to the last.
    ///
    /// A time may be off by a thousandth of a step, or by the rounding of its last decimal.
    ///
    /// # Errors
    /// [`NotUniform`] names the first time that is off, and the time that the grid expects there.
    ///
    /// # Panics
    /// If there are fewer than two times.
    pub(crate) fn through(time_s: &[f64]) -> Result<Self, NotUniform> {
        let (origin_s, last) = (time_s[0], time_s.len() - 1);
        let step_s = (time_s[last] - origin_s) / last as f64;
        let slack_s = slack(time_s, step_s);
        let grid = Self { origin_s, step_s, first: 0, len: time_s.len() };
        let is_off = |k: usize| exceeds((time_s[k] - grid.time_s(k)).abs(), slack_s);
        if step_s > 0.0 && !(0..=last).any(is_off) {
            return Ok(grid);
        }
        // One missing row shifts the mean step; the median step shows which row is missing.
        let mut steps: Vec<f64> = time_s.windows(2).map(|t| t[1] - t[0]).collect();
        let usual = *steps.clone().select_nth_unstable_by(last / 2, f64::total_cmp).1;
        steps.insert(0, usual);
        let strays = |k: &usize| exceeds((steps[*k] - usual).abs(), 2.0 * slack_s.abs());
        let sample =
            (1..=last).find(strays).or_else(|| (1..=last).find(|k| is_off(*k))).unwrap_or(last);
        Err(NotUniform {
            sample,
            found_s: time_s[sample],
            expected_s: time_s[sample - 1] + usual,
            step_s: usual,
        })
    }

    /// Largest distances of times in s from two grids, in steps: the grid through the first and last time, and the grid
    /// of the best fit. Both are 0 where the rounding of the last decimal explains the first distance.
    ///
    /// # Panics
    /// If there are fewer than two times.
    pub(crate) fn jitter(time_s: &[f64]) -> [f64; 2] {
        let (origin_s, last) = (time_s[0], time_s.len() - 1);
        let step_s = (time_s[last] - origin_s) / last as f64;
        let off_s = |k: usize| time_s[k] - (origin_s + k as f64 * step_s);
        let farthest =
            |off_s: &dyn Fn(usize) -> f64| (0..=last).map(|k| off_s(k).abs()).fold(0.0, f64::max);
        let from_ends_s = farthest(&off_s);
        if from_ends_s <= rounding(time_s, step_s) {
            return [0.0; 2];
        }
        let place = |k: usize| k as f64 - 0.5 * last as f64;
        let mean_s = (0..=last).map(off_s).sum::<f64>() / (last + 1) as f64;
        let squares: f64 = (0..=last).map(|k| place(k).powi(2)).sum();
        let slope_s = (0..=last).map(|k| place(k) * off_s(k)).sum::<f64>() / squares;
        let from_best_s = farthest(&|k| off_s(k) - mean_s - slope_s * place(k));
        [from_ends_s / step_s, from_best_s / step_s]
    }
}

/// Every n-th sample of a [`TimeGrid`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinnedGrid {
    grid: TimeGrid,
    /// Index of the first sample.
    start: usize,
    every: NonZeroUsize,
}

impl ThinnedGrid {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.grid.len.saturating_sub(self.start).div_ceil(self.every.get())
    }

    /// True if there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Time of sample `k` in s.
    pub fn time_s(&self, k: usize) -> f64 {
        self.grid.time_s(self.index(k))
    }

    /// Index of sample `k` in the whole grid.
    pub(crate) fn index(&self, k: usize) -> usize {
        self.start + k * self.every.get()
    }

    /// Steps of the whole grid between neighbouring samples.
    pub(crate) fn every(&self) -> usize {
        self.every.get()
    }

    /// Picks the values at these samples from the values of the whole grid.
    pub(crate) fn taken<'a>(&self, values: &'a [f64]) -> Cow<'a, [f64]> {
        if self.every.get() == 1 {
            return Cow::Borrowed(&values[self.start..]);
        }
        values.iter().skip(self.start).step_by(self.every.get()).copied().collect()
    }
}

/// Largest deviation of a time from the grid, in steps.
const TIME_TOLERANCE: f64 = 1e-3;

/// Largest ratio of the last decimal to the step at which times may be off by one decimal: allows a rate of 60 Hz
/// written in whole milliseconds.
const DECIMAL_SHARE: f64 = 0.1;

/// A time that is not on the uniform grid of the others.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "time = {} s, but must be {} s: the samples before and after are {} s apart",
    rounded(*found_s, 12),
    rounded(*expected_s, 12),
    rounded(*step_s, 12)
)]
pub struct NotUniform {
    /// Number of the sample, from 0.
    pub sample: usize,
    /// Time in the input, in s.
    pub found_s: f64,
    /// Time that continues the grid, in s.
    pub expected_s: f64,
    /// Step of the grid in s.
    pub step_s: f64,
}

impl NotUniform {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        "write times with more decimals, or resample the file to a uniform step"
    }
}

/// Allowed distance of a time from the grid, in s.
fn slack(time_s: &[f64], step_s: f64) -> f64 {
    (TIME_TOLERANCE * step_s).max(rounding(time_s, step_s))
}

/// Distance of a time from the grid, in s, that the rounding of its last decimal explains.
fn rounding(time_s: &[f64], step_s: f64) -> f64 {
    let decimal_s = last_decimal(time_s);
    // Half a decimal for the time itself, and half for the ends of the grid.
    let rounding_s = if decimal_s <= DECIMAL_SHARE * step_s { decimal_s } else { 0.0 };
    1.001 * rounding_s
}

/// Largest decimal unit, at most 1 s, of which all times are whole multiples.
fn last_decimal(time_s: &[f64]) -> f64 {
    let is_whole = |scale: f64| {
        time_s.iter().all(|t| {
            let scaled = t * scale;
            (scaled - scaled.round()).abs() <= 1e-6
        })
    };
    (0..12)
        .map(|decimals| 10.0_f64.powi(decimals))
        .find(|scale| is_whole(*scale))
        .map_or(0.0, f64::recip)
}

/// True if a distance exceeds its limit or is NaN.
fn exceeds(distance: f64, limit: f64) -> bool {
    distance > limit || distance.is_nan()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(time_s: &[f64]) -> String {
        TimeGrid::through(time_s).unwrap_err().to_string()
    }

    #[test]
    fn times_with_few_digits_are_uniform_and_keep_the_mean_step() {
        let third = |k: i32| (f64::from(k) / 300.0 * 1e6).round() / 1e6;
        let times: Vec<f64> = (0..301).map(third).collect();
        assert!((TimeGrid::through(&times).unwrap().step_s - 1.0 / 300.0).abs() < 1e-15);
    }

    #[test]
    fn ordinary_rates_in_few_decimals_are_uniform() {
        for (rate, decimals) in [(60.0, 3), (60.0, 4), (240.0, 4), (300.0, 5), (1000.0, 3)] {
            let unit = 10.0_f64.powi(decimals);
            let rounded = |k: i32| (f64::from(k) / rate * unit).round() / unit;
            let times: Vec<f64> = (0..=600).map(rounded).collect();
            let step_s = TimeGrid::through(&times).unwrap().step_s;
            assert!((step_s * rate - 1.0).abs() < 1e-3, "{rate} Hz in {decimals} decimals");
        }
        // At 154 Hz some of these end with a time rounded up and contain another rounded down.
        let rounded = |k: i32| (f64::from(k) / 154.0 * 1e5).round() / 1e5;
        for last in 4..200 {
            let times: Vec<f64> = (0..=last).map(rounded).collect();
            assert!(TimeGrid::through(&times).is_ok(), "154 Hz, {last} steps");
        }
        // In whole seconds a jitter cannot be distinguished from rounding.
        assert!(TimeGrid::through(&[0.0, 1.0, 2.0, 4.0, 5.0]).is_err());
    }

    #[test]
    fn a_missing_row_and_a_stray_time_are_named() {
        let mut times: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.5).collect();
        times.remove(7);
        assert_eq!(
            refusal(&times),
            "time = 4 s, but must be 3.5 s: the samples before and after are 0.5 s apart"
        );
        let times = [0.0, 1.0, 2.25, 3.0, 4.0, 5.0];
        assert!(refusal(&times).starts_with("time = 2.25 s, but must be 2 s"));
    }

    #[test]
    fn a_steady_drift_of_the_step_is_refused() {
        let times: Vec<f64> = (0..100).map(|k| f64::from(k) + 1e-5 * f64::from(k * k)).collect();
        assert!(TimeGrid::through(&times).is_err());
    }
}
