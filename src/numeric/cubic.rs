//! Cubics through evenly spaced samples of a complex function.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places are counted in samples from zero on"
)]

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

/// Samples around a place that its cubic goes through.
const AROUND: usize = 4;

/// The cubic through the four samples around a place, which is counted in samples.
///
/// # Panics
/// If there are fewer than four.
pub(crate) fn cubic(samples: &[Complex64], place: f64) -> Complex64 {
    let (first, around) = around(samples, place);
    through(around, place - first)
}

/// Multiplies each value by the cubic at its place, as [`cubic`] has it, with the same bits on every
/// processor.
///
/// Fast where places ascend, so that many one after the other lie between the same samples.
///
/// # Panics
/// As [`cubic`].
pub(crate) fn scale_by_cubics(samples: &[Complex64], places: &[f64], values: &mut [Complex64]) {
    Arch::new().dispatch(Scale { samples, places, values });
}

/// The sample at or before a place.
pub(crate) fn whole(place: f64) -> usize {
    place as usize
}

struct Scale<'a> {
    samples: &'a [Complex64],
    places: &'a [f64],
    values: &'a mut [Complex64],
}

impl WithSimd for Scale<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { samples, places, mut values } = self;
        for places in places.chunk_by(|a, b| whole(*a) == whole(*b)) {
            let (first, around) = around(samples, places[0]);
            let (here, further) = values.split_at_mut(places.len().min(values.len()));
            for (value, place) in here.iter_mut().zip(places) {
                *value *= through(around, place - first);
            }
            values = further;
        }
    }
}

/// The samples around a place, and the number of the first.
#[inline(always)]
fn around(samples: &[Complex64], place: f64) -> (f64, [Complex64; AROUND]) {
    let first = whole(place).saturating_sub(1).min(samples.len() - AROUND);
    (first as f64, std::array::from_fn(|k| samples[first + k]))
}

/// The cubic through four samples at `t` behind the first.
#[inline(always)]
fn through(around: [Complex64; AROUND], t: f64) -> Complex64 {
    let (t1, t2, t3) = (t - 1.0, t - 2.0, t - 3.0);
    let outer = around[0] * (t2 * t3 * t1 * (-1.0 / 6.0)) + around[3] * (t * t1 * t2 * (1.0 / 6.0));
    let inner = around[1] * (t * t2 * t3 * 0.5) + around[2] * (t * t1 * t3 * -0.5);
    outer + inner
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(t: f64) -> Complex64 {
        Complex64::new(t * t * t - 2.0 * t, 3.0 - t * t)
    }

    #[test]
    fn a_cubic_is_interpolated_as_it_is() {
        let samples: Vec<Complex64> = (0..7).map(|k| value(f64::from(k))).collect();
        for place in [0.0, 0.3, 1.0, 2.7, 5.5, 6.0] {
            assert!((cubic(&samples, place) - value(place)).norm() < 1e-13, "at {place}");
        }
    }

    #[test]
    fn many_places_have_the_bits_of_each_alone_on_all_vectors() {
        let samples: Vec<Complex64> = (0..20).map(|k| value(0.3 * f64::from(k)).inv()).collect();
        let places: Vec<f64> = (0..500).map(|k| 19.0 * (f64::from(k) / 499.0).sqrt()).collect();
        let factor = |k: usize| Complex64::new(1.0 + k as f64, -0.7);
        let mut wide: Vec<Complex64> = (0..500).map(factor).collect();
        let mut narrow = wide.clone();
        scale_by_cubics(&samples, &places, &mut wide);
        Scale { samples: &samples, places: &places, values: &mut narrow }.with_simd(pulp::Scalar);
        for (k, place) in places.iter().enumerate() {
            let alone = factor(k) * cubic(&samples, *place);
            assert!(wide[k] == alone && narrow[k] == alone, "at {place}");
        }
    }
}
