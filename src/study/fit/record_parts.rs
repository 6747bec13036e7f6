//! What a record is made of.

use std::cmp::Ordering;

use thiserror::Error;

use super::motor::Motor;
use super::response::Gain;
use crate::model::Sensor;
use crate::response::{Driven, Interpolation};
use crate::text::significant;

/// Size that no sample has.
const LARGEST: f64 = 1e150;

/// Fewest samples of a record.
pub(super) const FEWEST: usize = 4;

/// What errors call the samples that drive the link.
pub(super) const INPUT: &str = "the input";

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
    /// A sample that is no number, or one whose square is too large for a number.
    #[error("sample {sample} of {channel} = {found}, but must be a number of size below 1e150")]
    Size {
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

impl RecordInput {
    /// What it does to the link: the torque or the angle, and the friction of a motor.
    pub(super) fn driven(self) -> (Driven, f64) {
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

impl RecordError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        let is_undriven = matches!(self, Self::Constant { channel } if channel == INPUT);
        is_undriven
            .then_some("[[decay]] with file, mode and hub reads a free decay, which nothing drives")
    }
}

impl Channel {
    /// Root mean square of the samples, about their mean if an offset is free.
    pub(super) fn size(&self) -> f64 {
        if self.has_offset { rms_about_mean(&self.samples) } else { rms(&self.samples) }
    }
}

/// Root mean square of samples.
pub(super) fn rms(samples: &[f64]) -> f64 {
    (samples.iter().map(|sample| sample * sample).sum::<f64>() / samples.len() as f64).sqrt()
}

pub(super) fn rms_about_mean(samples: &[f64]) -> f64 {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    rms(&samples.iter().map(|sample| sample - mean).collect::<Vec<f64>>())
}

/// Refuses samples that cannot be fitted to.
pub(super) fn check(channel: &str, samples: &[f64], must: usize) -> Result<(), RecordError> {
    let channel = channel.to_owned();
    let found = samples.len();
    if found != must {
        return Err(RecordError::Uneven { channel, found, must });
    }
    if let Some(sample) = samples.iter().position(|sample| !(-LARGEST..LARGEST).contains(sample)) {
        return Err(RecordError::Size { channel, sample, found: samples[sample] });
    }
    Ok(())
}

pub(super) fn is_constant(samples: &[f64]) -> bool {
    samples.windows(2).all(|pair| pair[0].partial_cmp(&pair[1]).is_some_and(Ordering::is_eq))
}
