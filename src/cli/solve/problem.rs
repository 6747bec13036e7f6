//! What `solve` is given: one link and its motion, or an arm and its path.

use flexlink::csv::InputFile;
use flexlink::spec::Described;

use super::arm::ArmProblem;
use super::run::{Problem, SolveOptions};
use crate::terminal::Failure;

/// A problem of one link, or of an arm.
pub(super) enum OneOrSeveral<'a> {
    One(Box<Problem<'a>>),
    Several(Box<ArmProblem<'a>>),
}

impl<'a> OneOrSeveral<'a> {
    /// Reads the link or the arm from its file, and then the motion.
    pub(super) fn read(
        options: &'a SolveOptions,
        link_file: InputFile,
        motion_file: impl FnOnce() -> Result<InputFile, Failure>,
    ) -> Result<Self, Failure> {
        match options.described(&link_file)? {
            Described::Link(link) => {
                let problem = Problem::read(options, link_file, *link, motion_file()?)?;
                Ok(Self::One(Box::new(problem)))
            }
            Described::Arm(arm) => {
                let problem = ArmProblem::read(options, link_file, arm, motion_file()?)?;
                Ok(Self::Several(Box::new(problem)))
            }
        }
    }
}
