//! Samples over time, and predictions by polynomials through their neighbours.

use crate::numeric::largest;

/// Number of samples before and after a sample that decide whether it is bad.
pub(super) const NEAR: usize = 4;
/// Number of samples before and after a sample that show the noise around it.
pub(super) const AROUND: usize = 20;
/// Number of samples at each end without neighbours on both sides for a prediction.
pub(super) const ENDS: usize = 3;
/// Smallest distance of a bad sample in standard deviations of the noise.
pub(super) const DEVIATIONS: f64 = 6.5;
/// Largest distance of the samples near a removed bad sample, in standard deviations of the noise.
pub(super) const LEFT_DEVIATIONS: f64 = 4.0;
/// Smallest distance of another bad sample nearby, relative to the bad sample's distance.
pub(super) const SECOND: f64 = 0.4;
/// Largest distance of a sample that continues one side from that side's prediction: relative to the distance from its
/// cubic, and in standard deviations of the noise.
pub(super) const CONTINUES: f64 = 1.0 / 3.0;
pub(super) const CONTINUES_DEVIATIONS: f64 = 4.5;
/// Limit for the nearest sample of the predicting side, relative to the limit for the predicted sample.
const LED_BEFORE: f64 = 1.5;
/// Polynomials that predict from one side (samples, degree); the last ones follow a corner of a smooth motion.
pub(super) const LEADS: [(usize, usize); 6] = [(2, 1), (4, 1), (6, 2), (3, 2), (4, 3), (5, 4)];

/// Distances over the largest value below which they are round-off.
const ROUND_OFF: f64 = 1e-12;
/// Distances over the largest value that stay unnoticed.
pub(super) const UNNOTICED: f64 = 1e-9;
/// Smallest distance of a bad sample in the smallest steps between samples: a counter flickers by one or two.
const QUANTA: f64 = 3.5;
/// Median of the absolute value of a normal variable.
const MEDIAN: f64 = 0.674_5;
/// Fewest distances of samples that show the noise of all.
const FEWEST_OF_NOISE: usize = 25;
/// Upper quartile of the absolute value of a normal variable.
const QUARTILE: f64 = 1.15;
/// Relative doubt about the noise, times the number of samples that show it.
const FEW: f64 = 8.0;

/// Change of a quantity from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Without jumps, like a place or an angle. Its first and last samples are judged by one side.
    Continuous,
    /// With jumps, like a velocity, an acceleration or a torque. A deviation of two samples in a row, or of one of the
    /// first or last three, may be a pulse or the start of a step.
    Jumping,
}

/// Negligible distances in a column.
pub(super) struct Limits {
    pub(super) round_off: f64,
    /// Smallest distance of a bad sample.
    pub(super) least: f64,
}

impl Limits {
    pub(super) fn of(values: &[f64]) -> Self {
        let size = largest(values);
        let round_off = ROUND_OFF * size;
        let steps = values.windows(2).map(|two| (two[1] - two[0]).abs());
        let quantum = steps.filter(|step| *step > round_off).fold(f64::INFINITY, f64::min);
        let quantum = if quantum.is_finite() { quantum } else { 0.0 };
        Self { round_off, least: (QUANTA * quantum).max(UNNOTICED * size) }
    }
}

/// Standard deviation of the noise of samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    pub(super) deviation: f64,
    /// Factor for the uncertainty from few samples.
    pub(super) doubt: f64,
}

impl Noise {
    /// The noise of a whole column, or of some samples if it is larger.
    pub(super) fn around(whole: f64, mut deviations: Vec<f64>) -> Self {
        let doubt = if whole > 0.0 { 1.0 } else { 1.0 + FEW / deviations.len().max(1) as f64 };
        let deviation = whole.max(quantile(&mut deviations, 0.75) / QUARTILE);
        Self { deviation, doubt }
    }

    /// A distance of this number of standard deviations, with the doubt.
    pub(super) fn surely(self, deviations: f64) -> f64 {
        deviations * self.doubt * self.deviation
    }
}

/// Prediction from neighbours.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lead {
    pub(super) value: f64,
    /// Standard deviation of a sample's distance from the prediction, over the deviation of a sample.
    pub(super) gain: f64,
}

