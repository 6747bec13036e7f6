//! The Fourier pair on real samples.

use std::borrow::Cow;
use std::f64::consts::TAU;
use std::sync::Arc;

use num_complex::Complex64;
use pulp::Arch;

use super::transform::{Forward, Inverse, Plan, Scratch};

/// Fourier pair on an even number N of real samples.
///
/// ```text
/// X_k = (1/N) Σ_j x_j e^{−2πi jk/N}    k = 0 … N/2
/// x_j = Σ_k X_k e^{+2πi jk/N}          k = −N/2 + 1 … N/2, X_{−k} = conj X_k
/// ```
/// so that `X_k` is the complex amplitude of `e^{+iω_k t}` with `ω_k = 2πk/P` (Bayo 1987, eq 13).
#[derive(Debug, Clone)]
pub struct FourierPair(Arc<Plan>);

impl FourierPair {
    /// Plans the pair for `len` samples or a few more: the least number that is fast to transform.
    pub fn fast(len: usize) -> Self {
        Self::new(fast_length(len))
    }

    /// Plans the pair for `len` samples, an even number above 0. Lengths from [`fast_length`] are
    /// fast; the time of others grows with their largest prime factor.
    ///
    /// # Panics
    /// If `len` is odd or zero.
    pub(crate) fn new(len: usize) -> Self {
        assert!(len > 0 && len.is_multiple_of(2), "a Fourier pair needs an even length, not {len}");
        Self(Arc::new(Plan::new(len / 2)))
    }

    /// Number N of samples.
    pub fn len(&self) -> usize {
        2 * self.0.points
    }

    /// False: a pair has at least two samples.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Amplitudes `X_0 … X_{N/2}` of N samples; those not given are zero, further ones are left out.
    pub fn amplitudes(&self, samples: impl AsRef<[f64]>) -> Vec<Complex64> {
        let (plan, scale) = (&*self.0, 1.0 / self.len() as f64);
        let mut samples = Cow::Borrowed(samples.as_ref());
        if samples.len() != self.len() {
            samples.to_mut().resize(self.len(), 0.0);
        }
        let samples = &*samples;
        let mut found = vec![Complex64::ZERO; self.len() / 2 + 1];
        let (scratch, amplitudes) = (&mut Scratch::default(), &mut found[..]);
        Arch::new().dispatch(Forward { plan, samples, scale, scratch, amplitudes });
        found
    }

    /// The N samples of the amplitudes `X_0 …`; those not given are zero, and those beyond `X_{N/2}` are
    /// left out.
    ///
    /// Of the amplitudes at zero and at the Nyquist frequency only the real parts count: the rest
    /// of them has no real signal.
    pub fn samples(&self, amplitudes: impl AsRef<[Complex64]>) -> Vec<f64> {
        let mut samples = vec![0.0; self.len()];
        let amplitudes = amplitudes.as_ref();
        let amplitudes = &amplitudes[..amplitudes.len().min(self.len() / 2 + 1)];
        self.write_samples(amplitudes, &mut Scratch::default(), &mut samples);
        samples
    }

    /// Writes what [`Self::samples`] returns into `samples`; `scratch` is memory for any number of calls.
    ///
    /// # Panics
    /// If there are more than N/2 + 1 amplitudes or not room for N samples.
    pub(crate) fn write_samples(
        &self,
        amplitudes: &[Complex64],
        scratch: &mut Scratch,
        samples: &mut [f64],
    ) {
        let (len, bins) = (self.len(), self.len() / 2 + 1);
        assert!(amplitudes.len() <= bins, "{} amplitudes for {bins} bins", amplitudes.len());
        assert_eq!(samples.len(), len, "samples of a Fourier pair");
        Arch::new().dispatch(Inverse { plan: &self.0, amplitudes, scratch, samples });
    }
}

/// Angular frequency of bin `k` in rad/s for N samples at `step_s`.
pub(crate) fn angular_frequency(k: usize, len: usize, step_s: f64) -> f64 {
    TAU * k as f64 / (len as f64 * step_s)
}

/// The least even number of the form 2ᵃ 3ᵇ 5ᶜ that is at least `len`: fast to transform.
pub(crate) fn fast_length(len: usize) -> usize {
    let mut best = len.max(2).next_power_of_two();
    let mut fives = 1;
    while fives < best {
        let mut odd = fives;
        while odd < best {
            // The power of two that lifts `odd` to `len`, and at least one factor of two.
            let twos = len.div_ceil(odd).next_power_of_two().max(2);
            best = best.min(odd * twos);
            odd *= 3;
        }
        fives *= 5;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitudes_are_those_of_a_direct_sum_with_a_negative_exponent() {
        let x = [0.3, -1.0, 2.0, 0.7, 0.1, -0.4];
        let found = FourierPair::new(6).amplitudes(x);
        for (k, found) in found.iter().enumerate() {
            let direct: Complex64 = x
                .iter()
                .enumerate()
                .map(|(j, x)| Complex64::cis(-TAU * (j * k) as f64 / 6.0) * x / 6.0)
                .sum();
            assert!((found - direct).norm() < 1e-15);
        }
    }

    #[test]
    fn samples_undo_amplitudes_and_missing_amplitudes_are_zero() {
        let pair = FourierPair::new(60);
        let x: Vec<f64> = (0..60).map(|j| (0.1 * f64::from(j)).sin()).collect();
        let back = pair.samples(pair.amplitudes(x.clone()));
        assert!(x.iter().zip(&back).all(|(x, y)| (x - y).abs() < 1e-15));
        let few = pair.amplitudes(&x[..40]);
        assert_eq!(few, pair.amplitudes([&x[..40], &[0.0; 20]].concat()));
        assert_eq!(pair.amplitudes([&x[..], &[3.0]].concat()), pair.amplitudes(&x));
        assert_eq!(pair.samples([&few[..], &[Complex64::ONE]].concat()), pair.samples(&few));
        let mean = pair.samples(vec![Complex64::new(2.5, 7.0)]);
        assert!(mean.iter().all(|x| (x - 2.5).abs() < 1e-15));
    }

    #[test]
    fn fast_lengths_are_the_least_even_numbers_of_small_factors() {
        let smooth = |mut n: usize| {
            let even = n.is_multiple_of(2);
            for p in [2, 3, 5] {
                while n.is_multiple_of(p) {
                    n /= p;
                }
            }
            even && n == 1
        };
        for len in 1..3000 {
            let expected = (len..2 * len + 2).find(|&n| smooth(n)).unwrap();
            assert_eq!(fast_length(len), expected, "length {len}");
        }
    }
}
