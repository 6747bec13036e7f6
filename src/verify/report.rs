use thiserror::Error;

use super::check::{Check, Question};
use super::limits::within_limits;
use super::measured::Measured;
use super::playback::{Played, played, tip_solved};
use super::step::with_the_step_halved;
use super::transfer::dense_transfer;
use crate::beam::MeshPlan;
use crate::inverse::{Analysis, InversionError, Solution};
use crate::link::Link;
use crate::motion::{MotionError, TipMotion};
use crate::numeric::largest;
use crate::response::{HistoryError, SimulationError};
use crate::result::Limits;

/// What the user's own choice of elements, modes or step may change: no tolerance says.
pub(super) const CHOSEN: f64 = 1e-2;

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
    /// What link and motor stand.
    pub limits: &'a Limits,
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
/// damping; the tip that is solved; halved elements; halved steps; what is left at the edge of the
/// window; the paper's dense system at sample frequencies; the balance of energy; how small the
/// deflections are; the limits of the link file.
///
/// # Errors
/// [`VerificationError`].
pub fn verify(answer: &Answer) -> Result<Verification, VerificationError> {
    let Answer { limits, solution, .. } = answer;
    let Played { tip: mut checks, energy } = played(answer)?;
    checks.extend(tip_solved(answer));
    let Measured { mesh, window, modes } = Measured::of(answer);
    checks.push(mesh);
    checks.extend(with_the_step_halved(answer)?);
    checks.push(window);
    checks.extend(modes);
    checks.extend([dense_transfer(solution), energy, tip_deflection(solution)]);
    checks.extend(within_limits(limits, solution));
    Ok(Verification { checks })
}

fn tip_deflection(solution: &Solution) -> Check {
    let question =
        Question { name: "tip_deflection", what: "tip deflection", of: "the link's length" };
    let bent = largest(&solution.tip_deflection_m()) / solution.mesh().length_m();
    question.measured(bent, Link::LARGEST_DEFLECTION)
}

impl Verification {
    /// The checks that are out of their bounds.
    pub fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.fails())
    }
}