/// Samples over time.
pub(super) struct Course {
    pub(super) time_s: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Course {
    /// Keeps the samples for which `is_kept` is true.
    pub(super) fn kept(&self, is_kept: &[bool]) -> Self {
        Self { time_s: kept(&self.time_s, is_kept), values: kept(&self.values, is_kept) }
    }

    /// A range of the samples.
    pub(super) fn part(&self, range: std::ops::Range<usize>) -> Self {
        Self { time_s: self.time_s[range.clone()].to_vec(), values: self.values[range].to_vec() }
    }

    /// Distance of a sample from the cubic through its neighbours, and its deviation over the deviation of a sample.
    pub(super) fn off(&self, k: usize) -> (f64, f64) {
        let lead = self.cubic(self.time_s[k], self.around(k, Some(k)));
        (self.values[k] - lead.value, lead.gain)
    }

    /// Numbers of the four samples nearest to sample `k`, skipping `left_out`.
    pub(super) fn around(&self, k: usize, left_out: Option<usize>) -> [usize; 4] {
        let len = self.values.len();
        let skipped = usize::from(left_out.is_some());
        let first = k.saturating_sub(2).min(len - 4 - skipped);
        [0, 1, 2, 3].map(|j| {
            let at = first + j;
            if left_out.is_some_and(|sample| at >= sample) { at + 1 } else { at }
        })
    }

    /// Prediction for one of a row of samples by the cubic through the samples before and after the row: two on each
    /// side, or more on one side where the other has fewer.
    pub(super) fn across(&self, k: usize, [first, last]: [usize; 2]) -> Lead {
        let after = self.values.len() - 1 - last;
        let before = if after < 2 { 4 - after } else { first.min(2) };
        let near = |j: usize| if j < before { first - before + j } else { last + 1 + j - before };
        self.cubic(self.time_s[k], [0, 1, 2, 3].map(near))
    }

    /// Prediction at a time by the cubic through four samples.
    pub(super) fn cubic(&self, time_s: f64, samples: [usize; 4]) -> Lead {
        let weights = samples.map(|i| {
            let others = samples.into_iter().filter(|j| *j != i);
            let at = |j: usize| (time_s - self.time_s[j]) / (self.time_s[i] - self.time_s[j]);
            others.map(at).product::<f64>()
        });
        self.led(weights.into_iter().zip(samples))
    }

    /// True if a polynomial through the samples of one side, nearest first, predicts a sample within a distance. A
    /// prediction that noise of this standard deviation could hit by chance does not count.
    ///
    /// For a quantity without jumps the polynomial must also have predicted the nearest sample of that side nearly as
    /// well. A line that misses a curve can hit a bad sample by chance.
    pub(super) fn is_led_to(
        &self,
        k: usize,
        side: &[usize],
        (within, deviation): (f64, f64),
        change: Change,
    ) -> bool {
        let leads_to = |k: usize, side: &[usize], degree: usize, within: f64| {
            let lead = self.fitted(self.time_s[k], side, degree);
            lead.gain * deviation < within && (self.values[k] - lead.value).abs() < within
        };
        LEADS.into_iter().any(|(samples, degree)| {
            side.len() >= samples
                && leads_to(k, &side[..samples], degree, within)
                && (change == Change::Jumping
                    || side.len() == samples
                    || leads_to(side[0], &side[1..=samples], degree, LED_BEFORE * within))
        })
    }

    /// Prediction at a time by a polynomial, fitted to some samples by least squares.
    pub(super) fn fitted(&self, time_s: f64, samples: &[usize], degree: usize) -> Lead {
        let places: Vec<f64> = samples.iter().map(|j| self.time_s[*j] - time_s).collect();
        let scale = largest(&places);
        let places: Vec<f64> = places.iter().map(|own| own / scale).collect();
        // Polynomials orthogonal over the samples, by their recurrence: values at the samples, and last at 0.
        let mut before = vec![0.0; samples.len() + 1];
        let mut own = vec![1.0; samples.len() + 1];
        let mut weights = vec![0.0; samples.len()];
        let mut size_before = 1.0;
        for order in 0..=degree {
            let at_samples = || own[..samples.len()].iter().zip(&places);
            let size: f64 = at_samples().map(|(p, _)| p * p).sum();
            let at_zero = own[samples.len()];
            for (weight, p) in weights.iter_mut().zip(&own) {
                *weight += at_zero * p / size;
            }
            let mean = at_samples().map(|(p, u)| u * p * p).sum::<f64>() / size;
            let ratio = if order == 0 { 0.0 } else { size / size_before };
            let at_all = places.iter().chain([&0.0]).zip(own.iter().zip(&before));
            let next = at_all.map(|(u, (p, q))| (u - mean) * p - ratio * q).collect();
            (before, own, size_before) = (own, next, size);
        }
        self.led(weights.into_iter().zip(samples.iter().copied()))
    }

    fn led(&self, weights: impl Iterator<Item = (f64, usize)>) -> Lead {
        let (mut value, mut squares) = (0.0, 1.0);
        for (weight, sample) in weights {
            value += weight * self.values[sample];
            squares += weight * weight;
        }
        Lead { value, gain: squares.sqrt() }
    }
}

/// A column, and the distance of each sample from its neighbours' cubic.
pub(super) struct Column<'a> {
    pub(super) course: &'a Course,
    pub(super) limits: &'a Limits,
    pub(super) change: Change,
    /// Distance of each sample, and its deviation over the deviation of a sample.
    pub(super) off: Vec<(f64, f64)>,
    /// Distances divided by these deviations.
    pub(super) deviations: Vec<f64>,
    /// Standard deviation of the noise of the whole column; 0 if it has too few samples.
    pub(super) noise: f64,
}

impl<'a> Column<'a> {
    pub(super) fn of(course: &'a Course, limits: &'a Limits, change: Change) -> Self {
        let off: Vec<(f64, f64)> = (0..course.values.len()).map(|k| course.off(k)).collect();
        let deviations: Vec<f64> = off.iter().map(|(off, gain)| off.abs() / gain).collect();
        let rough = deviations.iter().copied().filter(|own| *own > limits.round_off);
        let mut rough: Vec<f64> = rough.collect();
        let is_known = rough.len() >= FEWEST_OF_NOISE;
        let noise = if is_known { quantile(&mut rough, 0.5) / MEDIAN } else { 0.0 };
        Self { course, limits, change, off, deviations, noise }
    }
}

/// Keeps the elements for which `is_kept` is true.
pub(super) fn kept<T: Copy>(all: &[T], is_kept: &[bool]) -> Vec<T> {
    all.iter().zip(is_kept).filter(|(_, kept)| **kept).map(|(own, _)| *own).collect()
}

/// A quantile of numbers, which it reorders; 0 without numbers.
pub(super) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number from 0 to that of the values"
    )]
    let at = (share * (values.len() - 1) as f64) as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}
