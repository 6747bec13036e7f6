//! The file of measurements that `fit` reads, with frequency responses, recorded histories and free decays in separate files.

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

use super::document::located;
use super::error::{Fault, SpecError};
use super::measured_table::{RawTable, TableKeys, Tabled};
use super::measured_values::{MeasuredOf, ModeKeys, RawDamping, RawFrequency, checked};
use super::tree::Node;
use super::value::{Angle, Count, Length, Resistance, Si, Time, TorqueConstant, tables};
use crate::fit::{DecayValues, Gain, HubEnd, Measured, Motor, Observable, RecordedInput};
use crate::link::{ParameterError, positive};
use crate::model::Sensor;
use crate::response::Interpolation;

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
    response: Vec<Tabled<RawResponse>>,
    #[serde(default, deserialize_with = "tables")]
    record: Vec<Tabled<RawRecord>>,
    #[serde(default, deserialize_with = "tables")]
    decay: Vec<Tabled<RawDecay>>,
    drive: Option<RawMotor>,
    /// The older name of `drive`.
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
    /// The motor at the joint.
    pub motor: Option<Motor>,
    /// Name of its table, `drive` or the older `motor`.
    pub table: &'static str,
    /// Whether it has the pinion of a carriage.
    pub has_pinion: bool,
}

/// Reads the text of a file of measured values of an arm with this number of `links`, or of one link, whose link file may
/// have the motor's constants (`is_driven`); errors call the file `name`.
///
/// ```
/// use flexlink::spec::read_measurements;
/// let text = "[[frequency]]\nmode = 1\nvalue = '2.52 Hz'\nuncertainty = '0.02 Hz'\nhub = 'held'\n\
///             [[damping]]\nmode = 1\nratio = 0.013\nuncertainty = 0.002\n";
/// let measured = read_measurements("measured.toml", text, (1, false))?;
/// assert_eq!(measured.values.len(), 2);
/// # Ok::<(), flexlink::spec::SpecError>(())
/// ```
///
/// # Errors
/// [`SpecError`] names the line and the wrong value.
pub fn read_measurements(
    name: &str,
    text: &str,
    (links, is_driven): (usize, bool),
) -> Result<MeasuredFile, SpecError> {
    let tree = Node::document(name, text)?;
    let raw = RawMeasurements::deserialize(&tree).map_err(Fault::from);
    raw.and_then(|raw| convert(raw, (links, is_driven)))
        .map_err(|fault| located(fault, &tree, (name, &[])))
}

fn convert(raw: RawMeasurements, (links, is_driven): (usize, bool)) -> Result<MeasuredFile, Fault> {
    let of = MeasuredOf::new(links, raw.at)?;
    if raw.drive.is_some() && raw.motor.is_some() {
        let message = "must not be there beside [drive], which takes its place";
        return Err(Fault::on("motor", message));
    }
    let of_one_link = [
        ("drive", raw.drive.is_some()),
        ("motor", raw.motor.is_some()),
        ("response", !raw.response.is_empty()),
        ("record", !raw.record.is_empty()),
    ];
    for (key, _) in of_one_link.into_iter().filter(|(_, is_given)| *is_given) {
        of.refuse(false, key, "only [[frequency]], [[damping]] and [[decay]]")?;
    }
    let values = each("frequency", raw.frequency, |raw, path| raw.convert(path, &of))?;
    let ratios = each("damping", raw.damping, |raw, path| raw.convert(path, &of))?;
    let values = [values, ratios].concat();
    let decays =
        each("decay", raw.decay, |Tabled(table, raw), path| raw.convert((path, table), &of))?;
    let table = if raw.motor.is_some() { "motor" } else { "drive" };
    let raw_motor = raw.drive.or(raw.motor);
    let has_pinion = raw_motor.is_some_and(|motor| motor.pinion_radius.is_some());
    let motor = raw_motor.map(|own| own.convert(table)).transpose()?;
    let has_motor = motor.is_some() || is_driven;
    let responses = each("response", raw.response, |Tabled(table, raw), path| {
        raw.convert((path, table), has_motor)
    })?;
    let records = each("record", raw.record, |Tabled(table, raw), path| {
        raw.convert((path, table), has_motor)
    })?;
    if values.is_empty() && responses.is_empty() && records.is_empty() && decays.is_empty() {
        let hint = if of.is_arm() {
            "[[frequency]] with mode, value, joints and at, [[damping]] with mode, ratio, joints and at, [[decay]] \
             with file, mode, joints and at"
        } else {
            "[[frequency]] with mode, value and hub, [[damping]] with mode and ratio, [[decay]] with file, mode and hub, \
             [[response]] with file and transfer, [[record]] with file, input and channel"
        };
        let message = "the file has no measurements, but needs at least one";
        return Err(Fault::new("", message).hinting(hint.to_owned()));
    }
    Ok(MeasuredFile { values, responses, records, decays, motor, table, has_pinion })
}

