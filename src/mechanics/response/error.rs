//! Errors and warnings of a simulation.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::driving::CycleError;
use crate::link::ParameterError;
use crate::modal::DampingError;
use crate::numeric::{TimeGrid, dot, largest, rounded};
use crate::text::{about_percent, gigabytes, plain};

/// Reason why a simulation is refused or fails.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SimulationError {
    /// A mesh plan of another link.
    #[error(transparent)]
    Plan(#[from] ParameterError),
    /// A torque of zero.
    #[error("the torque is zero in all samples, but must move the link")]
    NoTorque,
    /// A hub that does not move.
    #[error("the hub angle is the same in all samples, but must move the link")]
    NoTurn,
    /// A hub without inertia on a root without mass: its motion follows no differential equation.
    #[error("the hub moves no mass: hub.inertia = 0, and the link has no mass at its root")]
    MasslessHub,
    /// A link without equations for weight or large angles.
    #[error("{what}, but weight and second-order terms need a link {known}")]
    NotDerived {
        /// Unsupported property of the link.
        what: &'static str,
        /// Supported alternatives.
        known: &'static str,
    },
    /// A link with gravity but without a direction.
    #[error("start_angle is missing: with gravity the direction of the link matters")]
    NoStartAngle,
    /// A state that does not suit the link, or that comes with a prescribed motion of the hub.
    #[error("the state {found}, but must {must}")]
    State {
        /// Invalid content of the state, in words.
        found: String,
        /// Requirement, in words.
        must: String,
    },
    /// A link too soft for its weight.
    #[error("the link has no shape at rest under its weight where it starts")]
    NoRest,
    /// No cycle that repeats.
    #[error(transparent)]
    Cycle(#[from] CycleError),
    /// Damping that does not suit the mesh.
    #[error(transparent)]
    Damping(#[from] DampingError),
    /// A reference of the feedback at other times than the torque.
    #[error(
        "the reference has {} samples from {} s at {} s, but must have the torque's times: {} samples from {} s at {} s",
        found.len,
        rounded(found.time_s(0), 12),
        rounded(found.step_s, 12),
        torque.len,
        rounded(torque.time_s(0), 12),
        rounded(torque.step_s, 12)
    )]
    OtherTimes {
        /// Times of the reference.
        found: TimeGrid,
        /// Times of the torque.
        torque: TimeGrid,
    },
    /// An end before the torque's.
    #[error(
        "until = {until_s} s, but must not be before the torque's last sample, {} s",
        rounded(*end_s, 12)
    )]
    EndsEarly {
        /// Requested end in s.
        until_s: f64,
        /// The torque's last time in s.
        end_s: f64,
    },
    /// More samples than this program supports.
    #[error(
        "until = {} s, {samples:.3e} samples, but must be at most {limit} samples",
        plain(*until_s)
    )]
    TooLong {
        /// Requested end in s.
        until_s: f64,
        /// Samples up to that end.
        samples: f64,
        /// Samples possible.
        limit: usize,
    },
    /// More memory than the limit.
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
        /// Approximate number of bytes needed.
        bytes: usize,
        /// Bytes allowed.
        allowed: usize,
    },
    /// Steps too long for the motion.
    #[error("the motion does not converge at {} s", rounded(*time_s, 12))]
    NotConverged {
        /// The time in s.
        time_s: f64,
    },
    /// Numbers beyond double precision.
    #[error("the motion at {} s is not a finite number", rounded(*time_s, 12))]
    NotFinite {
        /// The time in s.
        time_s: f64,
    },
}

impl SimulationError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::Plan(_) => "make the plan of the mesh from this link",
            Self::Damping(error) => error.hint(),
            Self::Cycle(error) => error.hint(),
            Self::OtherTimes { .. } => "take hub_angle.csv and torque.csv of one run of solve",
            Self::TooLong { .. } | Self::TooMuchMemory { .. } => {
                "use an earlier end, or a torque with a longer step"
            }
            Self::NotConverged { .. } => {
                "use damping (beta = 2e-3), hub.inertia, a larger drive.friction_rate or a shorter step"
            }
            Self::NotFinite { .. } => "the inputs are too large for double precision",
            Self::EndsEarly { .. } => "leave it out to end with the torque",
            Self::NotDerived { .. } => {
                "--set 'gravity=[0, 0]' and analysis.second_order = \"none\" play the linear link"
            }
            Self::NoStartAngle => {
                "set start_angle: --set 'start_angle=\"-90 deg\"' is a hanging link where gravity is along -y"
            }
            Self::State { .. } => "use a state that --save-state of this link wrote",
            Self::NoRest => "use a stiffer link, or another start_angle",
            Self::MasslessHub => "set hub.inertia above 0, however small",
            Self::NoTorque | Self::NoTurn => return None,
        })
    }
}

