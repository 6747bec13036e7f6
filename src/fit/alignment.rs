//! How computed histories become recorded ones: a gain, an offset, and a delay that all have in common.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "places in a history are within it, and delays are a hundred samples at most"
)]

use super::response::Gain;
use crate::numeric::{CubicSpline, SplineEnds};

/// Largest delay that is looked for, in samples.
pub(super) const LONGEST_DELAY: f64 = 100.0;

/// Samples that decide where the search for a delay begins.
const FEW_SAMPLES: usize = 4000;

/// Change of a delay, in samples, that ends the search.
const SETTLED: f64 = 1e-7;

/// Most steps of the search.
const MOST_STEPS: usize = 20;

/// What is free between a computed history and a recorded one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Freedom {
    pub(super) gain: Gain,
    pub(super) has_offset: bool,
}

/// `gain · computed + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) gain: f64,
    pub(super) offset: f64,
}

/// A history to lay over a recorded one, and what may be changed of it.
pub(super) struct Overlaid<'a> {
    pub(super) recorded: &'a [f64],
    pub(super) computed: &'a [f64],
    pub(super) freedom: Freedom,
    /// Weight of a difference.
    pub(super) weight: f64,
}

/// Delay in samples and the line of each history, by which they lie best over the recorded ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Alignment {
    pub(super) delay: f64,
    pub(super) lines: Vec<Line>,
    /// Recorded less computed, in the unit of the record; 0 at samples that are not computed.
    pub(super) differences: Vec<Vec<f64>>,
}

impl Line {
    /// The line by which the sum of squared differences is least, for what is free.
    fn through(recorded: &[f64], computed: &[f64], freedom: Freedom) -> Self {
        Self::with_gain(recorded, computed, freedom.has_offset, |product, square| {
            match freedom.gain {
                Gain::Known => 1.0,
                Gain::Sign => 1.0_f64.copysign(product),
                Gain::Free if square > 0.0 => product / square,
                Gain::Free => 0.0,
            }
        })
    }

    /// What gain and offset could make of a change of the computed history: nothing if neither is free.
    fn of_change(change: &[f64], computed: &[f64], freedom: Freedom) -> Self {
        let is_free = freedom.gain == Gain::Free;
        Self::with_gain(change, computed, freedom.has_offset, |product, square| {
            if is_free && square > 0.0 { product / square } else { 0.0 }
        })
    }

    /// `gain` makes the gain of the sums of products and of squares, about the means if there is an offset.
    fn with_gain(
        recorded: &[f64],
        computed: &[f64],
        has_offset: bool,
        gain: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let mean = |samples: &[f64]| {
            if has_offset { samples.iter().sum::<f64>() / samples.len() as f64 } else { 0.0 }
        };
        let (recorded_mean, computed_mean) = (mean(recorded), mean(computed));
        let pairs = recorded.iter().zip(computed);
        let product: f64 = pairs.map(|(y, p)| (y - recorded_mean) * (p - computed_mean)).sum();
        let square: f64 = computed.iter().map(|p| (p - computed_mean).powi(2)).sum();
        let gain = gain(product, square);
        Self { gain, offset: recorded_mean - gain * computed_mean }
    }

    fn difference(self, recorded: f64, computed: f64) -> f64 {
        recorded - self.gain * computed - self.offset
    }
}

impl Alignment {
    /// Lays histories over recorded ones of as many samples, with a common delay if it is free.
    pub(super) fn of(histories: &[Overlaid], is_delay_free: bool) -> Self {
        let delay = if is_delay_free { delay(histories) } else { 0.0 };
        let aligned = histories.iter().map(|history| {
            let (computed, _) = delayed(&Curve::of(history.computed), delay);
            let recorded = &history.recorded[..computed.len()];
            let line = Line::through(recorded, &computed, history.freedom);
            let pairs = recorded.iter().zip(&computed);
            let mut differences: Vec<f64> = pairs.map(|(y, p)| line.difference(*y, *p)).collect();
            differences.resize(history.recorded.len(), 0.0);
            (line, differences)
        });
        let (lines, differences) = aligned.unzip();
        Self { delay, lines, differences }
    }
}

/// A history between its samples; nothing before the first of them.
struct Curve<'a> {
    samples: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> Curve<'a> {
    fn of(samples: &'a [f64]) -> Self {
        let spline = CubicSpline::uniform(samples, SplineEnds::NotAKnot);
        Self { samples, slopes: spline.slopes().to_vec() }
    }

    /// Value and slope at a place in samples.
    fn at(&self, place: f64) -> (f64, f64) {
        if place < 0.0 {
            return (0.0, 0.0);
        }
        let left = (place as usize).min(self.samples.len() - 2);
        let t = place - left as f64;
        let (y, s) = (&self.samples[left..=left + 1], &self.slopes[left..=left + 1]);
        let rise = y[1] - y[0];
        let (bend, third) = (3.0 * rise - 2.0 * s[0] - s[1], s[0] + s[1] - 2.0 * rise);
        (y[0] + t * (s[0] + t * (bend + t * third)), s[0] + t * (2.0 * bend + t * 3.0 * third))
    }
}

/// Values and slopes of a history that begins later by `delay` samples; one that begins earlier ends before
/// the record does.
fn delayed(curve: &Curve, delay: f64) -> (Vec<f64>, Vec<f64>) {
    let count = curve.samples.len() - (-delay).max(0.0).ceil() as usize;
    if delay == 0.0 {
        return (curve.samples[..count].to_vec(), curve.slopes[..count].to_vec());
    }
    (0..count).map(|k| curve.at(k as f64 - delay)).unzip()
}

