use thiserror::Error;

use crate::elastica::ElasticaError;
use crate::link::ParameterError;
use crate::model::ModelError;
use crate::text::{gigabytes, significant};

/// Reason why a valid link and a valid motion have no torque here.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InversionError {
    /// A mesh plan of another link.
    #[error(transparent)]
    Plan(#[from] ParameterError),
    /// No model of the link on its mesh, or no finite torque at a frequency.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A frequency where every torque moves the tip by rounding alone.
    #[error("no torque moves the tip at {} Hz", significant(*frequency_hz, 6))]
    BlockedTip {
        /// The frequency in Hz.
        frequency_hz: f64,
    },
    /// A torque whose square exceeds double precision.
    #[error("the peak torque = {peak_n_m:e} N m, but must lie from 1e-100 to 1e100 N m")]
    OutOfRange {
        /// Peak torque in N m.
        peak_n_m: f64,
    },
    /// A motor whose torque, angle, rate or power is not finite.
    #[error("the motor's {history} is not finite")]
    MotorNotFinite {
        /// The name of the history.
        history: &'static str,
    },
    /// An automatic mesh that does not converge.
    #[error(
        "mesh error = {error:.2e} of the peak torque with {elements} elements, but must be at most \
         {tolerance:e}"
    )]
    NotConverged {
        /// Error reached, relative to the peak torque.
        error: f64,
        /// Elements of the finest mesh tried.
        elements: usize,
        /// The tolerance of the mesh.
        tolerance: f64,
    },
    /// A link with gravity but without a direction.
    #[error("start_angle is missing: with gravity the direction of the link matters")]
    NoStartAngle,
    /// Ends of the motion that do not suit this link or the analysis.
    #[error("{0}")]
    Ends(RefusedEnds),
    /// A bent link without a solution.
    #[error(transparent)]
    Elastica(#[from] ElasticaError),
    /// A period that exceeds the memory limit.
    #[error(
        "the inversion would need {} of memory, but must fit in the {} available",
        gigabytes(*bytes),
        gigabytes(*allowed)
    )]
    TooMuchMemory {
        /// Approximate number of bytes needed.
        bytes: usize,
        /// Bytes allowed.
        allowed: usize,
    },
    /// A window too long for this program's transforms.
    #[error("the period = {} samples, but must be at most {limit}", counted(*samples))]
    TooLong {
        /// Samples needed.
        samples: usize,
        /// Samples possible.
        limit: usize,
    },
}

/// Reason why a motion cannot have its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum RefusedEnds {
    /// Weight or second-order terms, never at rest at a constant velocity.
    #[error(
        "the tip moves at the ends of its motion, but with gravity or second-order terms it must rest there or \
         repeat its motion"
    )]
    Bent,
    /// Drag on every mass: even a constant velocity needs a torque.
    #[error(
        "the tip moves at the ends of its motion, but with damping.alpha above 0 it must rest there"
    )]
    Drag,
    /// A lead or a lag of a motion without beginning and end.
    #[error("analysis.lead and analysis.lag have no meaning for a periodic motion")]
    Edges,
    /// A cycle under gravity that ends in another direction.
    #[error(
        "the cycle does not make whole turns, but with gravity it must end in its first direction"
    )]
    Turned,
}

impl RefusedEnds {
    fn hint(self) -> &'static str {
        match self {
            Self::Bent => {
                "add the samples that bring the tip to rest, or leave out gravity and second-order terms: \
                 second_order = \"none\""
            }
            Self::Drag => "use damping.beta or a damping ratio instead",
            Self::Edges => "leave them out",
            Self::Turned => "correct the mean of the velocity column, or leave it out",
        }
    }
}

/// Writes a number of samples; a huge one by its power of ten.
fn counted(samples: usize) -> String {
    if samples < 1_000_000_000_000 {
        samples.to_string()
    } else {
        format!("{:.0e} or more", samples as f64)
    }
}

impl InversionError {
    /// True if a file or an option causes the error, whatever the link.
    pub fn is_of_input(&self) -> bool {
        matches!(self, Self::NoStartAngle | Self::Ends(RefusedEnds::Edges))
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::Plan(_) => "make the plan of the mesh from this link",
            Self::Model(error) => error.hint(),
            Self::BlockedTip { .. } => {
                "use damping, more elements or a smoother motion; the cause is a payload's inertia without damping, \
                 damping that absorbs every wave, or a mesh far too coarse"
            }
            Self::MotorNotFinite { .. } => {
                "check the units of the drive and of the motion, and their powers of ten"
            }
            Self::OutOfRange { .. } => {
                "check the units of motion and link, and their powers of ten"
            }
            Self::NoStartAngle => {
                "set start_angle in the link file, the direction of the link before the motion, or write the motion \
                 as angles"
            }
            Self::Ends(why) => why.hint(),
            Self::Elastica(error) => return error.hint(),
            Self::NotConverged { .. } => {
                "loosen mesh.tolerance, or sample the motion more smoothly"
            }
            Self::TooMuchMemory { .. } | Self::TooLong { .. } => {
                "use a longer step, or a shorter analysis.lead and analysis.lag"
            }
        })
    }
}
