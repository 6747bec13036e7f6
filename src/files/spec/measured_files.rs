//! Recorded histories in separate files, and the parts that they share with frequency responses.

use super::error::Fault;
use super::value::{Count, Length, Si, tables};
use crate::fit::{Gain, Motor, RecordedInput};
use crate::model::Sensor;
use crate::response::Interpolation;

/// Recorded histories in a separate file.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordFile {
    /// The file, relative to the file that names it.
    pub file: String,
    /// Input that drives the link.
    pub input: RecordedInput,
    /// Course of a torque or a voltage between its samples.
    pub hold: Interpolation,
    /// True if the sensors may be late.
    pub is_delay_free: bool,
    /// Number of lines to skip at the beginning.
    pub skip: usize,
    /// Columns of the quantities, as for `--columns`.
    pub columns: Vec<String>,
    /// Factors on the numbers of columns, as for `--scale`.
    pub scale: Vec<String>,
    /// The sensors.
    pub channels: Vec<ChannelFile>,
}

/// A sensor's column of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelFile {
    /// The sensor.
    pub sensor: Sensor,
    /// Known or free scale of the sensor.
    pub gain: Gain,
    /// True if the sensor may have a constant offset.
    pub has_offset: bool,
    /// Distance of a strain gauge from the neutral axis in m, or 1.
    pub distance_m: f64,
    /// Standard uncertainty of a sample in the unit of its column.
    pub uncertainty: Option<f64>,
}

/// `[motor]`
#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawMotor {
    torque_constant: f64,
    resistance: f64,
    gear_ratio: Option<f64>,
}

/// `[[record]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawRecord {
    file: String,
    input: RawInput,
    hold: Option<RawHold>,
    delay: Option<RawFreedom>,
    skip: Option<Count>,
    #[serde(default)]
    columns: Vec<String>,
    #[serde(default)]
    scale: Vec<String>,
    #[serde(default, deserialize_with = "tables")]
    channel: Vec<RawChannel>,
}

/// `[[record.channel]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawChannel {
    sensor: RawSensor,
    gain: Option<RawGain>,
    offset: Option<RawFreedom>,
    distance: Option<Length>,
    uncertainty: Option<f64>,
}

#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "snake_case", expecting = "a string")]
pub(super) enum RawSensor {
    HubAngle,
    HubRate,
    TipDeflection,
    TipAcceleration,
    RootStrain,
}

#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "lowercase", expecting = "a string")]
pub(super) enum RawGain {
    Known,
    Sign,
    Free,
}

#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "snake_case", expecting = "a string")]
enum RawInput {
    Torque,
    Voltage,
    HubAngle,
}

#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "lowercase", expecting = "a string")]
enum RawHold {
    Zero,
    Linear,
    Cubic,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase", expecting = "a string")]
enum RawFreedom {
    Known,
    Free,
}

impl RawSensor {
    pub(super) fn sensor(self) -> Sensor {
        match self {
            Self::HubAngle => Sensor::HubAngle,
            Self::HubRate => Sensor::HubRate,
            Self::TipDeflection => Sensor::TipDeflection,
            Self::TipAcceleration => Sensor::TipAcceleration,
            Self::RootStrain => Sensor::RootStrain,
        }
    }

