//! Checks every approximation of a solution by other means, in the order of their display.

mod check;
mod playback;
mod table;

pub use check::{Answer, VerificationError};
pub use table::{TableError, Unknown, table_error};

use std::error::Error;
use std::f64::consts::TAU;

use serde::Serialize;

use crate::beam::{ElementCount, MeshPlan};
use crate::elastica::SecondOrder;
use crate::inverse::{PerQuantity, Quantity, QuantityErrors, Resources, Solution, invert_motion};
use crate::link::{Arm, ArmLink, ArmParts, Damping, Drive, Link, LinkParts};
use crate::modal::REPORTED_MODES;
use crate::model::{Dense, KeptModes, MOST_ELEMENTS_OF_DENSE_SOLVE, Model};
use crate::motion::{Ends, Motion, TipMotion};
use crate::numeric::{Size, largest, magnitude};
use crate::result::{Check, Reached};
use check::{Kind, PEAK, RANGE};
use playback::{LEAST_SIZE, PlayedChecks, largest_range, played, range, torque_change};

/// Number of frequencies for the dense system.
const FREQUENCIES: usize = 9;

/// Round-off of the dense solve above which the comparison is void.
const SPOILT: f64 = 1e-3;

/// Factor on the stiffness that makes links rigid.
const RIGID: f64 = 1e9;

/// The checks of a solution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verification {
    /// The checks, in the order of their display.
    pub checks: Vec<Check>,
}

/// Checks a solution by other means:
///
/// - the written torque, played on the link with its damping law and with viscous damping;
/// - with weight, at large angles and for an arm: the error of the tip and the torques of joints that move as solved;
/// - the solved tip of a link against the wanted motion;
/// - the torques with elements halved and with the step halved;
/// - the rest of the torques at the window's edge;
/// - the iteration of second-order terms, if they count;
/// - the transfer of a link against the paper's dense system at sample frequencies;
/// - an arm with rigid links against the rigid arm;
/// - the balance of energy;
/// - the tip of a link with all terms of second order, unless these count;
/// - the limits.
///
/// # Errors
/// [`VerificationError`].
pub fn verify(answer: &Answer) -> Result<Verification, VerificationError> {
    let PlayedChecks { tip: mut checks, energy } = played(answer)?;
    checks.extend(worst(&Kind::MESH, answer, |errors| Some(errors.mesh)));
    checks.extend(with_the_step_halved(answer)?);
    // A cycle has no edge.
    let has_edge = answer.solution.motion.ends() != Ends::Periodic;
    checks.extend(worst(&Kind::WINDOW, answer, |errors| has_edge.then_some(errors.window)));
    checks.extend(worst(&Kind::MODES, answer, |errors| errors.modes));
    checks.extend(worst(&Kind::ITERATION, answer, |errors| errors.iteration));
    let model = match &answer.solution.motion {
        Motion::Tip(_) => dense_transfer(answer, answer.solution),
        Motion::Path(_) => rigid_arm(answer),
    };
    checks.extend([model, energy]);
    let strays = answer.solution.tip_model_error;
    checks.extend(strays.map(|strays| Kind::MODEL.measured(answer, strays)));
    checks.extend(answer.reached().iter().map(|reached| within(answer, reached)));
    for check in &mut checks {
        word(check, &answer.solution.arm);
    }
    Ok(Verification { checks })
}

/// Gives a check the words of the joint and the output.
fn word(check: &mut Check, arm: &Arm) {
    let number = (arm.links().len() + 1).to_string();
    check.name = match arm.joints().nth(arm.links().len()) {
        Some(carriage) if check.name.contains(&number) => {
            check.of = carriage.worded(&check.of);
            let name = check.name.replace(&format!("joint{number}"), "carriage");
            carriage.named(&name.replace(&number, ""))
        }
        _ => arm.joint().named(&check.name),
    };
    for text in [&mut check.what, &mut check.of].into_iter().chain(&mut check.reason) {
        *text = arm.worded(text);
    }
}

impl Verification {
    /// The checks that are beyond their bounds.
    pub fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| !check.passes)
    }
}

