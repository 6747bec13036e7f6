//! Limits of a link and its motor, and how near a solution comes to them.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use thiserror::Error;

use super::metrics::{Metrics, MotorMetrics, PlayedMetrics};
use crate::inverse::{MotorHistories, QuantityErrors, Solution};
use crate::link::{Drive, ParameterError};
use crate::numeric::largest;
use crate::text::{given, significant};

/// How the keys of the motor's limits begin.
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
    /// That the limit is exceeded; a torque acts at this place.
    fn exceeded_at(&self, place: &str) -> String {
        let Self { key, limit, found, unit } = self;
        // The other keys say where the value acts.
        let at = if *key == "torque" { format!(" at the {place}") } else { String::new() };
        // Five digits, or as many as are beyond the limit.
        let shown = (5..=17).map(|digits| significant(*found, digits));
        let mut beyond = shown.filter(|text| text.parse().is_ok_and(|shown: f64| shown > *limit));
        let (limit, found) = (given(*limit), beyond.next().unwrap_or_else(|| given(*found)));
        format!("limits.{key} = {limit} {unit} is exceeded{at}: {found} {unit}")
    }
}

/// A limit that a solution exceeds.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize)]
#[error("{}", .0.exceeded_at("hub"))]
pub struct Exceeded(pub LimitedValue);

impl Exceeded {
    /// Name of the kind of warning that it is, for machines.
    pub const KIND: &'static str = "limit_exceeded";

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "a slower motion, a stronger motor or a stiffer link"
    }

    /// Its text where a joint of an arm, numbered from 0, exceeds it.
    pub fn of_joint(&self, joint: usize) -> String {
        format!("joint {}: {}", joint + 1, self.0.exceeded_at("joint"))
    }
}

impl Limits {
    /// Checks that every limit is finite and above 0, and that a limit of the motor has a motor.
    ///
    /// # Errors
    /// [`ParameterError`] names the first that is not.
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

    /// Refuses the first limit of which `is_wrong`.
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

    /// The limits that a solution exceeds, in the order of the link file.
    pub fn exceeded(&self, metrics: &Metrics) -> Vec<Exceeded> {
        let values = self.limited_values(metrics).into_iter();
        values.filter(|value| value.found > value.limit).map(Exceeded).collect()
    }

    /// The limits that a simulation exceeds, of those of its torque, hub rate, power and deflection.
    pub fn exceeded_in_play(&self, metrics: &PlayedMetrics) -> Vec<Exceeded> {
        self.exceeded_by(Self {
            torque_n_m: Some(metrics.peak_torque_n_m.value),
            hub_rate_rad_s: Some(metrics.peak_hub_rate_rad_s.value),
            power_w: Some(metrics.peak_power_w.value),
            deflection_m: Some(metrics.peak_deflection_m.value),
            ..Self::default()
        })
    }

    /// The limits that these values exceed, in the order of the link file; what has no value exceeds none.
    pub(super) fn exceeded_by(&self, values: Limits) -> Vec<Exceeded> {
        let found = values.entries().map(|(_, value, _)| value.unwrap_or(0.0));
        let values = self.limited_of(found).into_iter();
        values.filter(|value| value.found > value.limit).map(Exceeded).collect()
    }

    /// The values of a solution that have a limit, in the order of the link file.
    pub fn limited_values(&self, metrics: &Metrics) -> Vec<LimitedValue> {
        self.limited_of(found(metrics))
    }

    /// Those of these values, which are in the order of the link file, that have a limit.
    pub(super) fn limited_of(&self, found: [f64; 10]) -> Vec<LimitedValue> {
        let pairs = self.entries().into_iter().zip(found);
        let value =
            |((key, limit, unit), found)| Some(LimitedValue { key, limit: limit?, found, unit });
        pairs.filter_map(value).collect()
    }

    /// How near a solution comes to each limit, in the order of the link file.
    pub fn reached(&self, solution: &Solution) -> Vec<Reached> {
        let metrics = Metrics::of(solution);
        self.reached_by(found(&metrics), errors(solution, &metrics))
    }

