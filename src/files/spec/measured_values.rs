//! Measured frequencies and damping ratios of a link, or of an arm in its poses.

use std::f64::consts::TAU;
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

use super::error::Fault;
use super::value::{Angle, Count, Si};
use crate::fit::{ArmMode, HubEnd, Measured, Observable};
use crate::numeric::parse_hertz;

/// Fewest peaks of a decay: two yield one decrement.
const FEWEST_PEAKS: usize = 2;

/// Object of the measurement: one link, or an arm of several.
pub(super) struct MeasuredOf {
    links: usize,
    /// Pose of values without a pose.
    at_rad: Option<Vec<f64>>,
}

/// Keys that identify the mode of a value.
#[derive(Clone)]
pub(super) struct ModeKeys {
    pub(super) mode: usize,
    pub(super) hub: Option<HubEnd>,
    pub(super) joints: Option<HubEnd>,
    pub(super) at: Option<Vec<Angle>>,
}

impl MeasuredOf {
    pub(super) fn new(links: usize, at: Option<Vec<Angle>>) -> Result<Self, Fault> {
        let mut of = Self { links, at_rad: None };
        of.at_rad = of.directions("at", at)?;
        Ok(of)
    }

    pub(super) fn is_arm(&self) -> bool {
        self.links > 1
    }

    /// Refuses a key that only a single link has, or only an arm; the other takes something `instead`.
    pub(super) fn refuse(&self, of_arm: bool, path: &str, instead: &str) -> Result<(), Fault> {
        let links = self.links;
        match self.is_arm() {
            is_arm if is_arm == of_arm => Ok(()),
            true => Err(Fault::on(
                path,
                format!("is for one link; an arm of {links} links takes {instead}"),
            )),
            false => Err(Fault::on(path, format!("is for arms; one link takes {instead}"))),
        }
    }

    /// Directions in rad, one for each link of an arm.
    fn directions(&self, path: &str, at: Option<Vec<Angle>>) -> Result<Option<Vec<f64>>, Fault> {
        let Some(at) = at else { return Ok(None) };
        self.refuse(true, path, "no directions")?;
        let (given, links) = (at.len(), self.links);
        if given != links {
            let must = format!("must be {links}, one for each link of the arm");
            let words = format!("= {given} directions, but {must}");
            return Err(Fault::on(path, words).hinting(AT.to_owned()));
        }
        let at_rad: Vec<f64> = at.into_iter().map(Si::si).collect();
        match at_rad.iter().find(|angle| angle.is_nan() || angle.abs() > MOST_RAD) {
            Some(angle) => {
                let words = format!("= {angle:?} rad, but must be at most 1e4 in size");
                Err(Fault::on(path, words))
            }
            None => Ok(Some(at_rad)),
        }
    }

    /// The natural frequency of a mode.
    pub(super) fn frequency(&self, path: &str, keys: ModeKeys) -> Result<Observable, Fault> {
        let ModeKeys { mode, hub, joints, at } = keys;
        let below = |key: &str| format!("{path}.{key}");
        if hub.is_some() {
            self.refuse(false, &below("hub"), "`joints`")?;
        }
        if joints.is_some() {
            self.refuse(true, &below("joints"), "`hub`")?;
        }
        let own_rad = self.directions(&below("at"), at)?;
        if !self.is_arm() {
            return Ok(Observable::Frequency { mode, hub: hub.unwrap_or_default() });
        }
        let Some(at_rad) = own_rad.or_else(|| self.at_rad.clone()) else {
            let at = below("at");
            let must = format!("the directions of all {} links of the arm", self.links);
            return Err(Fault::new(path, format!("{at} is missing: {must}")).hinting(AT.to_owned()));
        };
        let joints = joints.unwrap_or_default();
        Ok(Observable::ArmFrequency(ArmMode { mode, joints, at_rad }))
    }
}

/// Largest direction in rad: some thousand turns, at which the digits still determine a place.
const MOST_RAD: f64 = 1e4;

/// Hint about the form of directions.
const AT: &str = "write at = [\"30 deg\", \"75 deg\"], from joint to joint, the inner link first; above all entries \
                  it holds for those without one";

/// `[[frequency]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawFrequency {
    mode: Option<Count>,
    zero: Option<Count>,
    #[serde(alias = "carriage")]
    hub: Option<HubEnd>,
    joints: Option<HubEnd>,
    at: Option<Vec<Angle>>,
    value: Hertz,
    uncertainty: Option<Hertz>,
}

/// `[[damping]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawDamping {
    mode: Count,
    #[serde(alias = "carriage")]
    hub: Option<HubEnd>,
    joints: Option<HubEnd>,
    at: Option<Vec<Angle>>,
    ratio: Option<f64>,
    peaks: Option<Vec<f64>>,
    uncertainty: Option<f64>,
}

