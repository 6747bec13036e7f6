use serde::de::Deserialize;

use super::document::shown;
use super::error::{Fault, SpecError};
use super::measured_decay::{DecayFile, RawDecay};
use super::measured_files::{
    RawGain, RawMotor, RawRecord, RawSensor, RecordFile, check_motor, checked,
};
use super::measured_values::{MeasuredOf, RawDamping, RawFrequency};
use super::tree::Node;
use super::value::{Angle, Count, Length, tables};
use crate::fit::{Gain, Measured, Motor};
use crate::model::Sensor;

/// The whole file of measured values, key by key.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawMeasurements {
    at: Option<Vec<Angle>>,
    #[serde(default, deserialize_with = "tables")]
    frequency: Vec<RawFrequency>,
    #[serde(default, deserialize_with = "tables")]
    damping: Vec<RawDamping>,
    #[serde(default, deserialize_with = "tables")]
    response: Vec<RawResponse>,
    #[serde(default, deserialize_with = "tables")]
    record: Vec<RawRecord>,
    #[serde(default, deserialize_with = "tables")]
    decay: Vec<RawDecay>,
    motor: Option<RawMotor>,
}

/// Content of a file of measured values.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredFile {
    /// Measured values.
    pub values: Vec<Measured>,
    /// Frequency responses in separate files.
    pub responses: Vec<ResponseFile>,
    /// Recorded histories in separate files.
    pub records: Vec<RecordFile>,
    /// Free decays in separate files.
    pub decays: Vec<DecayFile>,
    /// The motor at the hub.
    pub motor: Option<Motor>,
}

/// Reads the text of a file of measured values of an arm with this number of `links`, or of one link; errors call the
/// file `name`.
///
/// ```
/// use flexlink::spec::read_measurements;
/// let text = "[[frequency]]\nmode = 1\nvalue = '2.52 Hz'\nuncertainty = '0.02 Hz'\nhub = 'held'\n\
///             [[damping]]\nmode = 1\nratio = 0.013\nuncertainty = 0.002\n";
/// let measured = read_measurements("measured.toml", text, 1)?;
/// assert_eq!(measured.values.len(), 2);
/// # Ok::<(), flexlink::spec::SpecError>(())
/// ```
///
/// # Errors
/// [`SpecError`] names the line and the wrong value.
pub fn read_measurements(name: &str, text: &str, links: usize) -> Result<MeasuredFile, SpecError> {
    let tree = Node::document(name, text)?;
    let raw = RawMeasurements::deserialize(&tree).map_err(Fault::from);
    raw.and_then(|raw| convert(raw, links)).map_err(|fault| {
        let place = tree.last_place(&fault);
        fault.at(shown(place, name, &[]))
    })
}

fn convert(raw: RawMeasurements, links: usize) -> Result<MeasuredFile, Fault> {
    let of = MeasuredOf::new(links, raw.at)?;
    let of_one_link = [
        ("motor", raw.motor.is_some()),
        ("response", !raw.response.is_empty()),
        ("record", !raw.record.is_empty()),
    ];
    for (key, _) in of_one_link.into_iter().filter(|(_, is_given)| *is_given) {
        of.refuse_for_arms(key, "[[frequency]], [[damping]] and [[decay]] alone")?;
    }
    let mut values = Vec::new();
    for (number, raw) in raw.frequency.into_iter().enumerate() {
        values.push(raw.convert(&format!("frequency.{number}"), &of)?);
    }
    for (number, raw) in raw.damping.into_iter().enumerate() {
        values.push(raw.convert(&format!("damping.{number}"), &of)?);
    }
    let decays = raw.decay.into_iter().enumerate();
    let decays = decays.map(|(number, raw)| raw.convert(&format!("decay.{number}"), &of));
    let decays = decays.collect::<Result<Vec<_>, Fault>>()?;
    let motor = raw.motor.map(RawMotor::convert).transpose()?;
    let mut responses = Vec::new();
    for (number, raw) in raw.response.into_iter().enumerate() {
        responses.push(raw.convert(&format!("response.{number}"), motor.is_some())?);
    }
    let mut records = Vec::new();
    for (number, raw) in raw.record.into_iter().enumerate() {
        records.push(raw.convert(&format!("record.{number}"), motor.is_some())?);
    }
    if values.is_empty() && responses.is_empty() && records.is_empty() && decays.is_empty() {
        let hint = if of.is_arm() {
            "[[frequency]] with mode, value, joints and at, [[damping]] with mode, ratio, joints and at, [[decay]] \
             with file, mode, joints and at"
        } else {
            "[[frequency]] with mode, value and hub, [[damping]] with mode and ratio, [[decay]] with file, mode and hub, \
             [[response]] with file and transfer, [[record]] with file, input and channel"
        };
        let message = "measurements = none, but must be at least one";
        return Err(Fault::new("", message).hinting(hint.to_owned()));
    }
    Ok(MeasuredFile { values, responses, records, decays, motor })
}

/// A frequency response in a separate file.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseFile {
    /// The file, relative to the file that names it.
    pub file: String,
    /// Measured sensor.
    pub transfer: Sensor,
    /// True if the response is per volt at the motor, not per torque.
    pub is_per_volt: bool,
    /// Known or free scale of the response.
    pub gain: Gain,
    /// Distance of a strain gauge from the neutral axis in m, or 1.
    pub distance_m: f64,
    /// Relative uncertainty of the values.
    pub uncertainty: Option<f64>,
    /// Number of the zero in the lowest dip, for a measurement in a closed loop, in which only the zeros are the
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
        // A dip has the same place at any scale and behind any motor.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_refused_with_its_line() {
        for (text, expected) in [
            ("", "m.toml: measurements = none, but must be at least one"),
            (
                "[[frequency]]\nmode = 1\nvalue = 0",
                "m.toml:3: frequency.0.value = 0, but must be above 0",
            ),
            (
                "[[frequency]]\nvalue = 1",
                "m.toml:1: frequency.0 = neither mode nor zero, but must have one of them",
            ),
            ("[[frequency]]\nmode = 1", "m.toml:1: frequency.0.value is missing"),
            ("[[frequenzy]]\nmode = 1", "m.toml:1: unknown key `frequenzy`"),
            (
                "[[damping]]\nmode = 1\npeaks = [1, 2]",
                "m.toml:3: damping.0.peaks must be two or more peaks of one sign, each below the one before",
            ),
        ] {
            assert_eq!(read_measurements("m.toml", text, 1).unwrap_err().to_string(), expected);
        }
    }
}
