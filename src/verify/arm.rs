//! The torques of an arm, measured by other means.

use super::Verification;
use super::check::{Check, Kind};
use crate::beam::{ElementCount, MeshPlan};
use crate::elastica::SecondOrder;
use crate::inverse::{Analysis, ArmSolution, PerQuantity, QuantityErrors, Resources, invert_arm};
use crate::link::{Arm, ArmLink, ArmParts, Damping, Link, LinkParts, ParameterError};
use crate::numeric::{Size, extremes};
use crate::response::PlayedArm;
use crate::result::{LimitedValue, Limits, Metrics};
use crate::text::significant;

/// What an error of the joints' motion, a share of their ranges, may at most become of the tip's way.
const AMPLIFIED: f64 = 10.0;

/// What a torque that hardly changes is measured by, over the largest range of any.
const LEAST_SIZE: f64 = 1e-6;

/// Factor on the stiffness with which links do not bend.
const RIGID: f64 = 1e9;

/// A solution, the plans of its meshes and its limits, and its torques as written.
#[derive(Clone, Copy)]
pub struct ArmAnswer<'a> {
    /// The plans of its meshes.
    pub plans: &'a [MeshPlan],
    /// The limits of each joint, its link and its motor.
    pub limits: &'a [Limits],
    /// The solution.
    pub solution: &'a ArmSolution,
    /// Memory in bytes that the checks may take; `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// The torques in N m, rounded as in their file.
    pub written_torques_n_m: &'a [Vec<f64>],
}

/// Checks the torques of an arm by other means:
///
/// - its joints, moved as solved by Lagrange's equations: where the tip goes, which torques that takes, at rest and in
///   motion, and the balance of energy;
/// - the torques with elements halved, at the window's edge, with further iterations, with the step halved;
/// - links that do not bend, against the rigid arm's torques;
/// - the limits.
pub fn verify_arm(answer: &ArmAnswer<'_>) -> Verification {
    let ArmAnswer { plans, solution, .. } = *answer;
    let analysis = &solution.analysis;
    let mut checks = moved(answer);
    let is_automatic = plans.iter().any(MeshPlan::is_automatic);
    let tolerance = MeshPlan::smallest_tolerance(plans);
    let mesh = if is_automatic { tolerance } else { Kind::CHOSEN_MESH };
    checks.push(worst(&Kind::MESH, solution, |own| Some(own.mesh), mesh));
    checks.push(worst(&Kind::WINDOW, solution, |own| Some(own.window), analysis.tolerance()));
    if solution.findings.order != SecondOrder::None {
        checks.push(worst(&Kind::ITERATION, solution, |own| own.iteration, analysis.tolerance()));
    }
    if solution.errors.iter().any(|own| own.torque.step.is_some()) {
        checks.push(worst(&Kind::STEP, solution, |own| own.step, Kind::CHOSEN_MESH));
    }
    checks.push(rigid(solution, answer.memory_bytes));
    checks.extend(limits(answer));
    Verification { checks }
}

