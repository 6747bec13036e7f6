//! `solve --write`: the torque alone, as a controller plays it.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, ValueEnum};

use crate::beam::MeshPlan;
use crate::csv::Digits;
use crate::inverse::Solution;
use crate::motion::Ends;
use crate::response::Interpolation;
use crate::result::{Notice, TorqueTable};
use crate::store::{SUMMARY, Summary, TableRecord, TorqueFile, TorqueForm, is_result_file};
use crate::text::{plain, shown_path, significant};
use crate::verify::{TableError, table_error};

use crate::cli::options::common::{option, seconds};
use crate::cli::terminal::console::is_standard_output;
use crate::cli::terminal::files::keep_inputs;
use crate::cli::terminal::text::rows_text;
use crate::cli::terminal::{Exit, Failure, StageBar, console, memory};

/// Largest error of the tip over its travel without a warning, unless the tolerance is looser: the bound of `verify`.
const TIP: f64 = 1e-3;

/// Share of an error below which its uncertainty needs no line.
const KNOWN: f64 = 0.05;

/// Largest error of the time of a row, as a share of a step.
const TIME: f64 = 1e-3;

/// The torque in a file of its own.
#[derive(Debug, Args)]
pub(super) struct WriteArgs {
    /// Write only the torque at the hub, or the joints, or the force on a carriage; results go to a folder only with -o. The ending chooses the
    /// form: .csv, .h for C, .m for MATLAB and Simulink. `-` prints CSV, and no summary.
    #[arg(long, value_name = "FILE")]
    pub(super) write: Option<PathBuf>,

    /// Time of the first row of FILE, in s or with unit: shifts all times.
    #[arg(long, value_name = "TIME", requires = "write", value_parser = seconds)]
    #[arg(allow_hyphen_values = true)]
    start_at: Option<f64>,

    /// Cut the rows at both ends of FILE where every torque stays below this share of its peak, `2%` or 0.02. The
    /// table is then played, and the tip's error printed.
    #[arg(long, value_name = "SHARE", requires = "write", value_parser = share)]
    window: Option<f64>,

    /// FILE has values for a converter that holds each until the next row (zero), corrected so that the link moves as
    /// wanted. The remaining error of the tip is printed.
    #[arg(long, value_name = "KIND", requires = "write", value_enum)]
    hold: Option<Hold>,
}

/// Output of a converter between two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Hold {
    Zero,
}

/// A table to write, and its error of the tip, if the table differs from the torque.
pub(super) struct WrittenTable {
    table: TorqueTable,
    error: Option<TableError>,
    warning: Option<Notice>,
    /// Lines of the file and the summary about the table.
    notes: Vec<String>,
}

/// The arguments of a record, read as those of the command line are.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Recorded {
    #[command(flatten)]
    table: WriteArgs,
}

