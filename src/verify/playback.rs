//! The written torque, played on the link.

use super::check::{Answer, Check, Kind, VerificationError};
use crate::inverse::{Resources, Solution, invert_with};
use crate::link::{Damping, Link, LinkParts};
use crate::modal::held_frequencies;
use crate::motion::{Ends, TipTarget};
use crate::numeric::{largest, largest_difference};
use crate::response::{
    EnergyAccount, EnergyBalance, HubReference, Play, Simulation, SimulationError, State, Torque,
    simulate_on,
};

/// Error of the integrals of work above which a balance of energy says nothing.
const QUADRATURE: f64 = 1e-3;

/// Number of times at which the energies are summed.
const BALANCES: usize = 64;

/// What an error of the hub's motion, over its range, may at most become of the tip's travel: the error that the
/// solution states is that of the worst sample already.
const AMPLIFIED: f64 = 10.0;

/// The checks that follow from playing the torque.
pub(super) struct Played {
    pub(super) tip: Vec<Check>,
    pub(super) energy: Check,
}

/// Plays the written torque on the link: tip error and balance of energy.
pub(super) fn played(answer: &Answer, wanted: &TipTarget) -> Result<Played, VerificationError> {
    let solution = answer.solution;
    let ends = solution.motion.ends();
    let is_hysteretic =
        matches!(solution.link().damping(), Damping::Hysteretic { ratio } if *ratio > 0.0);
    if ends == Ends::Moving && is_hysteretic {
        return Ok(not_played("hysteretic damping has no state of a tip that has always moved"));
    }
    if solution.second_order().is_some() {
        return match solution.link().damping() {
            Damping::Hysteretic { ratio } if is_hysteretic => played_viscous(answer, *ratio),
            _ => played_large(answer, wanted, Kind::OF_HUB),
        };
    }
    let (link, grid) = (solution.link(), solution.grid);
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let torque = Torque::new(&time_s, answer.written_torque_n_m.to_vec())?;
    let memory_bytes = answer.memory_bytes;
    let initial_tip_m = solution.tip.displacement_m[0];
    let moving =
        State::turning(link, grid.time_s(0), [initial_tip_m, solution.tip.velocity_m_s[0]]);
    let play = Play {
        initial_tip_m,
        memory_bytes,
        state: (ends == Ends::Moving).then_some(&moving),
        cycle_turn_rad: turn_of_cycle_rad(solution),
        ..Play::of(&torque)
    };
    let simulation = match simulate_on(link, solution.mesh().clone(), &play) {
        Err(SimulationError::MasslessHub) => return Ok(not_played("the hub moves no mass")),
        played => played?,
    };
    let Some(modes) = simulation.modes() else { return played_large(answer, wanted, Kind::OF_HUB) };
    let straight_m = modes.straight_tip_m(answer.written_torque_n_m);
    let between_m = largest_difference(&simulation.tip.displacement_m, &straight_m);
    let bound = allowed_tip_error(answer, between_m);
    let error = |tip_m: &[f64]| tip_error(answer, wanted, tip_m);
    let tip = match link.damping() {
        Damping::Hysteretic { ratio } if *ratio > 0.0 => {
            let tip_m = modes.hysteretic_tip_m(*ratio, &net_torque(answer));
            // Under the viscous law the tip misses the wanted motion by far more than any useful bound,
            // but by a computable amount; the tip less this amount must be the wanted motion.
            let apart_m = modes.apart_m(*ratio, &solution.tip.acceleration_m_s2);
            let viscous_m = &simulation.tip.displacement_m;
            let less: Vec<f64> =
                viscous_m.iter().zip(&apart_m).map(|(v, apart)| v - apart).collect();
            if ends == Ends::Periodic {
                // Both begin where the tip does: the rigid rotation is another from law to law.
                let less: Vec<f64> = less.iter().map(|v| v + apart_m[0]).collect();
                let tip = vec![Kind::TIP_ERROR_VISCOUS.measured_to(error(&less), bound)];
                return Ok(Played { tip, energy: energy(answer, &simulation) });
            }
            vec![
                Kind::TIP_ERROR.measured_to(error(&tip_m), bound),
                Kind::TIP_ERROR_VISCOUS.measured_to(error(&less), bound),
            ]
        }
        _ => vec![Kind::TIP_ERROR.measured_to(error(&simulation.tip.displacement_m), bound)],
    };
    Ok(Played { tip, energy: energy(answer, &simulation) })
}

