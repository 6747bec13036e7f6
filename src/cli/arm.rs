//! An arm of several links and its path, as `solve` and `verify` read and solve them.

use flexlink::csv::{Digits, InputFile, PathTable, read_path_table};
use flexlink::inverse::{ArmSolution, Resources, invert_arm};
use flexlink::motion::ArmPath;
use flexlink::result::{ArmMetrics, Exceeded, Remark};
use flexlink::spec::ArmSpecification;
use flexlink::verify::{ArmAnswer, Verification, verify_arm};

use crate::options::inputs::{ReadArgs, tell};
use crate::terminal::{Exit, Failure, StageBar, memory};

/// An arm and the path that it is to follow.
pub(super) struct ArmAndPath {
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
    /// Remarks on the arm and its path.
    pub(super) remarks: Vec<Remark>,
}

/// Refuses options, as they are recorded, that are known for one link alone.
pub(super) fn refuse_for_arms(options: impl IntoIterator<Item = String>) -> Result<(), Failure> {
    match options.into_iter().find(|option| option.starts_with("--")) {
        None => Ok(()),
        Some(option) => {
            let option = option.split('=').next().unwrap_or_default();
            let message = format!("{option} is for one link, and the arm has several");
            Err(Failure::new(Exit::Usage, &message, None))
        }
    }
}

impl ArmAndPath {
    /// Reads the path of an arm. Tells what was guessed of the file.
    pub(super) fn read(
        specification: Box<ArmSpecification>,
        file: &InputFile,
        read: &ReadArgs,
    ) -> Result<Self, Failure> {
        let table = read_path_table(&file.shown, &file.bytes, &read.format())?;
        tell(&file.shown, table.reading());
        let links = specification.arm.links().iter();
        let path = table.path(&links.map(|own| own.link.length_m()).collect::<Vec<_>>())?;
        Ok(Self { specification, table, path })
    }

    /// Computes the solution.
    pub(super) fn solve(&self, stages: &StageBar) -> Result<SolvedArm, Failure> {
        let ArmSpecification { arm, meshes, analysis, limits, .. } = &*self.specification;
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, ..Resources::default() };
        stages.at("solving");
        let solution = invert_arm(arm, meshes, &self.path, analysis, &resources);
        let solution = solution.map_err(|error| match error.sample() {
            Some(sample) => self.table.refused(Some(sample), &error, error.hint()).into(),
            None => Failure::new(Exit::NotSolvable, &error, error.hint()),
        })?;
        let nodes: usize = solution.links.iter().map(|link| link.nodes_m.len()).sum();
        memory::check_nodes(6 * nodes * solution.grid.len * size_of::<f64>(), memory_bytes)?;
        let metrics = ArmMetrics::of(&solution);
        let exceeded = metrics.exceeded(limits);
        let tolerance = solution.analysis.tip_tolerance();
        let of_path = Remark::on_path(&self.path, solution.way_m, tolerance);
        let remarks = self.specification.remarks.iter().cloned().chain(of_path).collect();
        Ok(SolvedArm { solution, metrics, exceeded, remarks })
    }

    /// Checks a solution whose torques are written with so many digits.
    pub(super) fn verified(
        &self,
        solution: &ArmSolution,
        digits: Digits,
        stages: &StageBar,
    ) -> Verification {
        stages.at("verifying");
        let written = solution.joints.iter().map(|joint| digits.as_written(&joint.torque_n_m));
        let written: Vec<Vec<f64>> = written.collect();
        let ArmSpecification { meshes: plans, limits, .. } = &*self.specification;
        verify_arm(&ArmAnswer {
            plans,
            limits,
            solution,
            memory_bytes: memory::available(),
            written_torques_n_m: &written,
        })
    }
}
