//! Checks of what a solution holds itself: its error estimates, deflection and limits.

use super::check::{Answer, CHOSEN, Check, Label};
use crate::inverse::{PerQuantity, Quantity, Solution};
use crate::link::Link;
use crate::numeric::largest;
use crate::result::{Limits, Reached};

/// A function from each quantity to what is checked of it: its name and these words.
macro_rules! of_each {
    ($words:literal) => {
        |quantity| match quantity {
            Quantity::Torque => concat!("torque ", $words),
            Quantity::HubAngle => concat!("hub angle ", $words),
            Quantity::HubRate => concat!("hub rate ", $words),
            Quantity::HubAcceleration => concat!("hub accel. ", $words),
            Quantity::Displacement => concat!("displacement ", $words),
            Quantity::BendingMoment => concat!("moment ", $words),
            Quantity::MotorTorque => concat!("motor torque ", $words),
            Quantity::MotorRate => concat!("motor rate ", $words),
        }
    };
}

/// Error estimates of the mesh, of the window and, where modes were cut, of those left out.
pub(super) struct Estimates {
    pub(super) mesh: Check,
    pub(super) window: Check,
    pub(super) modes: Option<Check>,
}

impl Estimates {
    pub(super) fn of(answer: &Answer) -> Self {
        let Answer { plan, solution, .. } = answer;
        let accuracy = &solution.accuracy;
        let mesh_bound = if plan.is_automatic() { plan.tolerance() } else { CHOSEN };
        let modes = accuracy.errors.torque.modes.map(|_| {
            let left_out = accuracy.of_kind(|errors| errors.modes.unwrap_or(0.0));
            worst("truncation", of_each!("with all modes"), &left_out, CHOSEN)
        });
        let mesh = accuracy.of_kind(|errors| errors.mesh);
        let window = accuracy.of_kind(|errors| errors.window);
        Self {
            mesh: worst("mesh_halving", of_each!("with elements halved"), &mesh, mesh_bound),
            window: worst(
                "wrap_around",
                of_each!("at the window's edge"),
                &window,
                solution.analysis.tolerance(),
            ),
            modes,
        }
    }
}

/// The check of the quantity with the largest error; NaN is larger than any number.
fn worst(
    name: &'static str,
    what: fn(Quantity) -> &'static str,
    errors: &PerQuantity<f64>,
    bound: f64,
) -> Check {
    let nan = errors.iter().find(|(_, error)| error.is_nan());
    let (quantity, error) = nan.unwrap_or_else(|| errors.worst());
    let of = if quantity == Quantity::Torque { "the peak torque" } else { "its peak" };
    Label { name, what: what(quantity), of }.measured(error, bound)
}

/// One check for each limit of the link file: the value with its estimated error, over the limit.
pub(super) fn within_limits(limits: &Limits, solution: &Solution) -> Vec<Check> {
    limits.reached(solution).iter().map(within).collect()
}

fn within(reached: &Reached) -> Check {
    let (name, what) = names(reached.value.key);
    Label { name, what, of: "the limit" }.measured(reached.share(), 1.0)
}

/// Name of the check of a limit, and the limit as the link file names it.
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

/// The largest deflection of the tip over the length, against the range of the linear theory.
pub(super) fn tip_deflection(solution: &Solution) -> Check {
    let label = Label { name: "tip_deflection", what: "tip deflection", of: "the link's length" };
    let bent = largest(&solution.tip_deflection_m()) / solution.mesh().length_m();
    label.measured(bent, Link::LARGEST_DEFLECTION)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_is_of_the_quantity_with_the_largest_error_and_nan_is_the_largest() {
        let errors = PerQuantity { torque: 1e-3, hub_angle: 1e-2, ..Default::default() };
        let of = |errors| worst("mesh_halving", of_each!("with elements halved"), &errors, 5e-3);
        assert_eq!(of(errors).what, "hub angle with elements halved");
        assert!(of(errors).fails());
        let motor = PerQuantity { motor_torque: Some(f64::NAN), ..errors };
        assert_eq!(of(motor).what, "motor torque with elements halved");
        assert!(of(motor).fails());
        let torque = PerQuantity { torque: 1e-3, ..Default::default() };
        assert_eq!(of(torque).what, "torque with elements halved");
        assert!(!of(torque).fails());
    }
}
