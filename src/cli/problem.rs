//! A link or an arm and its wanted motion, as `solve`, `verify` and `sweep` read and solve them; the files of a solution
//! and of a simulation.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use crate::beam::MeshPlan;
use crate::csv::{Digits, InputFile};
use crate::elastica::SecondOrder;
use crate::inverse::{Analysis, InversionError, Resources, Solution, Unwatched, invert_motion};
use crate::modal::REPORTED_MODES;
use crate::motion::Ends;
use crate::result::{Exceeded, Limits, Metrics, Notice, Remark};
use crate::robust::{Command, Histories, Hold, Thinned};
use crate::spec::Specification;
use crate::store::{Findings, OutputFolder, PlayedRun, RunInputs, RunOutputs, RunTables, Summary};
use crate::text::gigabytes;
use crate::verify::{Answer, Verification, VerificationError, verify};

use crate::cli::options::inputs::{MotionArgs, Wanted};
use crate::cli::options::reading::tell;
use crate::cli::terminal::{Exit, Failure, StageBar, console, memory};

/// Most memory in bytes of an inversion whose times are probably in another unit.
const DOUBTED_BYTES: usize = 3_000_000_000;

/// A link or an arm and its wanted motion.
pub struct Problem {
    pub specification: Specification,
    wanted: Wanted,
    /// Name in messages of the file of the link or the arm.
    file: String,
}

impl Problem {
    /// Reads the motion of a link or an arm. Reports guesses about the file.
    pub(crate) fn read(
        (file, specification): (&InputFile, Specification),
        motion_file: &InputFile,
        motion: &MotionArgs,
    ) -> Result<Self, Failure> {
        let wanted = motion.motion_of(motion_file, &specification.arm)?;
        tell(&motion_file.shown, &wanted.reading);
        Ok(Self::of(file, specification, motion.scale.scaled(&wanted)?))
    }

    /// A link or an arm of a file, and its motion.
    pub fn of(file: &InputFile, specification: Specification, wanted: Wanted) -> Self {
        Self { specification, wanted, file: file.shown.clone() }
    }

    /// Ends of the motion, and its step in s.
    pub fn ends_and_step_s(&self) -> (Ends, f64) {
        (self.wanted.motion.ends(), self.wanted.motion.grid().step_s)
    }

    /// The plans of the links' meshes.
    pub fn plans(&self) -> &[MeshPlan] {
        &self.specification.meshes
    }

    /// The command that these histories of a solution are, which end at a time in s, with a hold.
    pub(super) fn command(
        &self,
        solution: &Solution,
        histories: (&Histories, f64),
        (hold, gains, thinned): (Hold, &[(f64, f64)], Thinned),
    ) -> Result<Command, Failure> {
        let Specification { arm, analysis, .. } = &self.specification;
        let is_large = analysis.second_order_of(&arm.links()[0].link) != SecondOrder::None;
        Command::of(solution, histories, (hold, gains), (thinned, is_large))
            .map_err(|error| Failure::new(Exit::InputRefused, &error, None))
    }

    /// Computes the solution. `analysis` may change the analysis of a link's file; `memory_bytes` is the free memory.
    pub(crate) fn solve(
        &self,
        analysis: impl FnOnce(&Analysis) -> Analysis,
        memory_bytes: Option<usize>,
        stages: &StageBar,
    ) -> Result<Solved, Failure> {
        // Times in another unit make the work large or impossible, so this remark comes before the work.
        let duration = Remark::on_duration(&self.wanted.motion);
        stages.above(|| console::remarks(&duration));
        let most = memory_bytes.unwrap_or(usize::MAX);
        let allowed = duration.as_ref().map_or(most, |_| most.min(DOUBTED_BYTES));
        let memory_bytes = (allowed < usize::MAX).then_some(allowed);
        let own = &self.specification.analysis;
        let analysis = if self.wanted.motion.tip().is_some() { analysis(own) } else { *own };
        let resources = Resources { memory_bytes, watch: stages, ..Resources::default() };
        let solution = self.inverted(&analysis, &resources).map_err(|error| {
            let hint = duration.as_ref().map(|remark| remark.hint().to_owned());
            let refused = match error {
                InversionError::TooMuchMemory { bytes, allowed: DOUBTED_BYTES } if duration.is_some() => {
                    let (needed, most) = (gigabytes(bytes), gigabytes(DOUBTED_BYTES));
                    format!("{needed} of memory is needed, but must need at most {most} where its unit is doubtful")
                }
                InversionError::TooLong { .. } if duration.is_some() => {
                    error.to_string()
                }
                error => {
                    let failure = self.failure(error);
                    return Failure { hint: hint.or(failure.hint), ..failure };
                }
            };
            let refused = format!("{}: time = such that {refused}", self.wanted.rows.name());
            Failure::new(Exit::InputRefused, &refused, hint.as_deref())
        })?;
        self.solved(solution, memory_bytes)
    }

