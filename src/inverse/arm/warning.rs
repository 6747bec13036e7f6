//! What the user must know to believe the torques of an arm.

use thiserror::Error;

use crate::inverse::Warning;

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
}

impl ArmWarning {
    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Joint { warning, .. } | Self::Arm(warning) => warning.kind(),
            Self::NearlyStretched { .. } => "nearly_stretched",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Joint { warning, .. } | Self::Arm(warning) => warning.hint(),
            Self::NearlyStretched { .. } => {
                "a path that stays away from the stretched arm and from the first joint"
            }
        }
    }
}
