//! `solve --write`: the torque alone, as a controller plays it.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use flexlink::csv::Digits;
use flexlink::inverse::{ArmSolution, Solution};
use flexlink::motion::Ends;
use flexlink::result::{TipError, TorqueTable};
use flexlink::store::{SUMMARY, Summary, TorqueFile, TorqueForm, is_result_file};
use flexlink::text::significant;
use flexlink::verify::table_error;

use crate::options::common::seconds;
use crate::terminal::console::is_standard_output;
use crate::terminal::files::keep_inputs;
use crate::terminal::text::rows_text;
use crate::terminal::{Exit, Failure, StageBar, console, memory};

/// Largest error of the tip over its travel that is no warning, unless the tolerance is looser: what `verify` allows.
const TIP: f64 = 1e-3;

/// The torque in a file of its own.
#[derive(Debug, Args)]
pub(super) struct WriteArgs {
    /// Write the torque at the hub, or the joints, alone; results go to a folder only with -o. The ending is
    /// the form: .csv, .h for C, .m for MATLAB and Simulink. `-` prints CSV, and no summary.
    #[arg(long, value_name = "FILE", conflicts_with = "repeat")]
    pub(super) write: Option<PathBuf>,

    /// Time of the first row of FILE, in s or with unit: shifts all times.
    #[arg(long, value_name = "TIME", requires = "write", value_parser = seconds)]
    #[arg(allow_negative_numbers = true)]
    start_at: Option<f64>,

    /// Leave out rows of FILE before and after which the torque stays below this share of its peak, `2%`
    /// or 0.02. What that costs is measured: the table is played, and the tip's error printed.
    #[arg(long, value_name = "SHARE", requires = "write", value_parser = share)]
    window: Option<f64>,

    /// FILE has the values of a converter that holds each until the next row (zero), so that the link
    /// moves as wanted. The tip's error that remains is measured and printed.
    #[arg(long, value_name = "KIND", requires = "write", value_enum)]
    hold: Option<Hold>,
}

/// What a converter does between two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Hold {
    Zero,
}

/// A table to write, and the tip's error where the table is not the torque itself.
pub(super) struct WrittenTable {
    table: TorqueTable,
    tip_error: Option<TipError>,
    /// The error that is no warning.
    allowed: f64,
    /// Where it was cut.
    cut: Option<String>,
    /// What else is to be known of the torque.
    remarks: Vec<String>,
}

impl WriteArgs {
    /// Returns an error if FILE has an ending that is no form, or would replace an input or a result.
    pub(super) fn check(&self, inputs: &[&Path], output: Option<&Path>) -> Result<(), Failure> {
        let Some(file) = self.write.as_deref().filter(|file| !is_standard_output(file)) else {
            return Ok(());
        };
        let refuse = |must: &str, hint: &str| {
            let message = format!("--write = {}, but {must}", file.display());
            Err(Failure::new(Exit::Usage, &message, Some(hint)))
        };
        if TorqueForm::of(file).is_none() {
            let hint = ".csv is a table, .h a C header, .m a script for MATLAB and Simulink";
            return refuse("must end in .csv, .h or .m, or be `-`", hint);
        }
        let is_result = file.file_name().is_some_and(is_result_file);
        let folder = placed(file.parent().unwrap_or(Path::new("")));
        let is_of_run =
            output.is_some_and(|output| placed(output) == folder) || folder.join(SUMMARY).is_file();
        if is_result && is_of_run {
            return refuse("must not be a file of a run's results", "give it another name");
        }
        keep_inputs("--write", file, inputs)
    }

    /// True if standard output has the table.
    pub(super) fn is_printed(&self) -> bool {
        self.write.as_deref().is_some_and(is_standard_output)
    }

    /// The table of a link, its error measured.
    pub(super) fn of_link(
        &self,
        solution: &Solution,
        stages: &StageBar,
    ) -> Result<Option<WrittenTable>, Failure> {
        if self.write.is_none() {
            return Ok(None);
        }
        let ends = solution.motion.ends();
        let mut table = TorqueTable::of(solution);
        if self.hold.is_some() {
            table = table.held(ends);
        }
        if let Some(share) = self.window {
            if ends != Ends::AtRest {
                let message = "--window is for a motion from rest to rest, and this one is not";
                return Err(Failure::new(Exit::Usage, &message, None));
            }
            table = table.cut(solution, share);
        }
        let is_changed = self.hold.is_some() || self.window.is_some();
        let error = || {
            stages.at("playing");
            table_error(solution, &table, memory::available())
        };
        let tip_error = is_changed.then(error).transpose()?;
        let allowed = TIP.max(solution.analysis.tip_tolerance());
        let (table, grid) = (self.shifted(table), &solution.grid);
        let of = if solution.link().has_weight() { "range" } else { "peak" };
        let cut = self.window.map(|share| {
            let percent = significant(100.0 * share, 3);
            format!("cut below {percent} % of the torque's {of}")
        });
        let until = self.window.map(|_| {
            let until = significant(table.time_s(grid.time_s(grid.len - 1)), 3);
            format!("measured to {until} s; a free hub drifts on after a cut")
        });
        let motor = solution.motor.as_ref().map(|_| {
            "torque at the hub, beyond the gear; with -o the motor's own is in motor.csv".to_owned()
        });
        let remarks = until.into_iter().chain(motor).collect();
        Ok(Some(WrittenTable { table, tip_error, allowed, cut, remarks }))
    }

