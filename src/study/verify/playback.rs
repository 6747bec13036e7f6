//! The written torque, played on the link, and joints moved as solved.

use std::error::Error;

use super::check::{Answer, Unplayed, VerificationError};
use super::check::{CHOSEN, Kind, STRAYS};
use crate::elastica::SecondOrder;
use crate::inverse::{Resources, Solution, invert_motion, size};
use crate::link::{Damping, Link, LinkParts};
use crate::modal::held_frequencies;
use crate::motion::{ArmPath, Ends, Motion, TipMotion, TipTarget};
use crate::numeric::{Size, TimeGrid, largest, largest_difference};
use crate::response::{
    EnergyAccount, EnergyBalance, HubReference, Interpolation, Play, Played, SimulationError,
    State, Torque, simulate_on,
};
use crate::result::Check;
use crate::text::significant;

/// Error of the integrals of work above which a balance of energy is void.
const QUADRATURE: f64 = 1e-3;

/// Number of times for the sums of energy.
const BALANCES: usize = 64;

/// Largest ratio of the tip's error, over its travel, to the error of a joint's motion, over its range. The solution
/// states the error of the worst sample already.
const AMPLIFIED: f64 = 10.0;

/// Largest ratio of the error of a link's tip, and of the torque of its moved hub, to the change of the torque by omitted
/// terms, over its range; the largest ratios of slender links of first order were 1.3 and 2.
const OF_MODEL: f64 = 3.0;

/// Least divisor for errors of a joint's torque, over the largest range of any joint's torque.
pub(super) const LEAST_SIZE: f64 = 1e-6;

/// The checks that follow from playing the torque.
pub(super) struct PlayedChecks {
    pub(super) tip: Vec<Check>,
    pub(super) energy: Check,
}

/// A link or an arm with its joints moved as solved.
struct Moved {
    tip_error: f64,
    torques_n_m: Vec<Vec<f64>>,
    energy: Check,
}

/// Plays the written torque, or moves the joints as solved. Returns the errors of the tip, with those of the solved
/// tip, and the balance of energy.
pub(super) fn played(answer: &Answer) -> Result<PlayedChecks, VerificationError> {
    let solution = answer.solution;
    let (played, unplayed) = match &solution.motion {
        Motion::Tip(motion) => (played_link(answer, motion), Kind::TIP_ERROR),
        Motion::Path(_) => (moved(answer, Kind::OF_JOINTS), Kind::TIP_OF_JOINTS),
    };
    let PlayedChecks { mut tip, energy } = match played {
        Ok(played) => played,
        Err(Unplayed::Reason(reason)) => PlayedChecks {
            tip: vec![unplayed.not_measured(&*reason)],
            energy: Kind::ENERGY.not_measured(reason),
        },
        Err(Unplayed::Error(error)) => return Err(error),
    };
    // Without a cut-off the solver uses all frequencies of the samples.
    if let Some(motion) = solution.motion.tip().filter(|_| answer.tip_tolerance() > 0.0) {
        let wanted = wanted_tip(solution, motion);
        let error = tip_error(solution, &wanted, &solution.tip[0].displacement_m);
        tip.push(Kind::TIP_SOLVED.measured(answer, error));
    }
    Ok(PlayedChecks { tip, energy })
}

/// Plays a link of a solution as it starts to follow its motion.
pub(super) fn simulated(solution: &Solution, play: &Play<'_>) -> Result<Played, VerificationError> {
    let (link, initial) = (&solution.links[0], initial(solution));
    let play = Play { state: initial.as_ref(), ..*play };
    Ok(simulate_on(link.link(), link.mesh().clone(), &play)?)
}

/// The undeformed link at the first row, unless it rests there.
pub(super) fn initial(solution: &Solution) -> Option<State> {
    let (link, tip) = (solution.links[0].link(), &solution.tip[0]);
    let motion = [tip.displacement_m[0], tip.velocity_m_s[0]].map(|own| own / link.rigid_tip());
    let state = || State::undeformed(link, solution.grid.time_s(0), motion);
    (solution.motion.ends() == Ends::Moving).then(state)
}

