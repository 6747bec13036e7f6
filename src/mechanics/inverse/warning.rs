use serde::Serialize;
use thiserror::Error;

use super::accuracy::{Quantity, ShareOf};
use crate::motion::Shortfall;
use crate::text::{about_percent, significant};

/// Largest change of the torque within the validity of first order in the thickness.
const MOST_THICK: f64 = 0.3;

/// Largest error of the tip of a solution with fewer terms, over its travel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Straying {
    /// Measured by moving the joints as solved.
    Measured(f64),
    /// Estimated from the shortening of the bent links' chords, for an arm without usable equations in time.
    Estimated(f64),
}

impl Straying {
    /// The share of the travel.
    pub fn share(self) -> f64 {
        match self {
            Self::Measured(share) | Self::Estimated(share) => share,
        }
    }
}

/// A fact that the user must know to judge the answer. Functions return it and never print it.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Warning {
    /// Few digits of the acceleration caused an end velocity of the tip, which the inversion removed.
    #[error(
        "the acceleration integrates to {velocity_m_s:.3e} m/s, {share:.1e} of the peak velocity: \
         removed by a constant acceleration over the motion's samples"
    )]
    EndVelocityCorrected {
        /// ∫a dt of the original samples in m/s.
        velocity_m_s: f64,
        /// This velocity over the peak velocity.
        share: f64,
    },
    /// The samples do not bring the tip within its tolerance.
    #[error(
        "the tip strays by {share:.1e} of its travel from the wanted motion, above \
         analysis.tip_tolerance = {tolerance:e}: {}",
        cause(shortfall)
    )]
    TipMissed {
        /// Largest distance from the wanted motion over its travel.
        share: f64,
        /// The tolerance of the tip.
        tolerance: f64,
        /// Deficiency of the samples.
        shortfall: Shortfall,
    },
    /// A quantity with an error from the finite period or the window above the tolerance.
    #[error(
        "the finite period and the window leave the {} off by {share:.1e} of its {}, above the \
         tolerance {tolerance:e}",
        quantity.name(),
        of.name()
    )]
    InexactWindow {
        /// Reference of the share.
        of: ShareOf,
        /// The quantity.
        quantity: Quantity,
        /// Its error over its peak.
        share: f64,
        /// The analysis tolerance.
        tolerance: f64,
    },
    /// A quantity that depends on the step of the motion.
    #[error(
        "half the step changes the {} by {share:.1e} of its {}: with analysis.tip_tolerance = 0 \
         every frequency of the samples is solved, and the step sets the highest one",
        quantity.name(),
        of.name()
    )]
    CoarseStep {
        /// Reference of the share.
        of: ShareOf,
        /// The quantity that changes most.
        quantity: Quantity,
        /// Its error over its peak.
        share: f64,
    },
    /// A torque that the tip's motion does not determine.
    #[error(
        "the peak {} depends on analysis.tip_tolerance: it is {} N m, and {} N m where the tip may stray twice as far",
        quantity.name(),
        significant(*peak_n_m, 3),
        significant(*looser_n_m, 3)
    )]
    UnsettledTorque {
        /// Torque of the hub or of the motor.
        quantity: Quantity,
        /// Its peak in N m.
        peak_n_m: f64,
        /// Its peak in N m where the tip may stray twice as far.
        looser_n_m: f64,
    },
    /// A torque that the samples of the motion do not determine.
    #[error(
        "the digits, the noise or the spacing of the motion's samples leave the torque uncertain by {} of its {}",
        about_percent(*share),
        of.name()
    )]
    UncertainInput {
        /// Reference of the share.
        of: ShareOf,
        /// Error over the peak.
        share: f64,
    },
    /// The written window cuts torque off.
    #[error(
        "the torque outside the written window reaches {share:.1e} of its {}, above the \
         tolerance {tolerance:e}",
        of.name()
    )]
    TorqueCut {
        /// Reference of the share.
        of: ShareOf,
        /// Largest torque outside the window over the peak.
        share: f64,
        /// The analysis tolerance.
        tolerance: f64,
    },
    /// One period's torque reaches into the next.
    #[error(
        "half a period from the motion the torque is still {share:.1e} of its {}, above the tolerance \
         {tolerance:e} (period {period_s:.4} s)",
        of.name()
    )]
    WrapAround {
        /// Reference of the share.
        of: ShareOf,
        /// Torque at the seam of two periods over the peak.
        share: f64,
        /// The analysis tolerance.
        tolerance: f64,
        /// Period P in s.
        period_s: f64,
    },
    /// A torque that does not decay has made the window long.
    #[error(
        "the torque hardly decays: its window has {rows} rows, {times:.0} times as many as the motion"
    )]
    LongWindow {
        /// Rows of the window.
        rows: usize,
        /// Rows over the samples of the motion.
        times: f64,
    },
    /// A payload's inertia or offset blocks the tip at a frequency that the motion contains.
    #[error(
        "at {} Hz no torque moves the tip (rotary inertia, shear or payload), and the motion has {share:.1e} of its \
         largest amplitude there: the torque grows as 1/(damping)",
        significant(*frequency_hz, 6)
    )]
    BlockedTip {
        /// The zero of torque → tip in Hz.
        frequency_hz: f64,
        /// Amplitude of the acceleration there over its largest.
        share: f64,
    },
    /// The motion changes too fast for its step.
    #[error(
        "the acceleration near the Nyquist frequency ({nyquist_hz:.4} Hz) reaches {share:.1e} of \
         its largest amplitude: jumps or noise that the step does not resolve"
    )]
    NearNyquist {
        /// Largest amplitude above 0.8 of the Nyquist frequency over the largest of all.
        share: f64,
        /// Nyquist frequency in Hz.
        nyquist_hz: f64,
    },
    /// Torque at frequencies too high for the mesh.
    #[error(
        "{share:.1e} of the torque (rms) lies above {resolved_hz:.4} Hz, beyond which the mesh is \
         wrong by 1 % and more"
    )]
    AboveMesh {
        /// Root-mean-square torque above the mesh's frequency over that of all frequencies.
        share: f64,
        /// Highest frequency of bending waves on the mesh in Hz.
        resolved_hz: f64,
    },
    /// Noticeable terms of second order outside the linear model.
    #[error(
        "large deflections and centrifugal stiffening, which the linear model leaves out, change the torque by {} of its \
         peak; the torque computed without them lets the tip stray by {} of its travel",
        about_percent(*torque),
        about_percent(*tip)
    )]
    InexactModel {
        /// Change of the torque by these terms, over its peak.
        torque: f64,
        /// Error of the tip over its travel.
        tip: f64,
    },
    /// Second-order terms that hardly converge.
    #[error(
        "each iteration of the second-order terms changes the torque by {contraction:.2} of the change before: they \
         hardly converge"
    )]
    SlowIteration {
        /// Change by the last iteration over that by the one before.
        contraction: f64,
    },
    /// Second-order terms that do not converge to the tolerance. The iteration omits their high frequencies.
    #[error(
        "the iteration of the second-order terms leaves the {} off by {share:.1e} of its {}, above the tolerance \
         {tolerance:e}",
        quantity.name(),
        of.name()
    )]
    InexactIteration {
        /// Reference of the share.
        of: ShareOf,
        /// The quantity.
        quantity: Quantity,
        /// Its error over the reference.
        share: f64,
        /// The analysis tolerance.
        tolerance: f64,
    },
    /// Noticeable second-order terms that the solution omits.
    #[error(
        "the second-order terms that analysis.second_order leaves out change the torque by {}",
        left_out(*share)
    )]
    SecondOrderLeftOut {
        /// Largest change over the torque's range. `None` where the motion with all terms is refused.
        share: Option<f64>,
    },
    /// Shear and rotary inertia outside the model.
    #[error(
        "shear and rotary inertia, which the theory leaves out, change the torque by {} (rms)",
        thick(*share)
    )]
    ThickLink {
        /// Change of the torque, root mean square over root mean square.
        share: f64,
    },
    /// A mesh that is too coarse for the motion.
    #[error("the mesh changes the {} by {error:.1e} of its {} (elements halved)", quantity.name(), of.name())]
    CoarseMesh {
        /// Reference of the share.
        of: ShareOf,
        /// The quantity with the largest error.
        quantity: Quantity,
        /// Discretisation error of the quantity over its peak.
        error: f64,
    },
    /// Too few modes for the motion.
    #[error(
        "the modes left out by analysis.modes change the {} by {error:.1e} of its peak",
        quantity.name()
    )]
    FewModes {
        /// The quantity that the omitted modes change most.
        quantity: Quantity,
        /// Error over its peak.
        error: f64,
    },
    /// An elbow too straight or too folded to determine well how the links follow the tip.
    #[error(
        "the sine of the elbow's angle falls to {sine:.3} at {time_s:.3} s: the arm is nearly stretched or folded there"
    )]
    NearlyStretched {
        /// The sine.
        sine: f64,
        /// Time in s.
        time_s: f64,
    },
    /// A weight not far from the one that buckles the link.
    #[error(
        "the weight is {share:.2} of the one that buckles the link: small errors of stiffness and mass change the answer much"
    )]
    NearBuckling {
        /// The weight over the one that buckles the link.
        share: f64,
    },
    /// Second-order terms that do not converge, so that only first-order terms count.
    #[error(
        "the second-order terms do not converge, and only those of first order are included: the tip strays by {}",
        strays(*straying)
    )]
    FellBack {
        /// Error of the tip.
        straying: Straying,
    },
}

