//! Rows of samples of many periodic signals, computed from their amplitudes.
//!
//! The plain way is one inverse transform over the whole period for each signal. For a narrow band, a transform over
//! fewer, coarse samples and a short weighted sum for each row take a fifth less time and an eighth of the memory (400
//! nodes, 65 536 samples).

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::f64::consts::PI;
use std::ops::Range;

use num_complex::Complex64;

use super::fft::{FourierPair, Scratch, fast_length};

/// Number of signals in a panel, whose samples at one time are adjacent.
pub(crate) const PANEL: usize = 16;

/// Number of coarse samples in the weighted sum of a row.
const TAPS: usize = 30;

/// Number of taps before the last coarse sample at or before the row.
const TAPS_BEFORE: usize = TAPS / 2 - 1;

/// Ratio of coarse samples to the samples that the band itself needs.
const OVERSAMPLING: usize = 4;

/// Shape of the window, the best for [`TAPS`] and [`OVERSAMPLING`]: errors stay below 1e-14 of the signal's peak.
const KAISER_BETA: f64 = 34.0;

/// Limit of positions between two coarse samples in the table of weights.
const MOST_PHASES: usize = 512;

/// Bytes of samples that a thread transforms before it interleaves them; a single signal may need more.
const TRANSFORMED_BYTES: usize = 1 << 20;

/// Working memory of a thread, reused for each panel.
#[derive(Debug, Default)]
pub(crate) struct Transforms {
    scratch: Scratch,
    samples: Vec<f64>,
}

/// The rows of a table over time, and the transform behind them. Rows are picked from the samples of the whole period,
/// or interpolated between coarse samples.
#[derive(Clone)]
pub(crate) struct Sampling {
    transform: FourierPair,
    upsampler: Option<Upsampler>,
    /// Sample of the period at row 0.
    first: usize,
    every: usize,
}

impl Sampling {
    /// Every `every`-th sample from `first` on, for signals with `bins` amplitudes from zero frequency on; `transform`
    /// covers the whole period.
    pub(crate) fn new(transform: &FourierPair, bins: usize, first: usize, every: usize) -> Self {
        let upsampler = Upsampler::plan(transform.len(), bins);
        let transform = upsampler
            .as_ref()
            .map_or_else(|| transform.clone(), |upsampler| FourierPair::new(upsampler.coarse));
        Self { transform, upsampler, first, every }
    }

    /// Number of samples of each signal needed for `rows`.
    pub(crate) fn samples_for(&self, rows: &Range<usize>) -> usize {
        self.span(rows).len()
    }

    /// Samples needed for `rows`, counted on beyond the end of the period.
    fn span(&self, rows: &Range<usize>) -> Range<usize> {
        match &self.upsampler {
            None => rows.clone(),
            Some(_) if rows.is_empty() => 0..0,
            Some(upsampler) => {
                let first_tap = |row: usize| upsampler.first_tap(self.sample_of(row));
                first_tap(rows.start)..first_tap(rows.end - 1) + TAPS
            }
        }
    }

    /// Range of the samples for `some` rows within the samples for all `rows`.
    pub(crate) fn taken(&self, rows: &Range<usize>, some: &Range<usize>) -> Range<usize> {
        let (all, taken) = (self.span(rows), self.span(some));
        taken.start - all.start..taken.end - all.start
    }

    /// Upper bound of a row relative to the largest sample behind it.
    pub(crate) fn gain(&self) -> f64 {
        self.upsampler.as_ref().map_or(1.0, Upsampler::gain)
    }

    /// The sample at a row, counted on beyond the end of the period.
    fn sample_of(&self, row: usize) -> usize {
        self.first + row * self.every
    }

    /// Writes the samples needed for `rows` into `panel`, from the amplitudes of at most [`PANEL`] signals. `advance`
    /// receives the number of signals done since the last call.
    pub(crate) fn write_samples(
        &self,
        rows: &Range<usize>,
        amplitudes: &[Vec<Complex64>],
        panel: &mut [[f64; PANEL]],
        memory: &mut Transforms,
        advance: impl Fn(usize),
    ) {
        let len = self.transform.len();
        let at_once = self.signals_at_once();
        for (part, amplitudes) in amplitudes.chunks(at_once).enumerate() {
            memory.samples.resize(at_once * len, 0.0);
            for (amplitudes, samples) in amplitudes.iter().zip(memory.samples.chunks_exact_mut(len))
            {
                self.transform.write_samples(amplitudes, &mut memory.scratch, samples);
            }
            let signals = part * at_once..part * at_once + amplitudes.len();
            self.interleave(rows, &memory.samples, signals, panel);
            advance(amplitudes.len());
        }
    }

    /// Number of signals transformed before they are interleaved.
    fn signals_at_once(&self) -> usize {
        (TRANSFORMED_BYTES / (self.transform.len() * size_of::<f64>())).clamp(1, PANEL)
    }

    /// Memory in bytes of a thread's [`Transforms`].
    pub(crate) fn transform_bytes(&self) -> usize {
        // The signals, and the scratch of one transform: twice its samples.
        (self.signals_at_once() + 2) * self.transform.len() * size_of::<f64>()
    }

    /// Copies the samples of some signals, stored one after the other, to their places in the panel.
    fn interleave(
        &self,
        rows: &Range<usize>,
        samples: &[f64],
        signals: Range<usize>,
        panel: &mut [[f64; PANEL]],
    ) {
        let len = self.transform.len();
        let place = |k: usize| match self.upsampler {
            None => self.sample_of(k) % len,
            Some(_) => (k + len - TAPS_BEFORE) % len,
        };
        for (k, at_k) in self.span(rows).zip(panel) {
            let samples = samples.iter().skip(place(k)).step_by(len);
            for (place, sample) in at_k[signals.clone()].iter_mut().zip(samples) {
                *place = *sample;
            }
        }
    }

