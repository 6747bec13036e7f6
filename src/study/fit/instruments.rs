//! Sensors and inputs of measurements: gains, channels, a motor, recorded inputs.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::link::{Drive, Link, ParameterError, positive};
use crate::model::Sensor;
use crate::response::{Driven, Interpolation};
use crate::text::significant;

/// Upper limit of the uncertainty of a measurement over its value.
pub(super) const MOST_UNCERTAIN: f64 = 0.5;

/// Known or free scale of measured values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Gain {
    /// The values are in SI.
    #[default]
    Known,
    /// The values are in SI, but with an unknown sign.
    Sign,
    /// All values have one unknown factor, as from a sensor or an amplifier, of either sign.
    Free,
}

/// Upper limit of the size of samples.
const LARGEST: f64 = 1e150;

/// Fewest samples of a record.
pub(super) const FEWEST: usize = 4;

/// Name in errors of the samples that drive the link.
pub(super) const INPUT: &str = "the input";

/// Kind of input that drives the recorded link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordedInput {
    /// The torque at the hub.
    Torque,
    /// The voltage at a motor.
    Voltage,
    /// Angle of the hub, whatever moves it.
    HubAngle,
    /// The force on a carriage.
    Force,
    /// Position of a carriage, whatever moves it.
    Carriage,
}

impl RecordedInput {
    /// True for a motion of the joint.
    pub fn is_motion(self) -> bool {
        matches!(self, Self::HubAngle | Self::Carriage)
    }

    /// Whether links on carriages, or on hubs, have the input; `None`: both.
    pub fn slides(self) -> Option<bool> {
        (self != Self::Voltage).then_some(matches!(self, Self::Force | Self::Carriage))
    }

    /// Name in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Voltage => "voltage",
            Self::HubAngle => "hub_angle",
            Self::Force => "force",
            Self::Carriage => "carriage",
        }
    }
}

/// Recorded input of a link that is at rest before.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordInput {
    /// The torque at the hub in N m, or the force on a carriage in N.
    Torque(Vec<f64>, Interpolation),
    /// The voltage at a motor in V.
    Voltage(Vec<f64>, Interpolation, Motor),
    /// Angle of the hub in rad, or position of the carriage in m, whatever moves it.
    HubAngle(Vec<f64>),
}

/// Record of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The sensor.
    pub sensor: Sensor,
    /// Known or free scale of the samples.
    pub gain: Gain,
    /// True if the samples may have a constant offset.
    pub has_offset: bool,
    /// Standard uncertainty of each sample, in the unit of the samples, if known.
    pub uncertainty: Option<f64>,
    /// Unit of the recorded column in SI; for a strain gauge, divided by its distance.
    pub unit: f64,
    /// Samples, in SI if the gain is known.
    pub samples: Vec<f64>,
}

/// Reason why histories are no record.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RecordError {
    /// There is no sensor.
    #[error("the record has no channels, but needs at least one")]
    NoChannel,
    /// There are too few samples.
    #[error("samples = {0}, but must be {FEWEST} or more")]
    Few(usize),
    /// A channel has another number of samples than the input.
    #[error("{channel} = {found} samples, but must be {must}, as the input has")]
    Uneven {
        /// The channel, or the input.
        channel: String,
        /// Number of its samples.
        found: usize,
        /// Number of samples of the input.
        must: usize,
    },
    /// A sample is not finite, or its square overflows.
    #[error("sample {sample} of {channel} = {found}, but must be a number of size below 1e150")]
    Size {
        /// The channel, or the input.
        channel: String,
        /// Number of the sample, from 0.
        sample: usize,
        /// Value of the sample.
        found: f64,
    },
    /// All samples are equal.
    #[error("{channel} is the same in all samples, but must change")]
    Constant {
        /// The channel, or the input.
        channel: String,
    },
    /// An uncertainty is not above 0, or too large for a measurement.
    #[error(
        "uncertainty of {channel} = {} in its column's unit, but must be above 0 and below {}, half of the samples' \
         variation",
        significant(*found, 4),
        significant(*most, 4)
    )]
    Uncertainty {
        /// The channel.
        channel: String,
        /// Value of the uncertainty.
        found: f64,
        /// Upper limit of the uncertainty.
        most: f64,
    },
    /// Only some uncertainties are known.
    #[error("uncertainty of {channel} is missing, but other channels have one")]
    Mixed {
        /// The first channel without an uncertainty.
        channel: String,
    },
    /// The step is not above 0.
    #[error("step = {0} s, but must be finite and above 0")]
    Step(f64),
}

impl RecordInput {
    /// Effect on the link: the torque or the angle, and the motor under a voltage.
    pub(super) fn driven(self) -> (Driven, Option<Motor>) {
        match self {
            Self::Torque(samples, interpolation) => (Driven::Torque(samples, interpolation), None),
            Self::Voltage(samples, interpolation, motor) => {
                let torque_n_m_v = motor.torque_per_volt_n_m_v();
                let samples = samples.iter().map(|volts| torque_n_m_v * volts).collect();
                (Driven::Torque(samples, interpolation), Some(motor))
            }
            Self::HubAngle(samples) => (Driven::Angle(samples), None),
        }
    }
}

impl RecordError {
    /// Suggests a remedy to the user.
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

/// Refuses samples that a fit cannot use.
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

/// A direct-current motor at the joint, with neglected inductance.
///
/// ```text
/// T = N k_t/R (V − N k_t θ̇)
/// ```
///
/// The back voltage acts as viscous friction `(N k_t)²/R` on the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    torque_constant_n_m_a: f64,
    resistance_ohm: f64,
    gear_ratio: f64,
}

impl Motor {
    /// Torque constant `k_t` in N m/A, resistance R in Ω, and N turns of the motor for one of the hub, or rad for 1 m of a
    /// carriage.
    ///
    /// # Errors
    /// [`ParameterError`] names the first value that is not above 0.
    pub fn new(
        torque_constant_n_m_a: f64,
        resistance_ohm: f64,
        gear_ratio: f64,
    ) -> Result<Self, ParameterError> {
        positive("drive.torque_constant", torque_constant_n_m_a, "N m/A")?;
        positive("drive.resistance", resistance_ohm, "ohm")?;
        positive("drive.gear_ratio", gear_ratio, "")?;
        Ok(Self { torque_constant_n_m_a, resistance_ohm, gear_ratio })
    }

    /// The motor of a link's drive; `None` unless it has torque constant and resistance.
    pub fn of(drive: &Drive) -> Option<Self> {
        let (constant, resistance) = drive.torque_constant_n_m_a.zip(drive.resistance_ohm)?;
        Self::new(constant, resistance, drive.gear_ratio).ok()
    }

    /// Torque of the held hub per volt in N m/V.
    pub(super) fn torque_per_volt_n_m_v(&self) -> f64 {
        self.gear_ratio * self.torque_constant_n_m_a / self.resistance_ohm
    }

    /// Viscous friction of the shorted motor at the hub in N m s/rad.
    pub(super) fn friction_n_m_s_rad(&self) -> f64 {
        self.gear_ratio * self.torque_constant_n_m_a * self.torque_per_volt_n_m_v()
    }
}

/// The link with the rotor of its drive and the friction due to a motor's back voltage on its joint; the link alone
/// without a motor. `None` if they are out of range.
pub(super) fn with_motor(link: &Link, motor: Option<&Motor>) -> Option<Link> {
    let Some(motor) = motor else { return Some(link.clone()) };
    let rotor = link.drive().map_or(0.0, Drive::rotor_at_joint);
    link.with_joint(rotor, motor.friction_n_m_s_rad()).ok()
}
