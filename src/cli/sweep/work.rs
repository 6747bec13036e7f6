//! The work of one case of a sweep, and what comes of it.

use std::path::Path;
use std::slice::from_ref;

use crate::csv::{InputFile, PathTable};
use crate::elastica::SecondOrder;
use crate::inverse::{Resources, Unwatched, invert_with};
use crate::response::{Play, PlayError, Torque, simulate};
use crate::result::{FollowedTarget, Metrics, Notice, PlayedMetrics, Remark};
use crate::spec::Specification;
use crate::store::{
    Findings, OutputFolder, PlayFindings, RunInputs, RunTables, SimulateFiles, Summary,
};
use crate::sweep::{ArmCase, CaseNumbers, PlayedCase, SolvedCase, SweepKind};
use crate::verify::AnySolution;

use super::cases::{Cases, of_case};
use super::first::{First, FirstLink};
use super::tally::of_limit;
use crate::cli::options::inputs::remarks;
use crate::cli::problem::{ArmAndPath, Solved};
use crate::cli::terminal::{Exit, Failure, memory};

/// What came of a case.
pub(crate) struct Outcome {
    /// Its numbers, or why it has none; or why the sweep ends.
    pub(crate) row: Result<Result<CaseNumbers, String>, Failure>,
    /// Its warnings.
    pub(crate) warnings: Vec<Notice>,
    /// What is possible but rare in it.
    pub(crate) remarks: Vec<Remark>,
}

/// The numbers of a case, its warnings and its remarks.
pub(crate) type Found = (CaseNumbers, Vec<Notice>, Vec<Remark>);

impl Outcome {
    fn of(result: Result<Found, Failure>, remarks: impl FnOnce() -> Vec<Remark>) -> Self {
        let failure = match result {
            Ok((row, warnings, remarks)) => return Self { row: Ok(Ok(row)), warnings, remarks },
            Err(failure) => failure,
        };
        let row = match failure.exit {
            Exit::InputRefused | Exit::NotSolvable => Ok(Err(failure.message)),
            // Results that cannot be written, or wrong options, fail the sweep.
            Exit::Usage | Exit::CannotWrite | Exit::Interrupted => Err(failure),
        };
        Self { row, warnings: Vec::new(), remarks: remarks() }
    }
}

