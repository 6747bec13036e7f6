use std::f64::consts::{PI, TAU};
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

use super::document::shown;
use super::error::{Fault, SpecError};
use super::measured_files::{
    RawGain, RawMotor, RawRecord, RawSensor, RecordFile, check_motor, checked,
};
use super::tree::Node;
use super::value::{Count, Length, tables};
use crate::fit::{Gain, HubEnd, Measured, Motor, Observable};
use crate::model::Sensor;
use crate::numeric::split_number;

/// Fewest peaks of a decay: two give one decrement.
const FEWEST_PEAKS: usize = 2;

/// The whole file of measured values, key by key.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawMeasurements {
    #[serde(default, deserialize_with = "tables")]
    frequency: Vec<RawFrequency>,
    #[serde(default, deserialize_with = "tables")]
    damping: Vec<RawDamping>,
    #[serde(default, deserialize_with = "tables")]
    response: Vec<RawResponse>,
    #[serde(default, deserialize_with = "tables")]
    record: Vec<RawRecord>,
    motor: Option<RawMotor>,
}

/// What a file of measured values names.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredFile {
    /// Values.
    pub values: Vec<Measured>,
    /// Frequency responses in files of their own.
    pub responses: Vec<ResponseFile>,
    /// Recorded histories in files of their own.
    pub records: Vec<RecordFile>,
    /// The motor at the hub.
    pub motor: Option<Motor>,
}

/// `[[frequency]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawFrequency {
    mode: Option<Count>,
    zero: Option<Count>,
    hub: Option<RawHub>,
    value: Hertz,
    uncertainty: Option<Hertz>,
}

/// `[[damping]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawDamping {
    mode: Count,
    hub: Option<RawHub>,
    ratio: Option<f64>,
    peaks: Option<Vec<f64>>,
    uncertainty: Option<f64>,
}

#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "lowercase", expecting = "a string")]
enum RawHub {
    Free,
    Held,
}

impl RawHub {
    fn end(hub: Option<Self>) -> HubEnd {
        match hub {
            Some(Self::Held) => HubEnd::Held,
            Some(Self::Free) | None => HubEnd::Free,
        }
    }
}

/// A frequency in Hz: a number, or text with Hz, kHz, rad/s or rpm. `Rate` takes a hertz for a radian.
#[derive(Debug, Clone, Copy)]
struct Hertz(f64);

impl<'de> Deserialize<'de> for Hertz {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Frequency;
        impl Visitor<'_> for Frequency {
            type Value = Hertz;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a frequency: a number in Hz, or text such as \"2.52 Hz\"")
            }

            fn visit_f64<E: Error>(self, number: f64) -> Result<Hertz, E> {
                Ok(Hertz(number))
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Hertz, E> {
                Ok(Hertz(number as f64))
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Hertz, E> {
                let wrong =
                    || E::custom("must be a frequency in Hz, kHz, rad/s or rpm: \"2.52 Hz\"");
                let (number, unit) = split_number(text).ok_or_else(wrong)?;
                let hertz = match unit.trim() {
                    "Hz" => 1.0,
                    "kHz" => 1000.0,
                    "rad/s" => 1.0 / TAU,
                    "rpm" => PI / 30.0 / TAU,
                    _ => return Err(wrong()),
                };
                Ok(Hertz(number * hertz))
            }
        }
        deserializer.deserialize_any(Frequency)
    }
}

/// Reads the text of a file of measured values; `name` is what errors call it.
///
/// ```
/// use flexlink::spec::read_measurements;
/// let text = "[[frequency]]\nmode = 1\nvalue = '2.52 Hz'\nuncertainty = '0.02 Hz'\nhub = 'held'\n\
///             [[damping]]\nmode = 1\nratio = 0.013\nuncertainty = 0.002\n";
/// let measured = read_measurements("measured.toml", text)?;
/// assert_eq!(measured.values.len(), 2);
/// # Ok::<(), flexlink::spec::SpecError>(())
/// ```
///
/// # Errors
/// [`SpecError`] names the line and the wrong value.
pub fn read_measurements(name: &str, text: &str) -> Result<MeasuredFile, SpecError> {
    let tree = Node::document(name, text)?;
    let raw = RawMeasurements::deserialize(&tree).map_err(Fault::from);
    raw.and_then(convert).map_err(|fault| {
        let place = tree.last_place(&fault);
        fault.at(shown(place, name, &[]))
    })
}