    fn inverted(
        &self,
        analysis: &Analysis,
        resources: &Resources,
    ) -> Result<Solution, InversionError> {
        let Specification { arm, meshes, .. } = &self.specification;
        invert_motion(arm, meshes, &self.wanted.motion, analysis, resources)
    }

    /// Computes the solution with its numbers.
    pub fn solved_within(&self, resources: &Resources) -> Result<Solved, Failure> {
        let solution = self.inverted(&self.specification.analysis, resources);
        self.solved(solution.map_err(|error| self.failure(error))?, resources.memory_bytes)
    }

    fn solved(&self, solution: Solution, memory_bytes: Option<usize>) -> Result<Solved, Failure> {
        let nodes: usize = solution.shapes().map(|shape| shape.positions_m.len()).sum();
        memory::check_nodes(6 * nodes * solution.grid.len * size_of::<f64>(), memory_bytes)?;
        let Specification { limits, remarks, .. } = &self.specification;
        let metrics = Metrics::of(&solution);
        let exceeded = metrics.exceeded(limits);
        let (limits, of_file) = (limits.clone(), remarks.clone());
        Ok(Solved { solution, metrics, limits, exceeded, of_file, remarks: OnceLock::new() })
    }

    /// Failure of a missing solution, with the faulty row of the path or link of the arm.
    fn failure(&self, error: InversionError) -> Failure {
        let (name, hint) = (&self.file, error.hint());
        let Specification { arm, lines, .. } = &self.specification;
        let is_of_tip = self.wanted.motion.tip().is_some();
        if is_of_tip || matches!(error, InversionError::TooMuchMemory { .. }) {
            let failure = Failure::from(error);
            let hint = failure.hint.map(|hint| arm.worded(&hint));
            return Failure { message: arm.worded(&failure.message), hint, ..failure };
        }
        if error.sample().is_some() || error == InversionError::NoCarriage {
            return self.wanted.rows.refused(error.sample(), &error, hint).into();
        }
        let message = match error.link() {
            Some((link, why)) => {
                let line = lines[link].map(|line| format!(":{line}")).unwrap_or_default();
                format!("{name}{line}: {}: {why}", arm.name_of(link))
            }
            None if error == InversionError::NoElbow => format!("{name}: {error}"),
            None => error.to_string(),
        };
        Failure::new(Exit::NotSolvable, &message, hint)
    }
}

/// A solution, with its numbers, limits and remarks.
pub struct Solved {
    pub solution: Solution,
    pub metrics: Metrics,
    /// The limits of each joint.
    pub limits: Vec<Limits>,
    /// Those that are exceeded.
    pub exceeded: Vec<Exceeded>,
    /// Remarks on the file of the link or the arm.
    of_file: Vec<Remark>,
    remarks: OnceLock<Vec<Remark>>,
}

impl Solved {
    /// Remarks on link or arm, motion and solution, computed once.
    pub fn remarks(&self) -> &[Remark] {
        // Not `get_or_init`: while it computes, a thread of the pool may take up another call that waits for it.
        if self.remarks.get().is_none() {
            let _ = self.remarks.set(self.remarks_on(None));
        }
        self.remarks.get().map_or(&[], Vec::as_slice)
    }