/// Converts the tables of a key, each with its path.
fn each<R, T>(
    key: &str,
    raw: Vec<R>,
    convert: impl Fn(R, &str) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    let numbered = raw.into_iter().enumerate();
    numbered.map(|(number, raw)| convert(raw, &format!("{key}.{number}"))).collect()
}

/// A frequency response in a separate file.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseFile {
    /// The file, relative to the file that names it.
    pub file: String,
    /// Measured sensor.
    pub transfer: Sensor,
    /// True if the response is per volt at the motor, not per torque or force.
    pub is_per_volt: bool,
    /// Name of the effort in the file, and whether it is that of a carriage.
    pub effort: Option<(&'static str, Option<bool>)>,
    /// Known or free scale of the response.
    pub gain: Gain,
    /// Distance of a strain gauge from the neutral axis in m, or 1.
    pub distance_m: f64,
    /// Relative uncertainty of the values.
    pub uncertainty: Option<f64>,
    /// Number of the zero in the lowest dip, for a measurement in a closed loop, in which only the zeros are the
    /// link's.
    pub first_zero: Option<usize>,
    /// Description of the table.
    pub table: TableKeys,
}

/// `[[response]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawResponse {
    file: String,
    transfer: Sensor,
    #[serde(rename = "loop")]
    around: Option<RawLoop>,
    first_zero: Option<Count>,
    per: Option<RawPer>,
    gain: Option<Gain>,
    distance: Option<Length>,
    uncertainty: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
enum RawLoop {
    Open,
    Closed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
enum RawPer {
    Torque,
    Force,
    Volt,
}

impl RawResponse {
    fn convert(
        self,
        (path, table): (&str, RawTable),
        has_motor: bool,
    ) -> Result<ResponseFile, Fault> {
        let first_zero = self.first_zero(path)?;
        let Self { file, transfer, per, gain, distance, uncertainty, .. } = self;
        let of_time = ["time_unit", "unit", "sample_rate", "resample"];
        let table = table.convert(path, (&of_time, "for a response, which is over frequencies"))?;
        checked(path, "uncertainty", uncertainty)?;
        let gain = gain.unwrap_or_default();
        let is_per_volt = per == Some(RawPer::Volt);
        let effort = match per {
            Some(RawPer::Torque) => Some(("torque", Some(false))),
            Some(RawPer::Force) => Some(("force", Some(true))),
            Some(RawPer::Volt) | None => None,
        };
        if is_per_volt {
            check_motor(&format!("{path}.per"), "volt", has_motor)?;
        }
        let distance_m = distance_m(path, transfer, gain, distance)?;
        Ok(ResponseFile {
            file,
            transfer,
            is_per_volt,
            effort,
            gain,
            distance_m,
            uncertainty,
            first_zero,
            table,
        })
    }

