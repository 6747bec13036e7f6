//! Limits of a link and its motor, how near a solution comes to them, and checks of other numbers against bounds.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use thiserror::Error;

use super::metrics::{JointMetrics, Metrics, PlayedMetrics};
use super::quantities::QUANTITIES;
use crate::inverse::{MotorHistories, QuantityErrors, Solution};
use crate::link::{Drive, ParameterError};
use crate::numeric::largest;
use crate::text::{given, significant};

/// Beginning of the keys of the motor's limits.
const MOTOR: &str = "motor_";

/// The largest values that a link and its motor may reach; `None` is no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(remote = "Self", default, deny_unknown_fields)]
pub struct Limits {
    /// Torque at the hub, on the link's side of a drive, in N m.
    pub torque_n_m: Option<f64>,
    /// Root mean square of the torque at the hub in N m while it acts.
    pub rms_torque_n_m: Option<f64>,
    /// Hub rate in rad/s.
    pub hub_rate_rad_s: Option<f64>,
    /// Mechanical power at the hub in W.
    pub power_w: Option<f64>,
    /// Deflection of the tip from the hub's tangent line in m.
    pub deflection_m: Option<f64>,
    /// Moment at the link's root in N m.
    pub bending_moment_n_m: Option<f64>,
    /// Torque of the motor in N m, on its own side of the gear, as the other limits of the motor.
    pub motor_torque_n_m: Option<f64>,
    /// Root mean square of the motor's torque in N m while it acts.
    pub motor_rms_torque_n_m: Option<f64>,
    /// Rate of the rotor in rad/s.
    pub motor_rate_rad_s: Option<f64>,
    /// Mechanical power of the motor in W.
    pub motor_power_w: Option<f64>,
}

impl Serialize for Limits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for Limits {
    /// Refuses a limit that is not finite and above 0.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let limits = Self::deserialize(deserializer)?;
        limits.check_numbers().map_err(D::Error::custom)?;
        Ok(limits)
    }
}

/// The value of a solution that has a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LimitedValue {
    /// Number of the joint of an arm, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
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
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize)]
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
    /// Checks that every limit is finite and above 0, and that a limit of the motor has a motor.
    ///
    /// # Errors
    /// [`ParameterError`] names the first wrong limit.
    pub fn check(self, drive: Option<&Drive>) -> Result<Self, ParameterError> {
        self.check_numbers()?;
        if drive.is_none() {
            let must = "must come with a [drive], the motor's side of the hub";
            self.refuse(must, |key, _| key.starts_with(MOTOR))?;
        }
        Ok(self)
    }

    fn check_numbers(&self) -> Result<(), ParameterError> {
        self.refuse("must be finite and above 0", |_, limit| !limit.is_finite() || limit <= 0.0)
    }

    /// Refuses the first limit for which `is_wrong` is true.
    fn refuse(
        &self,
        must: &str,
        is_wrong: impl Fn(&str, f64) -> bool,
    ) -> Result<(), ParameterError> {
        for (key, limit, unit) in self.entries() {
            if let Some(limit) = limit.filter(|limit| is_wrong(key, *limit)) {
                return Err(ParameterError::new(format!("limits.{key}"), limit, unit, must));
            }
        }
        Ok(())
    }

    /// The limited values of a joint, in the order of the link file.
    fn values(
        &self,
        joint: Option<usize>,
        found: impl Fn(&'static str) -> Option<f64>,
    ) -> impl Iterator<Item = LimitedValue> {
        let entries = self.entries().into_iter();
        entries.filter_map(move |(key, limit, unit)| {
            Some(LimitedValue { joint, key, limit: limit?, found: found(key)?, unit })
        })
    }

    /// The limits in the form of summary.json; absent without limits.
    pub(crate) fn stored(&self) -> Option<Value> {
        let Ok(Value::Object(mut keys)) = serde_json::to_value(self) else { return None };
        keys.retain(|_, limit| !limit.is_null());
        (!keys.is_empty()).then_some(Value::Object(keys))
    }

    /// Key in the link file, limit and unit of each, in the order of the link file.
    pub(crate) fn entries(&self) -> [(&'static str, Option<f64>, &'static str); 10] {
        [
            ("torque", self.torque_n_m, "N m"),
            ("rms_torque", self.rms_torque_n_m, "N m"),
            ("hub_rate", self.hub_rate_rad_s, "rad/s"),
            ("power", self.power_w, "W"),
            ("deflection", self.deflection_m, "m"),
            ("bending_moment", self.bending_moment_n_m, "N m"),
            ("motor_torque", self.motor_torque_n_m, "N m"),
            ("motor_rms_torque", self.motor_rms_torque_n_m, "N m"),
            ("motor_rate", self.motor_rate_rad_s, "rad/s"),
            ("motor_power", self.motor_power_w, "W"),
        ]
    }
}

/// How near a solution comes to a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    /// The limited values of all joints, in the order of the link file.
    pub fn limited(&self, limits: &[Limits]) -> Vec<LimitedValue> {
        let joints = self.joints.iter().zip(limits);
        joints.flat_map(|(joint, limits)| joint.limited(limits)).collect()
    }

    /// The limits of joints that a solution exceeds, in the order of the link file.
    pub fn exceeded(&self, limits: &[Limits]) -> Vec<Exceeded> {
        exceeded(self.limited(limits))
    }
}