/// The joints moved as solved.
fn moved(answer: &ArmAnswer<'_>) -> Vec<Check> {
    let solution = answer.solution;
    let tolerance = solution.analysis.tolerance();
    let played = solution.moved();
    let unsettled = |played: &PlayedArm| played.change[0] > tolerance * solution.way_m;
    let played = match played {
        Ok(played) if !unsettled(&played) => played,
        refused => {
            let reason = match refused {
                Ok(played) => {
                    let change = significant(played.change[0] / solution.way_m, 2);
                    format!("the last refinement moves the tip by {change} of its way")
                }
                Err(error) => error.to_string(),
            };
            return [Kind::TIP_OF_JOINTS, Kind::ENERGY]
                .map(|kind| kind.not_measured(reason.clone()))
                .into();
        }
    };
    let stated = stated(solution);
    let allowed = AMPLIFIED * (stated + tolerance);
    let most = extremes_of(&played.torques_n_m);
    let tip_tolerance = solution.analysis.tip_tolerance().max(solution.tip_error);
    let tip = Kind::TIP_OF_JOINTS
        .measured_to(solution.tip_error_of(&played), tip_tolerance + allowed.min(Kind::MOST_TIP));
    let mut checks = vec![tip];
    for (number, (written, needed)) in
        answer.written_torques_n_m.iter().zip(&played.torques_n_m).enumerate()
    {
        let (change, at_rest) = apart(written, needed, (solution.arm.has_weight(), most));
        let of_joint = |kind: Kind, found: f64, bound: f64| {
            let check = kind.measured_to(found, bound);
            let name = format!("{}{}", check.name, number + 1);
            Check { name, what: format!("{} {}", check.what, number + 1), ..check }
        };
        let bound = Kind::MOST_TORQUE.max(allowed.min(Kind::CHOSEN_MESH));
        checks.push(of_joint(Kind::TORQUE_OF_JOINT, change, bound));
        checks.push(of_joint(Kind::TORQUE_AT_REST, at_rest, bound));
    }
    checks.push(Kind::ENERGY.measured_to(played.imbalance(), Kind::MOST_ENERGY));
    checks
}

/// The largest error that the solution states of a joint's motion.
fn stated(solution: &ArmSolution) -> f64 {
    let of = |own: &QuantityErrors| {
        own.mesh + own.window + own.step.unwrap_or(0.0) + own.iteration.unwrap_or(0.0)
    };
    let of_joint = |errors: &PerQuantity<QuantityErrors>| {
        let acceleration = errors.hub_acceleration.map_or(0.0, |own| of(&own));
        Size::larger(of(&errors.hub_angle), acceleration)
    };
    solution.errors.iter().map(of_joint).fold(0.0, Size::larger)
}

/// The largest range of any of some torques.
fn extremes_of(torques_n_m: &[Vec<f64>]) -> f64 {
    let ranges = torques_n_m.iter().map(|torque| {
        let [low, high] = extremes(torque);
        high - low
    });
    ranges.fold(0.0, Size::larger)
}

/// How far a torque is from the needed one, root mean square over root mean square, without what holds a weight; and at
/// rest, over its range. What hardly changes is measured by `most`, the largest range of any.
fn apart(written: &[f64], needed: &[f64], (has_weight, most): (bool, f64)) -> (f64, f64) {
    let least = LEAST_SIZE * most;
    let mean = needed.iter().sum::<f64>() / needed.len() as f64;
    let held = if has_weight { mean } else { 0.0 };
    let pairs = || written.iter().zip(needed);
    let off: f64 = pairs().map(|(a, b)| (a - b) * (a - b)).sum();
    let whole: f64 = needed.iter().map(|b| (b - held) * (b - held)).sum();
    let [low, high] = extremes(needed);
    let ends = [0, needed.len() - 1].map(|k| (written[k] - needed[k]).abs());
    let size = whole.sqrt().max(least * (needed.len() as f64).sqrt());
    (off.sqrt() / size, ends[0].max(ends[1]) / (high - low).max(least))
}

/// The check of the joint with the largest error.
fn worst(
    kind: &Kind,
    solution: &ArmSolution,
    of: impl Fn(&QuantityErrors) -> Option<f64>,
    bound: f64,
) -> Check {
    let found = solution.worst(|own| of(own).unwrap_or(0.0));
    let check = kind.measured_to(found, bound);
    let of = if solution.arm.has_weight() { "its range" } else { "its peak" };
    Check { what: format!("all joints {}", check.what), of, ..check }
}