/// A play of a torque on a link at rest as it starts to follow its motion.
pub(super) fn under_torque<'a>(
    (solution, motion): (&Solution, &TipMotion),
    torque: &'a Torque,
    interpolation: Interpolation,
    memory_bytes: Option<usize>,
) -> Play<'a> {
    Play {
        interpolation,
        initial_tip_m: solution.tip[0].displacement_m[0],
        memory_bytes,
        is_large: solution.second_order.is_some(),
        cycle_turn_rad: motion.turn_of_cycle_rad(solution.links[0].link().rigid_tip()),
        ..Play::of(torque)
    }
}

/// A torque on a grid.
pub(super) fn torque_on(grid: &TimeGrid, torque_n_m: &[f64]) -> Result<Torque, VerificationError> {
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    Ok(Torque::new(&time_s, torque_n_m.to_vec())?)
}

/// Plays the written torque on a link, or moves its hub.
fn played_link(answer: &Answer, motion: &TipMotion) -> Result<PlayedChecks, Unplayed> {
    let (solution, written_n_m) = (answer.solution, &answer.written_torques_n_m[0]);
    let (link, ends) = (solution.links[0].link(), motion.ends());
    let ratio = match link.damping() {
        Damping::Hysteretic { ratio } if *ratio > 0.0 => Some(*ratio),
        _ => None,
    };
    match ratio {
        Some(_) if ends == Ends::Moving => {
            return Err("hysteretic damping has no state for a tip that moves at first".into());
        }
        Some(ratio) if solution.second_order.is_some() => {
            return played_viscous(answer, ratio);
        }
        None if solution.second_order.is_some() => return moved(answer, Kind::OF_HUB),
        _ => {}
    }
    let torque = torque_on(&solution.grid, written_n_m)?;
    let play = under_torque((solution, motion), &torque, Interpolation::Cubic, answer.memory_bytes);
    let simulation = simulated(solution, &play)?;
    let Some(modes) = simulation.modes() else { return moved(answer, Kind::OF_HUB) };
    let straight_m = modes.straight_tip_m(written_n_m);
    let between_m = largest_difference(&simulation.tip[0].displacement_m, &straight_m);
    let bound = allowed_tip_error(answer, solution, between_m);
    let wanted = wanted_tip(solution, motion);
    let error = |tip_m: &[f64]| tip_error(solution, &wanted, tip_m);
    let played_m = &simulation.tip[0].displacement_m;
    let tip = if let Some(ratio) = ratio {
        // Under the viscous law the tip misses the wanted motion by far more than any useful bound. The amount is
        // computable, and the tip less this amount must follow the wanted motion.
        let apart_m = modes.apart_m(ratio, &solution.tip[0].acceleration_m_s2);
        let is_cycle = ends == Ends::Periodic;
        // Both start with the tip: the rigid rotation differs between the laws.
        let start_m = if is_cycle { apart_m[0] } else { 0.0 };
        let less = played_m.iter().zip(&apart_m).map(|(v, apart)| v - apart + start_m);
        let viscous = Kind::TIP_ERROR_VISCOUS.measured_to(error(&less.collect::<Vec<_>>()), bound);
        let own = || {
            let tip_m = modes.hysteretic_tip_m(ratio, &net_torque(written_n_m, solution));
            Kind::TIP_ERROR.measured_to(error(&tip_m), bound)
        };
        (!is_cycle).then(own).into_iter().chain([viscous]).collect()
    } else {
        vec![Kind::TIP_ERROR.measured_to(error(played_m), bound)]
    };
    Ok(PlayedChecks { tip, energy: energy(answer, &simulation) })
}

/// The check of a simulation's balance of energy.
fn energy(answer: &Answer, simulation: &Played) -> Check {
    let (imbalance, quadrature) = imbalance(simulation);
    if quadrature > QUADRATURE {
        Kind::ENERGY.not_measured("the step is too long to add up work")
    } else {
        Kind::ENERGY.measured_to(imbalance, (Kind::ENERGY.bound)(answer).max(quadrature))
    }
}