    /// Remarks on link or arm, motion and solution. `modes_rad_s` replaces the reported modes of a link.
    pub(crate) fn remarks_on(&self, modes_rad_s: Option<&[f64]>) -> Vec<Remark> {
        let solution = &self.solution;
        let of_modes = solution.motion.tip().map(|_| {
            let reported = || {
                let highest = TAU * solution.band.highest_hz;
                let mut modes = solution.links[0].natural_frequencies_rad_s(REPORTED_MODES);
                let within = modes.iter().filter(|omega| **omega <= highest).count();
                modes.truncate(within.max(1));
                modes
            };
            let (link, modes_rad_s) =
                (&solution.links[0], modes_rad_s.map_or_else(reported, <[f64]>::to_vec));
            Remark::on_modes(link.link(), link.mesh(), &modes_rad_s)
        });
        let (travel_m, tolerance) = (solution.tip_travel_m(), solution.analysis.tip_tolerance());
        let of_motion = Remark::on_motion(&solution.arm, &solution.motion, travel_m, tolerance);
        let of_solution = Remark::on_jumps(solution).into_iter().chain(Remark::on_timing(solution));
        let of_motion = of_modes.into_iter().flatten().chain(of_motion);
        self.of_file.iter().cloned().chain(of_motion).chain(of_solution).collect()
    }

    /// The record of a run with these inputs and files.
    pub fn summary(
        &self,
        inputs: RunInputs,
        verification: Option<&Verification>,
        outputs: &RunOutputs,
    ) -> Summary {
        let Self { solution, metrics, limits, exceeded, .. } = self;
        let findings = Findings { limits, exceeded, verification, remarks: self.remarks() };
        Summary::of_solution(inputs, solution, metrics, &findings, outputs)
    }

    /// Writes the files of a run without checks, within this memory, into the folder that `stage` opens.
    pub fn write(
        &self,
        inputs: RunInputs,
        outputs: &RunOutputs,
        memory_bytes: Option<usize>,
        stage: impl FnOnce() -> Result<OutputFolder, Failure>,
    ) -> Result<(), Failure> {
        let tables = RunTables::of_solution(&self.solution, outputs)?;
        memory::check_nodes(tables.nodal_bytes(), memory_bytes)?;
        let summary = self.summary(inputs, None, outputs);
        Ok(outputs.write(stage()?, tables, (&summary, None), &Unwatched)?)
    }

    /// Checks the solution; the torques have this many digits in their file.
    pub fn verified(
        &self,
        plans: &[MeshPlan],
        digits: Digits,
        stages: &StageBar,
    ) -> Result<Verification, VerificationError> {
        stages.at("verifying");
        let Self { solution, limits, .. } = self;
        let joints = solution.joints.iter();
        let written = joints.map(|joint| digits.as_written(&joint.torque_n_m));
        let written_torques_n_m = &written.collect::<Vec<_>>();
        // Less memory is free than before the inversion, because the solution stays.
        let memory_bytes = memory::available();
        verify(&Answer { solution, plans, limits, memory_bytes, written_torques_n_m })
    }

    /// Prints the remarks and the warnings; the remark on the duration was printed before the work. Returns the
    /// number of warnings.
    pub(crate) fn tell(&self) -> usize {
        let arm = &self.solution.arm;
        let remarks = self.remarks().iter().filter(|own| !matches!(own, Remark::Duration { .. }));
        console::remarks(remarks.map(|own| Notice::from(own).worded(arm)));
        console::warnings(self.warnings());
        self.solution.warnings.len()
    }

    /// The warnings of the solution, in the words of its first joint.
    pub fn warnings(&self) -> Vec<Notice> {
        let warnings = self.solution.warnings.iter();
        warnings.map(|own| Notice::from(own).worded(&self.solution.arm)).collect()
    }
}

impl PlayedRun<'_> {
    /// Writes the files of a simulation into the folder that `stage` opens; returns their summary.
    pub fn write(
        &self,
        inputs: RunInputs,
        outputs: &RunOutputs,
        stage: impl FnOnce() -> Result<OutputFolder, Failure>,
    ) -> Result<Summary, Failure> {
        let summary = Summary::of_played(inputs, self);
        let tables = RunTables::of_played(self, outputs)?;
        outputs.write(stage()?, tables, (&summary, None), &Unwatched)?;
        Ok(summary)
    }
}
