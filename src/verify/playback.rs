use super::check::{Check, Question};
use super::report::{Answer, VerificationError};
use crate::link::Damping;
use crate::numeric::{largest, largest_difference};
use crate::response::{
    EnergyAccount, EnergyBalance, Play, Simulation, SimulationError, Torque, simulate_on,
};

/// How far the tip may stray at most, over its way, where the tolerance is no looser.
const TIP: f64 = 1e-3;

/// A balance of energy, over the largest energy, where the tolerance is no tighter.
const ENERGY: f64 = 1e-6;

/// Error of the integrals of work beyond which a balance would tell nothing.
const QUADRATURE: f64 = 1e-3;

/// Last of the ten digits of tip.csv, over the tip's way.
const ROUNDED: f64 = 1e-10;

/// Times at which the balance is drawn up.
const BALANCES: usize = 64;

/// What playing the torque tells.
pub(super) struct Played {
    pub(super) tip: Vec<Check>,
    pub(super) energy: Check,
}

const OWN_LAW: Question =
    Question { name: "tip_error", what: "tip, the link's own damping", of: "the tip's way" };

const BALANCE: Question =
    Question { name: "energy", what: "work less energy held and lost", of: "the largest energy" };

impl Played {
    /// A link that no torque is played on, and why.
    fn not(reason: &str) -> Self {
        let tip = vec![OWN_LAW.not_measured(reason.to_owned())];
        Self { tip, energy: BALANCE.not_measured(reason.to_owned()) }
    }
}

/// The torque as written, played on the link: tip error and balance of energy.
pub(super) fn played(answer: &Answer) -> Result<Played, VerificationError> {
    let Answer { link, solution, .. } = answer;
    let grid = solution.grid;
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let torque = Torque::new(&time_s, answer.written_torque_n_m.to_vec())?;
    let memory_bytes = answer.analysis.memory_bytes();
    let initial_tip_m = solution.tip.displacement_m[0];
    let play = Play { initial_tip_m, memory_bytes, ..Play::of(&torque) };
    let simulation = match simulate_on(link, solution.mesh().clone(), &play) {
        Err(SimulationError::MasslessHub) => return Ok(Played::not("the hub moves no mass")),
        played => played?,
    };
    let straight_m = simulation.straight_tip_m(answer.written_torque_n_m);
    let between_m = largest_difference(&simulation.tip.displacement_m, &straight_m);
    let bound = allowed_tip_error(answer, between_m);
    let viscous = tip_error(answer, &simulation.tip.displacement_m);
    let tip = match link.damping() {
        Damping::Hysteretic { ratio } if *ratio > 0.0 => {
            let tip_m = simulation.hysteretic_tip_m(*ratio, &net_torque(answer));
            let other_law = Question {
                name: "tip_error_viscous",
                what: "tip, viscous damping, as predicted",
                ..OWN_LAW
            };
            // The laws part by so much that no bound on the tip's distance from the wanted motion
            // would hold at small ratios and tell anything at large ones: where it goes is known.
            let apart_m = simulation.apart_m(*ratio, &solution.tip.acceleration_m_s2);
            let viscous_m = &simulation.tip.displacement_m;
            let less: Vec<f64> =
                viscous_m.iter().zip(apart_m).map(|(v, apart)| v - apart).collect();
            vec![
                OWN_LAW.measured(tip_error(answer, &tip_m), bound),
                other_law.measured(tip_error(answer, &less), bound),
            ]
        }
        _ => vec![OWN_LAW.measured(viscous, bound)],
    };
    let (imbalance, quadrature) = imbalance(&simulation);
    let energy = if quadrature > QUADRATURE {
        BALANCE.not_measured("the step is too long to add up work".to_owned())
    } else {
        BALANCE.measured(imbalance, ENERGY.min(answer.analysis.tolerance()).max(quadrature))
    };
    Ok(Played { tip, energy })
}

/// How far the tip may stray, over its way: as far as a torque that is wrong by the tolerance of its
/// peak, from one end of the window to the other, drives the rigid link, and by what the samples leave
/// open, `between_m` from cubics to straight lines; never more than 1e-3 or the tolerance. To that comes
/// what the tip may miss of the motion asked for.
fn allowed_tip_error(answer: &Answer, between_m: f64) -> f64 {
    let Answer { link, analysis, solution, .. } = answer;
    let peak = largest(&solution.torque_n_m);
    let acceleration = analysis.tolerance() * peak * link.length_m() / link.rigid_inertia_kg_m2();
    let driven_m = 0.5 * acceleration * solution.grid.duration_s().powi(2);
    let played = TIP.max(analysis.tolerance());
    analysis.tip_tolerance() + played.min((driven_m + between_m) / solution.tip.farthest_m())
}

/// The tip that is solved against the motion asked for; none where the band is that of the samples,
/// which the tip follows to the last digit.
pub(super) fn tip_solved(answer: &Answer) -> Option<Check> {
    let question = Question { name: "tip_solved", what: "tip that is solved", of: "the tip's way" };
    let tolerance = answer.analysis.tip_tolerance();
    let found = || tip_error(answer, &answer.solution.tip.displacement_m);
    (tolerance > 0.0).then(|| question.measured(found(), tolerance + ROUNDED))
}

/// The written torque less what the hub's friction takes of it.
fn net_torque(answer: &Answer) -> Vec<f64> {
    let friction = answer.link.joint().friction_n_m_s_rad;
    let samples = answer.written_torque_n_m.iter().zip(&answer.solution.hub_rate_rad_s);
    samples.map(|(t, rate)| t - friction * rate).collect()
}

/// Largest distance of a tip from the motion asked for, over its way.
fn tip_error(answer: &Answer, tip_m: &[f64]) -> f64 {
    let Answer { motion, solution, .. } = answer;
    let (grid, tip) = (solution.grid, &solution.tip);
    let wanted = motion.target(grid.time_s(0), grid.end_s());
    largest_difference(tip_m, wanted.displacement_m()) / tip.farthest_m()
}

/// What is missing in the balance of energy, at worst, and what its integrals may be wrong by, both
/// over the largest energy in the link.
fn imbalance(simulation: &Simulation) -> (f64, f64) {
    let EnergyAccount { balances, quadrature_error_j } = simulation.energy(BALANCES);
    let held = |b: &EnergyBalance| b.kinetic_j + b.strain_j;
    let largest = balances.iter().fold(0.0_f64, |m, b| m.max(held(b)));
    let missing = balances.iter().map(|b| (b.work_j - held(b) - b.dissipated_j).abs());
    let missing = missing.fold(0.0, f64::max);
    (missing / largest, quadrature_error_j / largest)
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
        assert!(missing < 1e-7 && quadrature < ENERGY, "{missing:e}, {quadrature:e}");
        for torque in &mut simulation.torque_n_m {
            *torque *= 1.001;
        }
        let (missing, quadrature) = imbalance(&simulation);
        assert!(missing > 1e-4 && quadrature < ENERGY, "{missing:e}, {quadrature:e}");
    }
}