impl Warning {
    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::EndVelocityCorrected { .. } => "end_velocity_corrected",
            Self::TipMissed { .. } => "tip_missed",
            Self::InexactWindow { .. } => "inexact_window",
            Self::CoarseStep { .. } => "coarse_step",
            Self::UnsettledTorque { .. } => "unsettled_torque",
            Self::UncertainInput { .. } => "uncertain_input",
            Self::TorqueCut { .. } => "torque_cut",
            Self::WrapAround { .. } => "wrap_around",
            Self::LongWindow { .. } => "long_window",
            Self::BlockedTip { .. } => "blocked_tip",
            Self::NearNyquist { .. } => "near_nyquist",
            Self::AboveMesh { .. } => "above_mesh",
            Self::InexactModel { .. } => "inexact_model",
            Self::SlowIteration { .. } => "slow_iteration",
            Self::InexactIteration { .. } => "inexact_iteration",
            Self::SecondOrderLeftOut { .. } => "second_order_left_out",
            Self::ThickLink { .. } => "thick_link",
            Self::CoarseMesh { .. } => "coarse_mesh",
            Self::FewModes { .. } => "few_modes",
            Self::NearlyStretched { .. } => "nearly_stretched",
            Self::NearBuckling { .. } => "near_buckling",
            Self::FellBack { .. } => "fell_back_to_first_order",
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::EndVelocityCorrected { .. } => "write the trajectory with more digits",
            Self::TipMissed { shortfall: Shortfall::Step(_), .. } => {
                "sample the motion more finely, in `trajectory` with a shorter --step, or use a larger analysis.tip_tolerance"
            }
            Self::TipMissed { shortfall: Shortfall::Noise, .. } => {
                "use an analysis.tip_tolerance above the noise, or write the motion with more digits"
            }
            Self::InexactWindow { .. } => "use longer analysis.lead and lag, or a looser tolerance",
            Self::CoarseStep { .. } => "use analysis.tip_tolerance above 0, or a smoother motion",
            Self::UnsettledTorque { .. } => {
                "use a smoother motion or a larger analysis.tip_tolerance, or write the motion with more digits"
            }
            Self::UncertainInput { .. } => {
                "use a displacement with more digits or less noise, the acceleration instead, or a slower or \
                 smoother motion"
            }
            Self::TorqueCut { .. } => "use longer analysis.lead and lag, or leave both out",
            Self::WrapAround { .. } => "lengthen analysis.lag, add damping or loosen the tolerance",
            Self::LongWindow { .. } => {
                "add damping; analysis.lead and analysis.lag limit the window, --every the rows of the nodal tables"
            }
            Self::FewModes { .. } => "raise analysis.modes, or leave it out to keep all modes",
            Self::InexactModel { .. } => {
                "use analysis.second_order = \"full\", a slower motion or a stiffer link"
            }
            Self::SlowIteration { .. } | Self::InexactIteration { .. } => {
                "use a slower motion or a stiffer link"
            }
            Self::SecondOrderLeftOut { .. } => {
                "use analysis.second_order = \"full\", which includes them or states why it cannot"
            }
            Self::ThickLink { .. } => "set theory = \"timoshenko\" in the link file",
            Self::BlockedTip { .. } => "use a smoother or slower motion to avoid the frequency",
            Self::NearNyquist { .. } => "use a smoother motion or a shorter step",
            Self::NearlyStretched { .. } => {
                "use a path that keeps away from the stretched arm and from the first joint"
            }
            Self::NearBuckling { .. } => "use a stiffer or lighter link, or a lighter payload",
            Self::FellBack { .. } => {
                "use a slower or smoother motion, or stiffer links; analysis.second_order = \"full\" makes this an error"
            }
            Self::AboveMesh { .. } | Self::CoarseMesh { .. } => {
                "use more elements, mesh.elements = \"auto\" or a smoother motion"
            }
        }
    }
}

