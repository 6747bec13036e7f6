//! The work of one case of a sweep, and its result.

use std::path::Path;

use crate::csv::InputFile;
use crate::elastica::SecondOrder;
use crate::inverse::Resources;
use crate::link::Arm;
use crate::modal::reports_weight;
use crate::motion::{Ends, Motion, Prescribed};
use crate::response::{Play, PlayedLink, SimulationError, Start, simulate};
use crate::result::{FollowedTarget, Notice, Remark, TipError, TipPlaces};
use crate::spec::Specification;
use crate::store::{OutputFolder, PlayedRun, RunInputs, SimulateFiles, Simulated};
use crate::sweep::{CaseNumbers, CaseValues, PlayedCase, SolvedCase, SweepKind};

use super::cases::{Cases, TorqueArgs};
use super::tally::of_limit;
use crate::cli::options::inputs::Wanted;
use crate::cli::options::play::Driven;
use crate::cli::problem::{Problem, Solved};
use crate::cli::simulate::refusal;
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
        let found = self.within_memory(|bytes| match &self.driven {
            Some(driven) => self.play(case, driven, bytes),
            None => self.solve(case, bytes),
        });
        // A case that fails has no columns.
        let has_column = |own: &Remark| !matches!(own, Remark::WithoutWeight { .. });
        Outcome::of(found, || self.remarks(case).into_iter().filter(has_column).collect())
    }

    /// The link or the arm of a case with its motion.
    fn problem(&self, values: &CaseValues) -> Result<Problem, Failure> {
        let specification = self.specification(values)?;
        let wanted = self.motion_of(&specification.arm, values.motion)?;
        Ok(Problem::of(&self.link_file, specification, wanted))
    }

    /// Solves a case, numbered from 0.
    fn solve(&self, case: usize, memory_bytes: Option<usize>) -> Result<Found, Failure> {
        let values = self.plan.case(case);
        let problem = self.problem(&values)?;
        let periods = self.first.periods.as_ref();
        let resources = Resources { memory_bytes, periods, ..Resources::default() };
        let solved = problem.solved_within(&resources)?;
        let Solved { solution, metrics, exceeded, .. } = &solved;
        let found = SolvedCase::of(solution, metrics);
        let numbers = self.kind.solved(&found);
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let arguments = self.arguments(&values);
            let inputs = RunInputs::of_solve(&self.link_file, &self.motion_file, arguments);
            let outputs = self.shared.outputs.of_case(&solution.nodes_m())?;
            solved.write(inputs, &outputs, memory_bytes, || self.stage(&folder))?;
        }
        let notices = solution.warnings.iter();
        let notices = notices.map(|own| Notice::from(own).worded(&solution.arm));
        let limits = exceeded.iter().map(|own| of_limit(own, &solution.arm).worded(&solution.arm));
        let notices = notices.chain(limits).collect();
        // The tally alone does not need a link's modes above the first.
        let mut remarks = solved.remarks_on(Some(found.first_rad_s.as_slice()));
        remarks.extend(Remark::on_weight(&solution.arm, solution.links[0].reports_weight()));
        Ok((numbers, notices, remarks))
    }

    /// Plays the torques, or the motion of the joints, on a case, numbered from 0.
    fn play(
        &self,
        case: usize,
        driven: &Driven,
        memory_bytes: Option<usize>,
    ) -> Result<Found, Failure> {
        let values = self.plan.case(case);
        let own = &self.specification(&values)?;
        let Wanted { motion, .. } = self.motion_of(&own.arm, values.motion)?;
        let of_case = (&self.link_file, own, &motion);
        let torque = &self.shared.torque;
        torque.played(driven, of_case, memory_bytes, |run, tip_error| {
            let Simulated { played, metrics, .. } = run.result;
            let numbers = self.kind.played(&PlayedCase { simulation: played, metrics, tip_error });
            if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
                let arguments = self.arguments(&values);
                let files = driven.files.recorded();
                let files = SimulateFiles { target: Some(&self.motion_file), ..files };
                let kind = (driven.moving.input().is_torque(), own.arm.joint().slides());
                let inputs = RunInputs::of_simulate(&self.link_file, &files, kind, arguments);
                let outputs = self.shared.outputs.of_case(&played.nodes_m())?;
                memory::check_nodes(outputs.simulation_bytes(played), memory_bytes)?;
                run.write(inputs, &outputs, || self.stage(&folder))?;
            }
            let notices = run.notices(|limit| of_limit(limit, &own.arm));
            let PlayedLink { mesh, outward_m_s2, .. } = &played.links[0];
            let weight = Remark::on_weight(&own.arm, reports_weight(mesh, *outward_m_s2));
            Ok((numbers, notices, own.remarks.iter().cloned().chain(weight).collect()))
        })
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