    /// How near these values, whose errors are these, come to their limits; both in the order of the link file.
    pub(super) fn reached_by(&self, found: [f64; 10], errors: [f64; 10]) -> Vec<Reached> {
        let errors = self.entries().into_iter().zip(errors);
        let errors = errors.filter(|((_, limit, _), _)| limit.is_some());
        let values = self.limited_of(found).into_iter().zip(errors);
        values.map(|(value, (_, error))| Reached { value, error }).collect()
    }

    /// The limits that are given, as they are stored; none without any.
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

/// The values that can have a limit, in the order of the link file.
fn found(metrics: &Metrics) -> [f64; 10] {
    // Without a motor no value is within its limits.
    let motor = |of: fn(&MotorMetrics) -> f64| metrics.motor.as_ref().map_or(f64::INFINITY, of);
    [
        metrics.peak_torque_n_m.value,
        metrics.rms_torque_n_m,
        metrics.peak_hub_rate_rad_s.value,
        metrics.peak_power_w.value,
        metrics.peak_deflection_m.value,
        metrics.peak_root_moment_n_m.value,
        motor(|motor| motor.peak_torque_n_m.value),
        motor(|motor| motor.rms_torque_n_m),
        motor(|motor| motor.peak_rate_rad_s.value),
        motor(|motor| motor.peak_power_w.value),
    ]
}

/// The errors of all kinds of one quantity that are measured on the model; what the model itself leaves out is told beside
/// them.
pub(super) fn all_kinds(errors: QuantityErrors) -> f64 {
    let QuantityErrors { mesh, window, step, iteration, modes, input, model: _ } = errors;
    [step, iteration, modes, input]
        .into_iter()
        .flatten()
        .fold(mesh + window, |sum, error| sum + error)
}

/// Measured error of each of these values, relative to it.
///
/// Errors are measured relative to peaks: a root mean square has the error of the peak. Power has the
/// errors of torque and rate, deflection that of the hub angle, the root's moment that of the torque.
fn errors(solution: &Solution, metrics: &Metrics) -> [f64; 10] {
    let errors = solution.accuracy.of_kind(all_kinds);
    // With gravity errors are shares of ranges.
    let has_weight = solution.link().has_weight();
    let per_peak = |error: f64, history: &[f64]| {
        if has_weight { error * solution.size_of(history) / largest(history) } else { error }
    };
    let torque = per_peak(errors.torque, &solution.torque_n_m);
    let rate = per_peak(errors.hub_rate, &solution.hub_rate_rad_s);
    let of_motor = |error: Option<f64>, history: fn(&MotorHistories) -> &Vec<f64>| {
        let history = solution.motor.as_ref().map(history);
        error.zip(history).map_or(0.0, |(error, history)| per_peak(error, history))
    };
    let motor_torque = of_motor(errors.motor_torque, |motor| &motor.torque_n_m);
    let motor_rate = of_motor(errors.motor_rate, |motor| &motor.rate_rad_s);
    let [
        peak,
        rms,
        peak_rate,
        power,
        deflection,
        moment,
        motor_peak,
        motor_rms,
        motor_peak_rate,
        motor_power,
    ] = found(metrics);
    let turned_rad = if has_weight {
        solution.size_of(&solution.hub_angle_rad)
    } else {
        metrics.peak_hub_angle_rad.value
    };
    let turned_m = solution.mesh().length_m() * turned_rad;
    let over = |error: f64, peak: f64, found: f64| {
        if error == 0.0 { 0.0 } else { (error * peak / found).min(f64::MAX) }
    };
    [
        torque,
        over(torque, peak, rms),
        rate,
        over(torque + rate, peak * peak_rate, power),
        over(errors.hub_angle, turned_m, deflection),
        torque * (peak / moment).max(1.0),
        motor_torque,
        over(motor_torque, motor_peak, motor_rms),
        motor_rate,
        over(motor_torque + motor_rate, motor_peak * motor_peak_rate, motor_power),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_exceeded_by_little_is_seen_to_be() {
        let text = |limit: f64, found: f64| {
            Exceeded(LimitedValue { key: "power", limit, found, unit: "W" }).to_string()
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
}
