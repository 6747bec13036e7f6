use super::check::{Check, Question};
use super::report::{Answer, VerificationError};
use crate::link::Damping;
use crate::response::{EnergyBalance, Play, Simulation, Torque, simulate_on};

/// How far the tip may stray at most, over its way.
const TIP: f64 = 1e-3;

/// How far a hysteretic torque may take the tip of a viscous link, over its way and ratio: the two
/// laws differ by their ratio between the resonances, the more of it the faster the motion.
const OTHER_LAW: f64 = 5.0;

/// A balance of energy, over the largest energy.
const ENERGY: f64 = 1e-6;

/// Times at which the balance is drawn up.
const BALANCES: usize = 64;

/// What playing the torque tells.
pub(super) struct Played {
    pub(super) tip: Vec<Check>,
    pub(super) energy: Check,
}

/// The torque as written, played on the link: tip error and balance of energy.
pub(super) fn played(answer: &Answer) -> Result<Played, VerificationError> {
    let Answer { link, solution, .. } = answer;
    let grid = solution.grid;
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let torque = Torque::new(&time_s, answer.written_torque_n_m.to_vec())?;
    let play = Play { initial_tip_m: solution.tip.displacement_m[0], ..Play::of(&torque) };
    let simulation = simulate_on(link, solution.mesh().clone(), &play)?;
    let bound = allowed_tip_error(answer);
    let viscous = tip_error(answer, &simulation.tip.displacement_m);
    let question = |name, what| Question { name, what, of: "the tip's way" };
    let own_law = question("tip_error", "tip, the link's own damping");
    let tip = match link.damping() {
        Damping::Hysteretic { ratio } if *ratio > 0.0 => {
            let tip_m = simulation.hysteretic_tip_m(*ratio, &net_torque(answer));
            let other_law = question("tip_error_viscous", "tip, viscous damping in its place");
            vec![
                own_law.measured(tip_error(answer, &tip_m), bound),
                other_law.measured(viscous, OTHER_LAW * ratio),
            ]
        }
        _ => vec![own_law.measured(viscous, bound)],
    };
    let energy = Question {
        name: "energy",
        what: "work less energy held and lost",
        of: "the largest energy",
    };
    let (imbalance, quadrature) = imbalance(&simulation);
    let energy = energy.measured(imbalance, ENERGY.max(quadrature));
    Ok(Played { tip, energy })
}

/// How far the tip may stray, over its way: as far as a torque that is wrong by the tolerance of its
/// peak, from one end of the window to the other, drives the rigid link, and never more than 1e-3.
fn allowed_tip_error(answer: &Answer) -> f64 {
    let Answer { link, analysis, solution, .. } = answer;
    let peak = solution.torque_n_m.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let acceleration = analysis.tolerance() * peak * link.length_m() / link.rigid_inertia_kg_m2();
    let driven_m = 0.5 * acceleration * solution.grid.duration_s().powi(2);
    TIP.min(driven_m / solution.tip.farthest_m())
}

/// The written torque less what the hub's friction takes of it.
fn net_torque(answer: &Answer) -> Vec<f64> {
    let friction = answer.link.hub().viscous_friction_n_m_s_rad;
    let samples = answer.written_torque_n_m.iter().zip(&answer.solution.hub_rate_rad_s);
    samples.map(|(t, rate)| t - friction * rate).collect()
}

/// Largest distance of a tip from the wanted one, over its way.
fn tip_error(answer: &Answer, tip_m: &[f64]) -> f64 {
    let wanted = &answer.solution.tip.displacement_m;
    let pairs = tip_m.iter().zip(wanted);
    let strays = pairs.fold(0.0_f64, |m, (tip, wanted)| m.max((tip - wanted).abs()));
    strays / answer.solution.tip.farthest_m()
}

/// What is missing in the balance of energy, at worst, and what its integrals may be wrong by, both
/// over the largest energy in the link.
fn imbalance(simulation: &Simulation) -> (f64, f64) {
    let balances = simulation.energy(BALANCES);
    let held = |b: &EnergyBalance| b.kinetic_j + b.strain_j;
    let largest = balances.iter().fold(0.0_f64, |m, b| m.max(held(b)));
    let missing = balances.iter().map(|b| (b.work_j - held(b) - b.dissipated_j).abs());
    let missing = missing.fold(0.0, f64::max);
    (missing / largest, simulation.quadrature_error_j() / largest)
}