impl TorqueArgs {
    /// The numbers of each case of an arm that plays the table.
    pub fn kind(&self, arm: &Arm) -> SweepKind {
        let slides = arm.joints().any(|joint| joint.slides());
        SweepKind::Played { joints: arm.links().len(), slides, is_open: self.moving.is_open() }
    }

    /// Plays the table on a case and compares its tip with the motion. `take` receives the run, and the distance of its
    /// tip from the motion.
    pub fn played<T>(
        &self,
        Driven { moving, feedback, .. }: &Driven,
        (file, own, motion): (&InputFile, &Specification, &Motion),
        memory_bytes: Option<usize>,
        take: impl FnOnce(&PlayedRun<'_>, &TipError) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let Specification { arm, meshes, analysis, limits, .. } = own;
        let options = &self.moving;
        let motors = options.under_voltages(file, arm, moving)?;
        let (moved, moving) = motors.as_ref().map_or((arm, moving), |(arm, moving)| (arm, moving));
        let input = moving.input();
        let grid = input.grid();
        let [from_s, until_s] = [grid.time_s(0), grid.end_s()];
        let mut play = Play {
            memory_bytes,
            interpolation: options.interpolation(),
            feedback,
            is_large: analysis.second_order_of(own.link()) != SecondOrder::None,
            cycle_turn_rad: (motion.ends() == Ends::Periodic).then_some(0.0),
            is_under_voltage: options.is_under_voltage(),
            ..Play::with(input)
        };
        let mut first: Vec<f64>;
        let places = match motion {
            Motion::Tip(motion) => {
                let target = motion.target(from_s, until_s);
                play.initial_tip_m = target.start_m();
                play.start_angle_rad = target.start_angle_rad();
                TipPlaces::from(&target)
            }
            Motion::Path(path) => {
                // The first row of a reference, or of the joints' own motion, is where an arm starts.
                if !feedback.is_empty() {
                    first = feedback.iter().map(|own| own.reference().angle_rad()[0]).collect();
                    play.start = Some(Start::Joints(&first));
                } else if input.is_torque() {
                    first = path.between(from_s, until_s).1.iter().map(|own| own[0]).collect();
                    if path.has_carriage() {
                        play.carriage_m = first.pop().unwrap_or_default();
                    }
                    play.start = Some(match (path.prescribed(), &first[..]) {
                        (Prescribed::Tip, [x, y, outer_rad @ ..]) => {
                            Start::Tip { at_m: [*x, *y], outer_rad }
                        }
                        (_, chords_rad) => Start::Chords(chords_rad),
                    });
                }
                TipPlaces::of_path(path, arm, [from_s, until_s])
            }
        };
        play.until_s = Some(until_s.max(places.grid.end_s()));
        let refused = |error: SimulationError| {
            let (message, hint) = refusal(&error, arm);
            Failure { message, hint, ..Failure::from(error) }
        };
        let played = simulate(moved, meshes, &play, &|_| {}).map_err(refused)?;
        let target = FollowedTarget::of(&played, &places)?;
        let tip_error = target.tip_error;
        let result = Simulated::of(played, moved, &play, Some(target)).map_err(refused)?;
        take(&PlayedRun { arm, play: &play, limits, result: &result }, &tip_error)
    }
}