/// A warning of a solution, and the arm's joint that it concerns.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{}{warning}", joint.map_or_else(String::new, |joint| format!("joint {}: ", joint + 1)))]
pub struct SolutionWarning {
    /// Number of the joint of an arm, from 0. `None` for one link, and where it concerns the whole arm.
    pub joint: Option<usize>,
    /// The warning.
    pub warning: Warning,
}

impl From<Warning> for SolutionWarning {
    fn from(warning: Warning) -> Self {
        Self { joint: None, warning }
    }
}

impl SolutionWarning {
    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        self.warning.kind()
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        self.warning.hint()
    }
}

fn strays(straying: Straying) -> String {
    let share = significant(straying.share(), 2);
    match straying {
        Straying::Measured(_) => {
            format!("{share} of its travel, measured with the joints moved as solved")
        }
        Straying::Estimated(_) => {
            format!("about {share} of its travel, estimated from the shortening of the bent links")
        }
    }
}

fn cause(shortfall: &Shortfall) -> String {
    match shortfall {
        Shortfall::Step(step_s) => {
            format!("the motion's step is too long, {} s would do", significant(*step_s, 2))
        }
        Shortfall::Noise => "the motion's samples contain noise or rounding of that size".into(),
    }
}

/// Change of the torque by omitted terms, in words.
fn left_out(share: Option<f64>) -> String {
    match share {
        Some(share) if share < 1.0 => {
            format!("about {} % of its range", significant(100.0 * share, 2))
        }
        Some(_) => "as much as its range, or more".into(),
        None => "an unknown amount: with all of them the motion is refused".into(),
    }
}

/// Change of the torque by shear and rotary inertia, in words.
fn thick(share: f64) -> String {
    if share <= MOST_THICK {
        format!("about {:.0} %", 100.0 * share)
    } else {
        format!("more than {:.0} %", 100.0 * MOST_THICK)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_the_torque_is_given_as_far_as_the_first_order_is_valid() {
        assert_eq!([0.0123, 0.3, 0.31].map(thick), ["about 1 %", "about 30 %", "more than 30 %"]);
    }
}
