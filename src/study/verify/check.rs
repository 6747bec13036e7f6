//! Kinds of checks, each with its bound; the solution that they check, and the errors of a verification.

use thiserror::Error;

use crate::beam::MeshPlan;
use crate::inverse::{InversionError, Solution};
use crate::link::ParameterError;
use crate::motion::{Motion, MotionError};
use crate::response::{HistoryError, SimulationError};
use crate::result::{Check, Limits, Reached, reached};

/// Bound on changes by the user's choice of elements, modes or step, which no tolerance sets.
pub(super) const CHOSEN: f64 = 1e-2;

/// Bound on the deviation of a link's tip with all terms of second order, over its travel. The claimed deviation is
/// up to three times the true one.
pub(super) const STRAYS: f64 = 3e-2;

/// Last of the ten digits of tip.csv, over the tip's travel.
const ROUNDED: f64 = 1e-10;

/// Largest error of the played tip over its travel, unless the tolerance is looser.
const TIP: f64 = 1e-3;

/// Largest difference of the moved hub's torque.
const TORQUE: f64 = 1e-3;

/// Largest imbalance of energy over the largest energy, unless the tolerance is tighter.
const ENERGY: f64 = 1e-6;

/// Largest imbalance of energy of an arm, whose work is added up over its samples.
const ENERGY_OF_ARM: f64 = 1e-4;

/// Largest difference of a stiff arm's torques from the rigid one's.
const RIGID: f64 = 1e-6;

/// Largest relative difference if round-off does not spoil the dense solve.
const AGREEMENT: f64 = 1e-9;

/// Name of the size that divides errors of a quantity.
pub(super) const PEAK: &str = "its peak";
pub(super) const RANGE: &str = "its range";

/// A kind of check, without its number.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    name: &'static str,
    what: &'static str,
    of: &'static str,
    /// The largest number that passes. Two checks measure a tighter or looser bound.
    pub(super) bound: fn(&Answer) -> f64,
    hint: &'static str,
}