    /// Number of the first zero of a closed loop.
    fn first_zero(&self, path: &str) -> Result<Option<usize>, Fault> {
        let refused = |key: &str, must: &str| Err(Fault::on(format!("{path}.{key}"), must));
        if self.around != Some(RawLoop::Closed) {
            return match self.first_zero {
                Some(_) => refused("first_zero", "has no meaning without loop = \"closed\""),
                None => Ok(None),
            };
        }
        if self.transfer.slides().is_none() {
            let must = "must be \"hub_angle\" or \"hub_rate\", or \"carriage\" or \"carriage_velocity\", beside \
                        loop = \"closed\": no other sensor has the zeros of the clamped link";
            return refused("transfer", must);
        }
        // A dip has the same place at any scale and behind any motor.
        let useless = [("per", self.per.is_some()), ("gain", self.gain.is_some())];
        if let Some((key, _)) = useless.into_iter().find(|(_, is_given)| *is_given) {
            let words = "has no meaning beside loop = \"closed\": only the dips are read";
            return refused(key, words);
        }
        Ok(Some(self.first_zero.map_or(1, |Count(number)| number)))
    }
}

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
    /// Description of the table.
    pub table: TableKeys,
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

/// `[drive]`, or the older `[motor]`
#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawMotor {
    torque_constant: TorqueConstant,
    resistance: Resistance,
    gear_ratio: Option<f64>,
    pinion_radius: Option<Length>,
}

/// `[[record]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawRecord {
    file: String,
    input: RecordedInput,
    hold: Option<Interpolation>,
    delay: Option<RawFreedom>,
    #[serde(default, deserialize_with = "tables")]
    channel: Vec<RawChannel>,
}

/// `[[record.channel]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawChannel {
    sensor: Sensor,
    #[serde(default)]
    gain: Gain,
    offset: Option<RawFreedom>,
    distance: Option<Length>,
    uncertainty: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
enum RawFreedom {
    Known,
    Free,
}

/// Distance of a strain gauge from the neutral axis in m; 1 for other sensors, and if a free gain includes it.
fn distance_m(
    path: &str,
    sensor: Sensor,
    gain: Gain,
    distance: Option<Length>,
) -> Result<f64, Fault> {
    let key = format!("{path}.distance");
    match (sensor, distance.map(Si::si)) {
        (Sensor::RootStrain, None) if gain != Gain::Free => {
            let message = format!("{key} is missing: the gauge's distance from the neutral axis");
            let hint = "set half the thickness of a strip, or gain = \"free\"";
            Err(Fault::new(path, message).hinting(hint.to_owned()))
        }
        (Sensor::RootStrain, Some(distance_m)) => {
            checked(path, "distance", distance_m).map(|()| distance_m)
        }
        (_, Some(_)) => Err(Fault::on(key, "has no meaning for a sensor other than root_strain")),
        (_, None) => Ok(1.0),
    }
}

impl RawMotor {
    pub(super) fn convert(self, table: &str) -> Result<Motor, Fault> {
        let Self { torque_constant, resistance, gear_ratio, pinion_radius } = self;
        let radius_m = pinion_radius.map_or(1.0, Si::si);
        positive(&format!("{table}.pinion_radius"), radius_m, "m")?;
        let ratio = gear_ratio.unwrap_or(1.0) / radius_m;
        Motor::new(torque_constant.si(), resistance.si(), ratio).map_err(|error| {
            let parameter = error.parameter.replace("drive.", &format!("{table}."));
            ParameterError { parameter, ..error }.into()
        })
    }
}

