use thiserror::Error;

use super::feedback::FeedbackError;
use crate::modal::DampingError;
use crate::numeric::{gigabytes, plain, rounded};

/// Why a torque is not played.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SimulationError {
    /// A torque of zero.
    #[error("the torque is zero in all samples, but must move the link")]
    NoTorque,
    /// A hub without inertia on a root without mass: its motion follows no differential equation.
    #[error("the hub moves no mass, but must: hub.inertia = 0, and the link's root has none")]
    MasslessHub,
    /// Damping that the mesh does not allow.
    #[error(transparent)]
    Damping(#[from] DampingError),
    /// Feedback that does not fit the torque.
    #[error(transparent)]
    Feedback(#[from] FeedbackError),
    /// An end before the torque's.
    #[error(
        "until = {until_s} s, but must not be before the torque's last sample, {} s",
        rounded(*end_s, 12)
    )]
    EndsEarly {
        /// The end asked for in s.
        until_s: f64,
        /// The torque's last time in s.
        end_s: f64,
    },
    /// More samples than this program holds.
    #[error(
        "until = {} s, {samples:.3e} samples, but must be at most {limit} samples",
        plain(*until_s)
    )]
    TooLong {
        /// The end asked for in s.
        until_s: f64,
        /// Samples that it needs.
        samples: f64,
        /// Samples possible.
        limit: usize,
    },
    /// More memory than is allowed.
    #[error(
        "{samples} samples of {modes} modes would need {} of memory, but must fit in the {} \
         available",
        gigabytes(*bytes),
        gigabytes(*allowed)
    )]
    TooMuchMemory {
        /// Samples of the simulation.
        samples: usize,
        /// Modes kept, rigid rotation and residual mode included.
        modes: usize,
        /// Bytes needed, about.
        bytes: usize,
        /// Bytes allowed.
        allowed: usize,
    },
    /// Numbers beyond double precision.
    #[error("the motion at {} s = not a finite number, but must be one", rounded(*time_s, 12))]
    NotFinite {
        /// The time in s.
        time_s: f64,
    },
}

impl SimulationError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Damping(error) => Some(error.hint()),
            Self::Feedback(error) => error.hint(),
            Self::TooLong { .. } | Self::TooMuchMemory { .. } => {
                Some("an earlier end, or a torque with a longer step")
            }
            Self::NotFinite { .. } => Some("the inputs are too large for double precision"),
            Self::EndsEarly { .. } => Some("the simulation goes on to the torque's end by itself"),
            Self::MasslessHub => Some("give the hub an inertia, however small"),
            Self::NoTorque => None,
        }
    }
}