/// Solves the link again with viscous damping of the same ratio in its first mode with the hub held, and moves the
/// hub of this solution. Viscous damping has an equation in time, so the play includes weight and second order. It
/// omits the written torque, because the transfer contains its law of damping.
fn played_viscous(answer: &Answer, ratio: f64) -> Result<PlayedChecks, Unplayed> {
    let solution = answer.solution;
    let Some(&first_rad_s) = held_frequencies(solution.links[0].mesh(), f64::INFINITY, 1).first()
    else {
        return Err("hysteretic damping has no equation in time, and no mode".into());
    };
    let damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2.0 * ratio / first_rad_s };
    let resources = Resources { memory_bytes: answer.memory_bytes, ..Resources::default() };
    let unsolved = |error: &dyn Error| Unplayed::Reason(format!("with viscous damping: {error}"));
    let link = Link::new(LinkParts { damping, ..solution.links[0].link().clone().into() });
    let link = link.map_err(|error| unsolved(&error))?;
    let viscous =
        invert_motion(&link.into(), answer.plans, &solution.motion, &solution.analysis, &resources);
    let viscous = viscous.map_err(|error| unsolved(&error))?;
    let written_torques_n_m = std::slice::from_ref(&viscous.hub().torque_n_m);
    let answer = Answer { solution: &viscous, written_torques_n_m, ..*answer };
    let PlayedChecks { tip, energy } = moved(&answer, Kind::OF_HUB_VISCOUS)?;
    let (name, what) = ("energy_viscous".to_owned(), "energy, viscous damping".to_owned());
    Ok(PlayedChecks { tip, energy: Check { name, what, ..energy } })
}

/// Moves the joints as solved, by other equations than the inversion's: error of the tip, the needed torques against
/// the written ones, and the balance of energy.
///
/// Torques would let a link or an arm with weight fall from an upright pose; moved joints do not.
fn moved(answer: &Answer, [tip, torque]: [Kind; 2]) -> Result<PlayedChecks, Unplayed> {
    let solution = answer.solution;
    let Moved { tip_error, torques_n_m, energy } = match &solution.motion {
        Motion::Tip(motion) => moved_link(answer, motion)?,
        Motion::Path(path) => moved_arm(answer, path)?,
    };
    let stated = solution.joints.iter().map(|joint| {
        joint.errors.of_kind(|of| {
            of.mesh + of.window + of.step.unwrap_or(0.0) + of.iteration.unwrap_or(0.0)
        })
    });
    let stated: Vec<_> = stated.collect();
    let of_motion = stated.iter().fold(0.0, |most: f64, own| {
        most.larger(own.hub_angle).larger(own.hub_acceleration.unwrap_or(0.0))
    });
    let allowed = |stated: f64| AMPLIFIED * (stated + solution.analysis.tolerance());
    let bound = (tip.bound)(answer).min(answer.tip_tolerance() + allowed(of_motion));
    // The play has all terms. Of an answer of first order it measures those left out, too. Where the solution states their
    // effect on the torque, the checks allow it.
    let first = solution.second_order.filter(|found| found.order == SecondOrder::First);
    let left_out = first.and_then(|found| found.left_out).flatten();
    let model = |times: f64| left_out.map_or(0.0, |share| (times * share).min(STRAYS));
    let with_left_out = |check: Check| match left_out {
        Some(_) => Check { of: check.of + ", terms left out", ..check },
        None => check,
    };
    let mut checks = vec![with_left_out(tip.measured_to(tip_error, bound + model(OF_MODEL)))];
    let least_n_m = LEAST_SIZE * largest_range(&torques_n_m);
    let size = (solution.arm.has_weight(), least_n_m);
    let joints = answer.written_torques_n_m.iter().zip(&torques_n_m).zip(&stated);
    for (number, ((written, needed), stated)) in (1..).zip(joints) {
        let change = torque_change(written, needed, 1, size);
        let least = (torque.bound)(answer);
        if solution.arm.alone().is_some() {
            let bound = least.max(allowed(stated.torque)) + model(OF_MODEL);
            checks.push(with_left_out(torque.measured_to(change, bound)));
            continue;
        }
        let bound = least.max(allowed(of_motion).min(CHOSEN)) + model(AMPLIFIED);
        let at_rest = change_at_rest(written, needed, least_n_m);
        let is_cycle = solution.motion.ends() == Ends::Periodic;
        let at_rest = (!is_cycle).then_some((Kind::TORQUE_AT_REST, at_rest));
        for (kind, found) in [(torque, change)].into_iter().chain(at_rest) {
            let check = with_left_out(kind.measured_to(found, bound));
            let name = format!("{}{number}", check.name);
            checks.push(Check { name, what: format!("{} {number}", check.what), ..check });
        }
    }
    Ok(PlayedChecks { tip: checks, energy })
}

