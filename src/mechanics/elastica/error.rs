//! Why there is no motion of links that follow chords.

use thiserror::Error;

use crate::text::significant;

/// Fewest samples of a period.
pub(super) const FEWEST: usize = 8;

/// Largest slope, the sine of an angle, that the iteration is tried with.
pub(super) const STEEPEST: f64 = 0.95;

/// Tolerance of the iteration below which round-off decides.
pub(super) const FINEST: f64 = 1e-13;

/// Why there is no motion of a link that follows a chord.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ElasticaError {
    /// Columns of different lengths, or an odd number of samples.
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
    /// A number that is not finite.
    #[error("{column} of sample {sample} = {value}, but must be a finite number")]
    Sample {
        /// What it is.
        column: &'static str,
        /// Number of the sample, from 0; of gravity 0 along x and 1 along y.
        sample: usize,
        /// The number.
        value: f64,
    },
    /// A tolerance that no iteration meets.
    #[error("tolerance = {0}, but must be at least {FINEST} and below 1")]
    Tolerance(f64),
    /// A step that is no positive number.
    #[error("step = {0} s, but must be a finite number above 0")]
    Step(f64),
    /// Slopes that no iteration reaches.
    #[error(
        "slope of the link = {}, but must be below {STEEPEST}: it bends too far for the motion asked of it",
        significant(*slope, 3)
    )]
    TooSteep {
        /// Largest slope.
        slope: f64,
    },
    /// Second-order terms that grow from one iteration to the next.
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
        /// Change of the torque, over its range.
        change: f64,
    },
    /// A link whose weight or second order is not derived.
    #[error("{what}, but weight and second-order terms are known for links {known}")]
    NotDerived {
        /// What the link has.
        what: &'static str,
        /// What it may have.
        known: &'static str,
    },
    /// One link of an arm.
    #[error("link {}: {error}", link + 1)]
    OfLink {
        /// Number of the link, from 0.
        link: usize,
        /// Why.
        error: Box<ElasticaError>,
    },
    /// A tip to be kept on its path by one link, which cannot change its length.
    #[error("the arm has one link, but must have two or more to keep its tip on a path")]
    OneLink,
    /// An elbow so far stretched or folded that its links do not tell how they follow the tip.
    #[error(
        "the sine of the elbow's angle at sample {sample} = {}, but must be at least 0.05 in size: the arm is stretched, \
         folded, or does not reach the tip",
        significant(*sine, 3)
    )]
    Elbow {
        /// Number of the sample, from 0.
        sample: usize,
        /// The sine; 0 where links of their bent lengths do not reach the tip.
        sine: f64,
    },
    /// A weight that bends the link otherwise in every direction.
    #[error(
        "the sag of the link under its weight changes too fast with its direction, but must be smooth where damping is \
         hysteretic"
    )]
    Sag,
    /// Samples too far apart for products of deflections.
    #[error(
        "step = {} s, but must be shorter, about {} s where the motion is smooth: it has content at the Nyquist frequency, or \
         above half of it, and second-order terms reach farther than the deflections that they are made of",
        significant(*step_s, 6), significant(*most_s, 2)
    )]
    LongStep {
        /// The step in s.
        step_s: f64,
        /// A step in s that resolves the terms, about.
        most_s: f64,
    },
    /// A frequency at which nothing is finite.
    #[error("the torque at {} Hz = not a finite number, but must be one", significant(*frequency_hz, 6))]
    NotFinite {
        /// The frequency in Hz.
        frequency_hz: f64,
    },
}

impl ElasticaError {
    /// The same of one link of an arm.
    pub(super) fn of_link(self, link: usize) -> Self {
        Self::OfLink { link, error: Box::new(self) }
    }

    /// The same of an iteration after the first: what was possible before the links bent and is no more was its doing.
    pub(super) fn diverging(self, iterations: usize, change: f64) -> Self {
        let own = if let Self::OfLink { error, .. } = &self { error } else { &self };
        match own {
            Self::Elbow { .. } | Self::LongStep { .. } | Self::TooSteep { .. } => {
                Self::Diverges { iterations, change }
            }
            _ => self,
        }
    }

    /// True if more samples of the same motion may do without it.
    pub(super) fn is_of_step(&self) -> bool {
        match self {
            Self::OfLink { error, .. } => error.is_of_step(),
            _ => matches!(self, Self::LongStep { .. }),
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::OfLink { error, .. } => return error.hint(),
            Self::TooSteep { .. } => "a slower motion, a lighter payload or a stiffer link",
            Self::Diverges { .. } => {
                "a slower motion or a stiffer link; analysis.second_order = \"first\" leaves out most of them, with \
                 a larger error of the tip"
            }
            Self::NotDerived { .. } => {
                "change the link; one link alone, without gravity, is solved for small deflections with \
                 analysis.second_order = \"none\""
            }
            Self::LongStep { .. } => {
                "a shorter step, or a smoother motion; a larger analysis.tip_tolerance leaves its fast parts out"
            }
            Self::Elbow { .. } => {
                "a path that stays away from the stretched arm and from the first joint"
            }
            Self::Sag => "damping by rayleigh with beta, or a stiffer link",
            Self::NotFinite { .. } => "give damping, or a smoother motion",
            _ => return None,
        })
    }
}