impl RawRecord {
    fn convert(
        self,
        (path, table): (&str, RawTable),
        has_motor: bool,
    ) -> Result<RecordFile, Fault> {
        let input = self.input;
        if input == RecordedInput::Voltage {
            check_motor(&format!("{path}.input"), "voltage", has_motor)?;
        }
        if input.is_motion() && self.hold.is_some() {
            let words = format!("has no meaning beside input = \"{}\"", input.word());
            return Err(Fault::on(format!("{path}.hold"), words));
        }
        if let (RecordedInput::Voltage, None) = (input, self.hold) {
            let message =
                format!("{path}.hold is missing: the course of the voltage between its samples");
            let hint = "set hold = \"zero\" for the output of a converter, \"linear\" for a measured voltage";
            return Err(Fault::new(path, message).hinting(hint.to_owned()));
        }
        if self.channel.is_empty() {
            let message = format!("{path}.channel is missing: at least one sensor must be named");
            let sensor = if input.slides() == Some(true) { "carriage" } else { "hub_angle" };
            let hint = format!("add [[record.channel]] with sensor = \"{sensor}\"");
            return Err(Fault::new(path, message).hinting(hint));
        }
        let mut channels: Vec<ChannelFile> = Vec::new();
        for (number, raw) in self.channel.into_iter().enumerate() {
            let path = format!("{path}.channel.{number}");
            let channel = raw.convert(&path)?;
            let is_input = channel.sensor.word() == input.word();
            if is_input || channels.iter().any(|earlier| earlier.sensor == channel.sensor) {
                let word = channel.sensor.word();
                let words = format!("= \"{word}\", but must not repeat the input or a channel");
                return Err(Fault::on(format!("{path}.sensor"), words));
            }
            channels.push(channel);
        }
        Ok(RecordFile {
            file: self.file,
            input,
            hold: self.hold.unwrap_or_default(),
            is_delay_free: self.delay == Some(RawFreedom::Free),
            table: table.convert(path, (&[], ""))?,
            channels,
        })
    }
}

impl RawChannel {
    fn convert(&self, path: &str) -> Result<ChannelFile, Fault> {
        let Self { sensor, gain, offset, distance, uncertainty } = *self;
        checked(path, "uncertainty", uncertainty)?;
        let distance_m = distance_m(path, sensor, gain, distance)?;
        let has_offset = offset == Some(RawFreedom::Free);
        Ok(ChannelFile { sensor, gain, has_offset, distance_m, uncertainty })
    }
}

fn check_motor(path: &str, found: &str, has_motor: bool) -> Result<(), Fault> {
    if has_motor {
        return Ok(());
    }
    let hint =
        "add [drive] with torque_constant in N m/A and resistance in ohm, here or in the link file";
    let words = format!("= \"{found}\", but must come with [drive]");
    Err(Fault::on(path, words).hinting(hint.to_owned()))
}

/// A free decay in a separate file.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayFile {
    /// The file, relative to the file that names it.
    pub file: String,
    /// Frequencies of the modes in the decay.
    pub frequencies: Vec<Observable>,
    /// Values to take from the decay.
    pub values: DecayValues,
    /// Relative uncertainty of each value from other causes than noise of the samples.
    pub uncertainty: Option<f64>,
    /// The sensor; `None` for a table in which only one column changes.
    pub sensor: Option<Sensor>,
    /// Times in s of the first and the last sample to use.
    pub span_s: [Option<f64>; 2],
    /// Description of the table.
    pub table: TableKeys,
}

/// `[[decay]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawDecay {
    file: String,
    mode: Option<Modes>,
    #[serde(alias = "carriage")]
    hub: Option<HubEnd>,
    joints: Option<HubEnd>,
    at: Option<Vec<Angle>>,
    sensor: Option<Sensor>,
    only: Option<DecayValues>,
    uncertainty: Option<f64>,
    from: Option<Time>,
    until: Option<Time>,
}

/// The number of a mode, or a list of them.
#[derive(Debug)]
struct Modes(Vec<Count>);

impl<'de> Deserialize<'de> for Modes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMore;
        impl<'de> Visitor<'de> for OneOrMore {
            type Value = Modes;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(formatter, "{}, or a list of such numbers", Count::WORDS)
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Modes, E> {
                Count::try_from(number).map(|count| Modes(vec![count])).map_err(E::custom)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Modes, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Modes)
            }
        }
        deserializer.deserialize_any(OneOrMore)
    }
}

