use std::cmp::Ordering;
use std::f64::consts::PI;

use thiserror::Error;

use super::alignment::{Alignment, Freedom, Overlaid, longest_delay, rough_delay};
use super::motor::{Motor, with_motor_friction};
use super::response::{Gain, MOST_UNCERTAIN};
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::natural_frequencies;
use crate::model::Sensor;
use crate::response::{Driven, Interpolation, sensed};
use crate::text::significant;

/// Fewest samples of a record.
const FEWEST: usize = 4;

/// Noise of a hub angle over its motion that a fit may take for motion.
const LITTLE_NOISE: f64 = 2e-4;

/// Least noise of a channel over its size.
const EXACT: f64 = 1e-12;

/// Order of the differences that leave of a motion its noise alone.
const NOISE_ORDER: usize = 8;

/// What differences of that order make of the variance of white noise: `C(16, 8)`.
const NOISE_GAIN: f64 = 12_870.0;

/// Modes that the mesh of a record follows.
const FOLLOWED_MODES: usize = 30;

/// What drives the link that is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordedInput {
    /// The torque at the hub.
    Torque,
    /// The voltage at a motor.
    Voltage,
    /// The angle of the hub, however it is moved.
    HubAngle,
}

impl RecordedInput {
    /// Its name in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Voltage => "voltage",
            Self::HubAngle => "hub_angle",
        }
    }
}

/// What was recorded of what drives the link, which is at rest before.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordInput {
    /// The torque at the hub in N m.
    Torque(Vec<f64>, Interpolation),
    /// The voltage at a motor in V.
    Voltage(Vec<f64>, Interpolation, Motor),
    /// The angle of the hub in rad, however it is moved.
    HubAngle(Vec<f64>),
}

/// What one sensor recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The sensor.
    pub sensor: Sensor,
    /// Whether the samples are in SI.
    pub gain: Gain,
    /// True if a constant may be added to the samples.
    pub has_offset: bool,
    /// Standard uncertainty of each sample, in the unit of the samples, if it is known.
    pub uncertainty: Option<f64>,
    /// The unit of the recorded column in SI; over its distance, of a strain gauge.
    pub unit: f64,
    /// The samples, in SI where the gain is known.
    pub samples: Vec<f64>,
}

/// Why histories are no record.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RecordError {
    /// No sensor.
    #[error("channels = none, but must be at least one")]
    NoChannel,
    /// Too few samples.
    #[error("samples = {0}, but must be {FEWEST} or more")]
    Few(usize),
    /// Another number of samples than those of the input.
    #[error("{channel} = {found} samples, but must be {must}, as the input has")]
    Uneven {
        /// The channel, or the input.
        channel: String,
        /// Samples found.
        found: usize,
        /// Samples of the input.
        must: usize,
    },
    /// A sample that is no number.
    #[error("sample {sample} of {channel} = {found}, but must be a finite number")]
    NotFinite {
        /// The channel, or the input.
        channel: String,
        /// Number of the sample, from 0.
        sample: usize,
        /// What was found.
        found: f64,
    },
    /// Samples that are all the same.
    #[error("{channel} = the same value in all samples, but must change")]
    Constant {
        /// The channel, or the input.
        channel: String,
    },
    /// An uncertainty that is not above 0, or too large for a measurement.
    #[error(
        "uncertainty of {channel} = {} in its column's unit, but must be above 0 and below {}, half of \
         what the samples vary by",
        significant(*found, 4),
        significant(*most, 4)
    )]
    Uncertainty {
        /// The channel.
        channel: String,
        /// What was found.
        found: f64,
        /// What it must be below.
        most: f64,
    },
    /// Some uncertainties are known and some are not.
    #[error("uncertainty of {channel} is missing, but other channels have one")]
    Mixed {
        /// The first channel without one.
        channel: String,
    },
    /// A step that is not above 0.
    #[error("step = {0} s, but must be finite and above 0")]
    Step(f64),
}