impl Cases<'_> {
    /// Works on a case, numbered from 0, within its share of the memory.
    pub(crate) fn outcome(&self, case: usize) -> Outcome {
        let found = self.within_memory(|bytes| match (&self.first, &self.torque_file) {
            (First::Link(first), None) => self.solve(case, first, bytes),
            (First::Link(first), Some(torque)) => self.play(case, first, torque, bytes),
            (First::Arm { path, .. }, _) => self.solve_arm(case, path, bytes),
        });
        Outcome::of(found, || self.remarks(case))
    }

    /// Solves a case, numbered from 0.
    fn solve(
        &self,
        case: usize,
        first: &FirstLink,
        memory_bytes: Option<usize>,
    ) -> Result<Found, Failure> {
        let values = self.plan.case(case);
        let specification = self.specification(&values)?;
        let Specification { link, mesh, analysis, limits, .. } = &specification;
        let motion = self.motion_of(first, link, values.motion)?;
        let resources =
            Resources { memory_bytes, periods: Some(&first.periods), ..Resources::default() };
        let solution = invert_with(link, mesh, &motion, analysis, &resources)?;
        let metrics = Metrics::of(&solution);
        let first_rad_s = solution.natural_frequencies_rad_s(1);
        let found = SolvedCase {
            solution: &solution,
            metrics: &metrics,
            first_rad_s: first_rad_s.first().copied(),
        };
        let numbers = self.kind.solved(&found);
        let exceeded = metrics.exceeded(&[*limits]);
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let arguments = self.arguments(&values);
            let inputs = RunInputs::of_solve(&self.link_file, &self.motion_file, arguments);
            let remarks = remarks(&specification.remarks, &solution);
            let findings = Findings {
                limits: from_ref(limits),
                exceeded: &exceeded,
                verification: None,
                remarks: &remarks,
            };
            let outputs = self.shared.outputs.of_case(&[solution.mesh().nodes_m()])?;
            let summary = Summary::of_solution(inputs, &solution, &metrics, &findings, &outputs);
            let deflections = outputs.deflections(&solution)?;
            memory::check_nodes(deflections.bytes(), memory_bytes)?;
            let folder = self.stage(&folder)?;
            let tables = RunTables::of_solution(&solution, deflections);
            outputs.write(folder, tables, (&summary, None), &Unwatched)?;
        }
        let own = solution.warnings.iter().map(Notice::from);
        let limits = exceeded.iter().map(of_limit);
        let of_modes = Remark::on_modes(link, solution.mesh(), &first_rad_s);
        let (travel_m, tolerance) = (solution.tip_travel_m(), analysis.tip_tolerance());
        let of_motion = Remark::on_motion(link, &motion, travel_m, tolerance);
        let of_link = specification.remarks.iter().cloned().chain(of_modes);
        let remarks = of_link.chain(of_motion).chain(Remark::on_jumps(&solution));
        let remarks = remarks.chain(Remark::on_timing(&solution));
        Ok((numbers, own.chain(limits).collect(), remarks.collect()))
    }

    /// Solves a case of an arm, numbered from 0.
    fn solve_arm(
        &self,
        case: usize,
        path: &PathTable,
        memory_bytes: Option<usize>,
    ) -> Result<Found, Failure> {
        let values = self.plan.case(case);
        let specification = self.arm(&values)?;
        let scale = self.shared.scale.scale() * values.motion;
        let path = path.slowed(scale.duration);
        let path = path.map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))?;
        let solved = ArmAndPath::of((&self.link_file, specification), path)?.solve(memory_bytes)?;
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let arguments = self.arguments(&values);
            let inputs = RunInputs::of_solve(&self.link_file, &self.motion_file, arguments);
            // Meshes differ from case to case: one without such a node is no reason to end all others.
            let nodes_m = AnySolution::Arm(&solved.solution).nodes_m();
            let outputs = self.shared.outputs.of_case(&nodes_m).map_err(of_case)?;
            let (findings, metrics) = (solved.findings(None), &solved.metrics);
            let summary = Summary::of_arm(inputs, &solved.solution, metrics, &findings, &outputs);
            let tables = RunTables::of_arm(&solved.solution, &outputs);
            outputs.write(self.stage(&folder)?, tables, (&summary, None), &Unwatched)?;
        }
        let Solved { solution, metrics, exceeded, remarks, .. } = &solved;
        let numbers = self.kind.of_arm(&ArmCase { solution, metrics });
        let own = solution.warnings.iter().map(Notice::from);
        let limits = exceeded.iter().map(of_limit);
        Ok((numbers, own.chain(limits).collect(), remarks.clone()))
    }

    /// Plays the torque on a case, numbered from 0.
    fn play(
        &self,
        case: usize,
        first: &FirstLink,
        (torque_file, torque): &(InputFile, Torque),
        memory_bytes: Option<usize>,
    ) -> Result<Found, Failure> {
        let values = self.plan.case(case);
        let Specification { link, mesh, remarks, analysis, limits } =
            &self.specification(&values)?;
        let motion = self.motion_of(first, link, values.motion)?;
        let grid = torque.grid();
        let target = motion.target(grid.time_s(0), grid.end_s());
        let play = Play {
            until_s: Some(grid.end_s().max(target.grid().end_s())),
            initial_tip_m: target.start_m(),
            memory_bytes,
            interpolation: self.shared.torque.hold.interpolation(),
            is_large: analysis.second_order_of(link) != SecondOrder::None,
            start_angle_rad: target.start_angle_rad(),
            ..Play::of(torque)
        };
        let simulation = simulate(link, mesh, &play)?;
        let target = FollowedTarget::of(&simulation, &target)?;
        let tip_error = &target.tip_error;
        let error = PlayError::of(&simulation, link, &play)?;
        let metrics = PlayedMetrics::of(&simulation);
        let found = PlayedCase { simulation: &simulation, metrics: &metrics, tip_error };
        let numbers = SweepKind::played(&found);
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let arguments = self.arguments(&values);
            let files = SimulateFiles {
                input: torque_file,
                target: Some(&self.motion_file),
                measured: None,
                reference: None,
                state: None,
            };
            let inputs =
                RunInputs::of_simulate(&self.link_file, &files, play.input.is_torque(), arguments);
            let outputs = self.shared.outputs.of_case(&[simulation.mesh.nodes_m()])?;
            memory::check_nodes(outputs.simulation_bytes(&simulation), memory_bytes)?;
            let target = Some(&target);
            let limits = from_ref(limits);
            let findings = PlayFindings { error: error.as_ref(), limits, target, comparison: None };
            let played = (link, &play);
            let summary = Summary::of_simulation(inputs, played, &simulation, &metrics, &findings);
            let tables = RunTables::of_simulation((link, &simulation), target, &outputs)?;
            outputs.write(self.stage(&folder)?, tables, (&summary, None), &Unwatched)?;
        }
        let coarse = error.and_then(|error| error.warning(&simulation));
        let own = simulation.warnings.iter().copied().chain(coarse);
        let own = own.map(Notice::from);
        let late = tip_error.late.map(Notice::from);
        let exceeded = metrics.exceeded(&[*limits]);
        let notices = own.chain(late).chain(exceeded.iter().map(of_limit)).collect();
        Ok((numbers, notices, remarks.clone()))
    }

    /// Opens the folder of a case, which the command line does not name: it must lead nowhere else.
    fn stage(&self, folder: &Path) -> Result<OutputFolder, Failure> {
        if folder.is_symlink() {
            let shown = folder.display();
            let message = format!("{shown}: is a symbolic link, but must be a folder of its own");
            return Err(Failure::new(Exit::CannotWrite, &message, None));
        }
        self.shared.outputs.sync.stage(folder)
    }
}
