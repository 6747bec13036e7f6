//! Samples of a band-limited periodic signal from fewer of them.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::f64::consts::PI;

use super::fourier::fast_length;

/// Coarse samples that one sample is made of.
pub(super) const TAPS: usize = 30;

/// Of them those that stand before it, the one at or next before it left out.
pub(super) const TAPS_BEFORE: usize = TAPS / 2 - 1;

/// Coarse samples per sample that the band itself would need.
const OVERSAMPLING: usize = 4;

/// Shape of the window, the best for [`TAPS`] and [`OVERSAMPLING`]: what is left of the images, and
/// what is changed of the band, lies below 1e-14 of the signal's peak.
const KAISER_BETA: f64 = 34.0;

/// Most places between two coarse samples that a table of weights is kept for.
const MOST_PHASES: usize = 512;

/// Makes N samples of a period from M < N of them, by a sinc under a Kaiser window.
///
/// ```text
/// x(t) = Σ_j x_j sinc(t − j) I₀(β√(1 − (2(t − j)/TAPS)²))/I₀(β)        t in coarse steps
/// ```
///
/// (J. F. Kaiser, *Nonrecursive digital filter design using the I₀-sinh window function*, 1974.)
#[derive(Debug, Clone)]
pub(super) struct Upsampler {
    coarse: usize,
    /// Coarse samples in as many samples as there are places between two coarse ones.
    steps: usize,
    /// Of every place between two coarse samples that a sample may have.
    weights: Vec<[f64; TAPS]>,
}

impl Upsampler {
    /// Plans the way from the coarse samples that `bins` amplitudes from zero frequency on need to
    /// `samples` of a period; none where the coarse ones would not be few.
    pub(super) fn plan(samples: usize, bins: usize) -> Option<Self> {
        let least = (2 * OVERSAMPLING * bins).max(TAPS);
        let phases = |coarse: &usize| samples / greatest_divisor(samples, *coarse);
        let lengths = std::iter::successors(Some(fast_length(least)), |m| Some(fast_length(m + 1)));
        let coarse = lengths.take_while(|m| 2 * m <= samples).find(|m| phases(m) <= MOST_PHASES)?;
        let phases = phases(&coarse);
        let weights = (0..phases).map(|phase| weights(phase as f64 / phases as f64)).collect();
        Some(Self { coarse, steps: coarse / (samples / phases), weights })
    }

    /// Number M of coarse samples.
    pub(super) fn coarse(&self) -> usize {
        self.coarse
    }

    /// Largest sum of the absolute weights of a sample.
    pub(super) fn gain(&self) -> f64 {
        let sum = |weights: &[f64; TAPS]| weights.iter().map(|weight| weight.abs()).sum();
        self.weights.iter().map(sum).fold(0.0, f64::max)
    }

    /// The first of the [`TAPS`] coarse samples that sample `k` is made of, counted from the first of
    /// sample 0, which stands [`TAPS_BEFORE`] before it.
    #[inline(always)]
    pub(super) fn first_tap(&self, k: usize) -> usize {
        k / self.phases() * self.steps + k % self.phases() * self.steps / self.phases()
    }

    /// Weights of the coarse samples that sample `k` is made of.
    #[inline(always)]
    pub(super) fn weights(&self, k: usize) -> &[f64; TAPS] {
        &self.weights[k % self.phases() * self.steps % self.phases()]
    }

    #[inline(always)]
    fn phases(&self) -> usize {
        self.weights.len()
    }
}

fn greatest_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
}