/// Warning threshold of a torque's first or last sample over its peak.
pub(super) const STEP_SHARE: f64 = 1e-3;

/// Warning threshold of the change by a halved step of losses, over the motion.
const COARSE_LOSSES: f64 = 1e-3;

/// Warning threshold of the hub's first rate over its peak.
const MOVES: f64 = 1e-2;

/// Warning threshold of a torque's roughness over that of noise. A sine of six samples a period has 0.4.
const ROUGH: f64 = 0.4;

/// Warning threshold of steps in a period of the first mode.
const STEPS_IN_A_PERIOD: f64 = 8.0;

/// A fact that the user must know to judge a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SimulationWarning {
    /// Losses of a drive that change their sign faster than the shortest steps.
    #[error(
        "the losses of the drive are too steep for the step: halving it changes the motion by {:.1} %",
        100.0 * change
    )]
    CoarseLosses {
        /// Largest change of tip or hub by the last halved step, over its motion.
        change: f64,
    },
    /// A torque that does not begin at zero.
    #[error(
        "the torque begins with {:?} N m, {:.1} % of its peak: it acts on the resting link as a jump",
        rounded(*torque_n_m, 4),
        100.0 * share
    )]
    BeginsWithJump {
        /// First sample in N m.
        torque_n_m: f64,
        /// The same over the peak.
        share: f64,
    },
    /// A torque that does not end at zero.
    #[error(
        "{} ends with {:?} N m, {:.1} % of {}: it drops to zero there",
        torque(*joint),
        rounded(*torque_n_m, 4),
        100.0 * share,
        if joint.is_some() { "the largest range of a torque" } else { "its peak" }
    )]
    EndsWithJump {
        /// Number of the joint of an arm, from 1.
        joint: Option<usize>,
        /// Last sample in N m.
        torque_n_m: f64,
        /// Last sample over the peak, or over the largest range of an arm's torques.
        share: f64,
    },
    /// A hub that already moves at its first sample.
    #[error(
        "{} begins with {:?} rad/s, {:.1} % of its peak rate: {} rests before its first sample, and \
         starts within the first step",
        moving(*joint),
        rounded(*rate_rad_s, 4),
        100.0 * share,
        if joint.is_some() { "it" } else { "the hub" }
    )]
    HubBeginsMoving {
        /// Number of the joint of an arm, from 1.
        joint: Option<usize>,
        /// Rate at the first sample in rad/s.
        rate_rad_s: f64,
        /// The same over the peak.
        share: f64,
    },
    /// A hub that still moves at its last sample, where the simulation goes on.
    #[error(
        "{} ends with {:?} rad/s, {:.1} % of its peak rate: {} stops within the step after its last sample",
        moving(*joint),
        rounded(*rate_rad_s, 4),
        100.0 * share,
        if joint.is_some() { "it" } else { "the hub" }
    )]
    HubEndsMoving {
        /// Number of the joint of an arm, from 1.
        joint: Option<usize>,
        /// Rate at the last sample in rad/s.
        rate_rad_s: f64,
        /// The same over the peak.
        share: f64,
    },
    /// A torque from the steps or the noise of a recorded hub angle.
    #[error(
        "the torque jumps from sample to sample, with {:.0} % of the roughness of noise: it contains the second \
         derivative of the encoder's noise; the tip's motion hardly does",
        100.0 * share
    )]
    RoughTorque {
        /// Roughness over that of noise.
        share: f64,
    },
    /// A step too long to show the vibration.
    #[error(
        "the step of {:?} s leaves {:?} steps to a period of the first mode, {:?} s: the rows do not show its vibration",
        rounded(*step_s, 12),
        rounded(*steps, 2),
        rounded(*period_s, 4)
    )]
    CoarseStep {
        /// Step in s.
        step_s: f64,
        /// Period of the first mode in s.
        period_s: f64,
        /// Period over step.
        steps: f64,
    },
    /// Noticeable terms of second order outside the linear model.
    #[error(
        "large deflections and centrifugal stiffening, which the linear model leaves out, change deflections by {} of \
         their peak at most, and move the tip by {} of its travel",
        about_percent(*deflection),
        about_percent(*tip)
    )]
    InexactModel {
        /// Change of the tip by these terms, over its travel.
        tip: f64,
        /// Change of deflections by these terms, over the largest.
        deflection: f64,
    },
    /// A torque that does not begin with the holding torque.
    #[error(
        "{} begins with {:?} N m, but {:?} N m hold the {body} where it starts: the difference acts on the \
         resting {body} as a jump, {:.1} % of {}",
        torque(*joint),
        rounded(*torque_n_m, 6),
        rounded(*holding_n_m, 6),
        100.0 * share,
        if joint.is_some() { "the largest range of a torque" } else { "the torque's range" },
        body = if joint.is_some() { "arm" } else { "link" }
    )]
    BeginsUnheld {
        /// Number of the joint of an arm, from 1.
        joint: Option<usize>,
        /// First sample in N m.
        torque_n_m: f64,
        /// Torque in N m that holds the links.
        holding_n_m: f64,
        /// Their difference over the range, for an arm over the largest range of any torque.
        share: f64,
    },
    /// A reference that does not begin at the hub's angle.
    #[error(
        "the reference{} begins at {:?} rad, but the {} stands at {:?} rad: the feedback turns it there",
        joint.map_or(String::new(), |joint| format!(" of joint {joint}")),
        rounded(*reference_rad, 6),
        if joint.is_some() { "joint" } else { "hub" },
        rounded(*hub_rad, 6)
    )]
    ReferenceApart {
        /// Number of the joint of an arm, from 1.
        joint: Option<usize>,
        /// First angle of the reference in rad.
        reference_rad: f64,
        /// Angle of the hub, or of the joint, at the start in rad.
        hub_rad: f64,
    },
    /// A state with waves too short for the modes.
    #[error(
        "the modes leave out {share:.1e} of the state (root of its energy): its shortest waves"
    )]
    StateCut {
        /// Omitted part of the state, over the whole.
        share: f64,
    },
    /// A large motion that refinement still changes.
    #[error(
        "the last refinement still changes the tip by {tip:.1e} of its travel, {} by \
         {hub_angle:.1e} of {} (half the step, more angles)",
        if *is_arm { "a joint" } else { "the hub angle" },
        if *is_arm { "the largest turn" } else { "its peak" }
    )]
    Unsettled {
        /// Change of the tip over its travel.
        tip: f64,
        /// Change of the hub angle over its peak, or of a joint over the largest turn of any.
        hub_angle: f64,
        /// Whether the motion is that of an arm.
        is_arm: bool,
    },
    /// An upright link with more than the weight that buckles it.
    #[error(
        "the weight is {share:.2} of the weight that buckles the link: the link falls from its straight shape, and its \
         first mode has no period"
    )]
    Falls {
        /// The weight over the buckling weight.
        share: f64,
    },
    /// Work that energy and losses do not account for.
    #[error("work and energy differ by {share:.1e} of the largest of them")]
    Imbalance {
        /// The difference over the largest work or energy.
        share: f64,
    },
    /// Too few elements or modes for the torque.
    #[error(
        "mesh and modes make the tip wrong by {tip:.1e} of its travel, the hub angle by \
         {hub_angle:.1e} of its peak (elements halved)"
    )]
    CoarseMesh {
        /// Error of the tip over its travel.
        tip: f64,
        /// Error of the hub angle over its peak.
        hub_angle: f64,
    },
}

