//! Errors of the motion of links that follow chords.

use thiserror::Error;

use crate::text::significant;

/// Fewest samples of a period.
pub(super) const FEWEST: usize = 8;

/// Largest slope, the sine of an angle, at which the iteration is tried.
pub(super) const STEEPEST: f64 = 0.95;

/// Tolerance of the iteration below which round-off dominates.
pub(super) const FINEST: f64 = 1e-13;

/// Reason why a link that follows a chord has no motion.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ElasticaError {
    /// Columns differ in length, or the number of samples is odd.
    #[error(
        "{angles} angles, {rates} rates and {accelerations} accelerations, but must be equally many, an even number and {FEWEST} or more"
    )]
    Lengths {
        /// Number of angles.
        angles: usize,
        /// Number of rates.
        rates: usize,
        /// Number of accelerations.
        accelerations: usize,
    },
    /// A number is not finite.
    #[error("{column} of sample {sample} = {value}, but must be a finite number")]
    Sample {
        /// Name of the column.
        column: &'static str,
        /// Number of the sample, from 0; for gravity 0 along x and 1 along y.
        sample: usize,
        /// Value of the number.
        value: f64,
    },
    /// No iteration can meet this tolerance.
    #[error("tolerance = {0}, but must be at least {FINEST} and below 1")]
    Tolerance(f64),
    /// The step is not a positive number.
    #[error("step = {0} s, but must be a finite number above 0")]
    Step(f64),
    /// The slopes are out of reach of any iteration.
    #[error(
        "slope of the link = {}, but must be below {STEEPEST}: the motion bends it too far",
        significant(*slope, 3)
    )]
    TooSteep {
        /// Largest slope.
        slope: f64,
    },
    /// Second-order terms grow from one iteration to the next.
    #[error(
        "the second-order terms do not converge: iteration {iterations} changes the torque by {}",
        if change.is_finite() {
            format!("{} of its range", significant(*change, 3))
        } else {
            "no finite number".into()
        }
    )]
    Diverges {
        /// Iterations so far.
        iterations: usize,
        /// Change of the torque relative to its range.
        change: f64,
    },
    /// The weight or second order of this kind of link is not derived.
    #[error("{what}, but weight and second-order terms need a link {known}")]
    NotDerived {
        /// Property of the link.
        what: &'static str,
        /// Possible properties.
        known: &'static str,
    },
    /// Error of one link of an arm.
    #[error("link {}: {error}", link + 1)]
    OfLink {
        /// Number of the link, from 0.
        link: usize,
        /// Error of the link.
        error: Box<ElasticaError>,
    },
    /// A single link, which cannot change its length, must keep the tip on its path.
    #[error("the arm has one link, but must have two or more to keep its tip on a path")]
    OneLink,
    /// The elbow is so stretched or folded that the links' rates do not follow from the tip.
    #[error(
        "the sine of the elbow's angle at sample {sample} = {}, but must be at least 0.05 in size: the arm is stretched, \
         folded, or does not reach the tip",
        significant(*sine, 3)
    )]
    Elbow {
        /// Number of the sample, from 0.
        sample: usize,
        /// The sine; 0 if the bent links do not reach the tip.
        sine: f64,
    },
    /// The sag under the weight varies too fast with the direction.
    #[error(
        "the sag of the link under its weight changes too fast with its direction, but must be smooth where damping is \
         hysteretic"
    )]
    Sag,
    /// Samples are too far apart for products of deflections.
    #[error(
        "step = {} s, but must be shorter, about {} s for a smooth motion: the motion reaches above half the Nyquist \
         frequency, and second-order terms reach higher still",
        significant(*step_s, 6), significant(*most_s, 2)
    )]
    LongStep {
        /// The step in s.
        step_s: f64,
        /// A step in s that about resolves the terms.
        most_s: f64,
    },
    /// No number is finite at a frequency.
    #[error("the torque at {} Hz is not a finite number", significant(*frequency_hz, 6))]
    NotFinite {
        /// The frequency in Hz.
        frequency_hz: f64,
    },
}

impl ElasticaError {
    /// Attributes the error to one link of an arm.
    pub(super) fn of_link(self, link: usize) -> Self {
        Self::OfLink { link, error: Box::new(self) }
    }

    /// Turns the error of an iteration after the first into divergence, if the motion was possible before the links
    /// bent.
    pub(super) fn diverging(self, iterations: usize, change: f64) -> Self {
        let cause = if let Self::OfLink { error, .. } = &self { error } else { &self };
        match cause {
            Self::Elbow { .. } | Self::LongStep { .. } | Self::TooSteep { .. } => {
                Self::Diverges { iterations, change }
            }
            _ => self,
        }
    }

    /// True if more samples of the motion may remove the error.
    pub(super) fn is_of_step(&self) -> bool {
        match self {
            Self::OfLink { error, .. } => error.is_of_step(),
            _ => matches!(self, Self::LongStep { .. }),
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::OfLink { error, .. } => return error.hint(),
            Self::TooSteep { .. } => "use a slower motion, a lighter payload or a stiffer link",
            Self::Diverges { .. } => {
                "use a slower motion or a stiffer link, or analysis.second_order = \"first\", which leaves out most \
                 of them, with a larger error of the tip"
            }
            Self::NotDerived { .. } => {
                "change the link; for one link without gravity, analysis.second_order = \"none\" solves small deflections"
            }
            Self::LongStep { .. } => {
                "use a shorter step, a smoother motion, or a larger analysis.tip_tolerance, which leaves fast parts out"
            }
            Self::Elbow { .. } => {
                "use a path that keeps away from the stretched arm and from the first joint"
            }
            Self::Sag => "use rayleigh damping with beta, or a stiffer link",
            Self::NotFinite { .. } => "use damping, or a smoother motion",
            _ => return None,
        })
    }
}
