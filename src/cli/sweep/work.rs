//! The work of one case of a sweep, and what comes of it.

use std::f64::consts::TAU;

use flexlink::inverse::{Resources, invert_with};
use flexlink::response::{Play, PlayError, simulate};
use flexlink::result::{Remark, TipError};
use flexlink::spec::Specification;
use flexlink::store::{RunInputs, SimulationInputs};
use flexlink::sweep::{PlayedCase, SolvedCase};

use super::cases::Cases;
use super::tally::Told;
use crate::cli::inputs::remarks;
use crate::terminal::{Exit, Failure};

/// What came of a case.
pub(crate) struct Outcome<C> {
    /// Its numbers, or why it has none; or why the sweep ends.
    pub(crate) row: Result<Result<C, String>, Failure>,
    /// Its warnings.
    pub(crate) warnings: Vec<Told>,
    /// What is possible but rare in it.
    pub(crate) remarks: Vec<Remark>,
}

/// The numbers of a case, its warnings and its remarks.
pub(crate) type Found<C> = (C, Vec<Told>, Vec<Remark>);

impl<C> Outcome<C> {
    fn of(result: Result<Found<C>, Failure>, remarks: impl FnOnce() -> Vec<Remark>) -> Self {
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
    pub(crate) fn outcome<C>(
        &self,
        case: usize,
        work: impl Fn(&Self, usize, Option<usize>) -> Result<Found<C>, Failure>,
    ) -> Outcome<C> {
        let found = self.within_memory(|bytes| work(self, case, bytes));
        Outcome::of(found, || self.remarks(case))
    }

    /// Solves a case, numbered from 0.
    pub(crate) fn solve(
        &self,
        case: usize,
        memory_bytes: Option<usize>,
    ) -> Result<Found<SolvedCase>, Failure> {
        let values = self.plan.case(case);
        let specification = self.specification(&values)?;
        let Specification { link, mesh, analysis, limits, .. } = &specification;
        let motion = self.motion_of(link, values.motion)?;
        let resources =
            Resources { memory_bytes, periods: Some(&self.periods), ..Resources::default() };
        let solution = invert_with(link, mesh, &motion, analysis, &resources)?;
        let found = SolvedCase::of(&solution);
        let exceeded = limits.exceeded(&found.metrics);
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let inputs = RunInputs {
                link_file: &self.link_file,
                motion_file: &self.motion_file,
                arguments: &self.arguments(&values),
                verification: None,
                remarks: &remarks(&specification.remarks, &solution),
            };
            let solved = (&solution, &found, &exceeded[..]);
            self.shared.outputs.write_solution(&folder, &inputs, solved, memory_bytes)?;
        }
        let own = solution.warnings.iter().map(|w| Told::new(w.kind(), w, w.hint()));
        let limits = exceeded.iter().map(Told::of_limit);
        let first: Vec<f64> = found.period_s.iter().map(|period_s| TAU / period_s).collect();
        let of_modes = Remark::on_modes(link, solution.mesh(), &first);
        let of_motion = Remark::on_motion(link, &motion, solution.tip.largest_travel_m());
        let remarks = specification.remarks.iter().cloned().chain(of_modes).chain(of_motion);
        Ok((found, own.chain(limits).collect(), remarks.collect()))
    }

    /// Plays the torque on a case, numbered from 0.
    pub(crate) fn play(
        &self,
        case: usize,
        memory_bytes: Option<usize>,
    ) -> Result<Found<PlayedCase>, Failure> {
        let values = self.plan.case(case);
        let Specification { link, mesh, remarks, .. } = &self.specification(&values)?;
        let motion = self.motion_of(link, values.motion)?;
        let Some((torque_file, torque)) = &self.torque_file else {
            return Err(Failure::new(Exit::Usage, &"no torque to play", None));
        };
        let grid = torque.grid();
        let target = motion.target(grid.time_s(0), grid.end_s());
        let play = Play {
            until_s: Some(grid.end_s().max(target.grid().end_s())),
            initial_tip_m: target.start_m(),
            memory_bytes,
            ..Play::of(torque)
        };
        let simulation = simulate(link, mesh, &play)?;
        let tip_error = TipError::of(&simulation, &target)?;
        let error = PlayError::of(&simulation, link, &play)?;
        let found = PlayedCase::of(&simulation, tip_error);
        if let Some(folder) = self.shared.outputs.folder_of(case, self.plan.cases()) {
            let inputs = SimulationInputs {
                link_file: &self.link_file,
                torque_file,
                target_file: Some(&self.motion_file),
                reference_file: None,
                link,
                play: &play,
                arguments: &self.arguments(&values),
            };
            let error = error.as_ref();
            self.shared.outputs.write_simulation(&folder, &inputs, &simulation, &found, error)?;
        }
        let coarse = error.and_then(|error| error.warning());
        let own = simulation.warnings.iter().copied().chain(coarse);
        let own = own.map(|w| Told::new(w.kind(), &w, w.hint()));
        let late = tip_error.late.map(|late| Told::new(late.kind(), &late, late.hint()));
        Ok((found, own.chain(late).collect(), remarks.clone()))
    }
}
