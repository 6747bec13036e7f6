//! A record beside the histories of its link, with the best gain and offset of each, and a common delay.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "a share of a number of samples, and places in a history"
)]

use std::borrow::Cow;
use std::f64::consts::PI;

use super::instruments::{
    Channel, FEWEST, Gain, INPUT, MOST_UNCERTAIN, Motor, RecordError, RecordInput, check,
    is_constant, rms, rms_about_mean, with_motor,
};
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::natural_frequencies;
use crate::model::Sensor;
use crate::numeric::{CubicSpline, SplineEnds, largest};
use crate::response::{Driven, sensed};

/// Noise of a hub angle, over its motion, that a fit may mistake for motion.
const LITTLE_NOISE: f64 = 2e-4;

/// Smallest noise of a channel over its size.
const EXACT: f64 = 1e-12;

/// Share of its largest value above which an input moves the link.
const STIRRING: f64 = 1e-3;

/// Fewest samples of the beginning of a record.
const LEAST_BEGINNING: usize = 32;

/// Order of differences that leaves only the noise of a motion.
const NOISE_ORDER: usize = 8;

/// Factor of differences of this order on the variance of white noise: `C(16, 8)`.
const NOISE_GAIN: f64 = 12_870.0;

/// Number of modes that the mesh of a record follows.
const FOLLOWED_MODES: usize = 30;

/// Recorded histories of a link, driven from rest, at uniform times.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub(super) name: String,
    pub(super) step_s: f64,
    driven: Driven,
    pub(super) motor: Option<Motor>,
    pub(super) channels: Vec<Channel>,
    /// Root mean square of the samples of each channel, about their mean if an offset is free.
    pub(super) sizes: Vec<f64>,
    /// True if the sensors may be late.
    pub(super) is_delay_free: bool,
    /// Noise of each channel over its size, from a fit, if uncertainties are unknown.
    noise: Option<Vec<f64>>,
}

