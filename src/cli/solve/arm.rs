//! `solve` of an arm of several links.

use std::path::Path;

use flexlink::beam::MeshPlan;
use flexlink::csv::InputFile;
use flexlink::inverse::Unwatched;
use flexlink::report::{self, Figures};
use flexlink::result::StoredResult;
use flexlink::spec::ArmSpecification;
use flexlink::store::{Durability, OutputFolder, RunInputs, RunTables, Summary};
use flexlink::verify::{AnySolution, Verification};

use super::run::{Page, SolveOptions};
use crate::cli::arm::{ArmAndPath, SolvedArm};
use crate::cli::verify::verified;
use crate::terminal::{Failure, StageBar, console, memory};

/// The inputs of a run.
pub(super) struct ArmProblem<'a> {
    options: &'a SolveOptions,
    arm_file: InputFile,
    path_file: InputFile,
    inputs: ArmAndPath,
}

/// The solution, and its checks where they were asked for.
pub(super) struct SolvedRun {
    pub(super) solved: SolvedArm,
    pub(super) verification: Option<Verification>,
}

impl<'a> ArmProblem<'a> {
    /// Reads the path of the arm.
    pub(super) fn read(
        options: &'a SolveOptions,
        arm_file: InputFile,
        specification: Box<ArmSpecification>,
        path_file: InputFile,
    ) -> Result<Self, Failure> {
        options.refuse_for_arms()?;
        let arm = (&arm_file, specification);
        let SolveOptions { read, resample, scale, .. } = options;
        let inputs = ArmAndPath::read(arm, &path_file, (read, resample, scale))?;
        Ok(Self { options, arm_file, path_file, inputs })
    }

    /// Step of the path in s.
    pub(super) fn step_s(&self) -> f64 {
        self.inputs.step_s()
    }

    /// The plans of the links' meshes.
    pub(super) fn plans(&self) -> &[MeshPlan] {
        self.inputs.plans()
    }

    /// Computes the solution, and verifies it if the options ask for that.
    pub(super) fn solve(&self, stages: &StageBar) -> Result<SolvedRun, Failure> {
        stages.at("solving");
        let solved = self.inputs.solve(memory::available())?;
        self.options.nodes.check_arm(&solved.solution)?;
        let verify = || {
            let plans = (self.plans(), &solved.limits[..]);
            verified(AnySolution::Arm(&solved.solution), plans, self.options.digits, stages)
        };
        let verification = self.options.verify.then(verify).transpose()?;
        Ok(SolvedRun { solved, verification })
    }

    /// The record of the run.
    pub(super) fn summary(&self, SolvedRun { solved, verification }: &SolvedRun) -> Summary {
        let inputs = RunInputs::of_solve(&self.arm_file, &self.path_file, self.options.arguments());
        solved.summary(inputs, verification.as_ref(), &self.options.outputs())
    }

    /// Writes the results into a folder.
    pub(super) fn write(
        &self,
        (SolvedRun { solved, .. }, summary): (&SolvedRun, &Summary),
        (folder, durability): (&Path, Durability),
        page: Page,
        stages: &StageBar,
    ) -> Result<(), Failure> {
        let outputs = self.options.outputs();
        // Drawn from memory before the folder is locked: the page belongs to the same run.
        let drawn = (page == Page::Written).then(|| {
            stages.at("drawing");
            // A page draws all nodes.
            let tables = RunTables::of_arm(&solved.solution, &outputs.of_page());
            let run = StoredResult::Runs(vec![outputs.stored(&tables, summary)?]);
            Ok::<String, Failure>(report::page(&run, &Figures::of(&run)))
        });
        let drawn = drawn.transpose()?;
        let on_wait = |folder: &Path| stages.above(|| console::waiting(folder));
        let folder = OutputFolder::stage(folder, &on_wait)?.with(durability);
        let tables = RunTables::of_arm(&solved.solution, &outputs);
        outputs.write(folder, tables, (summary, drawn.as_deref()), &Unwatched)?;
        Ok(())
    }

    /// Prints remarks, warnings and limits; with `is_strict` the first limit is an error, printed at the end.
    pub(super) fn warn(solved: &SolvedArm, is_strict: bool) {
        console::remarks(&solved.remarks);
        console::warnings(&solved.solution.warnings);
        let limits = solved.exceeded.iter().skip(usize::from(is_strict));
        console::warnings(limits);
    }
}
