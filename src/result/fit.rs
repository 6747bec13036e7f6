use thiserror::Error;

use super::limits::Limits;
use super::metrics::Metrics;
use crate::beam::MeshPlan;
use crate::inverse::{Analysis, InversionError, invert};
use crate::link::Link;
use crate::motion::{MotionError, Profile, TipMotion};

/// Fewest steps of a motion that is tried.
const FEWEST_STEPS: usize = 32;

/// Most steps of a motion that is tried.
const MOST_STEPS: usize = 1 << 18;

/// A motion of which only the duration is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpenMotion {
    /// Its shape.
    pub profile: Profile,
    /// Its way in m.
    pub distance_m: f64,
    /// Its step in s.
    pub step_s: f64,
}

/// Why no duration is found.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// Limits that even a slow motion exceeds.
    #[error("the shortest duration = above {duration_s} s, but must be at most that")]
    TooSlow {
        /// The longest duration tried in s.
        duration_s: f64,
    },
    /// A motion that is none.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A motion without a torque.
    #[error(transparent)]
    Inversion(#[from] InversionError),
}

/// The fewest steps of a motion whose torque, rate, power, bending stay within limits: the answer
/// to how fast a link may move its tip.
///
/// Found by halving, in whole steps, as what a motion asks for falls with its duration.
///
/// # Errors
/// [`FitError`].
pub fn shortest_steps(
    link: &Link,
    plan: &MeshPlan,
    analysis: &Analysis,
    limits: &Limits,
    motion: &OpenMotion,
) -> Result<usize, FitError> {
    let fits = |steps: usize| -> Result<bool, FitError> {
        let OpenMotion { profile, distance_m, step_s } = *motion;
        let motion = TipMotion::new(profile.sampled(distance_m, step_s, steps, [0, 0]))?;
        let solution = invert(link, plan, &motion, analysis)?;
        Ok(limits.exceeded(&Metrics::of(&solution)).is_empty())
    };
    let mut fitting = FEWEST_STEPS;
    while !fits(fitting)? {
        fitting *= 2;
        if fitting > MOST_STEPS {
            let duration_s = MOST_STEPS as f64 * motion.step_s;
            return Err(FitError::TooSlow { duration_s });
        }
    }
    let mut too_fast = if fitting == FEWEST_STEPS { fitting - 1 } else { fitting / 2 };
    while fitting - too_fast > 1 {
        let middle = usize::midpoint(fitting, too_fast);
        if fits(middle)? { fitting = middle } else { too_fast = middle }
    }
    Ok(fitting)
}
