//! The errors that a solution measured of itself, each kind at the quantity where it is worst.

use super::check::{Check, Question};
use super::report::{Answer, CHOSEN};
use crate::inverse::{PerQuantity, Quantity};

/// A name for each quantity, ending in the same words.
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

/// Errors of the mesh, of the window and, where few modes are kept, of those left out.
pub(super) struct Measured {
    pub(super) mesh: Check,
    pub(super) window: Check,
    pub(super) modes: Option<Check>,
}

impl Measured {
    pub(super) fn of(answer: &Answer) -> Self {
        let Answer { plan, analysis, solution, .. } = answer;
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
                analysis.tolerance(),
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
    Question { name, what: what(quantity), of }.measured(error, bound)
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
