use super::check::{Check, Question};
use crate::inverse::Solution;
use crate::result::{Limits, Reached};

/// One check for each limit of the link file: the value with its measured error, over the limit.
pub(super) fn within_limits(limits: &Limits, solution: &Solution) -> Vec<Check> {
    limits.reached(solution).iter().map(within).collect()
}

fn within(reached: &Reached) -> Check {
    let (name, what) = names(reached.held.key);
    Question { name, what, of: "the limit" }.measured(reached.share(), 1.0)
}

/// What the check of a limit is called, for machines and for people.
fn names(key: &str) -> (&'static str, &'static str) {
    match key {
        "torque" => ("limit_torque", "limits.torque"),
        "rms_torque" => ("limit_rms_torque", "limits.rms_torque"),
        "hub_rate" => ("limit_hub_rate", "limits.hub_rate"),
        "power" => ("limit_power", "limits.power"),
        "deflection" => ("limit_deflection", "limits.deflection"),
        "bending_moment" => ("limit_bending_moment", "limits.bending_moment"),
        "motor_torque" => ("limit_motor_torque", "limits.motor_torque"),
        "motor_rms_torque" => ("limit_motor_rms_torque", "limits.motor_rms_torque"),
        "motor_rate" => ("limit_motor_rate", "limits.motor_rate"),
        "motor_power" => ("limit_motor_power", "limits.motor_power"),
        _ => ("limit", "limits"),
    }
}
