//! Measured errors of the numbers of a joint.

use super::metrics::JointMetrics;
use super::peak::Peak;
use crate::inverse::{MotorHistories, QuantityErrors, Solution};
use crate::numeric::largest;

/// Measured errors of the values of a joint that have limits, in the units of the values.
///
/// A root mean square has the error of the peak. Power has the errors of torque and rate, deflection that of the hub angle,
/// the root's moment that of the torque.
pub(super) struct Errors {
    pub(super) torque_n_m: f64,
    pub(super) rate_rad_s: f64,
    pub(super) power_w: f64,
    /// Error of the hub angle times the length.
    pub(super) deflection_m: f64,
    pub(super) moment_n_m: f64,
    pub(super) motor_torque_n_m: f64,
    pub(super) motor_rate_rad_s: f64,
    pub(super) motor_power_w: f64,
}

impl Errors {
    pub(super) fn of(solution: &Solution, number: usize, metrics: &JointMetrics) -> Self {
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
        let (torque, rate) = (
            per_peak(errors.torque, &joint.torque_n_m),
            per_peak(errors.hub_rate, &joint.rate_rad_s),
        );
        let motor_torque = of_motor(errors.motor_torque, |motor| &motor.torque_n_m);
        let motor_rate = of_motor(errors.motor_rate, |motor| &motor.rate_rad_s);
        let peaks = |peak: [Peak; 2]| peak.map(|peak| peak.value);
        let [peak_n_m, peak_rad_s] = peaks([metrics.peak_torque_n_m, metrics.peak_hub_rate_rad_s]);
        let motor =
            metrics.motor.map(|motor| peaks([motor.peak_torque_n_m, motor.peak_rate_rad_s]));
        let [motor_n_m, motor_rad_s] = motor.unwrap_or_default();
        Self {
            torque_n_m: torque * peak_n_m,
            rate_rad_s: rate * peak_rad_s,
            power_w: (torque + rate) * (peak_n_m * peak_rad_s),
            deflection_m: errors.hub_angle
                * (solution.links[number].link().length_m() * turned_rad),
            moment_n_m: torque * peak_n_m.max(metrics.peak_root_moment_n_m.value),
            motor_torque_n_m: motor_torque * motor_n_m,
            motor_rate_rad_s: motor_rate * motor_rad_s,
            motor_power_w: (motor_torque + motor_rate) * (motor_n_m * motor_rad_s),
        }
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
