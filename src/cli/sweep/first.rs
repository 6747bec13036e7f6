//! The first case of a sweep: a link or an arm, and its motion.

use crate::csv::{InputFile, Reading};
use crate::link::{Arm, Link};
use crate::motion::{MotionScale, Periods};
use crate::spec::Specification;

use crate::cli::options::inputs::{ResampleArgs, Wanted, are_read_alike};
use crate::cli::options::reading::ReadArgs;
use crate::cli::terminal::Failure;

/// The first readable case, and the inputs that others share with it.
pub(super) struct First {
    pub(super) arm: Arm,
    pub(super) wanted: Wanted,
    /// The periods of the motion of a link's tip, which most cases share.
    pub(super) periods: Option<Periods>,
}

impl First {
    /// Reads the motion of a link or an arm.
    pub(super) fn read(
        Specification { arm, .. }: Specification,
        file: &InputFile,
        (resample, read): (&ResampleArgs, &ReadArgs),
    ) -> Result<(Self, Reading), Failure> {
        let (wanted, reading) = resample.motion_of(file, &arm, read)?;
        let periods = wanted.motion.tip().map(Periods::of);
        Ok((Self { arm, wanted, periods }, reading))
    }

    /// The first case with `name` as the name of its motion's file in errors.
    pub(super) fn named(self, name: &str) -> Self {
        let Wanted { motion, rows } = self.wanted;
        Self { wanted: Wanted { motion, rows: rows.named(name) }, ..self }
    }

    /// Its motion over another distance and duration, if a file would be the same motion of this arm.
    pub(super) fn motion_of(
        &self,
        arm: &Arm,
        scale: MotionScale,
    ) -> Option<Result<Wanted, Failure>> {
        are_read_alike(arm, &self.arm).then(|| self.wanted.of_case(scale))
    }

    /// The links.
    pub(super) fn links(&self) -> Vec<&Link> {
        self.arm.links().iter().map(|own| &own.link).collect()
    }
}
