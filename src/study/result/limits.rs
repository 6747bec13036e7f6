//! Limits of a link and its motor, how near a solution comes to them, and checks of other numbers against bounds.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use thiserror::Error;

use super::metrics::{JointMetrics, Metrics, PlayedMetrics};
use super::quantities::{Errors, JointQuantity, QUANTITIES};
use crate::inverse::Solution;
use crate::link::{Drive, Joint, MotorKnown, ParameterError};
use crate::text::{given, significant};

/// The largest values that a joint, its link and its motor may reach, in SI, by the keys of [`QUANTITIES`];
/// infinite without a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "BTreeMap<String, f64>", into = "Map<String, Value>")]
pub struct Limits([f64; QUANTITIES.len()]);

impl Default for Limits {
    fn default() -> Self {
        Self([f64::INFINITY; QUANTITIES.len()])
    }
}

impl From<Limits> for Map<String, Value> {
    fn from(limits: Limits) -> Self {
        limits.entries().map(|(own, key, limit)| (stored_key(own, key), limit.into())).collect()
    }
}

impl TryFrom<BTreeMap<String, f64>> for Limits {
    type Error = ParameterError;

    fn try_from(stored: BTreeMap<String, f64>) -> Result<Self, ParameterError> {
        let carriage = Joint::CARRIAGE;
        let key_of = |name: &str| {
            JointQuantity::with_limit().find(|(key, own)| {
                let of_hub = stored_key(own, key);
                of_hub == name || carriage.named(&of_hub) == name
            })
        };
        let unknown = |name: &str, limit| {
            ParameterError::new(
                format!("limits.{name}"),
                limit,
                "",
                "must be the limit of a quantity",
            )
        };
        let limits = stored.iter().map(|(name, limit)| match key_of(name) {
            Some((key, _)) => Ok((key, *limit)),
            None => Err(unknown(name, *limit)),
        });
        Self::new(limits.collect::<Result<Vec<_>, _>>()?)
    }
}

/// Key of a limit in summary.json.
fn stored_key(quantity: &JointQuantity, key: &str) -> String {
    format!("{key}{}", quantity.unit.suffix)
}

/// The value of a solution that has a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedValue {
    /// Number of the joint of an arm, from 0.
    pub joint: Option<usize>,
    /// Key of the limit in the link file.
    pub key: &'static str,
    /// The limit.
    pub limit: f64,
    /// The value.
    pub found: f64,
    /// Unit of both.
    pub unit: &'static str,
}

impl LimitedValue {
    /// Text of the exceeded limit.
    fn exceeded_text(&self) -> String {
        let Self { joint, key, limit, found, unit } = self;
        let (of, place) = joint
            .map_or((String::new(), "hub"), |joint| (format!("joint {}: ", joint + 1), "joint"));
        // The other keys say where the value acts.
        let at = if *key == "torque" { format!(" at the {place}") } else { String::new() };
        // At least five digits, and more until the text exceeds the limit.
        let shown = (5..=17).map(|digits| significant(*found, digits));
        let mut beyond = shown.filter(|text| text.parse().is_ok_and(|shown: f64| shown > *limit));
        let (limit, found) = (given(*limit), beyond.next().unwrap_or_else(|| given(*found)));
        format!("{of}limits.{key} = {limit} {unit} is exceeded{at}: {found} {unit}")
    }
}

/// A limit that a solution exceeds.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{}", .0.exceeded_text())]
pub struct Exceeded(pub LimitedValue);

impl Exceeded {
    /// Name of the kind of warning, for machines.
    pub const KIND: &'static str = "limit_exceeded";

    /// The same.
    pub fn kind(&self) -> &'static str {
        Self::KIND
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        "use a slower motion, a stronger motor or a stiffer link"
    }
}