/// The check of the largest error of a kind, over all quantities of all joints but the torques of motors with losses,
/// whose errors follow from those of torque and rate. `None` if the torque has no such error.
fn worst(
    kind: &Kind,
    answer: &Answer,
    of_kind: impl Fn(QuantityErrors) -> Option<f64>,
) -> Option<Check> {
    let links = answer.solution.arm.links().iter();
    let is_lossy = links.map(|own| own.link.drive().is_some_and(Drive::has_losses));
    let joints = answer.solution.joints.iter().zip(is_lossy.chain([false]));
    let joints = joints.map(|(joint, is_lossy)| PerQuantity {
        motor_torque: joint.errors.motor_torque.filter(|_| !is_lossy),
        ..joint.errors
    });
    let joints = joints.filter(|errors| of_kind(errors.torque).is_some());
    let each = joints.map(|errors| errors.of_kind(|own| of_kind(own).unwrap_or(0.0)).worst());
    let larger =
        |a: (Quantity, f64), b: (Quantity, f64)| if b.1 > a.1 || b.1.is_nan() { b } else { a };
    let (quantity, error) = each.reduce(larger)?;
    let of = if answer.solution.arm.has_weight() { RANGE } else { PEAK };
    let check = Check { of: of.to_owned(), ..kind.measured(answer, error) };
    let of_all = Check { what: format!("all joints {}", check.what), ..check.clone() };
    Some(answer.solution.arm.pick(of_quantity(quantity, check), of_all))
}

/// The check under the name of a quantity, in words that fit the column.
fn of_quantity(quantity: Quantity, check: Check) -> Check {
    let name = match quantity {
        Quantity::HubAcceleration => "hub accel.",
        Quantity::BendingMoment => "moment",
        _ => quantity.name(),
    };
    let of = match (quantity, &*check.of) {
        (Quantity::Torque, PEAK) => "the peak torque",
        (Quantity::Torque, RANGE) => "the torque's range",
        (_, of) => of,
    };
    Check { what: format!("{name} {}", check.what), of: of.to_owned(), ..check }
}

/// The check of one limit: the value with its measured error, over the limit.
fn within(answer: &Answer, reached: &Reached) -> Check {
    let check = Kind::LIMIT.measured(answer, reached.share());
    let key = reached.value.key;
    let (number, of_joint) = reached.value.joint.map_or_else(Default::default, |joint| {
        (format!("{}", joint + 1), format!("joint {} ", joint + 1))
    });
    let name = format!("{}{number}_{key}", check.name);
    Check { name, what: format!("{of_joint}{}.{key}", check.what), ..check }
}

/// Change of the torques with the motion sampled twice as often. A link is solved again, and its motor has a further
/// check. For an arm the inversion has measured the change if the step limits its band.
fn with_the_step_halved(answer: &Answer) -> Result<Vec<Check>, VerificationError> {
    let solution = answer.solution;
    let resources = Resources { memory_bytes: answer.memory_bytes, ..Resources::default() };
    let finer = solution.motion.tip().map(TipMotion::twice_as_often).transpose()?;
    let finer = finer.map(|finer| solution.torques_over_window(&finer, &resources)).transpose()?;
    let Some(finer) = finer.flatten() else {
        return Ok(worst(&Kind::STEP, answer, |errors| errors.step).into_iter().collect());
    };
    let size = (solution.arm.has_weight(), 0.0);
    let change = torque_change(&solution.hub().torque_n_m, &finer.hub_n_m, 2, size);
    let torque = of_quantity(Quantity::Torque, Kind::STEP.measured(answer, change));
    let motor = motor_change(solution, finer.motor_n_m.as_deref());
    let motor = motor.map(|change| Kind::STEP_OF_MOTOR.measured(answer, change));
    let motor = motor.map(|check| of_quantity(Quantity::MotorTorque, check));
    Ok(std::iter::once(torque).chain(motor).collect())
}

/// Largest change of the motor's torque over its peak. `None` without a drive.
///
/// The worst sample counts, since the motor must turn its rotor through each spike too.
fn motor_change(solution: &Solution, finer: Option<&[f64]>) -> Option<f64> {
    // The inversion has measured the change if the step limits the band.
    let measured = solution.hub().errors.motor_torque.and_then(|errors| errors.step);
    measured.or_else(|| {
        let (own, finer) = (&solution.hub().motor.as_ref()?.torque_n_m, finer?);
        let pairs = own.iter().zip(finer.iter().step_by(2));
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, Size::larger);
        Some(most / largest(finer))
    })
}