impl Record {
    /// Checks a record of step `step_s` in s; messages call it `name`.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn new(
        name: String,
        step_s: f64,
        input: RecordInput,
        channels: Vec<Channel>,
        is_delay_free: bool,
    ) -> Result<Self, RecordError> {
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(RecordError::Step(step_s));
        }
        if channels.is_empty() {
            return Err(RecordError::NoChannel);
        }
        let (driven, motor) = input.driven();
        let (Driven::Torque(driving, _) | Driven::Angle(driving)) = &driven;
        if driving.len() < FEWEST {
            return Err(RecordError::Few(driving.len()));
        }
        check(INPUT, driving, driving.len())?;
        // A torque that begins with the record and stays constant moves the link.
        let is_rest = matches!(driven, Driven::Angle(_)) || driving[0] == 0.0;
        if is_rest && is_constant(driving) {
            return Err(RecordError::Constant { channel: INPUT.to_owned() });
        }
        let mut sizes = Vec::new();
        for channel in &channels {
            let name = channel.sensor.word();
            check(name, &channel.samples, driving.len())?;
            if is_constant(&channel.samples) {
                return Err(RecordError::Constant { channel: name.to_owned() });
            }
            let size = channel.size();
            if let Some(found) = channel.uncertainty
                && !(found > 0.0 && found < MOST_UNCERTAIN * size)
            {
                let (found, most) = (found / channel.unit, MOST_UNCERTAIN * size / channel.unit);
                return Err(RecordError::Uncertainty { channel: name.to_owned(), found, most });
            }
            sizes.push(size);
        }
        let is_known = channels.iter().any(|channel| channel.uncertainty.is_some());
        let unknown = channels.iter().find(|channel| channel.uncertainty.is_none());
        if let Some(channel) = unknown.filter(|_| is_known) {
            return Err(RecordError::Mixed { channel: channel.sensor.word().to_owned() });
        }
        Ok(Self { name, step_s, driven, motor, channels, sizes, is_delay_free, noise: None })
    }

    /// Name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Records of the sensors.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// True if the uncertainty of every channel is known.
    pub fn has_uncertainties(&self) -> bool {
        self.channels.iter().all(|channel| channel.uncertainty.is_some())
    }

    /// The link with the motor that drives it.
    pub(super) fn with_motor(&self, link: &Link) -> Option<Link> {
        with_motor(link, self.motor.as_ref())
    }

    /// True if the torque at the hub, or the force on a carriage, is the input.
    pub(super) fn is_of_torque(&self) -> bool {
        self.motor.is_none() && matches!(self.driven, Driven::Torque(..))
    }

    /// Noise of a hub angle that drives the link, over its motion, if it counts: only noise remains in its eighth
    /// differences.
    pub(super) fn input_noise(&self) -> Option<f64> {
        let Driven::Angle(angle) = &self.driven else { return None };
        if angle.len() <= 2 * NOISE_ORDER {
            return None;
        }
        let differences = (0..NOISE_ORDER).fold(angle.clone(), |samples, _| {
            samples.windows(2).map(|pair| pair[1] - pair[0]).collect()
        });
        let share = rms(&differences) / NOISE_GAIN.sqrt() / rms_about_mean(angle);
        (share > LITTLE_NOISE).then_some(share)
    }

    /// Number of residuals.
    pub(super) fn rows(&self) -> usize {
        self.channels.len() * self.compared()
    }

    /// Longest delay of the search, in samples; 0 without a free delay.
    pub(super) fn longest_delay(&self) -> usize {
        if self.is_delay_free { longest_delay(self.channels[0].samples.len()) } else { 0 }
    }

    /// Number of compared samples.
    pub(super) fn compared(&self) -> usize {
        self.channels[0].samples.len() - self.longest_delay()
    }

    /// Number of additional free values: gains, offsets, the delay.
    pub(super) fn own_free_values(&self) -> usize {
        let own = |channel: &Channel| {
            usize::from(channel.gain == Gain::Free) + usize::from(channel.has_offset)
        };
        self.channels.iter().map(own).sum::<usize>() + usize::from(self.is_delay_free)
    }

    /// Sum of squared weights of the residuals.
    pub(super) fn weight(&self) -> f64 {
        let numbers = 0..self.channels.len();
        numbers.map(|k| self.compared() as f64 * self.uncertainty(k).powi(-2)).sum()
    }

    /// Uncertainty of a channel over its size; if unknown, the noise from a fit, or 1.
    fn uncertainty(&self, channel: usize) -> f64 {
        let shown = self.noise.as_ref().map_or(1.0, |noise| noise[channel]);
        self.channels[channel].uncertainty.map_or(shown, |u| u / self.sizes[channel])
    }

    /// Beginning of the record: a share of the part after the input first moves the link. In few periods a wrong
    /// frequency does not lose count of them.
    pub(super) fn beginning(&self, share: f64) -> Self {
        let (Driven::Torque(input, _) | Driven::Angle(input)) = &self.driven;
        let (first, size) = (input[0], largest(input));
        let moves = |sample: &f64| (sample - first).abs() > STIRRING * size || first != 0.0;
        let rest = input.iter().position(moves).unwrap_or(0);
        let kept = rest + (share * (input.len() - rest) as f64).ceil() as usize;
        let kept = kept.max(LEAST_BEGINNING).min(input.len());
        let input = input[..kept].to_vec();
        let driven = match &self.driven {
            Driven::Torque(_, interpolation) => Driven::Torque(input, *interpolation),
            Driven::Angle(_) => Driven::Angle(input),
        };
        let cut = |channel: &Channel| Channel {
            samples: channel.samples[..kept].to_vec(),
            ..channel.clone()
        };
        Self { driven, channels: self.channels.iter().map(cut).collect(), ..self.clone() }
    }

    /// This record with each channel weighted by the remaining differences of a fit.
    pub(super) fn weighed(&self, alignment: &Alignment) -> Self {
        let shares = alignment.differences.iter().zip(&self.sizes);
        let noise = shares.map(|(differences, size)| (rms(differences) / size).max(EXACT));
        Self { noise: Some(noise.collect()), ..self.clone() }
    }

    /// Highest frequency in rad/s that a mesh must follow.
    pub(super) fn highest_rad_s(&self, mesh: &Mesh) -> f64 {
        let modes = natural_frequencies(mesh, FOLLOWED_MODES);
        let nyquist = PI / self.step_s;
        modes.last().map_or(nyquist, |highest| highest.min(nyquist))
    }

    /// Alignment with the histories of a link, including its motor's friction, at a delay of `delay` samples. `None` if
    /// the link cannot be simulated.
    pub(super) fn fitted(&self, link: &Link, mesh: &Mesh, delay: f64) -> Option<Alignment> {
        let computed = self.computed(link, mesh)?;
        Some(Alignment::of(&self.overlaid(&computed), delay, self.compared()))
    }

    /// The delay in whole samples at which the histories of a link fit the record best.
    pub(super) fn rough_delay(&self, link: &Link, mesh: &Mesh) -> Option<f64> {
        Some(rough_delay(&self.overlaid(&self.computed(link, mesh)?)))
    }

    fn computed(&self, link: &Link, mesh: &Mesh) -> Option<Vec<Vec<f64>>> {
        let sensors: Vec<Sensor> = self.channels.iter().map(|channel| channel.sensor).collect();
        let back = self.motor.as_ref().map(Motor::friction_n_m_s_rad);
        sensed(link, mesh, (&self.driven, back), self.step_s, &sensors).ok()
    }

    fn overlaid<'a>(&'a self, computed: &'a [Vec<f64>]) -> Vec<Overlaid<'a>> {
        let pairs = self.channels.iter().zip(computed).enumerate();
        let overlaid = pairs.map(|(k, (channel, computed))| Overlaid {
            recorded: &channel.samples,
            computed,
            freedom: Freedom { gain: channel.gain, has_offset: channel.has_offset },
            weight: 1.0 / (self.sizes[k] * self.uncertainty(k)),
        });
        overlaid.collect()
    }

    /// Differences over their uncertainties, or over the size of the channel if these are unknown.
    pub(super) fn residuals(&self, alignment: &Alignment) -> Vec<f64> {
        let channels = alignment.differences.iter().enumerate();
        let residuals = channels.flat_map(|(k, differences)| {
            let unit = self.sizes[k] * self.uncertainty(k);
            differences.iter().map(move |difference| difference / unit)
        });
        residuals.collect()
    }
}

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