impl WriteArgs {
    /// Returns an error if FILE has an ending without a form, or would replace an input or a result.
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
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        if TorqueForm::of(file).is_some_and(|form| !form.takes(&stem)) {
            let must = "must have a name of letters, digits and `_`, a letter first";
            return refuse(must, "choose another name: names in C and MATLAB begin with it");
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

    /// Returns an error if the options do not fit a motion with these ends and this step.
    pub(super) fn check_motion(&self, ends: Ends, step_s: f64) -> Result<(), Failure> {
        if self.window.is_some() && ends != Ends::AtRest {
            let message = "--window is for a motion from rest to rest, and this one is not";
            return Err(Failure::new(Exit::Usage, &message, Some("leave --window out")));
        }
        let most_s = TIME * step_s / f64::EPSILON;
        let Some(start_s) = self.start_at.filter(|start_s| start_s.abs() > most_s) else {
            return Ok(());
        };
        let [start, most, step] = [start_s, most_s, step_s].map(|time_s| significant(time_s, 3));
        let message = format!(
            "--start-at = {start} s, but must lie from -{most} to {most} s: farther out, double precision does not \
             separate times {step} s apart to a thousandth of a step"
        );
        Err(Failure::new(Exit::Usage, &message, None))
    }

    /// True if standard output has the table.
    pub(super) fn is_printed(&self) -> bool {
        self.write.as_deref().is_some_and(is_standard_output)
    }

    /// Parses the arguments of a record.
    pub(super) fn recorded(arguments: &[String]) -> Result<Self, clap::Error> {
        Recorded::try_parse_from(arguments).map(|recorded| recorded.table)
    }

    /// The arguments, for the record; the file by its name alone.
    fn arguments(&self) -> Vec<String> {
        let write = option("--write", self.name());
        let start_at = self.start_at.map(|start_s| option("--start-at", plain(start_s)));
        let window = self.window.map(|share| option("--window", plain(share)));
        let hold = self.hold.map(|_| option("--hold", "zero"));
        [Some(write), start_at, window, hold].into_iter().flatten().flatten().collect()
    }

    /// Name of the file, `-` for standard output.
    fn name(&self) -> String {
        let name = self.write.as_deref().and_then(Path::file_name).unwrap_or("-".as_ref());
        name.to_string_lossy().into_owned()
    }

    fn form(&self) -> TorqueForm {
        self.write.as_deref().and_then(TorqueForm::of).unwrap_or(TorqueForm::Csv)
    }

    /// The table of a link or an arm with its measured error. `None` without --write.
    pub(super) fn table(
        &self,
        solution: &Solution,
        plans: &[MeshPlan],
        stages: &StageBar,
    ) -> Result<Option<WrittenTable>, Failure> {
        if self.write.is_none() {
            return Ok(None);
        }
        let words = solution.arm.pick(&OF_LINK, &OF_ARM);
        let has_motor = solution.joints.iter().any(|joint| joint.motor.is_some());
        let table = self.shaped(TorqueTable::of(solution), solution.motion.ends());
        let error = if self.hold.is_some() || self.window.is_some() {
            stages.at("playing");
            Some(table_error(solution, plans, &table, memory::available())?)
        } else {
            None
        };
        let motor = has_motor.then(|| words.motor.to_owned());
        let tip_tolerance = solution.analysis.tip_tolerance();
        let written = self.written((table, error), tip_tolerance, words, motor);
        let joint = solution.arm.joint();
        Ok(Some(WrittenTable {
            notes: written.notes.iter().map(|line| joint.worded(line)).collect(),
            warning: written.warning.map(|own| own.worded(&solution.arm)),
            ..written
        }))
    }

    /// A table with the effects of the options, except its start.
    fn shaped(&self, table: TorqueTable, ends: Ends) -> TorqueTable {
        let table = if self.hold.is_some() { table.held(ends) } else { table };
        match self.window {
            Some(share) => table.cut(share),
            None => table,
        }
    }

    /// The table at its start, its warning, and the lines about it.
    fn written(
        &self,
        (table, error): (TorqueTable, Option<TableError>),
        tip_tolerance: f64,
        words: &Words,
        motor: Option<String>,
    ) -> WrittenTable {
        let table = match self.start_at {
            Some(start_s) => table.starting_at(start_s),
            None => table,
        };
        let warning = error.as_ref().and_then(|error| self.warning(error, tip_tolerance, words));
        let begins = format!("the motion begins at {} s", significant(table.moves_from_s(), 4));
        let size = if table.has_weight() { "range" } else { "peak" };
        let cut = self.window.map(|share| {
            let percent = significant(100.0 * share, 3);
            format!("cut below {percent} % of {}torque's {size}", words.of_torque)
        });
        let held =
            self.hold.map(|_| "values for a converter that holds each until the next".to_owned());
        let found = error.iter().flat_map(|error| found(&table, error));
        let until = error.as_ref().filter(|_| self.window.is_some()).map(|error| {
            let until = significant(table.solved_until_s(), 3);
            let rest = if error.feedback.is_empty() { words.drift } else { "" };
            format!("measured to {until} s{rest}")
        });
        let notes = [Some(begins), cut, held].into_iter().flatten().chain(found);
        let notes = notes.chain(until).chain(motor).collect();
        WrittenTable { table, error, warning, notes }
    }

    /// The warning of a table with a larger tip error than allowed.
    fn warning(&self, error: &TableError, tip_tolerance: f64, words: &Words) -> Option<Notice> {
        let allowed = TIP.max(tip_tolerance);
        let TableError { tip, change_m, .. } = error;
        let share = tip.share * (1.0 + change_m / tip.worst_m.max(f64::MIN_POSITIVE));
        if share <= allowed {
            return None;
        }
        let [share, allowed] = [share, allowed].map(|share| significant(share, 2));
        let message = format!(
            "the torque table moves the tip off by {share} of its travel, more than {allowed}"
        );
        let hint = match self.window {
            Some(_) => words.smaller,
            None => "use a motion with a shorter step",
        };
        Some(Notice::new("table_moves_tip", &message, hint))
    }

    /// Writes the table and prints its warning; returns the number of warnings.
    pub(super) fn deliver(
        &self,
        written: &WrittenTable,
        summary: &Summary,
        digits: Digits,
    ) -> Result<usize, Failure> {
        let Some(file) = &self.write else { return Ok(0) };
        let WrittenTable { table, warning, notes, .. } = written;
        let table = TorqueFile { table, summary, notes, digits };
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        console::deliver_by(Some(file), |out| table.write(out, self.form(), &stem))?;
        if let Some(Notice { message, hint, .. }) = warning {
            console::warning(message, hint);
        }
        Ok(usize::from(warning.is_some()))
    }

    /// The summary of a run that writes the table, too.
    pub(super) fn recorded_in(&self, summary: Summary, written: Option<&WrittenTable>) -> Summary {
        let Some(WrittenTable { table, error, warning, .. }) = written else { return summary };
        summary.with_table(&TableRecord {
            table,
            file: &self.name(),
            form: self.form(),
            arguments: &self.arguments(),
            error: error.as_ref(),
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

/// Words that differ between a link and an arm.
struct Words {
    /// Article of a torque: "the ", "every ".
    of_torque: &'static str,
    /// Warning of drift after a cut.
    drift: &'static str,
    /// Remedy for a cut that is too large.
    smaller: &'static str,
    /// Place of the torques if there is a motor.
    motor: &'static str,
}

const OF_LINK: Words = Words {
    of_torque: "the ",
    drift: "; a free hub drifts on after a cut",
    smaller: "use a smaller --window, or feedback of the hub's angle",
    motor: "torque at the hub, beyond the gear; with -o the motor's own is in motor.csv",
};

const OF_ARM: Words = Words {
    of_torque: "every ",
    drift: "; free joints drift on after a cut",
    smaller: "use a smaller --window, or feedback of the joints",
    motor: "torques at the joints, beyond gears; motor.csv of -o has the motors'",
};

/// Results of playing a table, a line each.
fn found(table: &TorqueTable, error: &TableError) -> Vec<String> {
    let TableError { tip, change_m, feedback } = error;
    let [worst, time, of] =
        [tip.worst_m, table.time_s(tip.time_s), tip.share].map(|number| significant(number, 3));
    let mut lines =
        vec![format!("tip off at the rows by up to {worst} m, {of} of its travel, at {time} s")];
    if *change_m > KNOWN * tip.worst_m {
        let change = significant(*change_m, 1);
        lines.push(format!(
            "known to {change} m, the change by the last refinements of the simulations"
        ));
    }
    if !feedback.is_empty() {
        let gains: Vec<String> = feedback.iter().flatten().map(|gain| plain(*gain)).collect();
        let falls = "nothing else holds the arm: played with feedback around its joints,";
        lines.push(falls.to_owned());
        lines.push(format!("{} (N m/rad and N m s/rad of each)", gains.join(",")));
        if table.interpolation() == Interpolation::Zero {
            lines.push(
                "with a reference that is corrected for the hold as the torques are".to_owned(),
            );
        }
    }
    lines
}

/// A path from the root, for a folder that need not exist.
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
