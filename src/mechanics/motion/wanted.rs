//! The wanted motion, of the tip of one link or of an arm.

use super::path::ArmPath;
use super::samples::Ends;
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

    /// Its ends. A path begins and ends at rest.
    pub fn ends(&self) -> Ends {
        self.tip().map_or(Ends::AtRest, TipMotion::ends)
    }

    /// Times of its samples.
    pub fn grid(&self) -> TimeGrid {
        match self {
            Self::Tip(motion) => motion.grid(),
            Self::Path(path) => path.grid(),
        }
    }
}