impl PlayedMetrics {
    /// The limits that a simulation exceeds, of torque, rate and power, and of the deflection of one link.
    pub fn exceeded(&self, limits: &[Limits]) -> Vec<Exceeded> {
        let joints = self.joints.iter().zip(limits);
        let values = joints.flat_map(|(own, limits)| {
            limits.values(own.joint, |key| match key {
                "torque" => Some(own.peak_torque_n_m.value),
                "hub_rate" => Some(own.peak_hub_rate_rad_s.value),
                "power" => Some(own.peak_power_w.value),
                "deflection" => own.peak_deflection_m.map(|peak| peak.value),
                _ => None,
            })
        });
        exceeded(values.collect())
    }
}

fn exceeded(mut values: Vec<LimitedValue>) -> Vec<Exceeded> {
    values.retain(|value| value.found > value.limit);
    values.into_iter().map(Exceeded).collect()
}

/// How near a solution comes to each limit of its joints, in the order of the link file.
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
        limits.values(self.joint, |key| {
            let quantity = QUANTITIES.iter().find(|own| own.limit == Some(key))?;
            // Without a motor no value is within its limits.
            Some((quantity.of)(self).unwrap_or(f64::INFINITY))
        })
    }
}

/// Measured errors of the values of a joint that have limits, relative to the peaks of the values.
///
/// A root mean square has the error of the peak. Power has the errors of torque and rate, deflection that of the hub angle,
/// the root's moment that of the torque.
struct Errors<'a> {
    metrics: &'a JointMetrics,
    torque: f64,
    rate: f64,
    /// Error of the hub angle, times the turn and the length, in m.
    deflection_m: f64,
    motor_torque: f64,
    motor_rate: f64,
}

impl<'a> Errors<'a> {
    fn of(solution: &Solution, number: usize, metrics: &'a JointMetrics) -> Self {
        let (joint, has_weight) = (&solution.joints[number], solution.arm.has_weight());
        let errors = joint.errors.of_kind(all_kinds);
        // With gravity errors are shares of ranges.
        let per_peak = |error: f64, history: &[f64]| {
            if has_weight { error * solution.size_of(history) / largest(history) } else { error }
        };
        let of_motor = |error: Option<f64>, history: fn(&MotorHistories) -> &Vec<f64>| {
            let history = joint.motor.as_ref().map(history);
            error.zip(history).map_or(0.0, |(error, history)| per_peak(error, history))
        };
        let turned_rad = if has_weight {
            solution.size_of(solution.followed_rad(number))
        } else {
            metrics.peak_hub_angle_rad.value
        };
        Self {
            metrics,
            torque: per_peak(errors.torque, &joint.torque_n_m),
            rate: per_peak(errors.hub_rate, &joint.rate_rad_s),
            deflection_m: errors.hub_angle
                * (solution.links[number].link().length_m() * turned_rad),
            motor_torque: of_motor(errors.motor_torque, |motor| &motor.torque_n_m),
            motor_rate: of_motor(errors.motor_rate, |motor| &motor.rate_rad_s),
        }
    }

    /// The error of a value, relative to it.
    fn of_value(&self, value: &LimitedValue) -> f64 {
        let Self { metrics, torque, rate, deflection_m, motor_torque, motor_rate } = *self;
        let peak = metrics.peak_torque_n_m.value;
        let power = peak * metrics.peak_hub_rate_rad_s.value;
        let [motor, motor_power] = metrics.motor.map_or([0.0; 2], |motor| {
            let peak = motor.peak_torque_n_m.value;
            [peak, peak * motor.peak_rate_rad_s.value]
        });
        let (error, of) = match value.key {
            "torque" => return torque,
            "hub_rate" => return rate,
            "motor_torque" => return motor_torque,
            "motor_rate" => return motor_rate,
            "rms_torque" => (torque, peak),
            "power" => (torque + rate, power),
            "deflection" => (deflection_m, 1.0),
            "bending_moment" => (torque, peak.max(value.found)),
            "motor_rms_torque" => (motor_torque, motor),
            "motor_power" => (motor_torque + motor_rate, motor_power),
            // A value without a measured error may exceed any limit.
            _ => return f64::INFINITY,
        };
        if error == 0.0 { 0.0 } else { (error * of / value.found).min(f64::MAX) }
    }
}

/// Sum of all errors of a quantity except that of the model, which is shown beside it.
fn all_kinds(errors: QuantityErrors) -> f64 {
    let QuantityErrors { mesh, window, step, iteration, modes, input, model: _ } = errors;
    [step, iteration, modes, input]
        .into_iter()
        .flatten()
        .fold(mesh + window, |sum, error| sum + error)
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
        let limits = Limits { torque_n_m: Some(3.5), ..Limits::default() };
        let stored = serde_json::to_string(&limits).unwrap();
        assert_eq!(serde_json::from_str::<Limits>(&stored).unwrap(), limits);
        assert_eq!(serde_json::from_str::<Limits>("{}").unwrap(), Limits::default());
        assert_eq!(limits.stored().unwrap().to_string(), r#"{"torque_n_m":3.5}"#);
        assert_eq!(Limits::default().stored(), None);
        for wrong in [r#"{"power_w": -2.0}"#, r#"{"power_w": 0}"#, r#"{"power": 2.0}"#] {
            assert!(serde_json::from_str::<Limits>(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn every_limit_is_of_one_quantity() {
        let limits = Limits::default();
        let keys: Vec<&str> = limits.entries().iter().map(|(key, ..)| *key).collect();
        let mut of_quantities: Vec<&str> = QUANTITIES.iter().filter_map(|own| own.limit).collect();
        assert_eq!(of_quantities.len(), keys.len());
        of_quantities.retain(|key| !keys.contains(key));
        assert!(of_quantities.is_empty(), "{of_quantities:?}");
        for (key, ..) in limits.entries() {
            assert_eq!(QUANTITIES.iter().filter(|own| own.limit == Some(key)).count(), 1, "{key}");
        }
    }
}
