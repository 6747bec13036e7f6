//! The work of one case of a sweep, and its result.

use std::path::Path;
use std::slice::from_ref;

use crate::csv::InputFile;
use crate::elastica::SecondOrder;
use crate::inverse::{Resources, Unwatched};
use crate::link::Arm;
use crate::motion::Motion;
use crate::response::{Play, PlayError, Torque, simulate};
use crate::result::{FollowedTarget, Notice, PlayedMetrics, Remark, TipPlaces};
use crate::spec::Specification;
use crate::store::{
    Findings, OutputFolder, PlayedRun, RunInputs, RunTables, SimulateFiles, Summary,
};
use crate::sweep::{CaseNumbers, CaseValues, PlayedCase, SolvedCase, SweepKind};

use super::cases::Cases;
use super::first::{First, FirstLink};
use super::tally::of_limit;
use crate::cli::options::inputs::{remarks, remarks_on_link};
use crate::cli::problem::{Problem, Solved};
use crate::cli::terminal::{Exit, Failure, memory};

/// Result of a case.
pub(crate) struct Outcome {
    /// Its numbers, or the error of the case, or the failure that ends the sweep.
    pub(crate) row: Result<Result<CaseNumbers, String>, Failure>,
    /// Its warnings.
    pub(crate) warnings: Vec<Notice>,
    /// Remarks on its unusual input.
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
            // Failed writing and wrong options end the sweep.
            Exit::Usage | Exit::CannotWrite | Exit::Interrupted => Err(failure),
        };
        Self { row, warnings: Vec::new(), remarks: remarks() }
    }
}

impl Cases<'_> {
    /// Works on a case, numbered from 0, within its share of the memory.
    pub(crate) fn outcome(&self, case: usize) -> Outcome {
        let found = self.within_memory(|bytes| match (&self.first, &self.torque_file) {
            (First::Link(first), Some(torque)) => self.play(case, first, torque, bytes),
            _ => self.solve(case, bytes),
        });
        Outcome::of(found, || self.remarks(case))
    }

    /// The link or the arm of a case with its motion.
    fn problem(&self, values: &CaseValues) -> Result<Problem, Failure> {
        match &self.first {
            First::Link(first) => {
                let specification = self.specification(values)?;
                let motion = self.motion_of(first, &specification.link, values.motion)?;
                Ok(Problem::of_link(&self.motion_file.shown, specification.into(), motion))
            }
            First::Arm { path, .. } => {
                let scale = self.shared.scale.scale() * values.motion;
                let specification = self.arm(values)?;
                let path = path.slowed(scale.duration);
                let path =
                    path.map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))?;
                Problem::of_arm(&self.link_file, specification, path)
            }
        }
    }

    /// Solves a case, numbered from 0.
    fn solve(&self, case: usize, memory_bytes: Option<usize>) -> Result<Found, Failure> {
        let values = self.plan.case(case);
        let problem = self.problem(&values)?;
        let periods = match &self.first {
            First::Link(first) => Some(&first.periods),
            First::Arm { .. } => None,
        };
        let resources = Resources { memory_bytes, periods, ..Resources::default() };
        let solved = problem.solved_within(&resources)?;
        let (of_file, dropped) = (&problem.specification.remarks, problem.dropped());
        let Solved { solution, metrics, exceeded, .. } = &solved;
        let found = SolvedCase::of(solution, metrics);
        let numbers = self.kind.solved(&found);
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let arguments = self.arguments(&values);
            let inputs = RunInputs::of_solve(&self.link_file, &self.motion_file, arguments);
            let remarks = remarks(of_file, solution, dropped);
            let findings = Findings { remarks: &remarks, ..solved.findings(None) };
            let outputs = self.shared.outputs.of_case(&solution.nodes_m())?;
            let summary = Summary::of_solution(inputs, solution, metrics, &findings, &outputs);
            let tables = RunTables::of_solution(solution, &outputs)?;
            memory::check_nodes(tables.nodal_bytes(), memory_bytes)?;
            outputs.write(self.stage(&folder)?, tables, (&summary, None), &Unwatched)?;
        }
        let notices = solution.warnings.iter().map(Notice::from);
        let notices = notices.chain(exceeded.iter().map(of_limit)).collect();
        // The tally alone does not need a link's modes above the first.
        let remarks = match &solution.motion {
            Motion::Tip(motion) => {
                let of_link = remarks_on_link((solution, motion), found.first_rad_s.as_slice());
                let of_timing = Remark::on_timing(solution);
                of_file.iter().cloned().chain(of_link).chain(of_timing).collect()
            }
            Motion::Path(_) => remarks(of_file, solution, dropped),
        };
        Ok((numbers, notices, remarks))
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
        let arm = Arm::from(link.clone());
        let played = simulate(&arm, from_ref(mesh), &play, &|_| {})?;
        let target = FollowedTarget::of(&played, &TipPlaces::from(&target))?;
        let error = PlayError::of(&played, &arm, &play)?;
        let metrics = PlayedMetrics::of(&played);
        let tip_error = &target.tip_error;
        let run = PlayedRun {
            arm: &arm,
            play: &play,
            played: &played,
            metrics: &metrics,
            error: error.as_ref(),
            limits: from_ref(limits),
            target: Some(&target),
            comparison: None,
        };
        let numbers =
            SweepKind::played(&PlayedCase { simulation: &played, metrics: &metrics, tip_error });
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let arguments = self.arguments(&values);
            let files = SimulateFiles {
                input: torque_file,
                target: Some(&self.motion_file),
                measured: None,
                reference: None,
                state: None,
            };
            let inputs = RunInputs::of_simulate(&self.link_file, &files, true, arguments);
            let outputs = self.shared.outputs.of_case(&[played.mesh().nodes_m()])?;
            memory::check_nodes(outputs.simulation_bytes(&played), memory_bytes)?;
            let summary = Summary::of_played(inputs, &run);
            let tables = RunTables::of_played((&arm, &played), run.target, &outputs)?;
            outputs.write(self.stage(&folder)?, tables, (&summary, None), &Unwatched)?;
        }
        let notices = run.notices(of_limit);
        Ok((numbers, notices, remarks.clone()))
    }

    /// Opens the folder of a case. The command line does not name it, so it must not be a link to another place.
    fn stage(&self, folder: &Path) -> Result<OutputFolder, Failure> {
        if folder.is_symlink() {
            let shown = folder.display();
            let message = format!("{shown}: is a symbolic link, but must be a folder of its own");
            return Err(Failure::new(Exit::CannotWrite, &message, None));
        }
        self.shared.outputs.sync.stage(folder)
    }
}
