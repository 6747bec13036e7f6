//! Some samples of many periodic signals that are given by their amplitudes.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;

use num_complex::Complex64;

use super::fft::Scratch;
use super::fourier::FourierPair;
use super::upsampling::{TAPS, TAPS_BEFORE, Upsampler};

/// Signals that are worked on side by side: the samples of one time stand next to one another.
pub(crate) const CHANNELS: usize = 16;

/// What a thread holds of signals that are transformed but not yet taken apart, unless one is more.
const ROOM_BYTES: usize = 1 << 20;

/// Memory for the transforms of a panel, which serves again and again.
#[derive(Debug, Default)]
pub(crate) struct Room {
    scratch: Scratch,
    samples: Vec<f64>,
}

/// Which samples of a period are wanted, and how they are had: by a transform over the whole period,
/// or, where the signals' band is narrow, by one over fewer samples that others are made of.
#[derive(Clone)]
pub(crate) struct Sampling {
    transform: FourierPair,
    upsampler: Option<Upsampler>,
    /// Sample of the period that row 0 is.
    first: usize,
    every: usize,
}

impl Sampling {
    /// Every `every`-th sample from `first` on of signals with amplitudes from zero frequency on,
    /// `bins` of them; `transform` is that of the whole period.
    pub(crate) fn new(transform: &FourierPair, bins: usize, first: usize, every: usize) -> Self {
        let upsampler = Upsampler::plan(transform.len(), bins);
        let transform = upsampler
            .as_ref()
            .map_or_else(|| transform.clone(), |upsampler| FourierPair::new(upsampler.coarse()));
        Self { transform, upsampler, first, every }
    }

    /// Samples of each signal that are held for some rows.
    pub(crate) fn held(&self, rows: &Range<usize>) -> usize {
        self.span(rows).len()
    }

    /// The samples that are held for some rows, counted on beyond the period's end.
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

    /// Which of the samples held for `rows` some of these are made of.
    pub(crate) fn taken(&self, rows: &Range<usize>, some: &Range<usize>) -> Range<usize> {
        let (held, taken) = (self.span(rows), self.span(some));
        taken.start - held.start..taken.end - held.start
    }

    /// What no sample exceeds, over the largest of those held that it is made of.
    pub(crate) fn gain(&self) -> f64 {
        self.upsampler.as_ref().map_or(1.0, Upsampler::gain)
    }

    /// The sample that a row is, counted on beyond the period's end.
    fn sample_of(&self, row: usize) -> usize {
        self.first + row * self.every
    }

    /// Fills `held` with what `rows` are made of; `amplitudes` are those of at most [`CHANNELS`]
    /// signals. Every so often `advance` gets how many more of them are done.
    pub(crate) fn hold(
        &self,
        rows: &Range<usize>,
        amplitudes: &[Vec<Complex64>],
        held: &mut [[f64; CHANNELS]],
        room: &mut Room,
        advance: impl Fn(usize),
    ) {
        let len = self.transform.len();
        let at_once = self.signals_at_once();
        for (part, amplitudes) in amplitudes.chunks(at_once).enumerate() {
            room.samples.resize(at_once * len, 0.0);
            for (amplitudes, samples) in amplitudes.iter().zip(room.samples.chunks_exact_mut(len)) {
                self.transform.write_samples(amplitudes, &mut room.scratch, samples);
            }
            let signals = part * at_once..part * at_once + amplitudes.len();
            self.interleave(rows, &room.samples, signals, held);
            advance(amplitudes.len());
        }
    }

    /// Signals that are transformed before they are taken apart into rows.
    fn signals_at_once(&self) -> usize {
        (ROOM_BYTES / (self.transform.len() * size_of::<f64>())).clamp(1, CHANNELS)
    }

    /// Memory in bytes that a thread's [`Room`] takes.
    pub(crate) fn room_bytes(&self) -> usize {
        // What is transformed, and twice as much for the transform itself.
        (self.signals_at_once() + 2) * self.transform.len() * size_of::<f64>()
    }

    /// Puts the samples of some signals, one after the other, into their channels of the rows held.
    fn interleave(
        &self,
        rows: &Range<usize>,
        samples: &[f64],
        signals: Range<usize>,
        held: &mut [[f64; CHANNELS]],
    ) {
        let len = self.transform.len();
        let place = |k: usize| match self.upsampler {
            None => self.sample_of(k) % len,
            Some(_) => (k + len - TAPS_BEFORE) % len,
        };
        for (k, held) in self.span(rows).zip(held) {
            let samples = samples.iter().skip(place(k)).step_by(len);
            for (held, sample) in held[signals.clone()].iter_mut().zip(samples) {
                *held = *sample;
            }
        }
    }

    /// One row of the signals whose samples are `held` for `rows`.
    #[inline(always)]
    pub(crate) fn row(
        &self,
        rows: &Range<usize>,
        held: &[[f64; CHANNELS]],
        row: usize,
    ) -> [f64; CHANNELS] {
        let Some(upsampler) = &self.upsampler else { return held[row - rows.start] };
        let [start, sample] = [rows.start, row].map(|row| self.sample_of(row));
        let first = upsampler.first_tap(sample) - upsampler.first_tap(start);
        let weights = upsampler.weights(sample);
        let held = &held[first..first + TAPS];
        let mut sum = [0.0; CHANNELS];
        for tap in 0..TAPS {
            for channel in 0..CHANNELS {
                sum[channel] += weights[tap] * held[tap][channel];
            }
        }
        sum
    }
}