/// The transfer from tip to torque against the paper's dense system, at frequencies around the first
/// modes.
fn dense_transfer(answer: &Answer, solution: &Solution) -> Check {
    let (kind, model) = (Kind::DENSE, &solution.links[0].model);
    if model.kept_modes() != KeptModes::All {
        return kind.not_measured("the link is reduced to few modes");
    }
    let elements = solution.links[0].mesh().elements().len();
    if elements > MOST_ELEMENTS_OF_DENSE_SOLVE {
        return kind.not_measured(format!(
            "{elements} elements, more than the {MOST_ELEMENTS_OF_DENSE_SOLVE} that are factorised"
        ));
    }
    let Some(dense) = Dense::assemble(model.on_mesh().clone()) else {
        return kind.not_measured("its modes are no finite numbers");
    };
    let modes = solution.links[0].natural_frequencies_rad_s(REPORTED_MODES);
    let first = modes.first().copied().unwrap_or(TAU / solution.band.period_s);
    let (low, high) = (0.3 * first, 3.0 * modes.last().copied().unwrap_or(first));
    let (mut worst, mut bound) = (0.0_f64, (kind.bound)(answer));
    for k in 0..FREQUENCIES {
        // The odd offset avoids the poles and zeros of an undamped link.
        let omega = low * libm::pow(high / low, (k as f64 + 0.37) / FREQUENCIES as f64);
        let exact = model.tip_transfer(omega).inertia_kg_m;
        let found = dense.tip_transfer(omega).inertia_kg_m;
        let apart = magnitude(found - exact) / magnitude(exact);
        worst = Size::larger(worst, apart);
        bound = bound.max(dense.round_off(omega));
    }
    if bound > SPOILT {
        return kind.not_measured(format!("its round-off may be {bound:.1e}"));
    }
    // Round-off differs between processors, so a difference within the bound counts as the bound.
    kind.measured_to(if worst <= bound { bound } else { worst }, bound)
}

/// Torques of the same path with nearly rigid links against the torques of the rigid arm.
fn rigid_arm(answer: &Answer) -> Check {
    match rigid_arm_error(answer.solution, answer.memory_bytes) {
        Ok(apart) => Kind::RIGID_ARM.measured(answer, apart),
        Err(error) => Kind::RIGID_ARM.not_measured(error.to_string()),
    }
}

/// Largest difference of a torque from that of the rigid arm, over the range of the rigid arm's torque.
fn rigid_arm_error(
    solution: &Solution,
    memory_bytes: Option<usize>,
) -> Result<f64, Box<dyn Error>> {
    let (mut links, mut plans) = (Vec::new(), Vec::new());
    for ArmLink { name, link } in solution.arm.links() {
        let mut parts = LinkParts::from(link.clone());
        for segment in &mut parts.segments {
            segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(RIGID);
        }
        let link = Link::new(LinkParts { damping: Damping::None, drive: None, ..parts })?;
        let each = vec![None; link.segments().len()];
        let pieces = ElementCount::Total(link.segments().len() + link.masses().len());
        plans.push(MeshPlan::new(&link, &each, Some(pieces), MeshPlan::DEFAULT_TOLERANCE)?);
        links.push(ArmLink { name: name.clone(), link });
    }
    let arm = Arm::new(ArmParts {
        title: String::new(),
        links,
        gravity_m_s2: solution.arm.gravity_m_s2(),
        elbow: solution.arm.elbow(),
        carriage: solution.arm.carriage().copied(),
    })?;
    let linear = solution.analysis.with_second_order(SecondOrder::None);
    let resources = Resources { memory_bytes, ..Resources::default() };
    let stiff = invert_motion(&arm, &plans, &solution.motion, &linear, &resources)?;
    let joints = || stiff.joints.iter();
    let least = LEAST_SIZE * largest_range(joints().map(|joint| &joint.rigid_torque_n_m));
    let apart = joints().map(|joint| {
        let pairs = joint.torque_n_m.iter().zip(&joint.rigid_torque_n_m);
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, Size::larger);
        apart / range(&joint.rigid_torque_n_m).max(least)
    });
    Ok(apart.fold(0.0, Size::larger))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_has_the_name_of_its_quantity() {
        let of = |quantity| of_quantity(quantity, Kind::MESH.measured_to(0.0, 1.0));
        let motor = of(Quantity::MotorTorque);
        assert_eq!((&*motor.what, &*motor.of), ("motor torque with elements halved", "its peak"));
        assert_eq!(of(Quantity::HubAcceleration).what, "hub accel. with elements halved");
        let torque = of(Quantity::Torque);
        assert_eq!(
            (&*torque.what, &*torque.of),
            ("torque with elements halved", "the peak torque")
        );
    }
}
