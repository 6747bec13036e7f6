//! An arm of several links and its path, as `solve`, `verify` and `sweep` read and solve them.

use flexlink::beam::MeshPlan;
use flexlink::csv::{InputFile, PathTable};
use flexlink::inverse::{ArmError, ArmSolution, InversionError, Resources, invert_arm};
use flexlink::motion::ArmPath;
use flexlink::result::{Exceeded, Limits, Metrics, Remark};
use flexlink::spec::ArmSpecification;
use flexlink::store::Findings;
use flexlink::verify::Verification;

use crate::options::inputs::{ResampleArgs, ScaleArgs};
use crate::options::reading::{ReadArgs, tell};
use crate::terminal::{Exit, Failure, memory};

/// An arm and the path that it is to follow.
pub(crate) struct ArmAndPath {
    /// The arm's file as messages call it.
    name: String,
    specification: Box<ArmSpecification>,
    table: PathTable,
    path: ArmPath,
}

/// A solution, and what follows from it.
pub(crate) struct Solved<S> {
    pub(crate) solution: S,
    pub(crate) metrics: Metrics,
    /// The limits of each joint.
    pub(crate) limits: Vec<Limits>,
    /// Those that are exceeded.
    pub(crate) exceeded: Vec<Exceeded>,
    /// Remarks on link or arm and motion.
    pub(crate) remarks: Vec<Remark>,
}

impl<S> Solved<S> {
    /// What is known of the solution beside its numbers.
    pub(crate) fn findings<'a>(&'a self, verification: Option<&'a Verification>) -> Findings<'a> {
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
    pub(crate) fn of(
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
    pub(crate) fn solve(
        &self,
        memory_bytes: Option<usize>,
    ) -> Result<Solved<ArmSolution>, Failure> {
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
