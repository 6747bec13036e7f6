//! `solve` of an arm of several links.

use std::path::Path;

use flexlink::csv::{InputFile, PathTable, read_path_table};
use flexlink::inverse::{ArmSolution, Resources, invert_arm};
use flexlink::motion::ArmPath;
use flexlink::result::{ArmMetrics, Exceeded};
use flexlink::spec::ArmSpecification;
use flexlink::store::{Durability, OutputFolder, RunInputs, Summary};

use super::run::SolveOptions;
use crate::options::inputs::tell;
use crate::terminal::{Exit, Failure, StageBar, console, memory};

/// The inputs of a run.
pub(super) struct ArmProblem<'a> {
    options: &'a SolveOptions,
    arm_file: InputFile,
    path_file: InputFile,
    specification: Box<ArmSpecification>,
    table: PathTable,
    path: ArmPath,
}

/// The solution, and what follows from it.
pub(super) struct SolvedArm {
    pub(super) solution: ArmSolution,
    pub(super) metrics: ArmMetrics,
    /// The limits that are exceeded, with the number of the joint.
    pub(super) exceeded: Vec<(usize, Exceeded)>,
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
        let table = read_path_table(&path_file.shown, &path_file.bytes, &options.read.format())?;
        tell(&path_file.shown, table.reading());
        let lengths_m: Vec<f64> =
            specification.arm.links().iter().map(|own| own.link.length_m()).collect();
        let path = table.path(&lengths_m)?;
        Ok(Self { options, arm_file, path_file, specification, table, path })
    }

    /// Computes the solution.
    pub(super) fn solve(&self, stages: &StageBar) -> Result<SolvedArm, Failure> {
        let ArmSpecification { arm, meshes, analysis, limits, .. } = &*self.specification;
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, ..Resources::default() };
        stages.at("solving");
        let solution = invert_arm(arm, meshes, &self.path, analysis, &resources).map_err(
            |error| match error.sample() {
                Some(sample) => self.table.refused(Some(sample), &error, error.hint()).into(),
                None => Failure::new(Exit::NotSolvable, &error, error.hint()),
            },
        )?;
        let nodes: usize = solution.links.iter().map(|link| link.nodes_m.len()).sum();
        memory::check_nodes(6 * nodes * solution.grid.len * size_of::<f64>(), memory_bytes)?;
        let metrics = ArmMetrics::of(&solution);
        let exceeded = metrics.exceeded(limits);
        Ok(SolvedArm { solution, metrics, exceeded })
    }

    /// Writes the results into a folder.
    pub(super) fn write(
        &self,
        SolvedArm { solution, metrics, exceeded }: &SolvedArm,
        (folder, durability): (&Path, Durability),
        stages: &StageBar,
    ) -> Result<Summary, Failure> {
        let outputs = self.options.outputs();
        let inputs = RunInputs::of_solve(&self.arm_file, &self.path_file, self.options.arguments());
        let beside = (&self.specification.remarks[..], &outputs);
        let summary = Summary::of_arm(inputs, solution, metrics, exceeded, beside);
        let on_wait = |folder: &Path| stages.above(|| console::waiting(folder));
        let folder = OutputFolder::stage(folder, &on_wait)?.with(durability);
        outputs.write_arm(folder, solution, &summary)?;
        Ok(summary)
    }

    /// Prints remarks, warnings and limits; with `is_strict` the first limit is an error, printed at the end.
    pub(super) fn warn(&self, solved: &SolvedArm, is_strict: bool) {
        console::remarks(&self.specification.remarks);
        console::warnings(solved.solution.warnings.iter().map(|w| (w, w.hint())));
        let limits = solved.exceeded.iter().skip(usize::from(is_strict));
        console::warnings(limits.map(|(joint, e)| (format!("joint {}: {e}", joint + 1), e.hint())));
    }

    /// Number of the files that are written.
    pub(super) fn files(&self, solved: &SolvedArm) -> usize {
        self.options.outputs().arm_files(&solved.solution)
    }
}
