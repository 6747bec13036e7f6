//! Polynomials of the fifth degree through evenly spaced samples of a complex function.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places are counted in samples from zero on"
)]

use std::ops::Range;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

/// Samples around a place that its quintic goes through.
const AROUND: usize = 6;

/// The quintic through the six samples around a place, which is counted in samples.
///
/// # Panics
/// If there are fewer than six.
pub(crate) fn quintic(samples: &[Complex64], place: f64) -> Complex64 {
    let (first, around) = around(samples, place);
    through(around, place - first)
}

/// Numbers 0, 1, … laid over evenly spaced samples by their roots: the first stands at the first
/// sample, the last at the last.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RootPlaces {
    /// How many numbers there are, two or more.
    pub(crate) numbers: usize,
    /// Intervals between the samples.
    pub(crate) intervals: usize,
}

impl RootPlaces {
    /// The numbers that stand between a sample and the next, those at the latter left out unless it
    /// is the last.
    #[inline(always)]
    pub(crate) fn between(&self, sample: usize) -> Range<usize> {
        self.first_at(sample)..self.first_at(sample + 1)
    }

    #[inline(always)]
    fn first_at(&self, sample: usize) -> usize {
        let share = sample as f64 / self.intervals as f64;
        let number = ((self.numbers - 1) as f64 * (share * share)).ceil() as usize;
        if sample < self.intervals { number } else { self.numbers }
    }
}

/// Multiplies each value, which are as many as the places', by the [`quintic`] at its place, with the
/// same bits on every processor.
///
/// # Panics
/// If there are fewer than six samples, other than one more than intervals, or fewer values than
/// numbers.
pub(crate) fn scale_by_quintics(
    samples: &[Complex64],
    places: RootPlaces,
    values: &mut [Complex64],
) {
    assert_eq!(samples.len(), places.intervals + 1, "a sample at both ends of each interval");
    Arch::new().dispatch(Scale { samples, places, values });
}

struct Scale<'a> {
    samples: &'a [Complex64],
    places: RootPlaces,
    values: &'a mut [Complex64],
}

impl WithSimd for Scale<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { samples, places, values } = self;
        let per_root = places.intervals as f64 / ((places.numbers - 1) as f64).sqrt();
        for sample in 0..places.intervals {
            let (first, around) = around(samples, sample as f64);
            let between = places.between(sample);
            let start = between.start;
            for (k, value) in values[between].iter_mut().enumerate() {
                *value *= through(around, ((start + k) as f64).sqrt() * per_root - first);
            }
        }
    }
}

/// The samples around a place, and the number of the first.
#[inline(always)]
fn around(samples: &[Complex64], place: f64) -> (f64, [Complex64; AROUND]) {
    let first = (place as usize).saturating_sub(2).min(samples.len() - AROUND);
    (first as f64, std::array::from_fn(|k| samples[first + k]))
}

/// The quintic through six samples at `t` behind the first, by Lagrange's formula.
#[inline(always)]
fn through(around: [Complex64; AROUND], t: f64) -> Complex64 {
    let [t1, t2, t3, t4, t5] = [t - 1.0, t - 2.0, t - 3.0, t - 4.0, t - 5.0];
    let (low, middle, high) = (t * t1, t2 * t3, t4 * t5);
    let early = around[0] * (t1 * middle * high * (-1.0 / 120.0))
        + around[1] * (t * middle * high * (1.0 / 24.0));
    let amid = around[2] * (low * t3 * high * (-1.0 / 12.0))
        + around[3] * (low * t2 * high * (1.0 / 12.0));
    let late = around[4] * (low * middle * t5 * (-1.0 / 24.0))
        + around[5] * (low * middle * t4 * (1.0 / 120.0));
    early + amid + late
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(t: f64) -> Complex64 {
        Complex64::new(t.powi(5) - 20.0 * t * t, 3.0 - t.powi(4))
    }

    #[test]
    fn a_quintic_is_interpolated_as_it_is() {
        let samples: Vec<Complex64> = (0..9).map(|k| value(f64::from(k))).collect();
        for place in [0.0, 0.3, 1.0, 2.7, 4.5, 7.5, 8.0] {
            let off = (quintic(&samples, place) - value(place)).norm();
            assert!(off < 1e-15 * samples[8].norm(), "at {place}: {off:e}");
        }
    }

    /// What a quintic errs by of t⁶ is the product of its distances from the six samples.
    #[test]
    fn a_place_lies_amid_its_samples() {
        let samples: Vec<Complex64> =
            (0..9).map(|k| Complex64::from(f64::from(k).powi(6))).collect();
        for (place, first) in [(0.5, 0), (2.5, 0), (3.5, 1), (4.5, 2), (5.5, 3), (7.5, 3)] {
            let distances = (first..first + 6).map(|k| place - f64::from(k));
            let error = place.powi(6) - quintic(&samples, place).re;
            let expected: f64 = distances.product();
            assert!((error - expected).abs() < 1e-9, "at {place}: {error}, {expected}");
        }
    }

    #[test]
    fn many_values_are_scaled_as_each_alone_with_the_same_bits_on_all_vectors() {
        let samples: Vec<Complex64> = (0..20).map(|k| value(0.3 * f64::from(k)).inv()).collect();
        let places = RootPlaces { numbers: 500, intervals: 19 };
        let factor = |k: usize| Complex64::new(1.0 + k as f64, -0.7);
        let mut wide: Vec<Complex64> = (0..500).map(factor).collect();
        let mut narrow = wide.clone();
        scale_by_quintics(&samples, places, &mut wide);
        Scale { samples: &samples, places, values: &mut narrow }.with_simd(pulp::Scalar);
        for k in 0..500_u32 {
            let place = f64::from(k).sqrt() * (19.0 / 499.0_f64.sqrt());
            let alone = factor(k as usize) * quintic(&samples, place);
            assert!(wide[k as usize] == narrow[k as usize], "{k}");
            let off = (wide[k as usize] - alone).norm();
            assert!(off <= 1e-12 * alone.norm(), "{k} at {place}: {off:e}");
        }
    }

    #[test]
    fn every_number_stands_between_the_two_samples_next_to_its_root() {
        for (numbers, intervals) in [(500, 19), (1025, 47), (101, 10), (95, 94), (2, 6)] {
            let places = RootPlaces { numbers, intervals };
            let mut next = 0;
            for sample in 0..intervals {
                let between = places.between(sample);
                assert_eq!(between.start, next, "a number is lost, or stands twice");
                next = between.end;
                for number in between {
                    let share = number as f64 / (numbers - 1) as f64;
                    let place = intervals as f64 * share.sqrt() - sample as f64;
                    assert!(
                        (-1e-12..1.0 + 1e-12).contains(&place),
                        "{number} of {numbers}: {place}"
                    );
                }
            }
            assert_eq!(next, numbers);
        }
    }
}
