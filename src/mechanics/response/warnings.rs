//! Warnings of simulated bent links.

use std::f64::consts::TAU;

use super::bent::BentMotion;
use super::error::{STEP_SHARE, SimulationWarning};
use super::history::{APART_RAD, Feedback};
use super::play::{Input, Play};
use super::played::PlayedLink;
use crate::link::Arm;
use crate::numeric::extremes;

/// Warning threshold of the imbalance of energy.
const IMBALANCE: f64 = 1e-3;

/// Warnings of a link with weight or at large angles, or of an arm.
pub(super) fn of_bent(
    arm: &Arm,
    play: &Play<'_>,
    motion: &BentMotion,
    first: &PlayedLink,
) -> Vec<SimulationWarning> {
    match (play.input, arm.links().len()) {
        (_, 1) => of_link(arm, play, motion, first),
        (Input::Torques(_), _) if play.cycle_turn_rad.is_none() => of_arm(arm, play, motion),
        _ => imbalance(motion).into_iter().collect(),
    }
}

fn of_link(
    arm: &Arm,
    play: &Play<'_>,
    motion: &BentMotion,
    link: &PlayedLink,
) -> Vec<SimulationWarning> {
    let hub = &motion.joints[0];
    let [begins, ends] = play.input.warnings(&hub.torque_n_m);
    let own = match (play.state, play.input) {
        _ if play.cycle_turn_rad.is_some() => [None; 3],
        (Some(_), _) => [None, ends.filter(|_| !arm.has_weight()), None],
        (None, Input::Torques([torque])) if arm.has_weight() => {
            let reference = play.feedback.first().map(Feedback::reference);
            let apart = reference.and_then(|reference| reference.apart(hub.angle_rad[0]));
            [unheld(motion, torque.torque_n_m()), None, apart]
        }
        (None, _) => [begins, ends, None],
    };
    let first_rad_s = link.natural_frequencies_rad_s.first().copied().unwrap_or(0.0);
    let period_s = (first_rad_s > 0.0).then(|| TAU / first_rad_s);
    // Bent links move until the end, so that the step always matters.
    let step_s = play.input.grid().step_s;
    let coarse = SimulationWarning::coarse_step(step_s, period_s);
    own.into_iter().chain([coarse, imbalance(motion)]).flatten().collect()
}

/// A warning of a torque that does not begin with the holding torque.
fn unheld(motion: &BentMotion, torque_n_m: &[f64]) -> Option<SimulationWarning> {
    let (holding_n_m, [low, high]) = (motion.joints[0].holding_n_m?, extremes(torque_n_m));
    let (first, range) = (torque_n_m[0], high - low);
    // Round-off holds a link that hangs straight.
    let least = STEP_SHARE * STEP_SHARE * motion.play.weight_moment_n_m();
    let size = if range > 0.0 { range } else { holding_n_m.abs() }.max(least);
    let share = (first - holding_n_m).abs() / size;
    let warning =
        SimulationWarning::BeginsUnheld { joint: None, torque_n_m: first, holding_n_m, share };
    (share > STEP_SHARE).then_some(warning)
}

fn of_arm(arm: &Arm, play: &Play<'_>, motion: &BentMotion) -> Vec<SimulationWarning> {
    let Input::Torques(torques) = play.input else { return Vec::new() };
    let ranges = torques.iter().map(|torque| {
        let [low, high] = extremes(torque.torque_n_m());
        high - low
    });
    let range = ranges.fold(0.0, f64::max);
    let holding = motion.joints.iter().map(|joint| joint.holding_n_m.unwrap_or_default());
    let most = holding.clone().fold(range, |most, own| most.max(own.abs()));
    let size = if range > 0.0 { range } else { most };
    let starts_at_rest = play.state.is_none();
    let mut warnings = Vec::new();
    for (number, (torque, holding_n_m)) in torques.iter().zip(holding).enumerate() {
        let (own, joint) = (torque.torque_n_m(), Some(number + 1));
        let torque_n_m = own[0];
        let share = (torque_n_m - holding_n_m).abs() / size;
        if starts_at_rest && share > STEP_SHARE {
            let begins = SimulationWarning::BeginsUnheld { joint, torque_n_m, holding_n_m, share };
            warnings.push(begins);
        }
        let torque_n_m = own[own.len() - 1];
        let share = torque_n_m.abs() / size;
        if !arm.has_weight() && share > STEP_SHARE {
            warnings.push(SimulationWarning::EndsWithJump { joint, torque_n_m, share });
        }
        let hub_rad = motion.joints[number].angle_rad[0];
        let reference = play.feedback.get(number).map(|own| own.reference().angle_rad()[0]);
        let apart = reference.filter(|own| starts_at_rest && (own - hub_rad).abs() > APART_RAD);
        warnings.extend(apart.map(|reference_rad| SimulationWarning::ReferenceApart {
            joint,
            reference_rad,
            hub_rad,
        }));
    }
    warnings.extend(imbalance(motion));
    warnings
}

fn imbalance(motion: &BentMotion) -> Option<SimulationWarning> {
    let share = motion.play.imbalance();
    (share > IMBALANCE).then_some(SimulationWarning::Imbalance { share })
}
