//! A link or an arm and its wanted motion, as `solve`, `verify` and `sweep` read and solve them.

use std::slice::from_ref;

use crate::beam::MeshPlan;
use crate::csv::{Digits, InputFile, PathTable};
use crate::inverse::{
    Analysis, ArmError, ArmSolution, InversionError, Resources, Solution, invert_arm, invert_with,
};
use crate::motion::{ArmPath, Ends, TipMotion};
use crate::result::{Exceeded, Limits, Metrics, Remark};
use crate::spec::{ArmSpecification, Described, Specification};
use crate::store::Findings;
use crate::text::gigabytes;
use crate::verify::{Answer, AnySolution, Verification, VerificationError, verify};

use crate::cli::options::common::refuse_for_arms;
use crate::cli::options::inputs::{ResampleArgs, ScaleArgs, remarks};
use crate::cli::options::reading::{ReadArgs, tell};
use crate::cli::terminal::{Exit, Failure, StageBar, console, memory};

/// Most memory in bytes of an inversion whose times are probably in another unit.
const DOUBTED_BYTES: usize = 3_000_000_000;

/// A link or an arm and its wanted motion.
pub(crate) enum Problem {
    Link(Box<LinkAndMotion>),
    Arm(Box<ArmAndPath>),
}

/// A link and the wanted motion of its tip.
pub(crate) struct LinkAndMotion {
    specification: Specification,
    motion: TipMotion,
    /// The motion's file as messages call it.
    motion_file: String,
}

/// The solution of a link or of an arm.
pub(crate) enum LinkOrArm {
    Link(Box<Solution>),
    Arm(Box<ArmSolution>),
}

impl LinkOrArm {
    pub(crate) fn any(&self) -> AnySolution<'_> {
        match self {
            Self::Link(solution) => AnySolution::Link(solution),
            Self::Arm(solution) => AnySolution::Arm(solution),
        }
    }
}

impl Problem {
    /// Reads the motion of a link or an arm. Tells what was guessed of the file.
    pub(crate) fn read(
        (file, described): (&InputFile, Described),
        motion_file: &InputFile,
        (read, resample, scale): (&ReadArgs, &ResampleArgs, &ScaleArgs),
    ) -> Result<Self, Failure> {
        match described {
            Described::Link(specification) => {
                let found = resample.motion_of(motion_file, &specification.link, read)?;
                let (motion, reading) = found;
                tell(&motion_file.shown, &reading);
                let (motion, motion_file) = (scale.scaled(motion)?, motion_file.shown.clone());
                let specification = *specification;
                Ok(Self::Link(Box::new(LinkAndMotion { specification, motion, motion_file })))
            }
            Described::Arm(specification) => {
                refuse_for_arms([resample.of_one_link(), scale.of_one_link()].concat())?;
                let arm = (file, specification);
                let arm = ArmAndPath::read(arm, motion_file, (read, resample, scale))?;
                Ok(Self::Arm(Box::new(arm)))
            }
        }
    }

    /// Ends of the motion, and its step in s.
    pub(crate) fn ends_and_step_s(&self) -> (Ends, f64) {
        match self {
            Self::Link(link) => (link.motion.ends(), link.motion.grid().step_s),
            Self::Arm(arm) => (Ends::AtRest, arm.step_s()),
        }
    }

    /// The plans of the links' meshes.
    pub(crate) fn plans(&self) -> &[MeshPlan] {
        match self {
            Self::Link(link) => from_ref(&link.specification.mesh),
            Self::Arm(arm) => arm.plans(),
        }
    }

    /// Computes the solution. `analysis` may change the analysis of a link's file; `memory_bytes` is the free memory.
    pub(crate) fn solve(
        &self,
        analysis: impl FnOnce(&Analysis) -> Analysis,
        memory_bytes: Option<usize>,
        stages: &StageBar,
    ) -> Result<Solved<LinkOrArm>, Failure> {
        let of_link = match self {
            Self::Link(of_link) => &**of_link,
            Self::Arm(arm) => {
                stages.at("solving");
                let solved = arm.solve(memory_bytes)?;
                let Solved { solution, metrics, limits, exceeded, remarks } = solved;
                let solution = LinkOrArm::Arm(Box::new(solution));
                return Ok(Solved { solution, metrics, limits, exceeded, remarks });
            }
        };
        let LinkAndMotion { specification, motion, motion_file } = of_link;
        let Specification { link, mesh, limits, .. } = specification;
        // Times in another unit make the work large or impossible: they are told before it.
        let duration = Remark::on_duration(motion);
        stages.above(|| console::remarks(&duration));
        let most = memory_bytes.unwrap_or(usize::MAX);
        let allowed = duration.as_ref().map_or(most, |_| most.min(DOUBTED_BYTES));
        let allowed = (allowed < usize::MAX).then_some(allowed);
        let resources = Resources { memory_bytes: allowed, watch: stages, ..Resources::default() };
        let analysis = analysis(&specification.analysis);
        let solution = invert_with(link, mesh, motion, &analysis, &resources);
        let solution = solution.map_err(|error| {
            let hint = duration.as_ref().map(|remark| remark.hint().to_owned());
            let refused = match error {
                InversionError::TooMuchMemory { bytes, allowed: DOUBTED_BYTES } => {
                    let (needed, most) = (gigabytes(bytes), gigabytes(DOUBTED_BYTES));
                    format!("{needed} of memory is needed, but must need at most {most} where its unit is doubtful")
                }
                InversionError::TooLong { .. } if duration.is_some() => error.to_string(),
                _ => {
                    let failure = Failure::from(error);
                    return Failure { hint: hint.or(failure.hint), ..failure };
                }
            };
            let refused = format!("{motion_file}: time = such that {refused}");
            Failure::new(Exit::InputRefused, &refused, hint.as_deref())
        })?;
        let metrics = Metrics::of(&solution);
        let (limits, remarks) = (vec![*limits], remarks(&specification.remarks, &solution));
        let exceeded = metrics.exceeded(&limits);
        let solution = LinkOrArm::Link(Box::new(solution));
        Ok(Solved { solution, metrics, limits, exceeded, remarks })
    }
}

