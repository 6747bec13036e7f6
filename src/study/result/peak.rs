//! The largest value of a history, also between its samples.

use std::f64::consts::PI;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::inverse::Solution;
use crate::numeric::{TimeGrid, dot, largest};

/// Number of samples in each part of the search.
const PART: usize = 128;

/// Number of parts of a step, for interpolation between them.
const PARTS: usize = 16;

/// Number of samples on either side that contribute to an interpolated value.
const SIDE: usize = 48;

/// Shape β of the window exp(β √(1 − x²)) (A. H. Barnett, J. Magland, L. af Klinteberg, SIAM J. Sci. Comput. 41(5),
/// 2019). A wave is right to 1e-6 of its amplitude up to 0.9 of the Nyquist frequency, and to 4e-2 at 0.95 of it,
/// where the roll-off leaves a twentieth.
const WINDOW: f64 = 14.0;

/// Samples per cycle above which a parabola through three of them places the largest value to within a
/// part of a step.
const MANY: f64 = 8.0;

/// A largest value and its time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// The value.
    pub value: f64,
    /// Its time in s.
    pub time_s: f64,
}

/// Weights of the samples from `SIDE − 1` before one to `SIDE` after it, for every part of the step after this
/// sample: the sinc function times the window.
static WEIGHTS: LazyLock<[[f64; 2 * SIDE]; PARTS]> = LazyLock::new(|| {
    std::array::from_fn(|part| {
        let at = part as f64 / PARTS as f64;
        let weight = |tap: usize| {
            let away = tap as f64 - (SIDE - 1) as f64 - at;
            let sinc = if away == 0.0 { 1.0 } else { libm::sin(PI * away) / (PI * away) };
            let share = away / SIDE as f64;
            sinc * libm::exp(WINDOW * (1.0 - share * share).max(0.0).sqrt())
        };
        let weights: [f64; 2 * SIDE] = std::array::from_fn(weight);
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    })
});

/// Value of a history `part` parts of a step after sample `k`; constant beyond its ends.
fn between(samples: &[f64], k: usize, part: usize) -> f64 {
    let weights = &WEIGHTS[part];
    if let Some(around) = (k + 1).checked_sub(SIDE).and_then(|from| samples.get(from..k + 1 + SIDE))
    {
        return dot(weights, around);
    }
    let last = samples.len() - 1;
    let taps = weights.iter().enumerate();
    taps.map(|(tap, weight)| weight * samples[(k + tap + 1).saturating_sub(SIDE).min(last)]).sum()
}

/// Finds the peaks of histories on a grid.
#[derive(Clone, Copy)]
pub(super) struct Peaks<'a> {
    pub(super) grid: &'a TimeGrid,
    /// Samples per cycle at the end of the band, for interpolated histories without content above a frequency below
    /// Nyquist's; `None` for peaks of the samples alone.
    pub(super) per_cycle: Option<f64>,
}

impl<'a> Peaks<'a> {
    /// Search in the histories of a solution.
    pub(super) fn in_solution(Solution { grid, band, .. }: &'a Solution) -> Self {
        let per_cycle = band.cutoff_hz.map(|_| 1.0 / (band.highest_hz * grid.step_s));
        Self { grid, per_cycle }
    }

    /// Largest magnitude of a history.
    pub(super) fn of(&self, samples: &[f64]) -> Peak {
        let at = |k: usize, part: usize| between(samples, k, part);
        Tops::of(samples, self.grid).peak(self.per_cycle, at)
    }

    /// Largest magnitude of the product of two histories, which has twice their band.
    pub(super) fn of_product(&self, a: &[f64], b: &[f64]) -> Peak {
        let product: Vec<f64> = a.iter().zip(b).map(|(a, b)| a * b).collect();
        let at = |k: usize, part: usize| between(a, k, part) * between(b, k, part);
        Tops::of(&product, self.grid).peak(self.per_cycle.map(|own| 0.5 * own), at)
    }
}

/// Search for the peak between samples.
struct Tops<'a> {
    samples: &'a [f64],
    /// Largest magnitude of every [`PART`] samples.
    largest: Vec<f64>,
    grid: &'a TimeGrid,
}

impl<'a> Tops<'a> {
    fn of(samples: &'a [f64], grid: &'a TimeGrid) -> Self {
        Self { samples, largest: samples.chunks(PART).map(largest).collect(), grid }
    }

    /// The first of the largest samples. The function searches only the part that contains it.
    fn largest_sample(&self) -> Peak {
        let (mut value, mut first) = (0.0, 0);
        for (part, here) in self.largest.iter().enumerate() {
            if *here > value {
                (value, first) = (*here, part * PART);
            }
        }
        let mut within = self.samples[first..].iter();
        let within = within.position(|sample| sample.abs() >= value).unwrap_or(0);
        Peak { value, time_s: self.grid.time_s(first + within) }
    }