impl Limits {
    /// Limits in SI by their keys in the link file: `[("torque", 5.0), ("motor_rate", 300.0)]`.
    ///
    /// # Errors
    /// [`ParameterError`] names a limit that is not finite and above 0, and an unknown key.
    pub fn new<'a>(
        limits: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<Self, ParameterError> {
        let mut all = Self::default();
        for (key, limit) in limits {
            let refused = |unit, must: &str| {
                Err(ParameterError::new(format!("limits.{key}"), limit, unit, must))
            };
            let Some(at) = QUANTITIES.iter().position(|own| own.limit_key() == Some(key)) else {
                let keys: Vec<&str> = JointQuantity::with_limit().map(|(key, _)| key).collect();
                return refused("", &format!("must be one of {}", keys.join(", ")));
            };
            if !limit.is_finite() || limit <= 0.0 {
                return refused(QUANTITIES[at].unit.text, "must be finite and above 0");
            }
            all.0[at] = limit;
        }
        Ok(all)
    }

    /// Checks that a limit of the motor has a motor, and those of current and voltage its constants.
    ///
    /// # Errors
    /// [`ParameterError`] names the first limit without them.
    pub fn check(self, drive: Option<&Drive>) -> Result<Self, ParameterError> {
        let known = drive.map(Drive::known);
        match self.entries().find(|(own, ..)| own.of_motor > known) {
            None => Ok(self),
            Some((own, key, limit)) => {
                let must = match (known, own.of_motor) {
                    (None, _) => "must come with a [drive], which has the motor",
                    (_, Some(MotorKnown::Voltage)) => {
                        "must come with drive.torque_constant and drive.resistance"
                    }
                    _ => "must come with drive.torque_constant",
                };
                Err(ParameterError::new(format!("limits.{key}"), limit, own.unit.text, must))
            }
        }
    }

    /// Keys of the limits that are set.
    pub fn keys(&self) -> impl Iterator<Item = &'static str> {
        self.entries().map(|(_, key, _)| key)
    }

    /// The limit of a key in SI, such as `torque`.
    pub fn of(&self, key: &str) -> Option<f64> {
        self.entries().find(|(_, own, _)| *own == key).map(|(.., limit)| limit)
    }

    /// The limits that are set, with their quantities and keys, in the order of [`QUANTITIES`].
    fn entries(self) -> impl Iterator<Item = (&'static JointQuantity, &'static str, f64)> {
        let set = QUANTITIES.iter().zip(self.0).filter(|(_, limit)| limit.is_finite());
        set.filter_map(|(own, limit)| Some((own, own.limit_key()?, limit)))
    }

    /// The limited values of a joint, in the order of [`QUANTITIES`].
    fn values(
        self,
        joint: Option<usize>,
        read: impl Fn(&JointQuantity) -> Option<f64>,
    ) -> impl Iterator<Item = LimitedValue> {
        self.entries().filter_map(move |(own, key, limit)| {
            Some(LimitedValue { joint, key, limit, found: read(own)?, unit: own.unit.text })
        })
    }

    /// The limits in the form of summary.json; absent without limits.
    pub(crate) fn stored(&self) -> Option<Value> {
        (*self != Self::default()).then(|| Value::Object((*self).into()))
    }
}

/// How near a solution comes to a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// The value and its limit.
    pub value: LimitedValue,
    /// Measured error of the value, relative to it.
    pub error: f64,
}

impl Reached {
    /// The value with its error over the limit: at most 1 within it.
    pub fn share(&self) -> f64 {
        self.value.found * (1.0 + self.error) / self.value.limit
    }
}

/// One measured number against its bound: a line of the table of `verify`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Its name in summary.json: `tip_error`, `mesh_halving`, ….
    pub name: String,
    /// The measurement, for a person to read.
    pub what: String,
    /// Name of the size that divides the number.
    pub of: String,
    /// The number; `None` if it was not measured.
    pub found: Option<f64>,
    /// The largest number that passes.
    pub bound: Option<f64>,
    /// Reason for a missing number.
    pub reason: Option<String>,
    /// False if the number exceeds its bound or is NaN.
    pub passes: bool,
    /// The remedy for a failed check. A folder does not store it.
    #[serde(skip)]
    pub hint: &'static str,
}

impl Metrics {
    /// The limited values of all joints, in the order of [`QUANTITIES`].
    pub fn limited(&self, limits: &[Limits]) -> Vec<LimitedValue> {
        let joints = self.joints.iter().zip(limits);
        joints.flat_map(|(joint, limits)| joint.limited(limits)).collect()
    }

    /// The limits of joints that a solution exceeds, in the order of [`QUANTITIES`].
    pub fn exceeded(&self, limits: &[Limits]) -> Vec<Exceeded> {
        exceeded(self.limited(limits))
    }
}