/// Recorded histories of a link that is driven from rest, at uniform times.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub(super) name: String,
    pub(super) step_s: f64,
    driven: Driven,
    motor_friction_n_m_s_rad: f64,
    pub(super) channels: Vec<Channel>,
    /// Root mean square of the samples of each channel, about their mean if an offset is free.
    pub(super) sizes: Vec<f64>,
    pub(super) is_delay_free: bool,
    /// Noise of each channel over its size, where no uncertainty is known and a fit has shown it.
    noise: Option<Vec<f64>>,
}

/// A record and the computed histories, laid over each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RecordFit(pub(super) Alignment);

impl Record {
    /// Checks a record that messages call `name`, of `step_s` in s.
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
        let (driven, motor_friction_n_m_s_rad) = input.driven();
        let (Driven::Torque(driving, _) | Driven::Angle(driving)) = &driven;
        if driving.len() < FEWEST {
            return Err(RecordError::Few(driving.len()));
        }
        check("the input", driving, driving.len())?;
        // A torque that begins with the record and stays moves the link.
        let is_rest = matches!(driven, Driven::Angle(_)) || driving[0] == 0.0;
        if is_rest && is_constant(driving) {
            return Err(RecordError::Constant { channel: "the input".to_owned() });
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
        Ok(Self {
            name,
            step_s,
            driven,
            motor_friction_n_m_s_rad,
            channels,
            sizes,
            is_delay_free,
            noise: None,
        })
    }

    /// What messages call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What each sensor recorded.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// True if the uncertainty of every channel is known.
    pub fn has_uncertainties(&self) -> bool {
        self.channels.iter().all(|channel| channel.uncertainty.is_some())
    }

    /// The link with the friction of the motor that drives it.
    pub(super) fn with_motor_friction(&self, link: &Link) -> Option<Link> {
        with_motor_friction(link, self.motor_friction_n_m_s_rad)
    }

    /// Noise of a hub angle that drives the link, over its motion, where it counts: its eighth differences are
    /// noise alone.
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

    /// Numbers that it adds to the residuals.
    pub(super) fn rows(&self) -> usize {
        self.channels.len() * self.compared()
    }

    /// The longest delay that is looked for, in samples; 0 where the sensors are not late.
    pub(super) fn longest_delay(&self) -> usize {
        if self.is_delay_free { longest_delay(self.channels[0].samples.len()) } else { 0 }
    }

    /// Samples that are compared.
    pub(super) fn compared(&self) -> usize {
        self.channels[0].samples.len() - self.longest_delay()
    }

    /// Free values that it adds: gains, offsets, the delay.
    pub(super) fn own_free_values(&self) -> usize {
        let own = |channel: &Channel| {
            usize::from(channel.gain == Gain::Free) + usize::from(channel.has_offset)
        };
        self.channels.iter().map(own).sum::<usize>() + usize::from(self.is_delay_free)
    }

    /// Sum of the residuals' squared weights.
    pub(super) fn weight(&self) -> f64 {
        let numbers = 0..self.channels.len();
        numbers.map(|k| self.compared() as f64 * self.uncertainty(k).powi(-2)).sum()
    }

    /// Uncertainty of a channel over its size; where it is not known what a fit has shown, or 1.
    fn uncertainty(&self, channel: usize) -> f64 {
        let shown = self.noise.as_ref().map_or(1.0, |noise| noise[channel]);
        self.channels[channel].uncertainty.map_or(shown, |u| u / self.sizes[channel])
    }

    /// The same record, each channel weighed by the differences that a fit has left.
    pub(super) fn weighed(&self, RecordFit(alignment): &RecordFit) -> Self {
        let shares = alignment.differences.iter().zip(&self.sizes);
        let noise = shares.map(|(differences, size)| (rms(differences) / size).max(EXACT));
        Self { noise: Some(noise.collect()), ..self.clone() }
    }