    /// Distance of a strain gauge from the neutral axis in m; 1 for other sensors, and if a free gain includes it.
    pub(super) fn distance_m(
        self,
        path: &str,
        gain: Gain,
        distance: Option<Length>,
    ) -> Result<f64, Fault> {
        let key = || format!("{path}.distance");
        match (self, distance.map(Si::si)) {
            (Self::RootStrain, None) if gain != Gain::Free => {
                let message =
                    format!("{} is missing: that of the gauge from the neutral axis", key());
                let hint = "half the thickness of a strip; or gain = \"free\"";
                Err(Fault::new(path, message).hinting(hint.to_owned()))
            }
            (Self::RootStrain, Some(distance_m)) => {
                checked(path, "distance", distance_m).map(|()| distance_m)
            }
            (_, Some(_)) => {
                let message = format!("{} must stand beside root_strain alone", key());
                Err(Fault::new(key(), message))
            }
            (_, None) => Ok(1.0),
        }
    }
}

impl RawGain {
    pub(super) fn gain(gain: Option<Self>) -> Gain {
        match gain {
            Some(Self::Free) => Gain::Free,
            Some(Self::Sign) => Gain::Sign,
            Some(Self::Known) | None => Gain::Known,
        }
    }
}

impl RawMotor {
    pub(super) fn convert(self) -> Result<Motor, Fault> {
        let Self { torque_constant, resistance, gear_ratio } = self;
        Motor::new(torque_constant, resistance, gear_ratio.unwrap_or(1.0))
            .map_err(|error| Fault::new(error.parameter.clone(), error.to_string()))
    }
}

impl RawRecord {
    pub(super) fn convert(self, path: &str, has_motor: bool) -> Result<RecordFile, Fault> {
        let input = match self.input {
            RawInput::Torque => RecordedInput::Torque,
            RawInput::Voltage => RecordedInput::Voltage,
            RawInput::HubAngle => RecordedInput::HubAngle,
        };
        if input == RecordedInput::Voltage {
            check_motor(&format!("{path}.input"), "voltage", has_motor)?;
        }
        if let (RecordedInput::HubAngle, Some(_)) = (input, self.hold) {
            let path = format!("{path}.hold");
            let message = format!("{path} has no meaning beside input = \"hub_angle\"");
            return Err(Fault::new(path, message));
        }
        if let (RecordedInput::Voltage, None) = (input, self.hold) {
            let message =
                format!("{path}.hold is missing: how the voltage goes on between its samples");
            let hint =
                "hold = \"zero\" for what a converter gives, \"linear\" for what was measured";
            return Err(Fault::new(path, message).hinting(hint.to_owned()));
        }
        let hold = match self.hold {
            Some(RawHold::Zero) => Interpolation::Zero,
            Some(RawHold::Linear) => Interpolation::Linear,
            Some(RawHold::Cubic) | None => Interpolation::Cubic,
        };
        if self.channel.is_empty() {
            let message = format!("{path}.channel is missing: at least one sensor must be named");
            let hint = "[[record.channel]] with sensor = \"hub_angle\"";
            return Err(Fault::new(path, message).hinting(hint.to_owned()));
        }
        let mut channels: Vec<ChannelFile> = Vec::new();
        for (number, raw) in self.channel.into_iter().enumerate() {
            let path = format!("{path}.channel.{number}");
            let channel = raw.convert(&path)?;
            let is_input = channel.sensor.word() == input.word();
            if is_input || channels.iter().any(|earlier| earlier.sensor == channel.sensor) {
                let path = format!("{path}.sensor");
                let word = channel.sensor.word();
                let message = format!("{path} = \"{word}\", which is the input already");
                return Err(Fault::new(path, message));
            }
            channels.push(channel);
        }
        Ok(RecordFile {
            file: self.file,
            input,
            hold,
            is_delay_free: self.delay == Some(RawFreedom::Free),
            skip: self.skip.map_or(0, |Count(lines)| lines),
            columns: self.columns,
            scale: self.scale,
            channels,
        })
    }
}

impl RawChannel {
    fn convert(&self, path: &str) -> Result<ChannelFile, Fault> {
        let Self { sensor, gain, offset, distance, uncertainty } = *self;
        uncertainty.map_or(Ok(()), |uncertainty| checked(path, "uncertainty", uncertainty))?;
        let gain = RawGain::gain(gain);
        let distance_m = sensor.distance_m(path, gain, distance)?;
        let has_offset = offset == Some(RawFreedom::Free);
        Ok(ChannelFile { sensor: sensor.sensor(), gain, has_offset, distance_m, uncertainty })
    }
}

pub(super) fn check_motor(path: &str, found: &str, has_motor: bool) -> Result<(), Fault> {
    if has_motor {
        return Ok(());
    }
    let message = format!("{path} = \"{found}\", but must stand beside [motor]");
    let hint = "[motor] with torque_constant in N m/A and resistance in ohm";
    Err(Fault::new(path, message).hinting(hint.to_owned()))
}

pub(super) fn checked(path: &str, key: &str, number: f64) -> Result<(), Fault> {
    if number.is_finite() && number > 0.0 {
        return Ok(());
    }
    let path = format!("{path}.{key}");
    Err(Fault::new(path.clone(), format!("{path} = {number}, but must be above 0")))
}

#[cfg(test)]
mod tests {
    use super::super::read_measurements;

    const MOTOR: &str = "[motor]\ntorque_constant = 0.042\nresistance = 8.4\n";

    #[test]
    fn what_contradicts_itself_is_refused_with_its_line() {
        let record = |rest: &str| format!("[[record]]\nfile = 'r.csv'\n{rest}");
        for (text, expected) in [
            (
                record("input = 'voltage'\n[[record.channel]]\nsensor = 'hub_angle'\n"),
                "m.toml:3: record.0.input = \"voltage\", but must stand beside [motor]",
            ),
            (
                record("input = 'voltage'\n[[record.channel]]\nsensor = 'hub_angle'\n") + MOTOR,
                "m.toml:1: record.0.hold is missing: how the voltage goes on between its samples",
            ),
            (
                record("input = 'torque'\n"),
                "m.toml:1: record.0.channel is missing: at least one sensor must be named",
            ),
            (
                record("input = 'hub_angle'\n[[record.channel]]\nsensor = 'hub_angle'\n"),
                "m.toml:5: record.0.channel.0.sensor = \"hub_angle\", which is the input already",
            ),
            (
                record("input = 'torque'\n[[record.channel]]\nsensor = 'root_strain'\n"),
                "m.toml:4: record.0.channel.0.distance is missing: that of the gauge from the neutral axis",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'hub_angle'\ndistance = 1\n".to_owned(),
                "m.toml:4: response.0.distance must stand beside root_strain alone",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'hub_angle'\nfirst_zero = 2\n".to_owned(),
                "m.toml:4: response.0.first_zero must stand beside loop = \"closed\" alone",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'hub_rate'\nloop = 'closed'\ngain = 'free'\n"
                    .to_owned(),
                "m.toml:5: response.0.gain has no meaning beside loop = \"closed\": the dips alone are read",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'tip_deflection'\nloop = 'closed'\n".to_owned(),
                "m.toml:3: response.0.transfer must be \"hub_angle\" or \"hub_rate\" beside loop = \
                 \"closed\": no other sensor has the zeros of the clamped link",
            ),
            (
                MOTOR.replace("8.4", "0"),
                "m.toml:3: motor.resistance = 0 ohm, but must be finite and above 0",
            ),
        ] {
            assert_eq!(read_measurements("m.toml", &text, 1).unwrap_err().to_string(), expected);
        }
        let text =
            record("input = 'voltage'\nhold = 'zero'\n[[record.channel]]\nsensor = 'hub_angle'\n")
                + MOTOR;
        let read = read_measurements("m.toml", &text, 1).unwrap();
        assert!(read.motor.is_some() && read.records[0].channels[0].uncertainty.is_none());
    }
}