/// The same path with links that do not bend, against the torques of the rigid arm.
fn rigid(solution: &ArmSolution, memory_bytes: Option<usize>) -> Check {
    let kind = Kind::RIGID_ARM;
    let stiff = |own: &ArmLink| {
        let mut parts = LinkParts::from(own.link.clone());
        for segment in &mut parts.segments {
            segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(RIGID);
        }
        let link = Link::new(LinkParts { damping: Damping::None, drive: None, ..parts })?;
        let each = vec![None; link.segments().len()];
        let pieces = ElementCount::Total(link.segments().len() + link.masses().len());
        let plan = MeshPlan::new(&link, &each, Some(pieces), MeshPlan::DEFAULT_TOLERANCE)?;
        Ok::<_, ParameterError>((ArmLink { name: own.name.clone(), link }, plan))
    };
    let links: Result<Vec<_>, _> = solution.arm.links().iter().map(stiff).collect();
    let arm = links.and_then(|links| {
        let (links, plans): (Vec<_>, Vec<_>) = links.into_iter().unzip();
        let parts = ArmParts {
            title: String::new(),
            links,
            gravity_m_s2: solution.arm.gravity_m_s2(),
            elbow: solution.arm.elbow(),
        };
        Ok((Arm::new(parts)?, plans))
    });
    let linear = solution.analysis.with_second_order(SecondOrder::None);
    let found = arm
        .map_err(|error| error.to_string())
        .and_then(|(arm, plans)| found_rigid(&arm, &plans, solution, (&linear, memory_bytes)));
    match found {
        Ok(found) => kind.measured_to(found, Kind::MOST_RIGID),
        Err(reason) => kind.not_measured(reason),
    }
}

fn found_rigid(
    arm: &Arm,
    plans: &[MeshPlan],
    solution: &ArmSolution,
    (linear, memory_bytes): (&Analysis, Option<usize>),
) -> Result<f64, String> {
    let resources = Resources { memory_bytes, ..Resources::default() };
    let found = invert_arm(arm, plans, &solution.path, linear, &resources);
    let found = found.map_err(|error| error.to_string())?;
    let rigid: Vec<Vec<f64>> =
        found.joints.iter().map(|joint| joint.rigid_torque_n_m.clone()).collect();
    let least = LEAST_SIZE * extremes_of(&rigid);
    let off = found.joints.iter().map(|joint| {
        let pairs = joint.torque_n_m.iter().zip(&joint.rigid_torque_n_m);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, Size::larger);
        let [low, high] = extremes(&joint.rigid_torque_n_m);
        off / (high - low).max(least)
    });
    Ok(off.fold(0.0, Size::larger))
}

/// The checks of the limits: each value over its limit.
fn limits(answer: &ArmAnswer<'_>) -> Vec<Check> {
    let reached = Metrics::of(answer.solution).limited(answer.limits);
    let check = |value: &LimitedValue| {
        let joint = value.joint.unwrap_or_default();
        let check = Kind::LIMIT.measured_to(value.found / value.limit, 1.0);
        let (name, number) = (format!("{}{}_{}", check.name, joint + 1, value.key), joint + 1);
        Check { name, what: format!("joint {number} {}.{}", check.what, value.key), ..check }
    };
    reached.iter().map(check).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::Outcome;

    #[test]
    fn a_torque_that_is_off_is_seen_in_motion_and_at_rest() {
        let needed: Vec<f64> = (0..101).map(|k| 5.0 + f64::from(k * (100 - k)) / 2500.0).collect();
        let (change, at_rest) = apart(&needed, &needed, (true, 1.0));
        assert!(change < 1e-15 && at_rest < 1e-15);
        let off: Vec<f64> = needed.iter().map(|t| t + 0.01).collect();
        let (change, at_rest) = apart(&off, &needed, (true, 1.0));
        assert!((at_rest - 0.01).abs() < 1e-12 && change > 0.03, "{change} {at_rest}");
        let check = Kind::TORQUE_AT_REST.measured_to(at_rest, Kind::MOST_TORQUE);
        assert!(check.fails() && matches!(check.outcome, Outcome::Measured { .. }));
    }
}