impl RawDecay {
    fn convert(self, (path, table): (&str, RawTable), of: &MeasuredOf) -> Result<DecayFile, Fault> {
        let Self { file, mode, hub, joints, at, sensor, only, uncertainty, .. } = self;
        checked(path, "uncertainty", uncertainty)?;
        let modes = mode.map_or(vec![Count(1)], |Modes(modes)| modes);
        let refused = |key: &str, must: &str| Err(Fault::on(format!("{path}.{key}"), must));
        let is_twice = |k: usize| modes[..k].contains(&modes[k]);
        if modes.is_empty() || (0..modes.len()).any(is_twice) {
            return refused("mode", "must be the number of a mode, or a list of different ones");
        }
        let span_s = [self.from, self.until].map(|time| time.map(Si::si));
        if let [Some(from_s), Some(until_s)] = span_s
            && from_s >= until_s
        {
            return refused("until", "must be after from");
        }
        let frequency = |Count(mode): &Count| {
            of.frequency(path, ModeKeys { mode: *mode, hub, joints, at: at.clone() })
        };
        Ok(DecayFile {
            file,
            frequencies: modes.iter().map(frequency).collect::<Result<_, _>>()?,
            values: only.unwrap_or_default(),
            uncertainty,
            sensor,
            span_s,
            table: table.convert(path, (&["scale", "unit"], "for a decay, in any unit"))?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::read_measurements;
    use super::*;

    #[test]
    fn what_is_wrong_is_refused_with_its_line() {
        for (text, expected) in [
            ("", "m.toml: the file has no measurements, but needs at least one"),
            (
                "[[frequency]]\nmode = 1\nvalue = 0",
                "m.toml:3: frequency.0.value = 0, but must be above 0",
            ),
            (
                "[[frequency]]\nvalue = 1",
                "m.toml:1: frequency.0 has neither mode nor zero, but must have one of them",
            ),
            ("[[frequency]]\nmode = 1", "m.toml:1: frequency.0.value is missing"),
            ("[[frequenzy]]\nmode = 1", "m.toml:1: unknown key `frequenzy`"),
            (
                "[[damping]]\nmode = 1\npeaks = [1, 2]",
                "m.toml:3: damping.0.peaks must be two or more peaks of one sign, each below the one before",
            ),
        ] {
            assert_eq!(
                read_measurements("m.toml", text, (1, false)).unwrap_err().to_string(),
                expected
            );
        }
    }

    const MOTOR: &str = "[drive]\ntorque_constant = 0.042\nresistance = 8.4\n";

    #[test]
    fn what_contradicts_itself_is_refused_with_its_line() {
        let record = |rest: &str| format!("[[record]]\nfile = 'r.csv'\n{rest}");
        for (text, expected) in [
            (
                record("input = 'voltage'\n[[record.channel]]\nsensor = 'hub_angle'\n"),
                "m.toml:3: record.0.input = \"voltage\", but must come with [drive]",
            ),
            (
                record("input = 'voltage'\n[[record.channel]]\nsensor = 'hub_angle'\n") + MOTOR,
                "m.toml:1: record.0.hold is missing: the course of the voltage between its samples",
            ),
            (
                record("input = 'torque'\n"),
                "m.toml:1: record.0.channel is missing: at least one sensor must be named",
            ),
            (
                record("input = 'hub_angle'\n[[record.channel]]\nsensor = 'hub_angle'\n"),
                "m.toml:5: record.0.channel.0.sensor = \"hub_angle\", but must not repeat the input or a channel",
            ),
            (
                record("input = 'torque'\n[[record.channel]]\nsensor = 'root_strain'\n"),
                "m.toml:4: record.0.channel.0.distance is missing: the gauge's distance from the neutral axis",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'hub_angle'\ndistance = 1\n".to_owned(),
                "m.toml:4: response.0.distance has no meaning for a sensor other than root_strain",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'hub_angle'\nfirst_zero = 2\n".to_owned(),
                "m.toml:4: response.0.first_zero has no meaning without loop = \"closed\"",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'hub_rate'\nloop = 'closed'\ngain = 'free'\n"
                    .to_owned(),
                "m.toml:5: response.0.gain has no meaning beside loop = \"closed\": only the dips are read",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'tip_deflection'\nloop = 'closed'\n".to_owned(),
                "m.toml:3: response.0.transfer must be \"hub_angle\" or \"hub_rate\", or \"carriage\" or \
                 \"carriage_velocity\", beside loop = \"closed\": no other sensor has the zeros of the clamped link",
            ),
            (
                "[[response]]\nfile = 'f.csv'\ntransfer = 'hub_angle'\nresample = 2\n".to_owned(),
                "m.toml:4: response.0.resample has no meaning for a response, which is over frequencies",
            ),
            (
                MOTOR.replace("8.4", "0"),
                "m.toml:3: drive.resistance = 0 ohm, but must be finite and above 0",
            ),
        ] {
            assert_eq!(read_measurements("m.toml", &text, (1, false)).unwrap_err().to_string(), expected);
        }
        let text =
            record("input = 'voltage'\nhold = 'zero'\n[[record.channel]]\nsensor = 'hub_angle'\n")
                + MOTOR;
        let read = read_measurements("m.toml", &text, (1, false)).unwrap();
        assert!(read.motor.is_some() && read.records[0].channels[0].uncertainty.is_none());
        // The older name of the table, and constants with units.
        let older = text.replace("[drive]", "[motor]").replace("0.042", "'4.2 N cm/A'");
        let older = read_measurements("m.toml", &older, (1, false)).unwrap();
        assert_eq!((older.motor, older.table), (read.motor, "motor"));
        let of_link = text.replace(MOTOR, "");
        assert!(read_measurements("m.toml", &of_link, (1, true)).unwrap().motor.is_none());
        let both = text + &MOTOR.replace("drive", "motor");
        assert_eq!(
            read_measurements("m.toml", &both, (1, false)).unwrap_err().to_string(),
            "m.toml:10: motor must not be there beside [drive], which takes its place"
        );
    }

    #[test]
    fn one_mode_or_several_are_read() {
        let read = |more: &str| {
            let text = format!("[[decay]]\nfile = 'd.csv'\nhub = 'held'\n{more}");
            read_measurements("m.toml", &text, (1, false)).map(|mut read| read.decays.remove(0))
        };
        let mode = |mode| Observable::Frequency { mode, hub: HubEnd::Held };
        assert_eq!(read("").unwrap().frequencies, [mode(1)]);
        assert_eq!(read("mode = 2").unwrap().frequencies, [mode(2)]);
        let several = read("mode = [1, 3]\nfrom = '200 ms'\nonly = 'ratio'").unwrap();
        assert_eq!(several.frequencies, [mode(1), mode(3)]);
        assert_eq!((several.span_s, several.values), ([Some(0.2), None], DecayValues::Ratios));
        assert_eq!(read("skip = 0").unwrap().table, read("").unwrap().table);
        for (more, expected) in [
            ("mode = [1, 1]", "m.toml:4: decay.0.mode must be the number of a mode"),
            ("mode = []", "m.toml:4: decay.0.mode must be the number of a mode"),
            ("mode = 0", "m.toml:4: decay.0.mode = 0, but must be a whole number from 1"),
            ("mode = [0]", "m.toml:4: decay.0.mode.0 = 0, but must be a whole number from 1"),
            ("from = 2\nuntil = 1", "m.toml:5: decay.0.until must be after from"),
            ("resampel = 1", "m.toml:4: unknown key `resampel` in decay.0"),
            ("skip = -1", "m.toml:4: decay.0.skip = -1, but must be a whole number from 0"),
            ("skip = 1.5", "m.toml:4: decay.0.skip = 1.5, but must be a whole number from 0"),
            ("scale = ['displacement=2']", "m.toml:4: decay.0.scale has no meaning for a decay"),
            ("at = ['0 deg']", "m.toml:4: decay.0.at is for arms; one link takes no directions"),
            ("only = 'phase'", "m.toml:4: decay.0.only"),
        ] {
            let refused = read(more).unwrap_err().to_string();
            assert!(refused.starts_with(expected), "{refused}");
        }
        // The keys of the table are known, too.
        assert_eq!(read("resampel = 1").unwrap_err().hint(), Some("did you mean `resample`?"));
        let known = read("xyz = 1").unwrap_err().hint().unwrap().to_owned();
        assert!(
            known.starts_with("known here: file, mode, ") && known.ends_with(" and resample"),
            "{known}"
        );
    }
}