    /// The larger of two peaks: the samples' peak, and the values `at` around every sample that exceeds its
    /// neighbours of the same sign and is not much smaller than the samples' peak.
    fn peak(&self, per_cycle: Option<f64>, at: impl Fn(usize, usize) -> f64) -> Peak {
        let peak = self.largest_sample();
        let Some(per_cycle) = per_cycle.filter(|_| peak.value != 0.0) else { return peak };
        let mut found = peak;
        let last = self.samples.len() - 1;
        // Half way between two samples of a wave at the end of the band.
        let near = libm::cos(PI / per_cycle.max(4.0)).powi(2);
        let level = near * peak.value;
        let reaching = (0..self.largest.len()).filter(|part| self.largest[*part] >= level);
        let places = reaching.flat_map(|part| {
            let samples = part * PART..last.min(part * PART + PART - 1) + 1;
            samples.filter(|k| self.samples[*k].abs() >= level)
        });
        for k in places {
            let beside = [k.saturating_sub(1), (k + 1).min(last)];
            if !beside.iter().all(|beside| self.tops(k, *beside)) {
                continue;
            }
            let from = k.saturating_sub(1);
            let fine = |n: usize| at((from + n / PARTS).min(last), n % PARTS).abs();
            let [first, end] = self.places(k, per_cycle);
            let values: Vec<f64> = (first - 1..=end + 1).map(fine).collect();
            for (place, three) in values.windows(3).enumerate() {
                let [before, here, after] = [three[0], three[1], three[2]];
                if here < before || here < after {
                    continue;
                }
                // The parabola through three samples.
                let bend = 2.0 * here - before - after;
                let shift = if bend > 0.0 { 0.5 * (after - before) / bend } else { 0.0 };
                let value = here + 0.25 * shift * (after - before);
                if value > found.value {
                    let steps = ((first + place) as f64 + shift) / PARTS as f64;
                    let time_s = self.grid.time_s(from) + steps * self.grid.step_s;
                    found = Peak { value, time_s };
                }
            }
        }
        found
    }

    fn tops(&self, k: usize, beside: usize) -> bool {
        let [here, there] = [self.samples[k], self.samples[beside]];
        here * there <= 0.0 || here.abs() >= there.abs()
    }

    /// The parts of a step after sample `k − 1` that enclose the largest value around sample `k`.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 2 steps")]
    fn places(&self, k: usize, per_cycle: f64) -> [usize; 2] {
        let whole = [1, 2 * PARTS - 1];
        let is_inner = k > 0 && k + 1 < self.samples.len();
        if per_cycle < MANY || !is_inner {
            return whole;
        }
        let [before, here, after] = [k - 1, k, k + 1].map(|k| self.samples[k].abs());
        let bend = 2.0 * here - before - after;
        if bend <= 0.0 {
            return whole;
        }
        let place = PARTS as f64 * (1.0 + 0.5 * (after - before) / bend);
        let nearest = (place.round() as usize).clamp(2, 2 * PARTS - 2);
        [nearest - 1, nearest + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak(samples: &[f64], per_cycle: Option<f64>) -> Peak {
        Peaks { grid: &grid(samples.len()), per_cycle }.of(samples)
    }

    fn grid(len: usize) -> TimeGrid {
        TimeGrid { origin_s: 1.0, step_s: 0.5, first: -1, len }
    }

    #[test]
    fn the_peak_of_samples_is_the_first_of_equal_magnitudes() {
        let found = peak(&[0.0, -2.0, 1.0, 2.0], None);
        assert_eq!(found, Peak { value: 2.0, time_s: 1.0 });
    }

    /// A bell of three waves, its largest value −1.5 at sample 60.37 of 120.
    fn bell(cycle_steps: f64) -> Vec<f64> {
        let at = |k: i32| {
            let away = f64::from(k) - 60.37;
            -1.5 * (-(away / 12.0).powi(2)).exp() * (2.0 * PI * away / cycle_steps).cos()
        };
        (0..120).map(at).collect()
    }

    #[test]
    fn a_peak_between_samples_is_found_from_two_and_a_half_samples_a_cycle_on() {
        for (cycle_steps, error) in
            [(2.4, 1e-3), (3.0, 1e-4), (4.0, 1e-6), (8.0, 1e-6), (14.0, 1e-6), (40.0, 1e-6)]
        {
            let samples = bell(cycle_steps);
            let found = peak(&samples, Some(cycle_steps));
            assert!((found.value / 1.5 - 1.0).abs() < error, "{cycle_steps}: {found:?}");
            assert!((found.time_s - (1.0 + 0.5 * 59.37)).abs() < 1e-2, "{cycle_steps}: {found:?}");
            let sampled = peak(&samples, None).value;
            assert!(cycle_steps > 4.0 || sampled < 0.97 * 1.5, "{cycle_steps}: {sampled}");
        }
    }

    #[test]
    fn the_peak_of_a_product_is_found_from_its_factors() {
        let (a, b) = (bell(4.0), vec![2.0; 120]);
        let peaks = Peaks { grid: &grid(120), per_cycle: Some(3.0) };
        let found = peaks.of_product(&a, &b);
        assert!((found.value / 3.0 - 1.0).abs() < 1e-4, "{found:?}");
        let square = peaks.of_product(&a, &a);
        assert!((square.value / 2.25 - 1.0).abs() < 1e-4, "{square:?}");
    }

    #[test]
    fn rest_has_no_peak_and_an_end_is_one() {
        assert_eq!(peak(&[0.0; 9], Some(3.0)).value.to_bits(), 0);
        let ramp: Vec<f64> = (0..40).map(|k| 1.0 - (-0.3 * f64::from(k)).exp()).collect();
        let found = peak(&ramp, Some(3.0));
        assert!((found.value - ramp[39]).abs() < 1e-4, "{found:?}");
    }
}
