//! Frequency responses in files of their own.

use super::error::Fault;
use super::measured_files::{RawGain, RawSensor, check_motor, checked};
use super::value::{Count, Length};
use crate::fit::Gain;
use crate::model::Sensor;

/// A frequency response in a file of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseFile {
    /// The file, relative to that which names it.
    pub file: String,
    /// What was measured.
    pub transfer: Sensor,
    /// True if it was measured per volt at the motor, not per torque.
    pub is_per_volt: bool,
    /// Whether its scale is known.
    pub gain: Gain,
    /// Distance of a strain gauge from the neutral axis in m, or 1.
    pub distance_m: f64,
    /// Relative uncertainty of its values.
    pub uncertainty: Option<f64>,
    /// Number of the zero in its lowest dip, if it was measured in a closed loop: then its zeros alone are the
    /// link's.
    pub first_zero: Option<usize>,
}

/// `[[response]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawResponse {
    file: String,
    transfer: RawSensor,
    #[serde(rename = "loop")]
    around: Option<RawLoop>,
    first_zero: Option<Count>,
    per: Option<RawPer>,
    gain: Option<RawGain>,
    distance: Option<Length>,
    uncertainty: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase", expecting = "a string")]
enum RawLoop {
    Open,
    Closed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase", expecting = "a string")]
enum RawPer {
    Torque,
    Volt,
}

impl RawResponse {
    pub(super) fn convert(self, path: &str, has_motor: bool) -> Result<ResponseFile, Fault> {
        let first_zero = self.first_zero(path)?;
        let Self { file, transfer, per, gain, distance, uncertainty, .. } = self;
        uncertainty.map_or(Ok(()), |uncertainty| checked(path, "uncertainty", uncertainty))?;
        let gain = RawGain::gain(gain);
        let is_per_volt = per == Some(RawPer::Volt);
        if is_per_volt {
            check_motor(&format!("{path}.per"), "volt", has_motor)?;
        }
        let distance_m = transfer.distance_m(path, gain, distance)?;
        let transfer = transfer.sensor();
        Ok(ResponseFile { file, transfer, is_per_volt, gain, distance_m, uncertainty, first_zero })
    }

    /// Number of the first zero of a closed loop.
    fn first_zero(&self, path: &str) -> Result<Option<usize>, Fault> {
        let refused = |key: &str, must: &str| {
            let path = format!("{path}.{key}");
            let message = format!("{path} {must}");
            Err(Fault::new(path, message))
        };
        if self.around != Some(RawLoop::Closed) {
            return match self.first_zero {
                Some(_) => refused("first_zero", "must stand beside loop = \"closed\" alone"),
                None => Ok(None),
            };
        }
        let has_dips = matches!(self.transfer, RawSensor::HubAngle | RawSensor::HubRate);
        if !has_dips {
            let must = "must be \"hub_angle\" or \"hub_rate\" beside loop = \"closed\": \
                        no other sensor has the zeros of the clamped link";
            return refused("transfer", must);
        }
        // A dip is where it is at any scale and behind any motor.
        let useless = [("per", self.per.is_some()), ("gain", self.gain.is_some())];
        if let Some((key, _)) = useless.into_iter().find(|(_, is_given)| *is_given) {
            return refused(
                key,
                "has no meaning beside loop = \"closed\": the dips alone are read",
            );
        }
        Ok(Some(self.first_zero.map_or(1, |Count(number)| number)))
    }
}