/// Name of a torque in messages.
fn torque(joint: Option<usize>) -> String {
    joint.map_or("the torque".to_owned(), |joint| format!("torque{joint}"))
}

/// Name of a joint that moves in messages.
fn moving(joint: Option<usize>) -> String {
    joint.map_or("the hub angle".to_owned(), |joint| format!("joint {joint}"))
}

impl SimulationWarning {
    /// Name of the kind in summary.json.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::BeginsWithJump { .. } => "begins_with_jump",
            Self::EndsWithJump { .. } => "ends_with_jump",
            Self::HubBeginsMoving { .. } => "hub_begins_moving",
            Self::HubEndsMoving { .. } => "hub_ends_moving",
            Self::RoughTorque { .. } => "rough_torque",
            Self::CoarseStep { .. } => "coarse_step",
            Self::InexactModel { .. } => "inexact_model",
            Self::BeginsUnheld { .. } => "begins_unheld",
            Self::ReferenceApart { .. } => "reference_apart",
            Self::StateCut { .. } => "state_cut",
            Self::Unsettled { .. } => "unsettled",
            Self::Falls { .. } => "falls",
            Self::Imbalance { .. } => "imbalance",
            Self::CoarseMesh { .. } => "coarse_mesh",
            Self::CoarseLosses { .. } => "coarse_losses",
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::EndsWithJump { joint: Some(_), .. } => {
                "use torques that end at zero, as those of solve do unless the window is cut"
            }
            Self::BeginsWithJump { .. } | Self::EndsWithJump { .. } => {
                "use a torque that begins and ends at zero, as that of solve for an uncut window and a tip at rest"
            }
            Self::HubBeginsMoving { .. } => "use a recording that begins at rest",
            Self::HubEndsMoving { .. } => {
                "use a recording that ends at rest, or an earlier --until"
            }
            Self::RoughTorque { .. } => {
                "compare the tip, or record the hub with more counts or at a longer step"
            }
            Self::CoarseStep { .. } => "use a torque with a shorter step",
            Self::InexactModel { .. } => {
                "use analysis.second_order = \"full\" if the damping allows it, a smaller torque or a stiffer link"
            }
            Self::BeginsUnheld { joint: Some(_), .. } => {
                "start the arm where its path starts: torques.csv of solve begins with the holding torque"
            }
            Self::BeginsUnheld { .. } => {
                "set start_angle to that of the run: torque.csv of solve begins with the holding torque"
            }
            Self::ReferenceApart { joint: Some(_), .. } => {
                "start the arm where its path starts: joint_angles.csv of solve begins there"
            }
            Self::ReferenceApart { .. } => {
                "set start_angle to that of the run: hub_angle.csv of solve begins there"
            }
            Self::StateCut { .. } => "use the mesh of the earlier run, and a shorter step",
            Self::Unsettled { is_arm: true, .. } => {
                "use feedback if the arm falls from its pose; else torques without jumps, or damping and hub.inertia"
            }
            Self::Falls { .. } => "use a stiffer or lighter link, or a lighter payload",
            Self::Imbalance { .. } => "use a shorter step of the torques, or smaller gains",
            Self::Unsettled { .. } => {
                "use feedback if the link falls from its pose; else an input without jumps, or damping and hub.inertia"
            }
            Self::CoarseLosses { .. } => {
                "use a larger drive.friction_rate, or a voltage with a shorter step"
            }
            Self::CoarseMesh { .. } => {
                "use more elements, mesh.elements = \"auto\", or a torque without jumps and corners"
            }
        }
    }

    /// Warnings of a torque that jumps at its first or its last sample.
    pub(super) fn jumps(torque_n_m: &[f64]) -> [Option<Self>; 2] {
        let peak = largest(torque_n_m);
        let share = |torque_n_m: f64| torque_n_m.abs() / peak;
        let (first, last) = (torque_n_m[0], torque_n_m[torque_n_m.len() - 1]);
        let begins = Self::BeginsWithJump { torque_n_m: first, share: share(first) };
        let ends = Self::EndsWithJump { joint: None, torque_n_m: last, share: share(last) };
        let is_jump = |torque_n_m: f64| share(torque_n_m) > STEP_SHARE;
        [is_jump(first).then_some(begins), is_jump(last).then_some(ends)]
    }

    /// Warnings of a hub, or of a joint of an arm by its number, that moves at its first or its last sample.
    pub(super) fn hub_moves(joint: Option<usize>, rate_rad_s: &[f64]) -> [Option<Self>; 2] {
        let peak = largest(rate_rad_s);
        let share = |rate_rad_s: f64| rate_rad_s.abs() / peak;
        let (first, last) = (rate_rad_s[0], rate_rad_s[rate_rad_s.len() - 1]);
        let begins = Self::HubBeginsMoving { joint, rate_rad_s: first, share: share(first) };
        let ends = Self::HubEndsMoving { joint, rate_rad_s: last, share: share(last) };
        let moves = |rate_rad_s: f64| share(rate_rad_s) > MOVES;
        [moves(first).then_some(begins), moves(last).then_some(ends)]
    }

    /// A warning of a torque as rough as noise.
    ///
    /// Second differences of independent samples are √6 times as large as the samples.
    pub(super) fn rough(torque_n_m: &[f64]) -> Option<Self> {
        let bends: Vec<f64> = torque_n_m.windows(3).map(|t| t[0] - 2.0 * t[1] + t[2]).collect();
        let share = (dot(&bends, &bends) / (6.0 * dot(torque_n_m, torque_n_m))).sqrt();
        (share > ROUGH).then_some(Self::RoughTorque { share })
    }

    /// A warning of losses whose steps, halved, still change the motion by this share.
    pub(super) fn coarse_losses(change: f64) -> Option<Self> {
        (change > COARSE_LOSSES).then_some(Self::CoarseLosses { change })
    }

    /// A warning of a step too long for the first mode.
    pub(super) fn coarse_step(step_s: f64, first_period_s: Option<f64>) -> Option<Self> {
        let period_s = first_period_s?;
        let steps = period_s / step_s;
        (steps < STEPS_IN_A_PERIOD).then_some(Self::CoarseStep { step_s, period_s, steps })
    }
}