    /// The highest frequency in rad/s that a mesh must follow.
    pub(super) fn highest_rad_s(&self, mesh: &Mesh) -> f64 {
        let modes = natural_frequencies(mesh, FOLLOWED_MODES);
        let nyquist = PI / self.step_s;
        modes.last().map_or(nyquist, |highest| highest.min(nyquist))
    }

    /// True if the sensors may be late.
    pub(super) fn is_delay_free(&self) -> bool {
        self.is_delay_free
    }

    /// The record over the histories of a link, its motor's friction included, late by `delay` samples. None
    /// if the link cannot be simulated.
    pub(super) fn fitted(&self, link: &Link, mesh: &Mesh, delay: f64) -> Option<RecordFit> {
        let computed = self.computed(link, mesh)?;
        Some(RecordFit(Alignment::of(&self.overlaid(&computed), delay, self.compared())))
    }

    /// The delay of whole samples by which the histories of a link lie best over the record.
    pub(super) fn rough_delay(&self, link: &Link, mesh: &Mesh) -> Option<f64> {
        Some(rough_delay(&self.overlaid(&self.computed(link, mesh)?)))
    }

    fn computed(&self, link: &Link, mesh: &Mesh) -> Option<Vec<Vec<f64>>> {
        let sensors: Vec<Sensor> = self.channels.iter().map(|channel| channel.sensor).collect();
        sensed(link, mesh, &self.driven, self.step_s, &sensors).ok()
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

    /// The differences over their uncertainties, or over the size of the channel where that is not known.
    pub(super) fn residuals(&self, fitted: &RecordFit) -> Vec<f64> {
        let channels = fitted.0.differences.iter().enumerate();
        let residuals = channels.flat_map(|(k, differences)| {
            let unit = self.sizes[k] * self.uncertainty(k);
            differences.iter().map(move |difference| difference / unit)
        });
        residuals.collect()
    }
}

impl RecordInput {
    /// What it does to the link: the torque or the angle, and the friction of a motor.
    fn driven(self) -> (Driven, f64) {
        match self {
            Self::Torque(samples, interpolation) => (Driven::Torque(samples, interpolation), 0.0),
            Self::Voltage(samples, interpolation, motor) => {
                let torque_n_m_v = motor.torque_per_volt_n_m_v();
                let samples = samples.iter().map(|volts| torque_n_m_v * volts).collect();
                (Driven::Torque(samples, interpolation), motor.friction_n_m_s_rad())
            }
            Self::HubAngle(samples) => (Driven::Angle(samples), 0.0),
        }
    }
}

impl Channel {
    /// Root mean square of the samples, about their mean if an offset is free.
    fn size(&self) -> f64 {
        if self.has_offset { rms_about_mean(&self.samples) } else { rms(&self.samples) }
    }
}

/// Root mean square of samples.
pub(super) fn rms(samples: &[f64]) -> f64 {
    (samples.iter().map(|sample| sample * sample).sum::<f64>() / samples.len() as f64).sqrt()
}

fn rms_about_mean(samples: &[f64]) -> f64 {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    rms(&samples.iter().map(|sample| sample - mean).collect::<Vec<f64>>())
}

/// Refuses samples that cannot be fitted to.
fn check(channel: &str, samples: &[f64], must: usize) -> Result<(), RecordError> {
    let channel = channel.to_owned();
    let found = samples.len();
    if found != must {
        return Err(RecordError::Uneven { channel, found, must });
    }
    if let Some(sample) = samples.iter().position(|sample| !sample.is_finite()) {
        return Err(RecordError::NotFinite { channel, sample, found: samples[sample] });
    }
    Ok(())
}

fn is_constant(samples: &[f64]) -> bool {
    samples.windows(2).all(|pair| pair[0].partial_cmp(&pair[1]).is_some_and(Ordering::is_eq))
}