impl PlayedMetrics {
    /// The limited values of a simulation: of torque, rate and power, and of the deflection of one link.
    pub fn limited(&self, limits: &[Limits]) -> Vec<LimitedValue> {
        let joints = self.joints.iter().zip(limits);
        let values = joints
            .flat_map(|(own, limits)| limits.values(own.joint, |quantity| quantity.played_by(own)));
        values.collect()
    }

    /// The limits that a simulation exceeds.
    pub fn exceeded(&self, limits: &[Limits]) -> Vec<Exceeded> {
        exceeded(self.limited(limits))
    }
}

fn exceeded(mut values: Vec<LimitedValue>) -> Vec<Exceeded> {
    values.retain(|value| value.found > value.limit);
    values.into_iter().map(Exceeded).collect()
}

/// How near a solution comes to each limit of its joints, in the order of [`QUANTITIES`].
pub fn reached(solution: &Solution, limits: &[Limits]) -> Vec<Reached> {
    let metrics = Metrics::of(solution);
    let joints = metrics.joints.iter().zip(limits).enumerate();
    let of = |(number, (metrics, limits)): (usize, (&JointMetrics, &Limits))| {
        let errors = Errors::of(solution, number, metrics);
        let values = metrics.limited(limits);
        values.map(|value| Reached { value, error: errors.of_value(&value) }).collect::<Vec<_>>()
    };
    joints.flat_map(of).collect()
}

impl JointMetrics {
    fn limited(&self, limits: &Limits) -> impl Iterator<Item = LimitedValue> {
        // Without a motor no value is within its limits.
        limits.values(self.joint, |quantity| Some((quantity.of)(self).unwrap_or(f64::INFINITY)))
    }
}

impl Errors {
    /// The error of a value, relative to it. A value without a measured error may exceed any limit.
    fn of_value(&self, value: &LimitedValue) -> f64 {
        let limit = JointQuantity::of_limit(value.key).and_then(|own| own.limit);
        match limit.map_or(f64::INFINITY, |limit| (limit.error)(self)) {
            0.0 => 0.0,
            error => (error / value.found).min(f64::MAX),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_exceeded_by_little_is_seen_to_be() {
        let text = |limit: f64, found: f64| {
            Exceeded(LimitedValue { joint: None, key: "power", limit, found, unit: "W" })
                .to_string()
        };
        assert_eq!(text(2.0, 3.251_592), "limits.power = 2 W is exceeded: 3.2516 W");
        assert_eq!(text(2.0, 2.000_000_4), "limits.power = 2 W is exceeded: 2.0000004 W");
        let below = "limits.power = 2.51234 W is exceeded: 2.51235 W";
        assert_eq!(text(2.512_34, 2.512_346), below);
    }

    #[test]
    fn stored_limits_are_those_written_and_checked() {
        let limits = Limits::new([("torque", 3.5), ("motor_rate", 2.0)]).unwrap();
        let stored = serde_json::to_string(&limits).unwrap();
        assert_eq!(serde_json::from_str::<Limits>(&stored).unwrap(), limits);
        assert_eq!(serde_json::from_str::<Limits>("{}").unwrap(), Limits::default());
        let text = limits.stored().unwrap().to_string();
        assert_eq!(text, r#"{"torque_n_m":3.5,"motor_rate_rad_s":2.0}"#);
        assert_eq!(Limits::default().stored(), None);
        for wrong in [r#"{"power_w": -2.0}"#, r#"{"power_w": 0}"#, r#"{"power": 2.0}"#] {
            assert!(serde_json::from_str::<Limits>(wrong).is_err(), "{wrong}");
        }
        let error = Limits::new([("torqe", 1.0)]).unwrap_err().to_string();
        assert!(
            error.starts_with("limits.torqe = 1, but must be one of torque, rms_torque,"),
            "{error}"
        );
    }

    #[test]
    fn every_limit_is_of_one_quantity() {
        let keys: Vec<&str> = JointQuantity::with_limit().map(|(key, _)| key).collect();
        for key in &keys {
            assert_eq!(keys.iter().filter(|own| *own == key).count(), 1, "{key}");
        }
    }
}
