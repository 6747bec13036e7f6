use thiserror::Error;

use super::check::Check;
use super::playback::played;
use super::transfer::dense_transfer;
use crate::beam::MeshPlan;
use crate::inverse::{Analysis, InversionError, Solution, torque_over_window};
use crate::link::Link;
use crate::motion::{MotionError, TipMotion};
use crate::response::{HistoryError, SimulationError};

/// What the mesh may change of the torque where the user chose it, over the peak.
const CHOSEN_MESH: f64 = 1e-2;

/// What the step may change of the torque, over the peak.
const STEP: f64 = 1e-3;

/// What a solution was asked for, and as what it is written.
#[derive(Clone, Copy)]
pub struct Answer<'a> {
    /// The link.
    pub link: &'a Link,
    /// How it was to be meshed.
    pub plan: &'a MeshPlan,
    /// The wanted motion.
    pub motion: &'a TipMotion,
    /// How exact the answer was to be.
    pub analysis: &'a Analysis,
    /// The answer.
    pub solution: &'a Solution,
    /// The torque in N m as its file says it, rounded.
    pub written_torque_n_m: &'a [f64],
}

/// A solution's torque measured by other means, one check a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// The checks.
    pub checks: Vec<Check>,
}

/// Why a solution is not verified.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum VerificationError {
    /// The written torque is none.
    #[error("the written torque: {0}")]
    Torque(#[from] HistoryError),
    /// The torque cannot be played.
    #[error("playing the torque: {0}")]
    Simulation(#[from] SimulationError),
    /// The motion cannot be sampled twice as often.
    #[error("the motion at half the step: {0}")]
    Motion(#[from] MotionError),
    /// The motion at half the step has no torque.
    #[error("the motion at half the step: {0}")]
    Inversion(#[from] InversionError),
}

/// Measures a solution:
///
/// the torque as it is written, played on the link with its own damping law and with viscous
/// damping; halved elements; halved steps; what is left at the edge of the window; the paper's
/// dense system at sample frequencies; the balance of energy.
///
/// # Errors
/// [`VerificationError`].
pub fn verify(answer: &Answer) -> Result<Verification, VerificationError> {
    let Answer { plan, analysis, solution, .. } = answer;
    let accuracy = &solution.accuracy;
    let mut checks = played(answer)?;
    let mesh_bound = if plan.is_automatic() { plan.tolerance() } else { CHOSEN_MESH };
    checks.push(Check::measured(
        "mesh_halving",
        "torque on halved elements, of the peak".into(),
        accuracy.mesh_error,
        mesh_bound,
    ));
    checks.push(Check::measured(
        "step_halving",
        "torque of the motion at half the step, of the peak".into(),
        step_error(answer)?,
        STEP,
    ));
    checks.push(Check::measured(
        "wrap_around",
        "torque left at the window's edge, of the peak".into(),
        accuracy.edge_error,
        analysis.tolerance(),
    ));
    if let Some(error) = accuracy.truncation_error {
        checks.push(Check::measured(
            "truncation",
            "torque of all modes, of the peak".into(),
            error,
            CHOSEN_MESH,
        ));
    }
    checks.push(dense_transfer(solution));
    checks.sort_by_key(|check| check.name == "energy");
    Ok(Verification { checks })
}

impl Verification {
    /// The checks that are out of their bounds.
    pub fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.fails())
    }
}

/// Largest change of the torque when the motion is sampled twice as often, over the peak.
fn step_error(answer: &Answer) -> Result<f64, VerificationError> {
    let Answer { link, motion, analysis, solution, .. } = answer;
    let finer = motion.twice_as_often()?;
    let torque = torque_over_window(solution, link, &finer, analysis)?;
    let pairs = solution.torque_n_m.iter().zip(torque.iter().step_by(2));
    let difference = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    let peak = solution.torque_n_m.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    Ok(difference / peak)
}