/// Moves the hub of a link.
fn moved_link(answer: &Answer, motion: &TipMotion) -> Result<Moved, Unplayed> {
    let (solution, link) = (answer.solution, answer.solution.links[0].link());
    let (grid, wanted) = (solution.grid, wanted_tip(solution, motion));
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let hub = HubReference::new(&time_s, solution.hub().angle_rad.clone(), None)?;
    let play = Play {
        memory_bytes: answer.memory_bytes,
        is_large: true,
        cycle_turn_rad: motion.turn_of_cycle_rad(link.rigid_tip()),
        start_angle_rad: wanted.start_angle_rad(),
        ..Play::turning(&hub)
    };
    let simulation = simulate_on(link, solution.links[0].mesh().clone(), &play);
    let simulation = simulation.map_err(|error| match error {
        SimulationError::NotConverged { .. } => "the motion of its hub does not converge".into(),
        SimulationError::Cycle(_) => "the link does not settle".into(),
        error => Unplayed::from(error),
    })?;
    let tip_error = tip_error(solution, &wanted, &simulation.tip[0].displacement_m);
    let energy = energy(answer, &simulation);
    Ok(Moved { tip_error, torques_n_m: torques_n_m(simulation), energy })
}

/// Moves the joints of an arm.
fn moved_arm(answer: &Answer, path: &ArmPath) -> Result<Moved, Unplayed> {
    let (solution, travel_m) = (answer.solution, answer.solution.tip_travel_m());
    let moved = solution.moved().map_err(|error| Unplayed::Reason(error.to_string()))?;
    if moved.change()[0] > solution.analysis.tolerance() * travel_m {
        let change = significant(moved.change()[0] / travel_m, 2);
        let reason = format!("the last refinement moves the tip by {change} of its travel");
        return Err(Unplayed::Reason(reason));
    }
    Ok(Moved {
        tip_error: solution.tip_error_of(&moved, path),
        energy: Kind::ENERGY_OF_ARM.measured(answer, moved.imbalance()),
        torques_n_m: torques_n_m(moved),
    })
}

/// The torque of each joint in N m.
fn torques_n_m(played: Played) -> Vec<Vec<f64>> {
    played.joints.into_iter().map(|joint| joint.torque_n_m).collect()
}

/// Allowed error of the played tip over its travel, at most 1e-3 or the tolerance.
///
/// It has three parts. A constant torque of the tolerance times the peak drives the rigid link over the window. Cubics and
/// straight lines through the samples differ by `between_m`. The analysis has a tolerance of the tip.
fn allowed_tip_error(answer: &Answer, solution: &Solution, between_m: f64) -> f64 {
    let (link, analysis) = (solution.links[0].link(), &solution.analysis);
    let peak = largest(&solution.hub().torque_n_m);
    let acceleration = analysis.tolerance() * peak * link.rigid_tip() / link.rigid_inertia_kg_m2();
    let driven_m = 0.5 * acceleration * solution.grid.duration_s().powi(2);
    let played = (driven_m + between_m) / solution.tip_travel_m();
    (Kind::TIP_ERROR.bound)(answer).min(analysis.tip_tolerance() + played)
}

/// The written torque less the hub's friction.
fn net_torque(written_n_m: &[f64], solution: &Solution) -> Vec<f64> {
    let friction = solution.links[0].link().joint().friction();
    let samples = written_n_m.iter().zip(&solution.hub().rate_rad_s);
    samples.map(|(t, rate)| t - friction * rate).collect()
}

/// The wanted motion over the window of a solution.
pub(super) fn wanted_tip(solution: &Solution, motion: &TipMotion) -> TipTarget {
    motion.target(solution.grid.time_s(0), solution.grid.end_s())
}

/// Largest error of a tip against the wanted motion, over its travel.
fn tip_error(solution: &Solution, wanted: &TipTarget, tip_m: &[f64]) -> f64 {
    largest_difference(tip_m, wanted.displacement_m()) / solution.tip_travel_m()
}

/// Largest imbalance of energy, and the error of its integrals, both over the largest energy in the
/// link.
fn imbalance(simulation: &Played) -> (f64, f64) {
    let EnergyAccount { balances, start_j, quadrature_error_j } = simulation.energy(BALANCES);
    let held = |b: &EnergyBalance| b.kinetic_j + b.strain_j;
    // The energy of a link with weight may fall below its value at the start.
    let largest = balances.iter().fold(0.0_f64, |m, b| m.max(held(b).abs()).max(b.kinetic_j));
    let missing = balances.iter().map(|b| (b.work_j - (held(b) - start_j) - b.dissipated_j).abs());
    let missing = missing.fold(0.0, f64::max);
    (missing / largest, quadrature_error_j / largest)
}