    /// One row of a panel whose `samples` belong to `rows`.
    #[inline(always)]
    pub(crate) fn row(
        &self,
        rows: &Range<usize>,
        samples: &[[f64; PANEL]],
        row: usize,
    ) -> [f64; PANEL] {
        let Some(upsampler) = &self.upsampler else { return samples[row - rows.start] };
        let [start, sample] = [rows.start, row].map(|row| self.sample_of(row));
        let first = upsampler.first_tap(sample) - upsampler.first_tap(start);
        let weights = upsampler.weights(sample);
        let samples = &samples[first..first + TAPS];
        let mut sum = [0.0; PANEL];
        for tap in 0..TAPS {
            for signal in 0..PANEL {
                sum[signal] += weights[tap] * samples[tap][signal];
            }
        }
        sum
    }
}

/// Interpolates N samples of a period from M < N coarse ones, by a sinc in a Kaiser window.
///
/// ```text
/// x(t) = Σ_j x_j sinc(t − j) I₀(β√(1 − (2(t − j)/TAPS)²))/I₀(β)        t in coarse steps
/// ```
///
/// (J. F. Kaiser, *Nonrecursive digital filter design using the I₀-sinh window function*, 1974.)
#[derive(Debug, Clone)]
struct Upsampler {
    /// Number M of coarse samples.
    coarse: usize,
    /// Coarse steps after which the positions between two coarse samples repeat.
    steps: usize,
    /// Weights for each position between two coarse samples.
    weights: Vec<[f64; TAPS]>,
}

impl Upsampler {
    /// Plans the coarse samples for `bins` amplitudes from zero frequency on, and their weights for `samples` of a
    /// period. Returns `None` unless the coarse samples are at most half as many.
    fn plan(samples: usize, bins: usize) -> Option<Self> {
        let least = (2 * OVERSAMPLING * bins).max(TAPS);
        let phases = |coarse: &usize| samples / greatest_divisor(samples, *coarse);
        let lengths = std::iter::successors(Some(fast_length(least)), |m| Some(fast_length(m + 1)));
        let coarse = lengths.take_while(|m| 2 * m <= samples).find(|m| phases(m) <= MOST_PHASES)?;
        let phases = phases(&coarse);
        let weights = (0..phases).map(|phase| weights(phase as f64 / phases as f64)).collect();
        Some(Self { coarse, steps: coarse / (samples / phases), weights })
    }

    /// Largest sum of absolute weights over all positions.
    fn gain(&self) -> f64 {
        let sum = |weights: &[f64; TAPS]| weights.iter().map(|weight| weight.abs()).sum();
        self.weights.iter().map(sum).fold(0.0, f64::max)
    }

    /// First of the [`TAPS`] coarse samples for sample `k`, counted from the first one for sample 0, [`TAPS_BEFORE`]
    /// before that sample.
    #[inline(always)]
    fn first_tap(&self, k: usize) -> usize {
        k / self.phases() * self.steps + k % self.phases() * self.steps / self.phases()
    }

    /// Weights of the coarse samples for sample `k`.
    #[inline(always)]
    fn weights(&self, k: usize) -> &[f64; TAPS] {
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

/// Weights of the coarse samples −14 … 15 for the time `phase`, in [0, 1), after sample 0.
fn weights(phase: f64) -> [f64; TAPS] {
    let half = TAPS as f64 / 2.0;
    let largest = bessel_i0(KAISER_BETA);
    // sin π(t − j) = ±sin πt.
    let sine = libm::sin(PI * phase.min(1.0 - phase));
    std::array::from_fn(|tap| {
        let away = phase - (tap as f64 - TAPS_BEFORE as f64);
        let sign = if tap.is_multiple_of(2) { 1.0 } else { -1.0 };
        let sinc = if away == 0.0 { 1.0 } else { sign * sine / (PI * away) };
        let share = away / half;
        sinc * bessel_i0(KAISER_BETA * (1.0 - share * share).max(0.0).sqrt()) / largest
    })
}

/// Modified Bessel function of the first kind and order zero, from its series of positive terms.
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

    /// Amplitudes of `bins` harmonics of equal size.
    fn amplitudes(bins: usize) -> Vec<Complex64> {
        let turn = |k: usize| Complex64::cis(1.3 * (k * k) as f64 + 0.2);
        (0..bins).map(|k| if k == 0 { 0.3.into() } else { turn(k) }).collect()
    }

    /// Rows of the second of two signals, computed in blocks with these ends.
    fn rows(sampling: &Sampling, ends: &[usize], bins: usize) -> Vec<f64> {
        let spectra = vec![vec![Complex64::ZERO; bins], amplitudes(bins)];
        let mut found = vec![];
        for ends in ends.windows(2) {
            let rows = ends[0]..ends[1];
            let mut panel = vec![[0.0; PANEL]; sampling.samples_for(&rows)];
            let memory = &mut Transforms::default();
            sampling.write_samples(&rows, &spectra, &mut panel, memory, |_| {});
            for row in rows.clone() {
                let values = sampling.row(&rows, &panel, row);
                assert!(values[0] == 0.0 && values[2..] == [0.0; PANEL - 2]);
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
                // Rows have the same bits whatever the blocks.
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
        // The series 1 + 1/4 + 1/64 + … and its counterpart for 5, to eleven digits.
        for (x, expected) in [(0.0, 1.0), (1.0, 1.266_065_877_75), (5.0, 27.239_871_823_60)] {
            assert!((bessel_i0(x) / expected - 1.0_f64).abs() < 1e-11, "I₀({x})");
        }
    }
}
