//! Checks every approximation of a solution by other means, in the order in which they are shown.

mod arm;
mod check;
mod playback;
mod table;

pub use arm::{ArmAnswer, verify_arm};
pub use check::{Answer, Check, Outcome, VerificationError};
pub use table::{TableError, arm_table_error, table_error};

use std::f64::consts::TAU;

use serde::Serialize;

use crate::inverse::{PerQuantity, Quantity, Resources, Solution, torques_over_window};
use crate::modal::REPORTED_MODES;
use crate::model::{Dense, KeptModes, MOST_ELEMENTS_OF_DENSE_SOLVE, Model};
use crate::motion::Ends;
use crate::numeric::{largest, magnitude};
use crate::result::{Reached, reached};
use check::{Kind, PEAK, RANGE};
use playback::{Played, played, tip_solved, torque_change};

/// Number of frequencies at which the dense system is solved.
const FREQUENCIES: usize = 9;

/// Round-off of the dense solve above which the comparison says nothing.
const SPOILT: f64 = 1e-3;

/// The checks of a solution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verification {
    /// The checks, in the order in which they are shown.
    pub checks: Vec<Check>,
}

/// Checks a solution by other means:
///
/// - the written torque, played on the link with its own damping law and with viscous damping;
/// - the solved tip against the wanted motion;
/// - the torque with elements halved and with the step halved;
/// - the rest of the torque at the window's edge;
/// - the transfer against the paper's dense system at sample frequencies;
/// - the balance of energy;
/// - the iteration of second-order terms, where they are counted;
/// - the tip of a link with all terms of second order, unless these are counted;
/// - the limits of the link file.
///
/// # Errors
/// [`VerificationError`].
pub fn verify(answer: &Answer) -> Result<Verification, VerificationError> {
    let Answer { limits, solution, .. } = answer;
    let wanted = solution.motion.target(solution.grid.time_s(0), solution.grid.end_s());
    let Played { tip: mut checks, energy } = played(answer, &wanted)?;
    checks.extend(tip_solved(answer, &wanted));
    let accuracy = &solution.accuracy;
    checks.push(worst(&Kind::MESH, answer, &accuracy.errors.of_kind(|errors| errors.mesh)));
    checks.extend(with_the_step_halved(answer)?);
    // A cycle has no edge.
    if solution.motion.ends() != Ends::Periodic {
        checks.push(worst(&Kind::WINDOW, answer, &accuracy.errors.of_kind(|errors| errors.window)));
    }
    if accuracy.errors.torque.modes.is_some() {
        let left_out = accuracy.errors.of_kind(|errors| errors.modes.unwrap_or(0.0));
        checks.push(worst(&Kind::MODES, answer, &left_out));
    }
    if accuracy.errors.torque.iteration.is_some() {
        let iteration = accuracy.errors.of_kind(|errors| errors.iteration.unwrap_or(0.0));
        checks.push(worst(&Kind::ITERATION, answer, &iteration));
    }
    checks.extend([dense_transfer(answer), energy]);
    checks.extend(accuracy.tip_model.map(|strays| Kind::MODEL.measured(answer, strays)));
    let reached = reached(*solution, &[**limits]);
    checks.extend(reached.iter().map(|reached| within(answer, reached)));
    Ok(Verification { checks })
}

impl Verification {
    /// The checks that are beyond their bounds.
    pub fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.fails())
    }
}

/// The check of the quantity with the largest error.
fn worst(kind: &Kind, answer: &Answer, errors: &PerQuantity<f64>) -> Check {
    let (quantity, error) = errors.worst();
    let check = kind.measured(answer, error);
    // Of a link with weight errors are shares of ranges.
    let has_weight = answer.solution.link().has_weight();
    let of = if has_weight && check.of == PEAK { RANGE } else { check.of };
    of_quantity(quantity, Check { of, ..check })
}

/// The check under the name of a quantity, in words that fit the column.
fn of_quantity(quantity: Quantity, check: Check) -> Check {
    let name = match quantity {
        Quantity::HubAcceleration => "hub accel.",
        Quantity::BendingMoment => "moment",
        _ => quantity.name(),
    };
    let of = match (quantity, check.of) {
        (Quantity::Torque, PEAK) => "the peak torque",
        (Quantity::Torque, RANGE) => "the torque's range",
        (_, of) => of,
    };
    Check { what: format!("{name} {}", check.what), of, ..check }
}