impl Solved<LinkOrArm> {
    /// Checks the solution, whose torques are written with this many digits.
    pub(crate) fn verified(
        &self,
        plans: &[MeshPlan],
        digits: Digits,
        stages: &StageBar,
    ) -> Result<Verification, VerificationError> {
        stages.at("verifying");
        let solution = self.solution.any();
        let torques = solution.torques();
        let written = torques.whole_n_m().iter().map(|torque_n_m| digits.as_written(torque_n_m));
        let written_torques_n_m = &written.collect::<Vec<_>>();
        // Less memory is free than before the inversion: the solution stays.
        let memory_bytes = memory::available();
        let limits = &self.limits;
        verify(&Answer { solution, plans, limits, memory_bytes, written_torques_n_m })
    }

    /// Prints the remarks and the warnings; the remark on the duration was printed before the work. Returns the number of
    /// warnings.
    pub(crate) fn tell(&self) -> usize {
        console::remarks(self.remarks.iter().filter(|own| !matches!(own, Remark::Duration { .. })));
        let warnings = self.solution.any().warnings();
        let count = warnings.len();
        console::warnings(warnings);
        count
    }
}

/// An arm and the path that it is to follow.
pub struct ArmAndPath {
    /// The arm's file as messages call it.
    name: String,
    specification: Box<ArmSpecification>,
    table: PathTable,
    path: ArmPath,
}

/// A solution, and what follows from it.
pub struct Solved<S> {
    pub solution: S,
    pub metrics: Metrics,
    /// The limits of each joint.
    pub limits: Vec<Limits>,
    /// Those that are exceeded.
    pub exceeded: Vec<Exceeded>,
    /// Remarks on link or arm and motion.
    pub remarks: Vec<Remark>,
}

impl<S> Solved<S> {
    /// What is known of the solution beside its numbers.
    pub fn findings<'a>(&'a self, verification: Option<&'a Verification>) -> Findings<'a> {
        let Self { limits, exceeded, remarks, .. } = self;
        Findings { limits, exceeded, verification, remarks }
    }
}

impl ArmAndPath {
    /// Reads the path of an arm. Tells what was guessed of the file.
    pub(crate) fn read(
        (arm_file, specification): (&InputFile, Box<ArmSpecification>),
        file: &InputFile,
        (read, resample, scale): (&ReadArgs, &ResampleArgs, &ScaleArgs),
    ) -> Result<Self, Failure> {
        let table = resample.path_of(file, read)?;
        tell(&file.shown, table.reading());
        Self::of((arm_file, specification), scale.scaled_path(&table)?)
    }

    /// An arm and the path in a table.
    pub fn of(
        (arm_file, specification): (&InputFile, Box<ArmSpecification>),
        table: PathTable,
    ) -> Result<Self, Failure> {
        let path = table.path(&specification.arm.lengths_m())?;
        Ok(Self { name: arm_file.shown.clone(), specification, table, path })
    }

    /// Step of the path in s.
    pub(crate) fn step_s(&self) -> f64 {
        self.path.grid().step_s
    }

    /// The plans of the links' meshes.
    pub(crate) fn plans(&self) -> &[MeshPlan] {
        &self.specification.meshes
    }

    /// Computes the solution, for which so many bytes of memory are free.
    pub fn solve(&self, memory_bytes: Option<usize>) -> Result<Solved<ArmSolution>, Failure> {
        let ArmSpecification { arm, meshes, analysis, limits, .. } = &*self.specification;
        let resources = Resources { memory_bytes, ..Resources::default() };
        let solution = invert_arm(arm, meshes, &self.path, analysis, &resources);
        let solution = solution.map_err(|error| match error {
            ArmError::Inversion(error @ InversionError::TooMuchMemory { .. }) => error.into(),
            error => self.refused(&error),
        })?;
        let nodes: usize = solution.links.iter().map(|link| link.nodes_m.len()).sum();
        memory::check_nodes(6 * nodes * solution.grid.len * size_of::<f64>(), memory_bytes)?;
        let metrics = Metrics::of(&solution);
        let exceeded = metrics.exceeded(limits);
        let tolerance = solution.analysis.tip_tolerance();
        let of_path = Remark::on_path(&self.path, solution.way_m, tolerance);
        let dropped = Remark::on_dropped(self.table.reading().dropped());
        let of_path = dropped.into_iter().chain(of_path);
        let of_path = of_path.chain(Remark::on_timing(&solution));
        let remarks = self.specification.remarks.iter().cloned().chain(of_path).collect();
        Ok(Solved { solution, metrics, limits: limits.clone(), exceeded, remarks })
    }

    /// Why there is no solution: with its row of the path, or the link of the arm, where one is to blame.
    fn refused(&self, error: &ArmError) -> Failure {
        let hint = error.hint();
        if let Some(sample) = error.sample() {
            return self.table.refused(Some(sample), error, hint).into();
        }
        let name = &self.name;
        let message = match error.link() {
            Some((link, why)) => {
                let line = self.specification.lines[link].map(|line| format!(":{line}"));
                let (line, link) = (line.unwrap_or_default(), self.specification.arm.name_of(link));
                format!("{name}{line}: {link}: {why}")
            }
            None if *error == ArmError::NoElbow => format!("{name}: {error}"),
            None => error.to_string(),
        };
        Failure::new(Exit::NotSolvable, &message, hint)
    }
}