/// Largest value less the smallest.
pub(super) fn range(torque_n_m: &[f64]) -> f64 {
    size(torque_n_m, true)
}

/// The largest range of several torques.
pub(super) fn largest_range<'a>(torques_n_m: impl IntoIterator<Item = &'a Vec<f64>>) -> f64 {
    torques_n_m.into_iter().map(|torque_n_m| range(torque_n_m)).fold(0.0, Size::larger)
}

/// Change of the torque against one with `often` times the samples, root mean square over root mean square. For a
/// torque that hardly changes, the divisor is `least_n_m`.
///
/// The worst sample would not do. Where the acceleration of a motion has a kink at its begin or end, the torque has a
/// spike. The spike narrows with every shorter step, never converges, and hardly moves the link. The mean torque,
/// which holds a weight, does not count.
pub(super) fn torque_change(
    own: &[f64],
    finer: &[f64],
    often: usize,
    (has_weight, least_n_m): (bool, f64),
) -> f64 {
    let count = own.len() as f64;
    let held_n_m = if has_weight { own.iter().sum::<f64>() / count } else { 0.0 };
    let pairs = own.iter().zip(finer.iter().step_by(often));
    let (difference, whole) = pairs.fold((0.0, 0.0), |(difference, whole), (a, b)| {
        (difference + (a - b).powi(2), whole + (b - held_n_m).powi(2))
    });
    (difference / whole.max(count * least_n_m.powi(2))).sqrt()
}

/// Change of a torque at its ends, where it is at rest, over its range.
fn change_at_rest(written: &[f64], needed: &[f64], least_n_m: f64) -> f64 {
    let ends = [0, needed.len() - 1].map(|k| (written[k] - needed[k]).abs());
    ends[0].max(ends[1]) / range(needed).max(least_n_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{Hub, Link, LinkParts, uniform};
    use crate::response::simulate;

    #[test]
    fn work_that_is_nowhere_in_the_link_is_missed() {
        let hub = Hub { viscous_friction_n_m_s_rad: 0.1, ..uniform().hub };
        let damping = Damping::Hysteretic { ratio: 0.02 };
        let link = Link::new(LinkParts { hub, damping, ..uniform() }).unwrap();
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(10)), 1e-6).unwrap();
        let time_s: Vec<f64> = (0..=1000).map(|k| 1e-3 * f64::from(k)).collect();
        let sine = time_s.iter().map(|t| (std::f64::consts::TAU * t).sin().powi(3)).collect();
        let torque = Torque::new(&time_s, sine).unwrap();
        let (arm, play) = (link.into(), Play::of(&torque));
        let mut simulation = simulate(&arm, &[plan], &play, &|_| {}).unwrap();
        let (missing, quadrature) = imbalance(&simulation);
        assert!(missing < 1e-7 && quadrature < 1e-6, "{missing:e}, {quadrature:e}");
        for torque in &mut simulation.joints[0].torque_n_m {
            *torque *= 1.001;
        }
        let (missing, quadrature) = imbalance(&simulation);
        assert!(missing > 1e-4 && quadrature < 1e-6, "{missing:e}, {quadrature:e}");
    }

    #[test]
    fn a_torque_that_is_off_is_seen_in_motion_and_at_rest() {
        let needed: Vec<f64> = (0..101).map(|k| 5.0 + f64::from(k * (100 - k)) / 2500.0).collect();
        let apart = |written: &[f64]| {
            let change = torque_change(written, &needed, 1, (true, LEAST_SIZE));
            (change, change_at_rest(written, &needed, LEAST_SIZE))
        };
        let (change, at_rest) = apart(&needed);
        assert!(change < 1e-15 && at_rest < 1e-15);
        let off: Vec<f64> = needed.iter().map(|t| t + 0.01).collect();
        let (change, at_rest) = apart(&off);
        assert!((at_rest - 0.01).abs() < 1e-12 && change > 0.03, "{change} {at_rest}");
        let check = Kind::TORQUE_AT_REST.measured_to(at_rest, 1e-3);
        assert!(!check.passes && check.found.is_some());
    }
}