/// Weights of the coarse samples −14 … 15 for a sample at `phase` in [0, 1) behind sample 0.
fn weights(phase: f64) -> [f64; TAPS] {
    let half = TAPS as f64 / 2.0;
    let largest = bessel_i0(KAISER_BETA);
    // sin π(t − j) = ±sin πt: one sine for all, with the sign of each.
    let sine = libm::sin(PI * phase.min(1.0 - phase));
    std::array::from_fn(|tap| {
        let away = phase - (tap as f64 - TAPS_BEFORE as f64);
        let sign = if tap.is_multiple_of(2) { 1.0 } else { -1.0 };
        let sinc = if away == 0.0 { 1.0 } else { sign * sine / (PI * away) };
        let share = away / half;
        sinc * bessel_i0(KAISER_BETA * (1.0 - share * share).max(0.0).sqrt()) / largest
    })
}

/// Modified Bessel function of the first kind and order zero, by its series of positive terms.
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    while term > sum * f64::EPSILON / 8.0 {
        term *= quarter / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::numeric::{CHANNELS, FourierPair, Room, Sampling};

    /// Amplitudes of `bins` harmonics, all of one size.
    fn amplitudes(bins: usize) -> Vec<Complex64> {
        let turn = |k: usize| Complex64::cis(1.3 * (k * k) as f64 + 0.2);
        (0..bins).map(|k| if k == 0 { 0.3.into() } else { turn(k) }).collect()
    }

    /// Rows of the second of two signals, made in blocks that end here.
    fn rows(sampling: &Sampling, ends: &[usize], bins: usize) -> Vec<f64> {
        let spectra = vec![vec![Complex64::ZERO; bins], amplitudes(bins)];
        let mut found = vec![];
        for ends in ends.windows(2) {
            let rows = ends[0]..ends[1];
            let mut held = vec![[0.0; CHANNELS]; sampling.held(&rows)];
            sampling.hold(&rows, &spectra, &mut held, &mut Room::default(), |_| {});
            for row in rows.clone() {
                let values = sampling.row(&rows, &held, row);
                assert!(values[0] == 0.0 && values[2..] == [0.0; CHANNELS - 2]);
                found.push(values[1]);
            }
        }
        found
    }

    #[test]
    fn samples_of_a_narrow_band_are_those_of_the_whole_transform() {
        for (samples, bins) in [(65_536, 2171), (13_824, 700), (4000, 11), (1 << 15, 2000)] {
            let pair = FourierPair::new(samples);
            assert!(Upsampler::plan(samples, bins).is_some(), "{bins} bins of {samples}");
            let exact = pair.samples(amplitudes(bins));
            let peak = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (first, every) in [(0, 1), (samples - 77, 3), (samples - 5, 64)] {
                let len = samples.div_ceil(every) / 2;
                let sampling = Sampling::new(&pair, bins, first, every);
                let found = rows(&sampling, &[0, len], bins);
                for (row, found) in found.iter().enumerate() {
                    let error = (found - exact[(first + row * every) % samples]).abs() / peak;
                    assert!(error < 2e-14, "row {row} of {samples} from {first}: {error:e}");
                }
                // Rows made in blocks have the bits of those made at once.
                assert!(rows(&sampling, &[0, 1, len / 3, len], bins) == found);
            }
        }
    }

    #[test]
    fn a_wide_band_is_transformed_as_a_whole() {
        assert!(Upsampler::plan(4096, 257).is_none());
        let (pair, bins) = (FourierPair::new(4096), 2049);
        let sampling = Sampling::new(&pair, bins, 4087, 7);
        let exact = pair.samples(amplitudes(bins));
        let expected: Vec<f64> = (0..571).map(|row| exact[(4087 + 7 * row) % 4096]).collect();
        assert!(rows(&sampling, &[0, 571], bins) == expected);
        assert!(rows(&sampling, &[0, 2, 300, 571], bins) == expected);
    }

    #[test]
    fn the_bessel_function_has_the_values_of_the_tables() {
        // The sums 1 + 1/4 + 1/64 + … and its like for 5, to eleven digits.
        for (x, expected) in [(0.0, 1.0), (1.0, 1.266_065_877_75), (5.0, 27.239_871_823_60)] {
            assert!((bessel_i0(x) / expected - 1.0_f64).abs() < 1e-11, "I₀({x})");
        }
    }
}
