use thiserror::Error;

use crate::beam::MeshPlan;
use crate::inverse::{InversionError, Solution};
use crate::motion::MotionError;
use crate::response::{HistoryError, SimulationError};
use crate::result::Limits;

/// Bound on what elements, modes or a step of the user's own choice may change; no tolerance sets it.
pub(super) const CHOSEN: f64 = 1e-2;

/// A solution, the plan of its mesh and the limits set, and its torque as written.
#[derive(Clone, Copy)]
pub struct Answer<'a> {
    /// The plan of its mesh.
    pub plan: &'a MeshPlan,
    /// The limits of link and motor.
    pub limits: &'a Limits,
    /// The solution.
    pub solution: &'a Solution,
    /// Memory in bytes that the checks may take; `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// The torque in N m, rounded as in its file.
    pub written_torque_n_m: &'a [f64],
}

/// One measured number against its bound.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Name in summary.json: `tip_error`, `mesh_halving`, ….
    pub name: &'static str,
    /// What was measured, for a person to read.
    pub what: &'static str,
    /// What the number is a share of.
    pub of: &'static str,
    /// Its result.
    pub outcome: Outcome,
}

/// Result of a check.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A number and the largest one that passes.
    Measured {
        /// What was found.
        found: f64,
        /// Its bound.
        bound: f64,
    },
    /// The check was not made.
    NotMeasured {
        /// The reason.
        reason: String,
    },
}

/// The names of a check, before its number is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label {
    pub(super) name: &'static str,
    pub(super) what: &'static str,
    pub(super) of: &'static str,
}

impl Label {
    /// The check with its number.
    pub(super) fn measured(self, found: f64, bound: f64) -> Check {
        self.with(Outcome::Measured { found, bound })
    }

    /// The check without a number.
    pub(super) fn not_measured(self, reason: String) -> Check {
        self.with(Outcome::NotMeasured { reason })
    }

    fn with(self, outcome: Outcome) -> Check {
        let Self { name, what, of } = self;
        Check { name, what, of, outcome }
    }
}

impl Check {
    /// True if the value exceeds its bound or is NaN.
    pub fn fails(&self) -> bool {
        match self.outcome {
            Outcome::Measured { found, bound } => found.is_nan() || found > bound,
            Outcome::NotMeasured { .. } => false,
        }
    }

    /// What the user can do where it fails.
    pub fn hint(&self) -> &'static str {
        match self.name {
            "tip_error" | "tip_error_viscous" => {
                "a tighter analysis.tolerance, no analysis.lead and analysis.lag of your own, or more --digits"
            }
            "wrap_around" => {
                "a looser analysis.tolerance, or a longer analysis.lead and analysis.lag"
            }
            "tip_solved" => "a shorter step, a smoother motion or a looser analysis.tip_tolerance",
            "step_halving" | "step_halving_motor" | "energy" => {
                "a shorter step or a smoother motion"
            }
            "mesh_halving" => "more elements, or mesh.elements = \"auto\"",
            "truncation" => "more modes: analysis.modes",
            "tip_deflection" => "a slower motion or a stiffer link",
            name if name.starts_with("limit") => "a slower motion, or another limit",
            _ => "please report this as an error of the program",
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
            Self::Motion(_) => None,
            Self::Inversion(error) => error.hint(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_nan_fails() {
        let label = Label { name: "x", what: "", of: "" };
        let fails = |found| label.measured(found, 1.0).fails();
        assert!(!fails(1.0) && fails(1.1) && fails(f64::NAN));
        assert!(!label.not_measured("too large".into()).fails());
    }
}