fn convert(raw: RawMeasurements) -> Result<MeasuredFile, Fault> {
    let mut values = Vec::new();
    for (number, raw) in raw.frequency.into_iter().enumerate() {
        values.push(frequency(&format!("frequency.{number}"), &raw)?);
    }
    for (number, raw) in raw.damping.into_iter().enumerate() {
        values.push(damping(&format!("damping.{number}"), raw)?);
    }
    let motor = raw.motor.map(RawMotor::convert).transpose()?;
    let mut responses = Vec::new();
    for (number, raw) in raw.response.into_iter().enumerate() {
        responses.push(raw.convert(&format!("response.{number}"), motor.is_some())?);
    }
    let mut records = Vec::new();
    for (number, raw) in raw.record.into_iter().enumerate() {
        records.push(raw.convert(&format!("record.{number}"), motor.is_some())?);
    }
    if values.is_empty() && responses.is_empty() && records.is_empty() {
        let hint = "[[frequency]] with mode, value and hub, [[damping]] with mode and ratio, \
                    [[response]] with file and transfer, [[record]] with file, input and channel";
        let message = "measurements = none, but must be at least one";
        return Err(Fault::new("", message).hinting(hint.to_owned()));
    }
    Ok(MeasuredFile { values, responses, records, motor })
}

fn frequency(path: &str, raw: &RawFrequency) -> Result<Measured, Fault> {
    let observable = match (raw.mode, raw.zero, raw.hub) {
        (Some(Count(mode)), None, hub) => Observable::Frequency { mode, hub: RawHub::end(hub) },
        (None, Some(Count(zero)), None) => Observable::Zero { zero },
        (None, Some(_), Some(_)) => {
            let message = format!(
                "{path}.hub must not stand beside zero, which is one of torque → hub angle"
            );
            return Err(Fault::new(format!("{path}.hub"), message));
        }
        (mode, ..) => {
            let found = if mode.is_some() { "both mode and zero" } else { "neither mode nor zero" };
            return Err(Fault::new(path, format!("{path} = {found}, but must have one of them")));
        }
    };
    let Hertz(value) = raw.value;
    checked(path, "value", value)?;
    let uncertainty = raw.uncertainty.map(|Hertz(uncertainty)| uncertainty);
    uncertainty.map_or(Ok(()), |uncertainty| checked(path, "uncertainty", uncertainty))?;
    Ok(Measured { observable, value, uncertainty })
}

fn damping(path: &str, raw: RawDamping) -> Result<Measured, Fault> {
    let observable = Observable::Damping { mode: raw.mode.0, hub: RawHub::end(raw.hub) };
    let value = match (raw.ratio, raw.peaks) {
        (Some(ratio), None) => ratio,
        (None, Some(peaks)) => of_decay(&format!("{path}.peaks"), &peaks)?,
        (ratio, _) => {
            let found =
                if ratio.is_some() { "both ratio and peaks" } else { "neither ratio nor peaks" };
            return Err(Fault::new(path, format!("{path} = {found}, but must have one of them")));
        }
    };
    checked(path, "ratio", value)?;
    raw.uncertainty.map_or(Ok(()), |uncertainty| checked(path, "uncertainty", uncertainty))?;
    Ok(Measured { observable, value, uncertainty: raw.uncertainty })
}

/// Damping ratio of peaks one period apart: with the decrement δ, the slope of their logarithms,
/// `ζ = δ/√(4π² + δ²)`.
fn of_decay(path: &str, peaks: &[f64]) -> Result<f64, Fault> {
    let falls = peaks.windows(2).all(|pair| pair[1] < pair[0]);
    if peaks.len() < FEWEST_PEAKS || !falls || peaks.iter().any(|peak| *peak <= 0.0) {
        let message =
            format!("{path} must be two or more peaks of one sign, each below the one before");
        return Err(Fault::new(path, message));
    }
    let middle = 0.5 * (peaks.len() - 1) as f64;
    let places = || (0..peaks.len()).map(|k| k as f64 - middle);
    let moment: f64 = places().zip(peaks).map(|(k, peak)| k * libm::log(*peak)).sum();
    let decrement = -moment / places().map(|k| k * k).sum::<f64>();
    Ok(decrement / (TAU * TAU + decrement * decrement).sqrt())
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_gives_the_ratio_that_it_has() {
        let ratio: f64 = 0.03;
        let decrement = TAU * ratio / (1.0 - ratio * ratio).sqrt();
        let peaks: Vec<f64> = (0..5).map(|k| 2.0 * (-decrement * f64::from(k)).exp()).collect();
        assert!((of_decay("peaks", &peaks).unwrap() / ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn frequencies_are_read_in_hertz() {
        let value = |text: &str| {
            let text = format!("[[frequency]]\nmode = 1\nvalue = {text}\n");
            read_measurements("m.toml", &text).map(|measured| measured.values[0].value)
        };
        for text in ["2.5", "'2.5 Hz'", "'15.707963267948966 rad/s'", "'150 rpm'"] {
            assert!((value(text).unwrap() - 2.5).abs() < 1e-15, "{text}");
        }
        for wrong in ["'2.5'", "'2.5 s'", "'fast'", "true"] {
            assert!(value(wrong).is_err(), "{wrong}");
        }
    }

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
            assert_eq!(read_measurements("m.toml", text).unwrap_err().to_string(), expected);
        }
    }
}