impl Kind {
    pub(super) const TIP_ERROR: Self = Self {
        name: "tip_error",
        what: "tip, the link's own damping",
        of: "the tip's travel",
        bound: |answer| answer.tip_tolerance() + TIP.max(answer.solution.analysis.tolerance()),
        hint: "use a tighter analysis.tolerance or more --digits, or leave analysis.lead and analysis.lag out",
    };
    pub(super) const TIP_ERROR_VISCOUS: Self = Self {
        name: "tip_error_viscous",
        what: "tip, viscous damping, as predicted",
        ..Self::TIP_ERROR
    };
    pub(super) const TIP_OF_HUB: Self = Self {
        name: "tip_error",
        what: "tip, the hub moved as solved",
        hint: "use analysis.second_order = \"full\", a tighter analysis.tolerance, or more elements",
        ..Self::TIP_ERROR
    };
    pub(super) const TORQUE_OF_HUB: Self = Self {
        name: "torque_of_hub",
        what: "torque that the moved hub takes",
        of: "the torque, rms",
        bound: |_| TORQUE,
        hint: "use analysis.second_order = \"full\", more elements, a shorter step or a smoother motion",
    };
    pub(super) const OF_HUB: [Self; 2] = [Self::TIP_OF_HUB, Self::TORQUE_OF_HUB];
    /// Checks of a link, solved again with viscous damping.
    pub(super) const OF_HUB_VISCOUS: [Self; 2] = [
        Self {
            name: "tip_error_viscous",
            what: "tip, hub moved, viscous damping",
            ..Self::TIP_OF_HUB
        },
        Self {
            name: "torque_of_hub_viscous",
            what: "torque of it, viscous damping",
            ..Self::TORQUE_OF_HUB
        },
    ];
    pub(super) const TIP_OF_JOINTS: Self =
        Self { what: "tip, the joints moved as solved", ..Self::TIP_OF_HUB };
    pub(super) const OF_JOINTS: [Self; 2] = [
        Self::TIP_OF_JOINTS,
        Self {
            name: "torque_of_joint",
            what: "torque taken by moved joint",
            ..Self::TORQUE_OF_HUB
        },
    ];
    pub(super) const TORQUE_AT_REST: Self = Self {
        name: "torque_at_rest",
        what: "torque at rest of joint",
        of: RANGE,
        ..Self::TORQUE_OF_HUB
    };
    pub(super) const TIP_SOLVED: Self = Self {
        name: "tip_solved",
        what: "tip that is solved",
        of: "the tip's travel",
        bound: |answer| answer.tip_tolerance() + ROUNDED,
        hint: "use a shorter step, a smoother motion or a looser analysis.tip_tolerance",
    };
    pub(super) const MESH: Self = Self {
        name: "mesh_halving",
        what: "with elements halved",
        of: PEAK,
        bound: |Answer { plans, .. }| {
            let is_automatic = plans.iter().any(MeshPlan::is_automatic);
            if is_automatic { MeshPlan::smallest_tolerance(plans) } else { CHOSEN }
        },
        hint: "use more elements, or mesh.elements = \"auto\"",
    };
    pub(super) const WINDOW: Self = Self {
        name: "wrap_around",
        what: "at the window's edge",
        of: PEAK,
        bound: |answer| answer.solution.analysis.tolerance(),
        hint: "use a looser analysis.tolerance, or a longer analysis.lead and analysis.lag",
    };
    pub(super) const MODES: Self = Self {
        name: "truncation",
        what: "with all modes",
        of: PEAK,
        bound: |_| CHOSEN,
        hint: "use more modes: analysis.modes",
    };
    pub(super) const ITERATION: Self = Self {
        name: "iteration",
        what: "with further iterations",
        of: PEAK,
        bound: |answer| answer.solution.analysis.tolerance(),
        hint: "use a slower motion or a stiffer link",
    };
    pub(super) const STEP: Self = Self {
        name: "step_halving",
        what: "with the step halved",
        of: "the torque, rms",
        bound: |_| CHOSEN,
        hint: "use a shorter step or a smoother motion",
    };
    pub(super) const STEP_OF_MOTOR: Self =
        Self { name: "step_halving_motor", of: PEAK, ..Self::STEP };
    pub(super) const DENSE: Self = Self {
        name: "dense_transfer",
        what: "T/a_tip of the paper's dense H",
        of: "T/a_tip",
        bound: |_| AGREEMENT,
        hint: "please report this as an error of the program",
    };
    pub(super) const RIGID_ARM: Self = Self {
        name: "rigid_arm",
        what: "links that do not bend",
        of: "rigid torques' ranges",
        bound: |_| RIGID,
        ..Self::DENSE
    };
    pub(super) const ENERGY: Self = Self {
        name: "energy",
        what: "work less energy held and lost",
        of: "the largest energy",
        bound: |answer| ENERGY.min(answer.solution.analysis.tolerance()),
        hint: "use a shorter step or a smoother motion",
    };
    pub(super) const ENERGY_OF_ARM: Self = Self { bound: |_| ENERGY_OF_ARM, ..Self::ENERGY };
    pub(super) const MODEL: Self = Self {
        name: "model",
        what: "tip with all terms",
        of: "the tip's travel",
        bound: |_| STRAYS,
        hint: "use analysis.second_order = \"full\", a slower motion or a stiffer link",
    };
    /// Check of a limit by its key in the link file.
    pub(super) const LIMIT: Self = Self {
        name: "limit",
        what: "limits",
        of: "the limit",
        bound: |_| 1.0,
        hint: "use a slower motion, or another limit",
    };

    /// The check with its number.
    pub(super) fn measured(&self, answer: &Answer, found: f64) -> Check {
        self.measured_to(found, (self.bound)(answer))
    }

    /// The check with its number and a measured bound.
    pub(super) fn measured_to(&self, found: f64, bound: f64) -> Check {
        let passes = found <= bound;
        let (found, bound, reason) = (Some(found), Some(bound), None);
        Check { found, bound, reason, passes, ..self.not_measured("") }
    }

    /// The check without a number.
    pub(super) fn not_measured(&self, reason: impl Into<String>) -> Check {
        let [name, what, of] = [self.name, self.what, self.of].map(str::to_owned);
        let (found, bound, reason) = (None, None, Some(reason.into()));
        Check { name, what, of, found, bound, reason, passes: true, hint: self.hint }
    }
}

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
    /// The link of a check is impossible.
    #[error("the link of a check: {0}")]
    Link(#[from] ParameterError),
    /// The motion at half the step has no torque.
    #[error("the motion at half the step: {0}")]
    Inversion(#[from] InversionError),
}

impl VerificationError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Link(_) => None,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_nan_fails() {
        let passes = |found| Kind::MESH.measured_to(found, 1.0).passes;
        assert!(passes(1.0) && !passes(1.1) && !passes(f64::NAN));
        assert!(Kind::MESH.not_measured("too large").passes);
    }
}
