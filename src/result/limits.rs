use thiserror::Error;

use super::metrics::{Metrics, MotorMetrics};
use crate::inverse::{Accuracy, QuantityErrors, Solution};
use crate::link::{Drive, ParameterError};
use crate::numeric::{plain, significant};

/// How the keys of the motor's limits begin.
const MOTOR: &str = "motor_";

/// The largest values that a link and its motor may reach; `None` is no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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

/// The value of a solution that has a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// Where the value acts, if its key does not say so.
    fn place(&self) -> &'static str {
        if self.key == "torque" { " at the hub" } else { "" }
    }
}

/// A limit that a solution exceeds.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "limits.{} = {} {unit} is exceeded{}: {} {unit}",
    .0.key, plain(.0.limit), .0.place(), significant(.0.found, 5), unit = .0.unit
)]
pub struct Exceeded(pub LimitedValue);

impl Exceeded {
    /// Name of the kind of warning that it is, for machines.
    pub const KIND: &'static str = "limit_exceeded";

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "a slower motion, a stronger motor or a stiffer link"
    }
}

impl Limits {
    /// Checks that every limit is finite and above 0, and that a limit of the motor has a motor.
    ///
    /// # Errors
    /// [`ParameterError`] names the first that is not.
    pub fn check(self, drive: Option<&Drive>) -> Result<Self, ParameterError> {
        for (key, limit, unit) in self.entries() {
            let Some(limit) = limit else { continue };
            let must = if !limit.is_finite() || limit <= 0.0 {
                "must be finite and above 0"
            } else if key.starts_with(MOTOR) && drive.is_none() {
                "must come with a [drive], the motor's side of the hub"
            } else {
                continue;
            };
            return Err(ParameterError::new(format!("limits.{key}"), limit, unit, must));
        }
        Ok(self)
    }

    /// The limits that a solution exceeds, in the order of the link file.
    pub fn exceeded(&self, metrics: &Metrics) -> Vec<Exceeded> {
        let values = self.limited_values(metrics).into_iter();
        values.filter(|value| value.found > value.limit).map(Exceeded).collect()
    }

    /// The values of a solution that have a limit, in the order of the link file.
    pub fn limited_values(&self, metrics: &Metrics) -> Vec<LimitedValue> {
        // Without a motor no value is within its limits.
        let motor = |of: fn(&MotorMetrics) -> f64| metrics.motor.as_ref().map_or(f64::INFINITY, of);
        let found = [
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
        ];
        let pairs = self.entries().into_iter().zip(found);
        let value =
            |((key, limit, unit), found)| Some(LimitedValue { key, limit: limit?, found, unit });
        pairs.filter_map(value).collect()
    }

    fn entries(&self) -> [(&'static str, Option<f64>, &'static str); 10] {
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

impl Limits {
    /// How near a solution comes to each limit, in the order of the link file.
    pub fn reached(&self, solution: &Solution) -> Vec<Reached> {
        let metrics = Metrics::of(solution);
        let values = self.limited_values(&metrics).into_iter();
        values.map(|value| Reached { value, error: error_of(value, solution, &metrics) }).collect()
    }
}

/// Measured error of a limited value, relative to it.
///
/// Errors are measured relative to peaks: a root mean square has the error of the peak. Power has the
/// errors of torque and rate, deflection that of the hub angle, the root's moment that of the torque.
fn error_of(value: LimitedValue, solution: &Solution, metrics: &Metrics) -> f64 {
    let Accuracy { errors, .. } = solution.accuracy;
    let torque = total(errors.torque);
    let rate = total(errors.hub_rate);
    let [motor_torque, motor_rate] =
        [errors.motor_torque, errors.motor_rate].map(|errors| errors.map_or(0.0, total));
    let peak = metrics.peak_torque_n_m.value;
    let motor = metrics.motor.as_ref();
    let over = |error: f64, peak: f64| (error * peak / value.found).min(f64::MAX);
    match value.key {
        "rms_torque" => over(torque, peak),
        "hub_rate" => rate,
        "power" => over(torque + rate, peak * metrics.peak_hub_rate_rad_s.value),
        "deflection" => {
            let turned_m = solution.mesh().length_m() * metrics.peak_hub_angle_rad.value;
            over(total(errors.hub_angle), turned_m)
        }
        "bending_moment" => torque * (peak / value.found).max(1.0),
        "motor_torque" => motor_torque,
        "motor_rate" => motor_rate,
        "motor_rms_torque" => {
            motor.map_or(0.0, |motor| over(motor_torque, motor.peak_torque_n_m.value))
        }
        "motor_power" => motor.map_or(0.0, |motor| {
            let peaks = motor.peak_torque_n_m.value * motor.peak_rate_rad_s.value;
            over(motor_torque + motor_rate, peaks)
        }),
        _ => torque,
    }
}

fn total(errors: QuantityErrors) -> f64 {
    let QuantityErrors { mesh, window, step, modes } = errors;
    mesh + window + step.unwrap_or(0.0) + modes.unwrap_or(0.0)
}
