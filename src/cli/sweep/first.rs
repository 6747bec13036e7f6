//! The first case of a sweep: a link and its motion, or an arm and its path.

use crate::csv::{InputFile, PathTable, Reading};
use crate::link::{Arm, Link};
use crate::motion::{Periods, TipMotion};
use crate::spec::Specification;
use crate::sweep::SweepKind;

use crate::cli::options::inputs::ResampleArgs;
use crate::cli::options::reading::ReadArgs;
use crate::cli::terminal::Failure;

/// The first readable case, and the inputs that others share with it.
pub(super) enum First {
    /// A link and its motion.
    Link(Box<FirstLink>),
    /// An arm and the table of its path.
    Arm { arm: Arm, path: Box<PathTable> },
}

/// The link of the first case, its motion, and the periods of this motion, which most cases share.
pub(super) struct FirstLink {
    pub(super) link: Link,
    pub(super) motion: TipMotion,
    pub(super) periods: Periods,
}

impl First {
    /// Reads the motion of a link, or the path of an arm.
    pub(super) fn read(
        found: Specification,
        file: &InputFile,
        (resample, read): (&ResampleArgs, &ReadArgs),
    ) -> Result<(Self, Reading), Failure> {
        if found.arm.links().len() == 1 {
            let link = found.link().clone();
            let (motion, reading) = resample.motion_of(file, &link, read)?;
            let periods = Periods::of(&motion);
            return Ok((Self::Link(Box::new(FirstLink { link, motion, periods })), reading));
        }
        let path = resample.path_of(file, read)?;
        path.path(&found.arm.lengths_m())?;
        let reading = path.reading().clone();
        Ok((Self::Arm { arm: found.arm, path: Box::new(path) }, reading))
    }

    /// The first case with `name` as the name of its path in errors.
    pub(super) fn named(self, name: &str) -> Self {
        match self {
            Self::Arm { arm, path } => Self::Arm { arm, path: Box::new(path.named(name)) },
            link @ Self::Link(_) => link,
        }
    }

    /// Kind of the numbers in its rows.
    pub(super) fn kind(&self) -> SweepKind {
        SweepKind::of_links(&self.links())
    }

    /// The link, or the links of the arm.
    pub(super) fn links(&self) -> Vec<&Link> {
        match self {
            Self::Link(first) => vec![&first.link],
            Self::Arm { arm, .. } => arm.links().iter().map(|own| &own.link).collect(),
        }
    }

    /// Title of the link or the arm.
    pub(super) fn title(&self) -> &str {
        match self {
            Self::Link(first) => first.link.title(),
            Self::Arm { arm, .. } => arm.title(),
        }
    }
}