/// Frequency in Hz: a number, or text with Hz, kHz, rad/s or rpm. `Rate` would take a hertz for a radian.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hertz(pub(super) f64);

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
                parse_hertz(text).map(Hertz).ok_or_else(wrong)
            }
        }
        deserializer.deserialize_any(Frequency)
    }
}

impl RawFrequency {
    pub(super) fn convert(self, path: &str, of: &MeasuredOf) -> Result<Measured, Fault> {
        let Self { mode, zero, hub, joints, at, value: Hertz(value), uncertainty } = self;
        let observable = match (mode, zero) {
            (Some(Count(mode)), None) => of.frequency(path, ModeKeys { mode, hub, joints, at })?,
            (None, Some(Count(zero))) => {
                of.refuse(false, &format!("{path}.zero"), "`mode`")?;
                let beside =
                    [("hub", hub.is_some()), ("joints", joints.is_some()), ("at", at.is_some())];
                if let Some((key, _)) = beside.into_iter().find(|(_, is_given)| *is_given) {
                    let must = "must not stand beside zero, a zero of torque → hub angle";
                    return Err(Fault::on(format!("{path}.{key}"), must));
                }
                Observable::Zero { zero }
            }
            _ => return Err(not_one_of(path, ["mode", "zero"], mode.is_some())),
        };
        checked(path, "value", value)?;
        let uncertainty = uncertainty.map(|Hertz(uncertainty)| uncertainty);
        checked(path, "uncertainty", uncertainty)?;
        Ok(Measured { observable, value, uncertainty })
    }
}

impl RawDamping {
    pub(super) fn convert(self, path: &str, of: &MeasuredOf) -> Result<Measured, Fault> {
        let Self { mode: Count(mode), hub, joints, at, ratio, peaks, uncertainty } = self;
        let observable = of.frequency(path, ModeKeys { mode, hub, joints, at })?.ratio();
        let value = match (ratio, peaks) {
            (Some(ratio), None) => ratio,
            (None, Some(peaks)) => of_decay(&format!("{path}.peaks"), &peaks)?,
            _ => return Err(not_one_of(path, ["ratio", "peaks"], ratio.is_some())),
        };
        checked(path, "ratio", value)?;
        checked(path, "uncertainty", uncertainty)?;
        Ok(Measured { observable, value, uncertainty })
    }
}

/// Error about two keys of which one must be there: both are, or neither.
fn not_one_of(path: &str, [one, other]: [&str; 2], has_both: bool) -> Fault {
    let words = if has_both {
        format!("has both {one} and {other}, but must have one of them")
    } else {
        format!("has neither {one} nor {other}, but must have one of them")
    };
    Fault::on(path, words)
}

/// Refuses a number that is not above 0.
pub(super) fn checked(path: &str, key: &str, number: impl Into<Option<f64>>) -> Result<(), Fault> {
    match number.into() {
        Some(number) if !(number.is_finite() && number > 0.0) => {
            Err(Fault::on(format!("{path}.{key}"), format!("= {number}, but must be above 0")))
        }
        _ => Ok(()),
    }
}

/// Damping ratio from peaks one period apart: with the decrement δ, the slope of their logarithms, `ζ = δ/√(4π² + δ²)`.
fn of_decay(path: &str, peaks: &[f64]) -> Result<f64, Fault> {
    let falls = peaks.windows(2).all(|pair| pair[1] < pair[0]);
    if peaks.len() < FEWEST_PEAKS || !falls || peaks.iter().any(|peak| *peak <= 0.0) {
        let must = "must be two or more peaks of one sign, each below the one before";
        return Err(Fault::on(path, must));
    }
    let middle = 0.5 * (peaks.len() - 1) as f64;
    let places = || (0..peaks.len()).map(|k| k as f64 - middle);
    let moment: f64 = places().zip(peaks).map(|(k, peak)| k * libm::log(*peak)).sum();
    let decrement = -moment / places().map(|k| k * k).sum::<f64>();
    Ok(decrement / (TAU * TAU + decrement * decrement).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::read_measurements;
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
            read_measurements("m.toml", &text, (1, false)).map(|measured| measured.values[0].value)
        };
        for text in ["2.5", "'2.5 Hz'", "'15.707963267948966 rad/s'", "'150 rpm'"] {
            assert!((value(text).unwrap() - 2.5).abs() < 1e-15, "{text}");
        }
        for wrong in ["'2.5'", "'2.5 s'", "'fast'", "true"] {
            assert!(value(wrong).is_err(), "{wrong}");
        }
    }
}
