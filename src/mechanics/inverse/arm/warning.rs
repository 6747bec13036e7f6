//! What the user must know to believe the torques of an arm.

use serde::Serialize;
use thiserror::Error;

use crate::inverse::Warning;
use crate::text::significant;

/// How far the tip of a solution with fewer terms strays at most from where it should be, over its way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Straying {
    /// As the joints, moved as solved, lead it.
    Measured(f64),
    /// By how much shorter the chords of bent links are; of an arm that no equation in time moves.
    Estimated(f64),
}

impl Straying {
    /// The share of the way.
    pub fn share(self) -> f64 {
        match self {
            Self::Measured(share) | Self::Estimated(share) => share,
        }
    }
}

/// Something that the user must know to believe the answer. Returned, never printed here.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ArmWarning {
    /// Of one joint and its link.
    #[error("joint {}: {warning}", joint + 1)]
    Joint {
        /// Number of the joint, from 0.
        joint: usize,
        /// What it is.
        warning: Warning,
    },
    /// Of the whole arm.
    #[error("{0}")]
    Arm(Warning),
    /// An elbow that hardly tells how the links follow the tip.
    #[error(
        "the sine of the elbow's angle falls to {sine:.3} at {time_s:.3} s: the arm is nearly stretched or folded there"
    )]
    NearlyStretched {
        /// The sine.
        sine: f64,
        /// When, in s.
        time_s: f64,
    },
    /// Second-order terms that do not converge, of which those of first order are counted.
    #[error(
        "the second-order terms do not converge, only those of first order are counted: the tip strays by {}",
        strays(*straying)
    )]
    FellBack {
        /// How far.
        straying: Straying,
    },
}

fn strays(straying: Straying) -> String {
    let share = significant(straying.share(), 2);
    match straying {
        Straying::Measured(_) => {
            format!("{share} of its way, measured with the joints moved as solved")
        }
        Straying::Estimated(_) => {
            format!("about {share} of its way, estimated by how much shorter bent links are")
        }
    }
}

impl ArmWarning {
    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Joint { warning, .. } | Self::Arm(warning) => warning.kind(),
            Self::NearlyStretched { .. } => "nearly_stretched",
            Self::FellBack { .. } => "fell_back_to_first_order",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Joint { warning, .. } | Self::Arm(warning) => warning.hint(),
            Self::NearlyStretched { .. } => {
                "a path that stays away from the stretched arm and from the first joint"
            }
            Self::FellBack { .. } => {
                "a slower or smoother motion, or stiffer links; analysis.second_order = \"full\" refuses instead"
            }
        }
    }
}
