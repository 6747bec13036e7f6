//! A solution with its limits and its written torques, as the checks read it; the errors of a verification.

use thiserror::Error;

use crate::beam::MeshPlan;
use crate::inverse::{
    Analysis, ArmSolution, InversionError, PerQuantity, QuantityErrors, Solution,
};
use crate::motion::{Ends, MotionError};
use crate::numeric::TimeGrid;
use crate::response::{HistoryError, SimulationError};
use crate::result::{Limits, Notice, Reached, TorqueTable, reached};

/// The solution of a link or of an arm.
#[derive(Clone, Copy)]
pub enum AnySolution<'a> {
    /// One link that follows the motion of its tip.
    Link(&'a Solution),
    /// An arm that follows its path.
    Arm(&'a ArmSolution),
}

/// A solution, the plans of its meshes, its limits, and its torques as written.
#[derive(Clone, Copy)]
pub struct Answer<'a> {
    /// The solution.
    pub solution: AnySolution<'a>,
    /// The plan of each link's mesh.
    pub plans: &'a [MeshPlan],
    /// The limits of each joint, its link and its motor.
    pub limits: &'a [Limits],
    /// Memory in bytes that the checks may take; `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// The torque of each joint in N m, rounded as in its file.
    pub written_torques_n_m: &'a [Vec<f64>],
}

impl<'a> AnySolution<'a> {
    /// The accuracy that was asked for.
    pub fn analysis(self) -> &'a Analysis {
        match self {
            Self::Link(solution) => &solution.analysis,
            Self::Arm(solution) => &solution.analysis,
        }
    }

    /// The ends of the motion. A path begins and ends at rest.
    pub fn ends(self) -> Ends {
        match self {
            Self::Link(solution) => solution.motion.ends(),
            Self::Arm(_) => Ends::AtRest,
        }
    }

    /// Warnings of the solution.
    pub fn warnings(self) -> Vec<Notice> {
        match self {
            Self::Link(solution) => solution.warnings.iter().map(Notice::from).collect(),
            Self::Arm(solution) => solution.warnings.iter().map(Notice::from).collect(),
        }
    }

    /// Distances of the nodes of each link from its joint in m.
    pub fn nodes_m(self) -> Vec<&'a [f64]> {
        match self {
            Self::Link(solution) => vec![solution.mesh().nodes_m()],
            Self::Arm(solution) => solution.links.iter().map(|link| &link.nodes_m[..]).collect(),
        }
    }

    /// The torques as a table.
    pub fn torques(self) -> TorqueTable {
        match self {
            Self::Link(solution) => TorqueTable::of(solution),
            Self::Arm(solution) => TorqueTable::of_arm(solution),
        }
    }

    /// Times of all histories.
    pub fn grid(self) -> TimeGrid {
        match self {
            Self::Link(solution) => solution.grid,
            Self::Arm(solution) => solution.grid,
        }
    }

    /// True if gravity acts in the plane of motion.
    pub(super) fn has_weight(self) -> bool {
        match self {
            Self::Link(solution) => solution.link().has_weight(),
            Self::Arm(solution) => solution.arm.has_weight(),
        }
    }

    /// Largest distance of the tip from its start in m.
    pub(super) fn travel_m(self) -> f64 {
        match self {
            Self::Link(solution) => solution.tip_travel_m(),
            Self::Arm(solution) => solution.way_m,
        }
    }

    /// Errors of the quantities of each joint.
    pub(super) fn errors(self) -> &'a [PerQuantity<QuantityErrors>] {
        match self {
            Self::Link(solution) => std::slice::from_ref(&solution.accuracy.errors),
            Self::Arm(solution) => &solution.errors,
        }
    }
}

impl Answer<'_> {
    /// Share of the tip's travel by which the solved tip may miss the wanted one. A path of angles is cut off by the arcs of
    /// its links, which may be longer than the travel of the tip.
    pub(super) fn tip_tolerance(&self) -> f64 {
        let tolerance = self.solution.analysis().tip_tolerance();
        match self.solution {
            AnySolution::Link(_) => tolerance,
            AnySolution::Arm(solution) => tolerance.max(solution.tip_error),
        }
    }

    /// Every value that has a limit, with its measured error.
    pub(super) fn reached(&self) -> Vec<Reached> {
        match self.solution {
            AnySolution::Link(solution) => reached(solution, self.limits),
            AnySolution::Arm(solution) => reached(solution, self.limits),
        }
    }
}

/// Why a solution is not verified.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum VerificationError {
    /// The written samples are no torque.
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
            Self::Motion(error) => error.hint(),
            Self::Inversion(error) => error.hint(),
        }
    }
}

/// Why a solution is not played: a reason that its checks tell, or an error that ends all.
pub(super) enum Unplayed {
    Reason(String),
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
            error => Self::Error(error),
        }
    }
}