/// The check of one limit of the link file: the value with its estimated error, over the limit.
fn within(answer: &Answer, reached: &Reached) -> Check {
    let check = Kind::LIMIT.measured(answer, reached.share());
    let key = reached.value.key;
    Check { name: format!("{}_{key}", check.name), what: format!("{}.{key}", check.what), ..check }
}

/// Change of the hub's torque, and of the motor's where there is a drive, with the motion sampled
/// twice as often.
fn with_the_step_halved(answer: &Answer) -> Result<Vec<Check>, VerificationError> {
    let Answer { solution, memory_bytes, .. } = *answer;
    let resources = Resources { memory_bytes, ..Resources::default() };
    let finer = torques_over_window(solution, &solution.motion.twice_as_often()?, &resources)?;
    let change = torque_change(&solution.torque_n_m, &finer.hub_n_m, 2, solution.link());
    let torque = Kind::STEP.measured(answer, change);
    let motor = motor_change(solution, finer.motor_n_m.as_deref());
    let motor = motor.map(|change| Kind::STEP_OF_MOTOR.measured(answer, change));
    Ok(std::iter::once(torque).chain(motor).collect())
}

/// Largest change of the motor's torque over its peak; none without a drive.
///
/// Taken at the worst sample, since the motor must turn its rotor through that spike too.
fn motor_change(solution: &Solution, finer: Option<&[f64]>) -> Option<f64> {
    // The inversion has measured it where the step limits the band.
    let measured = solution.accuracy.errors.motor_torque.and_then(|errors| errors.step);
    measured.or_else(|| {
        let (own, finer) = (&solution.motor.as_ref()?.torque_n_m, finer?);
        let pairs = own.iter().zip(finer.iter().step_by(2));
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, |most: f64, change| {
            if change.is_nan() || change > most { change } else { most }
        });
        Some(most / largest(finer))
    })
}

/// The transfer from tip to torque against the paper's dense system, at frequencies around the first
/// modes.
fn dense_transfer(answer: &Answer) -> Check {
    let (kind, solution) = (Kind::DENSE, answer.solution);
    if solution.model.kept_modes() != KeptModes::All {
        return kind.not_measured("the link is reduced to few modes");
    }
    let elements = solution.mesh().elements().len();
    if elements > MOST_ELEMENTS_OF_DENSE_SOLVE {
        return kind.not_measured(format!(
            "{elements} elements, more than the {MOST_ELEMENTS_OF_DENSE_SOLVE} that are factorised"
        ));
    }
    let Some(dense) = Dense::assemble(solution.model.on_mesh().clone()) else {
        return kind.not_measured("its modes are no finite numbers");
    };
    let modes = solution.natural_frequencies_rad_s(REPORTED_MODES);
    let first = modes.first().copied().unwrap_or(TAU / solution.band.period_s);
    let (low, high) = (0.3 * first, 3.0 * modes.last().copied().unwrap_or(first));
    let (mut worst, mut bound) = (0.0_f64, (kind.bound)(answer));
    for k in 0..FREQUENCIES {
        // The odd offset keeps these off the poles and zeros of an undamped link.
        let omega = low * libm::pow(high / low, (k as f64 + 0.37) / FREQUENCIES as f64);
        let exact = solution.model.tip_transfer(omega).inertia_kg_m;
        let found = dense.tip_transfer(omega).inertia_kg_m;
        let apart = magnitude(found - exact) / magnitude(exact);
        // Unlike the larger of two numbers, NaN stays.
        worst = if apart.is_nan() || apart > worst { apart } else { worst };
        bound = bound.max(dense.round_off(omega));
    }
    if bound > SPOILT {
        return kind.not_measured(format!("its round-off may be {bound:.1e}"));
    }
    // Round-off has other digits on every processor: a difference within the bound counts as the bound.
    kind.measured_to(if worst <= bound { bound } else { worst }, bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_has_the_name_of_its_quantity() {
        let of = |quantity| of_quantity(quantity, Kind::MESH.measured_to(0.0, 1.0));
        let motor = of(Quantity::MotorTorque);
        assert_eq!((&*motor.what, motor.of), ("motor torque with elements halved", "its peak"));
        assert_eq!(of(Quantity::HubAcceleration).what, "hub accel. with elements halved");
        let torque = of(Quantity::Torque);
        assert_eq!((&*torque.what, torque.of), ("torque with elements halved", "the peak torque"));
    }
}
