use super::check::Check;
use super::report::{Answer, VerificationError};
use crate::link::Damping;
use crate::motion::TipTarget;
use crate::numeric::TimeGrid;
use crate::response::{EnergyBalance, Play, Simulation, Torque, simulate_on};

/// How far the tip may stray, in tolerances of the torque: a torque that is wrong by a share of its
/// peak for seconds drives the tip off by some hundred times that share of its way.
const TIP_OVER_TORQUE: f64 = 1e3;

/// A balance of energy that is integrated numerically, over the largest energy.
const ENERGY: f64 = 1e-6;

/// Times at which the balance is drawn up.
const BALANCES: usize = 64;

/// The torque as written, played on the link: tip error and balance of energy.
pub(super) fn played(answer: &Answer) -> Result<Vec<Check>, VerificationError> {
    let Answer { link, solution, .. } = answer;
    let grid = solution.grid;
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let torque = Torque::new(&time_s, answer.written_torque_n_m.to_vec())?;
    let play = Play { initial_tip_m: solution.tip.displacement_m[0], ..Play::of(&torque) };
    let simulation = simulate_on(link, solution.mesh().clone(), &play)?;
    let bound = TIP_OVER_TORQUE * answer.analysis.tolerance();
    let viscous = tip_error(answer, grid, &simulation.tip.displacement_m);
    let own_law = "tip under the written torque, own damping law, of its way";
    let mut checks = match link.damping() {
        Damping::Hysteretic { ratio } if *ratio > 0.0 => {
            let tip_m = simulation.hysteretic_tip_m(*ratio, &net_torque(answer));
            vec![
                Check::measured(
                    "tip_error",
                    own_law.into(),
                    tip_error(answer, grid, &tip_m),
                    bound,
                ),
                Check::measured(
                    "tip_error_viscous",
                    "tip on the viscous equivalent, of its way".into(),
                    viscous,
                    // The two laws differ by their ratio between the resonances.
                    ratio.max(bound),
                ),
            ]
        }
        _ => vec![Check::measured("tip_error", own_law.into(), viscous, bound)],
    };
    checks.push(Check::measured(
        "energy",
        "work less kinetic, strain and lost energy, of the largest".into(),
        imbalance(&simulation),
        ENERGY,
    ));
    Ok(checks)
}

/// The written torque less what the hub's friction takes of it.
fn net_torque(answer: &Answer) -> Vec<f64> {
    let friction = answer.link.hub().viscous_friction_n_m_s_rad;
    let samples = answer.written_torque_n_m.iter().zip(&answer.solution.hub_rate_rad_s);
    samples.map(|(t, rate)| t - friction * rate).collect()
}

/// Largest distance of a tip from the wanted one, over its way.
fn tip_error(answer: &Answer, grid: TimeGrid, tip_m: &[f64]) -> f64 {
    let wanted = &answer.solution.tip.displacement_m;
    let way_m = TipTarget::new(grid, wanted.clone()).farthest_m();
    let pairs = tip_m.iter().zip(wanted);
    pairs.fold(0.0_f64, |m, (tip, wanted)| m.max((tip - wanted).abs())) / way_m
}

/// What is missing in the balance of energy, at worst, over the largest energy in the link.
fn imbalance(simulation: &Simulation) -> f64 {
    let balances = simulation.energy(BALANCES);
    let held = |b: &EnergyBalance| b.kinetic_j + b.strain_j;
    let largest = balances.iter().fold(0.0_f64, |m, b| m.max(held(b)));
    let missing = balances.iter().map(|b| (b.work_j - held(b) - b.dissipated_j).abs());
    missing.fold(0.0, f64::max) / largest
}
