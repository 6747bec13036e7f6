//! The input of the checks of a verification: a solution, its limits and its written torques. The errors of a
//! verification.

use thiserror::Error;

use crate::beam::MeshPlan;
use crate::inverse::{InversionError, Solution};
use crate::motion::{Motion, MotionError};
use crate::response::{HistoryError, SimulationError};
use crate::result::{Limits, Reached, reached};

/// A solution, the plans of its meshes, its limits, and its torques as written.
#[derive(Clone, Copy)]
pub struct Answer<'a> {
    /// The solution.
    pub solution: &'a Solution,
    /// The plan of each link's mesh.
    pub plans: &'a [MeshPlan],
    /// The limits of each joint, its link and its motor.
    pub limits: &'a [Limits],
    /// Memory in bytes that the checks may take; `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// The torque of each joint in N m, rounded as in its file.
    pub written_torques_n_m: &'a [Vec<f64>],
}

impl Answer<'_> {
    /// Tolerance of the solved tip against the wanted one, as a share of its travel. For the path of an arm it is at
    /// least the solution's tip error: where the path prescribes angles, the arcs of the links set the cut-off, and
    /// they may be longer than the travel of the tip.
    pub(super) fn tip_tolerance(&self) -> f64 {
        let Solution { analysis, motion, tip_error, .. } = self.solution;
        match motion {
            Motion::Tip(_) => analysis.tip_tolerance(),
            Motion::Path(_) => analysis.tip_tolerance().max(*tip_error),
        }
    }

    /// Every value that has a limit, with its measured error.
    pub(super) fn reached(&self) -> Vec<Reached> {
        reached(self.solution, self.limits)
    }
}

/// Reason for a missing verification.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum VerificationError {
    /// The written samples are not a torque.
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
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Torque(error) => error.hint(),
            Self::Simulation(error) => error.hint(),
            Self::Motion(error) => error.hint(),
            Self::Inversion(error) => error.hint(),
        }
    }
}

/// Obstacle to playing a solution.
pub(super) enum Unplayed {
    /// Why the checks by playing do not apply, in words.
    Reason(String),
    /// An error that ends the verification.
    Error(VerificationError),
}

impl From<&str> for Unplayed {
    fn from(reason: &str) -> Self {
        Self::Reason(reason.to_owned())
    }
}

impl<E: Into<VerificationError>> From<E> for Unplayed {
    fn from(error: E) -> Self {
        match error.into() {
            VerificationError::Simulation(SimulationError::MasslessHub) => {
                "the hub moves no mass".into()
            }
            other => Self::Error(other),
        }
    }
}