    /// The table of an arm.
    pub(super) fn of_arm(&self, solution: &ArmSolution) -> Option<WrittenTable> {
        self.write.as_ref()?;
        let table = self.shifted(TorqueTable::of_arm(solution));
        Some(WrittenTable { table, tip_error: None, allowed: TIP, cut: None, remarks: Vec::new() })
    }

    /// Options that are known for one link alone.
    pub(super) fn of_one_link(&self) -> Vec<String> {
        let given = [("--window", self.window.is_some()), ("--hold", self.hold.is_some())];
        given
            .into_iter()
            .filter(|(_, is_given)| *is_given)
            .map(|(name, _)| name.to_owned())
            .collect()
    }

    fn shifted(&self, table: TorqueTable) -> TorqueTable {
        match self.start_at {
            Some(start_s) => table.starting_at(start_s),
            None => table,
        }
    }

    /// Writes the table and warns where it moves the tip off; returns the number of warnings.
    pub(super) fn deliver(
        &self,
        written: &WrittenTable,
        summary: &Summary,
        digits: Digits,
    ) -> Result<usize, Failure> {
        let Some(file) = &self.write else { return Ok(0) };
        let notes = [vec![written.begins()], self.notes(written)].concat();
        let table = TorqueFile { table: &written.table, summary, notes: &notes, digits };
        let form = TorqueForm::of(file).unwrap_or(TorqueForm::Csv);
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        console::deliver_by(Some(file), |out| table.write(out, form, &stem))?;
        let Some(error) = written.tip_error.filter(|error| error.share > written.allowed) else {
            return Ok(0);
        };
        let [share, allowed] = [error.share, written.allowed].map(|share| significant(share, 2));
        let message = format!(
            "the torque table moves the tip off by {share} of its travel, more than {allowed}"
        );
        let hint = if self.window.is_some() {
            "a smaller --window, or feedback of the hub's angle"
        } else {
            "a motion with a shorter step"
        };
        console::warning(message, hint);
        Ok(1)
    }

    /// What the summary says of the table, and standard error where standard output has it.
    pub(super) fn text(&self, written: &WrittenTable) -> String {
        let file = self.write.as_deref().unwrap_or(Path::new("-")).display();
        let rows = rows_text(&written.table.grid().thinned(std::num::NonZeroUsize::MIN));
        let begins = written.begins();
        let lines = [vec![format!("{rows}; {file}"), begins], self.notes(written)].concat();
        let labels = std::iter::once("table").chain(std::iter::repeat(""));
        let lines = lines.iter().zip(labels).map(|(line, label)| format!("{label:<8} {line}"));
        lines.collect::<Vec<_>>().join("\n") + "\n"
    }

    /// What was done to the torque, and what it costs.
    fn notes(&self, written: &WrittenTable) -> Vec<String> {
        let held =
            self.hold.map(|_| "values for a converter that holds each until the next".to_owned());
        let error = written.tip_error.map(|error| {
            let [worst, time, of] =
                [error.worst_m, written.table.time_s(error.time_s), error.share]
                    .map(|number| significant(number, 3));
            format!("tip off by up to {worst} m, {of} of its travel, at {time} s")
        });
        let cut = written.cut.iter().cloned();
        cut.chain(held).chain(error).chain(written.remarks.iter().cloned()).collect()
    }
}

impl WrittenTable {
    /// When the motion begins in the table.
    fn begins(&self) -> String {
        format!("the motion begins at {} s", significant(self.table.moves_from_s(), 4))
    }
}

/// A path from the root, of a folder that need not be there.
fn placed(folder: &Path) -> PathBuf {
    let whole = std::path::absolute(Path::new(".").join(folder)).unwrap_or_default();
    let there = whole.ancestors().find_map(|own| Some((own.canonicalize().ok()?, own)));
    let rest = there.and_then(|(there, own)| Some(there.join(whole.strip_prefix(own).ok()?)));
    rest.unwrap_or(whole)
}

/// A share above 0 and below 1, as a number or in percent.
fn share(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(percent) => (percent, 0.01),
        None => (text, 1.0),
    };
    let share = number.trim().parse().ok().map(|number: f64| scale * number);
    let share = share.filter(|share| *share > 0.0 && *share < 1.0);
    share.ok_or_else(|| "must be a share above 0 and below 1, as 2% or 0.02".into())
}
