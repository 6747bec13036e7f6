//! Errors of the inversion of an arm.

use thiserror::Error;

use crate::elastica::ElasticaError;
use crate::inverse::InversionError;
use crate::motion::MotionError;
use crate::text::significant;

/// Reason why a valid arm and a valid path have no torques here.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ArmError {
    /// An error that one link can have, too.
    #[error(transparent)]
    Inversion(#[from] InversionError),
    /// The path at half its step.
    #[error("the path at half the step: {0}")]
    Finer(#[from] MotionError),
    /// A path of the tip, which two positions of the elbow can follow.
    #[error("elbow is missing: the second link can reach the path on the left or on the right")]
    NoElbow,
    /// A plan of the mesh for each link.
    #[error("{plans} plans of meshes, but must be {links}, one for each link")]
    Plans {
        /// Number of plans.
        plans: usize,
        /// Links of the arm.
        links: usize,
    },
    /// A motion along an arc for several links, or a path for one.
    #[error("the motion does not suit {links} links: one link needs an arc, several need a path")]
    OtherMotion {
        /// Links of the arm.
        links: usize,
    },
    /// A place of the tip beyond the reach of the first two links.
    #[error(
        "the end of the second link = {distance_m:.6} m from the first joint, but must be from {least_m:.6} to {most_m:.6} m \
         away: the arm does not {}",
        if distance_m < least_m { "fold that far" } else { "reach" }
    )]
    OutOfReach {
        /// Number of the sample, from 0.
        sample: usize,
        /// Distance in m.
        distance_m: f64,
        /// The least distance in m.
        least_m: f64,
        /// The largest distance in m.
        most_m: f64,
    },
    /// An elbow too straight or too folded to determine how the links follow the tip.
    #[error(
        "the sine of the elbow's angle = {sine:.4}, but must be at least {least} in size: the arm is stretched or folded"
    )]
    Stretched {
        /// Number of the sample, from 0.
        sample: usize,
        /// The sine.
        sine: f64,
        /// Smallest valid size.
        least: f64,
    },
    /// Second-order terms that grow where a body's rotary inertia holds a link's tip.
    #[error(
        "the second-order terms do not converge: at {} Hz, within the path's band, no torque moves the tip of link {}, which a \
         body's rotary inertia holds",
        significant(*frequency_hz, 4),
        link + 1
    )]
    Blocked {
        /// Number of the link, from 0.
        link: usize,
        /// The frequency in Hz.
        frequency_hz: f64,
    },
    /// Second-order terms that do not converge, not even to first order.
    #[error("{0}; those of first order alone do not converge either")]
    NorFirst(Box<ArmError>),
    /// Directions beside the tip's place that contradict it.
    #[error("angle{} = {found:.6} rad, but must be {expected:.6} rad to agree with x and y", link + 1)]
    Disagree {
        /// Number of the sample, from 0.
        sample: usize,
        /// Number of the link, from 0.
        link: usize,
        /// Prescribed direction in rad.
        found: f64,
        /// Direction from the tip's place in rad.
        expected: f64,
    },
}

impl ArmError {
    /// Number of the path's sample that causes the error, from 0, where one does.
    pub fn sample(&self) -> Option<usize> {
        match self {
            Self::OutOfReach { sample, .. }
            | Self::Stretched { sample, .. }
            | Self::Disagree { sample, .. } => Some(*sample),
            _ => None,
        }
    }

    /// Number of the link that causes the error, from 0, and its reason, where one does.
    pub fn link(&self) -> Option<(usize, &ElasticaError)> {
        match self {
            Self::Inversion(InversionError::Elastica(ElasticaError::OfLink { link, error })) => {
                Some((*link, error))
            }
            _ => None,
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::Inversion(error) => return error.hint(),
            Self::Finer(error) => return error.hint(),
            Self::NoElbow => {
                "set elbow = \"left\" if the second link turns left from the first, else \"right\""
            }
            Self::Plans { .. } | Self::OtherMotion { .. } => return None,
            Self::OutOfReach { distance_m, least_m, .. } if distance_m < least_m => {
                "use a path that keeps away from the first joint, or links whose lengths differ less"
            }
            Self::OutOfReach { .. } => "use a path within reach, or longer links",
            Self::Stretched { .. } => {
                "use a path that keeps away from the stretched arm and from the first joint, or a path of angles"
            }
            Self::Blocked { .. } => {
                "use a slower or smoother path, more damping, or analysis.second_order = \"first\", with a larger \
                 error of the tip"
            }
            Self::NorFirst(_) => {
                "use a slower motion or a stiffer link, or analysis.second_order = \"none\", which leaves all of \
                 them out, with a larger error of the tip"
            }
            Self::Disagree { .. } => {
                "check the units and the elbow, or leave x and y or the angles out"
            }
        })
    }
}
