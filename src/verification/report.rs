use thiserror::Error;

use super::check::{Check, Question};
use super::playback::{Played, played};
use super::transfer::dense_transfer;
use crate::beam::MeshPlan;
use crate::inverse::{Analysis, InversionError, Solution, torque_over_window};
use crate::link::Link;
use crate::motion::{MotionError, TipMotion};
use crate::numeric::largest;
use crate::response::{HistoryError, SimulationError};

/// What the user's own choice of elements, modes or step may change of the torque: no tolerance says.
const CHOSEN: f64 = 1e-2;

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

impl VerificationError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Torque(error) => error.hint(),
            Self::Simulation(error) => error.hint(),
            Self::Motion(_) => None,
            Self::Inversion(error) => error.hint(),
        }
    }
}

/// Measures a solution:
///
/// the torque as it is written, played on the link with its own damping law and with viscous
/// damping; halved elements; halved steps; what is left at the edge of the window; the paper's
/// dense system at sample frequencies; the balance of energy; how small the deflections are.
///
/// # Errors
/// [`VerificationError`].
pub fn verify(answer: &Answer) -> Result<Verification, VerificationError> {
    let Answer { plan, analysis, solution, .. } = answer;
    let errors = solution.accuracy.errors.torque;
    let Played { tip: mut checks, energy } = played(answer)?;
    let mesh_bound = if plan.is_automatic() { plan.tolerance() } else { CHOSEN };
    let torque = |name, what| Question { name, what, of: "the peak torque" };
    checks.extend([
        torque("mesh_halving", "torque with elements halved").measured(errors.mesh, mesh_bound),
        Question { of: "the torque, rms", ..torque("step_halving", "torque with the step halved") }
            .measured(step_error(answer)?, CHOSEN),
        torque("wrap_around", "torque at the window's edge")
            .measured(errors.window, analysis.tolerance()),
    ]);
    let truncation = torque("truncation", "torque with all modes");
    checks.extend(errors.modes.map(|e| truncation.measured(e, CHOSEN)));
    let bent = largest(&solution.tip_deflection_m()) / solution.mesh().length_m();
    let deflection =
        Question { name: "tip_deflection", what: "tip deflection", of: "the link's length" };
    let deflection = deflection.measured(bent, Link::LARGEST_DEFLECTION);
    checks.extend([dense_transfer(solution), energy, deflection]);
    Ok(Verification { checks })
}

impl Verification {
    /// The checks that are out of their bounds.
    pub fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.fails())
    }
}

/// Change of the torque when the motion is sampled twice as often, root mean square over root mean
/// square.
///
/// Not at the worst sample: where a motion begins or ends with a kink of its acceleration, the
/// torque has a spike that grows ever narrower with the step and never settles, and moves next to
/// nothing.
fn step_error(answer: &Answer) -> Result<f64, VerificationError> {
    let Answer { link, motion, analysis, solution, .. } = answer;
    let finer = motion.twice_as_often()?;
    let torque = torque_over_window(solution, link, &finer, analysis)?;
    let pairs = solution.torque_n_m.iter().zip(torque.iter().step_by(2));
    let (difference, whole) = pairs.fold((0.0, 0.0), |(difference, whole), (a, b)| {
        (difference + (a - b).powi(2), whole + b * b)
    });
    Ok((difference / whole).sqrt())
}
