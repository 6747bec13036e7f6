//! The table for a controller: made, played and written.

use std::path::Path;

use crate::beam::MeshPlan;
use crate::csv::Digits;
use crate::inverse::Solution;
use crate::link::Arm;
use crate::motion::Ends;
use crate::response::Interpolation;
use crate::result::{Held, Notice, SetPointError, SetPoints, Side};
use crate::store::{SetPointFile, Summary, TableRecord};
use crate::text::shown_path;
use crate::verify::{TableError, Unknown, table_error};

use super::notes::Told;
use super::write_args::{Hold, SideName, WriteArgs};
use crate::cli::terminal::text::rows_text;
use crate::cli::terminal::{Exit, Failure, StageBar, console, memory};

/// Most pins of LinuxCNC's streamer.
const PINS: usize = 20;

/// A table to write, and its error of the tip, if the table differs from the torque.
pub struct WrittenTable {
    pub table: SetPoints,
    errors: Vec<(Held, TableError)>,
    pub warning: Option<Notice>,
    /// Lines of the file and the summary about the table.
    pub notes: Vec<String>,
    joint_names: Vec<String>,
}

impl WriteArgs {
    /// The table of a link or an arm with its measured errors. `None` without --write.
    pub fn table(
        &self,
        solution: &Solution,
        plans: &[MeshPlan],
        stages: &StageBar,
    ) -> Result<Option<WrittenTable>, Failure> {
        if self.write.is_none() {
            return Ok(None);
        }
        let arm = &solution.arm;
        let side = if self.side == Some(SideName::Motor) { Side::Motor } else { Side::Joint };
        let joint_names = self.names_of_joints(arm)?;
        let refused = |error: SetPointError| table_refused(&error, arm);
        let table = SetPoints::of(solution, &self.set_points(), side).map_err(refused)?;
        let table = self.shaped(table, solution.motion.ends()).map_err(refused)?;
        if self.form.is_some() && table.columns().len() > PINS {
            let found = table.columns().len();
            let message = format!("halstreamer takes {PINS} columns, but the table has {found}");
            return Err(Failure::new(
                Exit::Usage,
                &message,
                Some("name fewer quantities in --with"),
            ));
        }
        let is_changed = self.hold.is_some() || self.window.is_some() || self.cycle.is_some();
        let (mut errors, mut unknown) = (Vec::new(), Vec::new());
        if is_changed || !self.counts.is_empty() {
            stages.at("playing");
            for held in table.held_by_drive() {
                match table_error(solution, plans, (&table, held), memory::available()) {
                    Ok(error) => errors.push((held, error)),
                    Err(Unknown::Reason(reason)) => unknown.push((held, reason)),
                    Err(Unknown::Error(error)) => return Err(error.into()),
                }
            }
        }
        // The times of a message begin with it.
        let from_0 = self.file_form().is_ros().then_some(0.0);
        let table = match self.start_at.or(from_0) {
            Some(start_s) => table.starting_at(start_s),
            None => table,
        };
        let (errors_of, unknown) = (&errors[..], &unknown[..]);
        let told = Told { options: self, arm, table: &table, errors: errors_of, unknown };
        let notes = told.lines(solution.joints.iter().any(|joint| joint.motor.is_some()));
        let warning = told.warning(solution.analysis.tip_tolerance());
        Ok(Some(WrittenTable { table, errors, warning, notes, joint_names }))
    }

    /// A table with the effects of the options, except its start.
    fn shaped(&self, table: SetPoints, ends: Ends) -> Result<SetPoints, SetPointError> {
        let table = match self.cycle {
            Some(cycle_s) => table.on_cycle(cycle_s, ends)?,
            None => table,
        };
        let table = match self.hold {
            Some(Hold::Zero) => table.held(Interpolation::Zero, ends),
            Some(Hold::Linear) => table.held(Interpolation::Linear, ends),
            None => table,
        };
        let table = match self.window {
            Some(share) => table.cut(share),
            None => table,
        };
        table.in_units(&self.units, &self.counts)
    }

    /// Writes the table and prints its warning; returns the number of warnings.
    pub(super) fn deliver(
        &self,
        written: &WrittenTable,
        summary: &Summary,
        digits: Digits,
    ) -> Result<usize, Failure> {
        self.write(written, summary, digits)?;
        let warning = written.warning.as_ref().filter(|_| self.write.is_some());
        console::warnings(warning.cloned());
        Ok(usize::from(warning.is_some()))
    }

    /// Writes the table.
    pub fn write(
        &self,
        WrittenTable { table, notes, joint_names, .. }: &WrittenTable,
        summary: &Summary,
        digits: Digits,
    ) -> Result<(), Failure> {
        let Some(file) = &self.write else { return Ok(()) };
        let is_plain = self.is_plain();
        let table = SetPointFile { table, summary, notes, digits, is_plain, joint_names };
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        console::deliver_by(Some(file), |out| table.write(out, self.file_form(), &stem))
    }

    /// The summary of a run that writes the table, too.
    pub fn recorded_in(&self, summary: Summary, written: Option<&WrittenTable>) -> Summary {
        let Some(WrittenTable { table, errors, warning, .. }) = written else { return summary };
        summary.with_table(&TableRecord {
            table,
            file: &self.name(),
            form: self.file_form(),
            arguments: &self.arguments(),
            errors,
            has_set_points: !self.is_plain(),
            warning: warning.as_ref(),
        })
    }

    /// Lines of the summary about the table; they go to standard error if standard output has the table.
    pub(super) fn text(&self, written: &WrittenTable) -> String {
        let file = shown_path(self.write.as_deref().unwrap_or(Path::new("-")));
        let rows = rows_text(&written.table.grid().thinned(std::num::NonZeroUsize::MIN));
        let first = format!("{rows}; {file}");
        let lines = std::iter::once(&first).chain(&written.notes);
        let labels = std::iter::once("table").chain(std::iter::repeat(""));
        let lines = lines.zip(labels).map(|(line, label)| format!("{label:<8} {line}"));
        lines.collect::<Vec<_>>().join("\n") + "\n"
    }
}

/// The failure of a table that is impossible.
fn table_refused(error: &SetPointError, arm: &Arm) -> Failure {
    let (option, hint) = match error {
        SetPointError::NoMotor { .. } => ("--side = motor", "leave --side out"),
        SetPointError::Rows { .. } => ("--cycle", "use another cycle, such as '2 ms'"),
        SetPointError::NoFit { .. } => {
            ("--cycle", "use a cycle that divides the motion, or --resample")
        }
        SetPointError::NoColumn { .. } => {
            let hint =
                "name a quantity of --with, a joint that is there, and a unit of its dimension";
            ("--units or --counts", hint)
        }
        SetPointError::NoUnit { .. } => {
            ("--counts", "name it, as in position='4096/360 deg', or choose --units position=deg")
        }
        SetPointError::TooManyCounts { .. } => ("--counts", "use fewer counts, or no counts"),
    };
    Failure::new(Exit::Usage, &arm.worded(&format!("{option}: {error}")), Some(hint))
}