/// Turn in rad of a cycle; none of a motion that does not repeat.
pub(super) fn turn_of_cycle_rad(solution: &Solution) -> Option<f64> {
    let is_cycle = solution.motion.ends() == Ends::Periodic;
    is_cycle.then(|| solution.motion.travel_m() / solution.link().length_m())
}

/// The check of a simulation's balance of energy.
fn energy(answer: &Answer, simulation: &Simulation) -> Check {
    let (imbalance, quadrature) = imbalance(simulation);
    if quadrature > QUADRATURE {
        Kind::ENERGY.not_measured("the step is too long to add up work")
    } else {
        Kind::ENERGY.measured_to(imbalance, (Kind::ENERGY.bound)(answer).max(quadrature))
    }
}

/// What was not played.
fn not_played(reason: &str) -> Played {
    let tip = vec![Kind::TIP_ERROR.not_measured(reason)];
    Played { tip, energy: Kind::ENERGY.not_measured(reason) }
}

/// Solves the link again with viscous damping, which has an equation in time, of the same ratio in its first mode with the
/// hub held, on a mesh of its own, and moves that one's hub: weight and second order are then played. The written torque is
/// not; its law of damping is in the transfer.
fn played_viscous(answer: &Answer, ratio: f64) -> Result<Played, VerificationError> {
    let (solution, memory_bytes) = (answer.solution, answer.memory_bytes);
    let Some(&first_rad_s) = held_frequencies(solution.mesh(), f64::INFINITY, 1).first() else {
        return Ok(not_played("hysteretic damping has no equation in time, and no mode"));
    };
    let damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2.0 * ratio / first_rad_s };
    let resources = Resources { memory_bytes, ..Resources::default() };
    let viscous = Link::new(LinkParts { damping, ..solution.link().clone().into() });
    let viscous = viscous.map_err(|error| error.to_string()).and_then(|link| {
        let (motion, analysis) = (&solution.motion, &solution.analysis);
        let found = invert_with(&link, answer.plan, motion, analysis, &resources);
        found.map_err(|error| error.to_string())
    });
    let viscous = match viscous {
        Ok(viscous) => viscous,
        Err(error) => return Ok(not_played(&format!("with viscous damping: {error}"))),
    };
    let wanted = viscous.motion.target(viscous.grid.time_s(0), viscous.grid.end_s());
    let written_torque_n_m = &viscous.torque_n_m[..];
    let answer = Answer { solution: &viscous, written_torque_n_m, ..*answer };
    let Played { tip, energy } = played_large(&answer, &wanted, Kind::OF_HUB_VISCOUS)?;
    let (name, what) = ("energy_viscous".to_owned(), "energy, viscous damping".to_owned());
    Ok(Played { tip, energy: Check { name, what, ..energy } })
}

/// Moves the hub of a link with weight, or at large angles, as solved: tip error, the torque that it takes beside the
/// written one, and balance of energy.
///
/// A torque would let the link fall from an upright pose; a hub that is moved does not.
fn played_large(
    answer: &Answer,
    wanted: &TipTarget,
    [tip_of_hub, torque_of_hub]: [Kind; 2],
) -> Result<Played, VerificationError> {
    let solution = answer.solution;
    let grid = solution.grid;
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let hub = HubReference::new(&time_s, solution.hub_angle_rad.clone(), None)?;
    let play = Play {
        memory_bytes: answer.memory_bytes,
        is_large: true,
        cycle_turn_rad: turn_of_cycle_rad(solution),
        start_angle_rad: wanted.start_angle_rad(),
        ..Play::turning(&hub)
    };
    let simulation = match simulate_on(solution.link(), solution.mesh().clone(), &play) {
        Ok(simulation) => simulation,
        Err(SimulationError::MasslessHub) => return Ok(not_played("the hub moves no mass")),
        Err(SimulationError::NotConverged { .. }) => {
            return Ok(not_played("the motion of its hub does not converge"));
        }
        Err(SimulationError::Cycle(_)) => return Ok(not_played("the link does not settle")),
        Err(error) => return Err(error.into()),
    };
    let stated = solution
        .accuracy
        .errors
        .of_kind(|of| of.mesh + of.window + of.step.unwrap_or(0.0) + of.iteration.unwrap_or(0.0));
    let of_hub = stated.hub_angle.max(stated.hub_acceleration.unwrap_or(0.0));
    let analysis = &solution.analysis;
    let allowed = |stated: f64| AMPLIFIED * (stated + analysis.tolerance());
    let bound = (tip_of_hub.bound)(answer).min(analysis.tip_tolerance() + allowed(of_hub));
    let tip_error = tip_error(answer, wanted, &simulation.tip.displacement_m);
    let torque_n_m = answer.written_torque_n_m;
    let apart = torque_change(torque_n_m, &simulation.torque_n_m, 1, solution.link());
    Ok(Played {
        tip: vec![
            tip_of_hub.measured_to(tip_error, bound),
            torque_of_hub
                .measured_to(apart, (torque_of_hub.bound)(answer).max(allowed(stated.torque))),
        ],
        energy: energy(answer, &simulation),
    })
}

