//! Alignment of computed with recorded histories: a gain and an offset for each, and a common delay.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "places in a history are within it, and delays are a hundred samples at most"
)]

use std::borrow::Cow;

use super::instruments::Gain;
use crate::numeric::{CubicSpline, SplineEnds};

/// Largest delay of the search, in samples; for a short record a quarter of its samples.
const LONGEST_DELAY: usize = 100;

/// Number of samples that decide the start of the search for a delay.
const FEW_SAMPLES: usize = 4000;

/// Freedom between a computed history and a recorded one.
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

/// A computed history to align with a recorded one.
pub(super) struct Overlaid<'a> {
    pub(super) recorded: &'a [f64],
    pub(super) computed: &'a [f64],
    pub(super) freedom: Freedom,
    /// Weight of the differences.
    pub(super) weight: f64,
}

/// Histories with a delay in samples, and the line that fits each to its recorded one best.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Alignment {
    pub(super) delay: f64,
    pub(super) lines: Vec<Line>,
    /// Recorded minus computed, in the unit of the record, for the compared samples.
    pub(super) differences: Vec<Vec<f64>>,
}

/// Longest delay of the search, in samples, for a record with this number of samples. With a free delay this number of
/// last samples is not compared, because sensors that are early show them before they are computed.
pub(super) fn longest_delay(samples: usize) -> usize {
    (samples / 4).min(LONGEST_DELAY)
}

impl Line {
    /// The line with the least sum of squared differences, within the freedom.
    fn through(recorded: &[f64], computed: &[f64], freedom: Freedom) -> Self {
        let mean = |samples: &[f64]| {
            let number = samples.len() as f64;
            if freedom.has_offset { samples.iter().sum::<f64>() / number } else { 0.0 }
        };
        let (recorded_mean, computed_mean) = (mean(recorded), mean(computed));
        let pairs = recorded.iter().zip(computed);
        let product: f64 = pairs.map(|(y, p)| (y - recorded_mean) * (p - computed_mean)).sum();
        let square: f64 = computed.iter().map(|p| (p - computed_mean).powi(2)).sum();
        let gain = match freedom.gain {
            Gain::Known => 1.0,
            Gain::Sign => 1.0_f64.copysign(product),
            Gain::Free if square > 0.0 => product / square,
            Gain::Free => 0.0,
        };
        Self { gain, offset: recorded_mean - gain * computed_mean }
    }

    fn difference(self, recorded: f64, computed: f64) -> f64 {
        recorded - self.gain * computed - self.offset
    }
}

impl Alignment {
    /// Aligns histories, with a delay of `delay` samples, with the first `compared` recorded samples.
    pub(super) fn of(histories: &[Overlaid], delay: f64, compared: usize) -> Self {
        let aligned = histories.iter().map(|history| {
            let computed = delayed(history.computed, delay, compared);
            let recorded = &history.recorded[..compared];
            let line = Line::through(recorded, &computed, history.freedom);
            let pairs = recorded.iter().zip(computed.iter());
            let differences = pairs.map(|(y, p)| line.difference(*y, *p)).collect();
            (line, differences)
        });
        let (lines, differences) = aligned.unzip();
        Self { delay, lines, differences }
    }
}

/// The first `compared` samples of a history that begins `delay` samples later. A cubic spline goes through the
/// samples, and a straight line leads to them from rest one sample before.
fn delayed(samples: &[f64], delay: f64, compared: usize) -> Cow<'_, [f64]> {
    if delay == 0.0 {
        return Cow::Borrowed(&samples[..compared]);
    }
    let spline = CubicSpline::uniform(samples, SplineEnds::NotAKnot);
    let slopes = spline.slopes();
    let at = |k: usize| {
        let place = k as f64 - delay;
        if place < 0.0 {
            return samples[0] * (1.0 + place).max(0.0);
        }
        let left = (place as usize).min(samples.len() - 2);
        let t = place - left as f64;
        let (y, s) = (&samples[left..=left + 1], &slopes[left..=left + 1]);
        let rise = y[1] - y[0];
        let (bend, third) = (3.0 * rise - 2.0 * s[0] - s[1], s[0] + s[1] - 2.0 * rise);
        y[0] + t * (s[0] + t * (bend + t * third))
    };
    Cow::Owned((0..compared).map(at).collect())
}

/// The delay in whole samples with the least sum of squares.
pub(super) fn rough_delay(histories: &[Overlaid]) -> f64 {
    let samples = histories.first().map_or(0, |history| history.computed.len());
    let longest = longest_delay(samples) as i64;
    let all = (-longest..=longest).map(|delay| (rough_cost(histories, delay), delay as f64));
    all.reduce(|a, b| if b.0 < a.0 { b } else { a }).map_or(0.0, |(_, delay)| delay)
}

/// Weighted sum of squares at a delay of whole samples, over some of them.
fn rough_cost(histories: &[Overlaid], delay: i64) -> f64 {
    let cost = |history: &Overlaid| {
        let (count, every) =
            (history.computed.len(), (history.computed.len() / FEW_SAMPLES).max(1));
        // All delays use the same samples of the record.
        let places = (0..count - longest_delay(count)).step_by(every);
        let at = |k: usize| {
            let place = k as i64 - delay;
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
        for delay in [0.0, 7.3, -4.6, 63.0, 99.2, -99.2] {
            let lines = [Line { gain: -2.5, offset: 0.3 }, Line { gain: 1.0, offset: 0.0 }];
            let recorded = lines.map(|line| history(delay, line));
            let histories = [(0, FREE), (1, KNOWN)].map(|(k, freedom)| Overlaid {
                recorded: &recorded[k],
                computed: &computed,
                freedom,
                weight: 1.0,
            });
            let rough = rough_delay(&histories);
            assert!((rough - delay).abs() < 0.51, "{rough} is not {delay}");
            let found = Alignment::of(&histories, delay, 900);
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
            let Alignment { delay, lines, .. } = Alignment::of(&of, 0.0, 1000);
            (delay, lines[0].gain, lines[0].offset)
        };
        let same = |found: (f64, f64, f64), exact: [f64; 3]| {
            assert_eq!([found.0, found.1, found.2].map(f64::to_bits), exact.map(f64::to_bits));
        };
        same(laid(KNOWN), [0.0, 1.0, 0.0]);
        same(laid(Freedom { gain: Gain::Sign, has_offset: false }), [0.0, -1.0, 0.0]);
    }
}
