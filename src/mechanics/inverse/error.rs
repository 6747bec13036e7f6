use thiserror::Error;

use crate::elastica::ElasticaError;
use crate::link::ParameterError;
use crate::model::ModelError;
use crate::text::{gigabytes, significant};

/// Share of the buckling weight from which on no link is solved.
pub(super) const BUCKLED: f64 = 0.98;

/// Reason why a valid link or arm and a valid motion have no torques here.
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
    /// A weight that buckles the link, or next to it.
    #[error(
        "the weight is {share:.3} of the one that buckles the link, but must be below {BUCKLED}"
    )]
    Buckled {
        /// The weight over the one that buckles the link.
        share: f64,
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
    /// A path of the tip, which two positions of the elbow can follow.
    #[error("elbow is missing: the second link can reach the path on the left or on the right")]
    NoElbow,
    /// A path of a carriage that the arm does not have.
    #[error("carriage is a column of the path, but the arm has no [carriage]")]
    NoCarriage,
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
    /// Second-order terms that do not converge for a motion with a frequency at which no torque moves a link's output.
    #[error(
        "{refused}; at {} Hz, within the motion's band, no torque moves the tip{} (rotary inertia, shear or payload)",
        significant(*frequency_hz, 4),
        link.map_or_else(String::new, |link| format!(" of link {}", link + 1))
    )]
    Blocked {
        /// Its iteration.
        refused: Box<InversionError>,
        /// Number of the link, from 0. `None` for the only one.
        link: Option<usize>,
        /// The frequency in Hz.
        frequency_hz: f64,
    },
    /// Second-order terms that do not converge, not even to first order.
    #[error("{0}; those of first order alone do not converge either")]
    NorFirst(Box<InversionError>),
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

/// Reason why a motion cannot have its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum RefusedEnds {
    /// Weight or second-order terms, never at rest at a constant velocity.
    #[error(
        "the tip moves at the ends of its motion, but an arm, or a link with gravity or second-order terms, must rest \
         there or repeat its motion"
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
            Self::Elastica(ElasticaError::OfLink { link, error }) => Some((*link, error)),
            _ => None,
        }
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
            Self::Buckled { .. } => "use a stiffer or lighter link, or a lighter payload",
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
            Self::NoElbow => {
                "set elbow = \"left\" if the second link turns left from the first, else \"right\""
            }
            Self::NoCarriage => {
                "add carriage = { mass = …, axis = [1, 0] } above the links, or leave the column out"
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
                "use a slower or smoother motion, more damping, or analysis.second_order = \"first\", with a larger \
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