/// Allowed error of the played tip over its travel.
///
/// It is how far a constant torque of the tolerance times the peak drives the rigid link over the window,
/// plus `between_m`, the difference between cubics and straight lines through the samples; at most 1e-3
/// or the tolerance. The tip tolerance of the analysis is added.
fn allowed_tip_error(answer: &Answer, between_m: f64) -> f64 {
    let solution = answer.solution;
    let (link, analysis) = (solution.link(), &solution.analysis);
    let peak = largest(&solution.torque_n_m);
    let acceleration = analysis.tolerance() * peak * link.length_m() / link.rigid_inertia_kg_m2();
    let driven_m = 0.5 * acceleration * solution.grid.duration_s().powi(2);
    let played = (driven_m + between_m) / solution.tip_travel_m();
    (Kind::TIP_ERROR.bound)(answer).min(analysis.tip_tolerance() + played)
}

/// The solved tip against the wanted motion; none where all frequencies of the samples are solved for.
pub(super) fn tip_solved(answer: &Answer, wanted: &TipTarget) -> Option<Check> {
    let found = || tip_error(answer, wanted, &answer.solution.tip.displacement_m);
    let is_cut = answer.solution.analysis.tip_tolerance() > 0.0;
    is_cut.then(|| Kind::TIP_SOLVED.measured(answer, found()))
}

/// The written torque less the hub's friction.
fn net_torque(answer: &Answer) -> Vec<f64> {
    let friction = answer.solution.link().joint().friction_n_m_s_rad;
    let samples = answer.written_torque_n_m.iter().zip(&answer.solution.hub_rate_rad_s);
    samples.map(|(t, rate)| t - friction * rate).collect()
}

/// Largest error of a tip against the wanted motion, over its travel.
fn tip_error(answer: &Answer, wanted: &TipTarget, tip_m: &[f64]) -> f64 {
    largest_difference(tip_m, wanted.displacement_m()) / answer.solution.tip_travel_m()
}

/// Largest imbalance of energy, and the error of its integrals, both over the largest energy in the
/// link.
fn imbalance(simulation: &Simulation) -> (f64, f64) {
    let EnergyAccount { balances, start_j, quadrature_error_j } = simulation.energy(BALANCES);
    let held = |b: &EnergyBalance| b.kinetic_j + b.strain_j;
    // What weight holds may be less than at the start.
    let largest = balances.iter().fold(0.0_f64, |m, b| m.max(held(b).abs()).max(b.kinetic_j));
    let missing = balances.iter().map(|b| (b.work_j - (held(b) - start_j) - b.dissipated_j).abs());
    let missing = missing.fold(0.0, f64::max);
    (missing / largest, quadrature_error_j / largest)
}

/// Change of the torque against one with `often` times the samples, root mean square over root mean square.
///
/// The worst sample would not do: where the acceleration of a motion has a kink at its begin or end,
/// the torque has a spike that becomes narrower with every shorter step, never converges, and hardly
/// moves the link. What holds a weight at rest is no part of what must not change.
pub(super) fn torque_change(own: &[f64], finer: &[f64], often: usize, link: &Link) -> f64 {
    let held_n_m = if link.has_weight() { own.iter().sum::<f64>() / own.len() as f64 } else { 0.0 };
    let pairs = own.iter().zip(finer.iter().step_by(often));
    let (difference, whole) = pairs.fold((0.0, 0.0), |(difference, whole), (a, b)| {
        (difference + (a - b).powi(2), whole + (b - held_n_m).powi(2))
    });
    (difference / whole).sqrt()
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
        let mut simulation = simulate(&link, &plan, &Play::of(&torque)).unwrap();
        let (missing, quadrature) = imbalance(&simulation);
        assert!(missing < 1e-7 && quadrature < 1e-6, "{missing:e}, {quadrature:e}");
        for torque in &mut simulation.torque_n_m {
            *torque *= 1.001;
        }
        let (missing, quadrature) = imbalance(&simulation);
        assert!(missing > 1e-4 && quadrature < 1e-6, "{missing:e}, {quadrature:e}");
    }
}
