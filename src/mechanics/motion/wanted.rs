//! The wanted motion, of the tip of one link or of an arm.

use super::error::MotionError;
use super::path::{ArmPath, Prescribed};
use super::recording::Recording;
use super::samples::Ends;
use super::scale::MotionScale;
use super::tip_motion::TipMotion;
use crate::numeric::TimeGrid;

/// The wanted motion of a link or an arm.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// The tip of one link along its arc.
    Tip(TipMotion),
    /// An arm: x and y of its tip, or the directions of its links.
    Path(ArmPath),
}

impl Motion {
    /// The motion of the tip of one link. `None` for an arm.
    pub fn tip(&self) -> Option<&TipMotion> {
        match self {
            Self::Tip(motion) => Some(motion),
            Self::Path(_) => None,
        }
    }

    /// [`Motion::tip`], without the rest.
    pub fn into_tip(self) -> Option<TipMotion> {
        match self {
            Self::Tip(motion) => Some(motion),
            Self::Path(_) => None,
        }
    }

    /// Name of the quantity that the samples prescribe.
    pub fn given(&self) -> &'static str {
        match self {
            Self::Tip(tip) if tip.is_from_displacement() => "displacement",
            Self::Tip(_) => "acceleration",
            Self::Path(path) if path.prescribed() == Prescribed::Tip => "tip",
            Self::Path(_) => "angles",
        }
    }

    /// This motion over another distance and duration; a path keeps its start.
    ///
    /// # Errors
    /// Those of [`TipMotion::scaled`].
    pub fn scaled(&self, scale: MotionScale) -> Result<Self, MotionError> {
        Ok(match self {
            Self::Tip(motion) => Self::Tip(motion.scaled(scale)?),
            Self::Path(_) if scale == MotionScale::default() => self.clone(),
            Self::Path(path) => Self::Path(path.scaled(scale)?),
        })
    }

    /// Largest distance in m of the tip from its start, of a path that of a coordinate.
    pub fn largest_travel_m(&self) -> f64 {
        match self {
            Self::Tip(motion) => {
                let grid = motion.grid();
                motion.target(grid.time_s(0), grid.end_s()).largest_travel_m()
            }
            Self::Path(path) => path.farthest_m(),
        }
    }

    /// Estimate of the tip's largest error in m from the samples; `None` for exact samples.
    pub fn known_to_m(&self) -> Option<f64> {
        match self {
            Self::Tip(motion) => motion.known_to_m(),
            Self::Path(path) => path.known_to_m(),
        }
    }

    /// Quality of its samples.
    pub fn recording(&self) -> &Recording {
        match self {
            Self::Tip(motion) => motion.recording(),
            Self::Path(path) => path.recording(),
        }
    }

    /// Numbers of the last sample at rest before the motion and of the first one after it.
    pub fn moving_samples(&self) -> (usize, usize) {
        match self {
            Self::Tip(motion) => motion.moving_samples(),
            Self::Path(path) => path.moving_samples(),
        }
    }

    /// Its ends.
    pub fn ends(&self) -> Ends {
        match self {
            Self::Tip(motion) => motion.ends(),
            Self::Path(path) => path.ends(),
        }
    }

    /// Times of its samples.
    pub fn grid(&self) -> TimeGrid {
        match self {
            Self::Tip(motion) => motion.grid(),
            Self::Path(path) => path.grid(),
        }
    }
}