/// The delay in samples that leaves the least sum of squares: Gauss and Newton's steps from the best of all
/// whole numbers of samples.
fn delay(histories: &[Overlaid]) -> f64 {
    let shortest = histories.iter().map(|history| history.computed.len()).min().unwrap_or(0);
    let longest = LONGEST_DELAY.min(shortest as f64 / 4.0).floor();
    let whole = -(longest as i32)..=longest as i32;
    let rough = whole.map(|samples| (rough_cost(histories, samples), f64::from(samples)));
    let best = rough.reduce(|a, b| if b.0 < a.0 { b } else { a });
    let mut delay = best.map_or(0.0, |(_, samples)| samples);
    let curves: Vec<Curve> = histories.iter().map(|history| Curve::of(history.computed)).collect();
    for _ in 0..MOST_STEPS {
        let (mut product, mut square) = (0.0, 0.0);
        for (history, curve) in histories.iter().zip(&curves) {
            let (computed, slopes) = delayed(curve, delay);
            let recorded = &history.recorded[..computed.len()];
            let line = Line::through(recorded, &computed, history.freedom);
            // Of a slope that gain and offset can make there is nothing to be gained.
            let own = Line::of_change(&slopes, &computed, history.freedom);
            for ((y, p), slope) in recorded.iter().zip(&computed).zip(&slopes) {
                let slope = line.gain * history.weight * own.difference(*slope, *p);
                product += history.weight * line.difference(*y, *p) * slope;
                square += slope * slope;
            }
        }
        let step = if square > 0.0 { -product / square } else { 0.0 };
        let next = (delay + step.clamp(-1.0, 1.0)).clamp(-longest, longest);
        let moved = (next - delay).abs();
        delay = next;
        if moved < SETTLED {
            break;
        }
    }
    delay
}

/// The weighted sum of squares at a delay of whole samples, of some of them.
fn rough_cost(histories: &[Overlaid], delay: i32) -> f64 {
    let cost = |history: &Overlaid| {
        let (count, every) =
            (history.computed.len(), (history.computed.len() / FEW_SAMPLES).max(1));
        // All delays are judged by the same samples of the record.
        let margin = (LONGEST_DELAY as usize).min(count / 4);
        let places = (0..count - margin).step_by(every);
        let at = |k: usize| {
            let place = k as i64 - i64::from(delay);
            usize::try_from(place).map_or(0.0, |place| history.computed[place])
        };
        let computed: Vec<f64> = places.clone().map(at).collect();
        let recorded: Vec<f64> = places.map(|k| history.recorded[k]).collect();
        let line = Line::through(&recorded, &computed, history.freedom);
        let pairs = recorded.iter().zip(&computed);
        let sum: f64 = pairs.map(|(y, p)| line.difference(*y, *p).powi(2)).sum();
        history.weight * history.weight * sum
    };
    histories.iter().map(cost).sum()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const FREE: Freedom = Freedom { gain: Gain::Free, has_offset: true };
    const KNOWN: Freedom = Freedom { gain: Gain::Known, has_offset: false };

    /// A decaying vibration that begins at rest after sample 200.
    fn vibration(place: f64) -> f64 {
        let t = (place - 200.0).max(0.0) / 50.0;
        t.powi(3) * (-t).exp() * (TAU * t).sin()
    }

    fn history(delay: f64, line: Line) -> Vec<f64> {
        let at = |k: i32| line.gain * vibration(f64::from(k) - delay) + line.offset;
        (0..1000).map(at).collect()
    }

    #[test]
    fn gain_offset_and_delay_of_two_histories_are_found() {
        let computed = history(0.0, Line { gain: 1.0, offset: 0.0 });
        for delay in [0.0, 7.3, -4.6, 63.0, 99.2] {
            let lines = [Line { gain: -2.5, offset: 0.3 }, Line { gain: 1.0, offset: 0.0 }];
            let recorded = lines.map(|line| history(delay, line));
            let histories = [(0, FREE), (1, KNOWN)].map(|(k, freedom)| Overlaid {
                recorded: &recorded[k],
                computed: &computed,
                freedom,
                weight: 1.0,
            });
            let found = Alignment::of(&histories, true);
            assert!((found.delay - delay).abs() < 1e-4, "{} is not {delay}", found.delay);
            for (line, exact) in found.lines.iter().zip(lines) {
                let off = (line.gain - exact.gain).abs().max((line.offset - exact.offset).abs());
                assert!(off < 1e-5, "{line:?} is not {exact:?}");
            }
        }
    }

    #[test]
    fn what_is_not_free_stays() {
        let computed = history(0.0, Line { gain: 1.0, offset: 0.0 });
        let recorded = history(5.0, Line { gain: -2.0, offset: 0.0 });
        let laid = |freedom| {
            let weight = 1.0;
            let of = [Overlaid { recorded: &recorded, computed: &computed, freedom, weight }];
            let Alignment { delay, lines, .. } = Alignment::of(&of, false);
            (delay, lines[0].gain, lines[0].offset)
        };
        let same = |found: (f64, f64, f64), exact: [f64; 3]| {
            assert_eq!([found.0, found.1, found.2].map(f64::to_bits), exact.map(f64::to_bits));
        };
        same(laid(KNOWN), [0.0, 1.0, 0.0]);
        same(laid(Freedom { gain: Gain::Sign, has_offset: false }), [0.0, -1.0, 0.0]);
    }
}
