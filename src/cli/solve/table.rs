//! `solve --write`: the torque alone, or set-points, as a controller plays them.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, ValueEnum};

use crate::beam::MeshPlan;
use crate::csv::Digits;
use crate::inverse::Solution;
use crate::link::Arm;
use crate::motion::Ends;
use crate::response::Interpolation;
use crate::result::{
    DriveUnit, Held, Notice, SetPoint, SetPointError, SetPoints, Side, UnitChoice,
};
use crate::store::{SUMMARY, SetPointFile, SetPointForm, Summary, TableRecord, is_result_file};
use crate::text::{plain, shown_path, significant};
use crate::verify::{TableError, Unknown, table_error};

use crate::cli::help::wrapped;
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

/// Most pins of LinuxCNC's streamer.
const PINS: usize = 20;

/// Letters of a line of a reason.
const REASON: usize = 70;

const CONTROLLER: &str = "Table for a controller";

/// The torque, or set-points, in a file of its own.
#[derive(Debug, Args)]
pub struct WriteArgs {
    /// Write only the torque at the hub, or the joints, or the force on a carriage; results go to a folder only with -o. The ending chooses the
    /// form: .csv, .h for C, .m for MATLAB and Simulink, .mat, .npz for NumPy, .yaml or .json for ROS 2. `-` prints CSV,
    /// and no summary.
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

    /// FILE has values for a converter that holds each until the next row (zero), or for a drive that draws straight lines
    /// between them (linear), corrected so that the link moves as wanted. The remaining error of the tip is printed.
    #[arg(long, value_name = "KIND", requires = "write", value_enum)]
    hold: Option<Hold>,

    /// Columns of FILE for every joint; effort is the torque or force. The tip's error is played for a drive that holds the
    /// position, else the velocity, and for one that holds the effort.
    #[arg(long, value_name = "LIST", requires = "write", value_delimiter = ',', value_enum)]
    #[arg(help_heading = CONTROLLER)]
    with: Vec<Quantity>,

    /// Side of the columns: the joint, or its motor before gear and elastic transmission, as in motor.csv
    /// [default: joint].
    #[arg(long, value_name = "SIDE", requires = "write", value_enum, help_heading = CONTROLLER)]
    side: Option<SideName>,

    /// Cycle of the controller, `2 ms`: the time between two rows [default: the step of MOTION].
    #[arg(long, value_name = "TIME", requires = "write", value_parser = cycle, help_heading = CONTROLLER)]
    cycle: Option<f64>,

    /// Units of the columns: position=deg,effort='N cm'; of one joint position2=deg [default: SI].
    #[arg(long, value_name = "QUANTITY=UNIT", requires = "write", value_delimiter = ',')]
    #[arg(value_parser = UnitChoice::of_unit, help_heading = CONTROLLER)]
    units: Vec<UnitChoice>,

    /// Columns in whole counts of the drive: counts over a range, in --units unless it has a unit, and the count at 0:
    /// position=4096/'360 deg'+2048, effort=1000/2.5. A negative number turns the sign. The rounding is played.
    #[arg(long, value_name = "QUANTITY=COUNTS/RANGE", requires = "write", value_delimiter = ',')]
    #[arg(value_parser = UnitChoice::of_counts, help_heading = CONTROLLER)]
    counts: Vec<UnitChoice>,

    /// Form of FILE where its ending does not say it: lines for LinuxCNC's halstreamer, .txt.
    #[arg(long, value_name = "FORM", requires = "write", value_enum, help_heading = CONTROLLER)]
    form: Option<FormName>,

    /// Names of the joints in .yaml, .json, .mat and .npz [default: joint1, joint2, …, carriage].
    #[arg(long, value_name = "LIST", requires = "write", value_delimiter = ',')]
    #[arg(help_heading = CONTROLLER)]
    joint_names: Vec<String>,
}

/// Output of a converter or a drive between two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Hold {
    Zero,
    Linear,
}

/// A quantity of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Quantity {
    Position,
    Velocity,
    Acceleration,
    Effort,
}

/// A side of a joint's gear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SideName {
    Joint,
    Motor,
}

/// A form without an ending of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormName {
    Halstreamer,
}

impl From<Quantity> for SetPoint {
    fn from(own: Quantity) -> Self {
        match own {
            Quantity::Position => Self::Position,
            Quantity::Velocity => Self::Velocity,
            Quantity::Acceleration => Self::Acceleration,
            Quantity::Effort => Self::Effort,
        }
    }
}

/// Name of a value of an option.
fn value_name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |own| own.get_name().to_owned())
}

/// A table to write, and its error of the tip, if the table differs from the torque.
pub struct WrittenTable {
    pub table: SetPoints,
    errors: Vec<(Held, TableError)>,
    pub warning: Option<Notice>,
    /// Lines of the file and the summary about the table.
    pub notes: Vec<String>,
    joint_names: Vec<String>,
}

/// The arguments of a record, read as those of the command line are.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Recorded {
    #[command(flatten)]
    table: WriteArgs,
}

impl WriteArgs {
    /// Returns an error if FILE has an ending without a form, or would replace an input or a result, or if its columns do
    /// not suit it.
    pub fn check(&self, inputs: &[&Path], output: Option<&Path>) -> Result<(), Failure> {
        self.check_columns()?;
        let Some(file) = self.write.as_deref().filter(|file| !is_standard_output(file)) else {
            return Ok(());
        };
        let refuse = |must: &str, hint: &str| {
            let message = format!("--write = {}, but {must}", file.display());
            Err(Failure::new(Exit::Usage, &message, Some(hint)))
        };
        let is_text = file.extension().is_some_and(|end| end.eq_ignore_ascii_case("txt"));
        if self.form.is_some() && !is_text {
            return refuse("must end in .txt with --form halstreamer", "leave --form out");
        }
        if self.form.is_none() && is_text {
            let hint = "--form halstreamer writes lines for LinuxCNC";
            return refuse("a .txt needs the name of its form", hint);
        }
        if self.form.is_none() && SetPointForm::of(file).is_none() {
            let hint = ".csv is a table, .h a C header, .m a script for MATLAB and Simulink, .yaml and .json are for ROS 2";
            return refuse("must end in .csv, .h, .m, .mat, .npz, .yaml or .json, or be `-`", hint);
        }
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        if !self.file_form().takes(&stem) {
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

    /// Returns an error if the columns contradict each other or the form.
    fn check_columns(&self) -> Result<(), Failure> {
        let refuse =
            |message: &str, hint: &str| Err(Failure::new(Exit::Usage, &message, Some(hint)));
        let with = self.set_points();
        let has = |set_point: SetPoint| with.contains(&set_point);
        if (1..with.len()).any(|k| with[..k].contains(&with[k])) {
            return refuse(
                "--with names a quantity twice, but must name each once",
                "leave one out",
            );
        }
        if with == [SetPoint::Acceleration] {
            let message = "--with = acceleration, but must have a quantity that a drive holds, too";
            return refuse(message, "add position, velocity or effort");
        }
        let form = self.file_form();
        if self.write.is_some() && form.is_ros() {
            if !has(SetPoint::Position) || has(SetPoint::Acceleration) && !has(SetPoint::Velocity) {
                let message = "a JointTrajectory must have the position of each joint, and with the acceleration the velocity";
                return refuse(
                    message,
                    "use --with position,velocity,acceleration,effort, or the first of these",
                );
            }
            if !self.units.is_empty() || !self.counts.is_empty() {
                let message =
                    "--units and --counts do not suit a JointTrajectory, whose numbers are in SI";
                return refuse(message, "leave them out, or choose another ending");
            }
            if self.start_at.is_some_and(|start_s| start_s < 0.0) {
                let message = "--start-at is below 0, but must be 0 or above: time_from_start of the first point";
                return refuse(message, "leave --start-at out");
            }
        }
        Ok(())
    }

    /// Returns an error if the options do not fit a motion with these ends and this step.
    pub fn check_motion(&self, ends: Ends, step_s: f64) -> Result<(), Failure> {
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
        let list = |name: &str, texts: Vec<String>| {
            if texts.is_empty() { Vec::new() } else { option(name, texts.join(",")) }
        };
        let texts = |own: &[UnitChoice]| own.iter().map(|own| own.text.clone()).collect();
        [
            option("--write", self.name()),
            self.start_at.map_or_else(Vec::new, |start_s| option("--start-at", plain(start_s))),
            self.window.map_or_else(Vec::new, |share| option("--window", plain(share))),
            self.hold.map_or_else(Vec::new, |hold| option("--hold", value_name(&hold))),
            list("--with", self.with.iter().map(value_name).collect()),
            self.side.map_or_else(Vec::new, |side| option("--side", value_name(&side))),
            self.cycle.map_or_else(Vec::new, |cycle_s| option("--cycle", plain(cycle_s))),
            list("--units", texts(&self.units)),
            list("--counts", texts(&self.counts)),
            self.form.map_or_else(Vec::new, |form| option("--form", value_name(&form))),
            list("--joint-names", self.joint_names.clone()),
        ]
        .concat()
    }

    /// Name of the file, `-` for standard output.
    fn name(&self) -> String {
        let name = self.write.as_deref().and_then(Path::file_name).unwrap_or("-".as_ref());
        name.to_string_lossy().into_owned()
    }

    fn file_form(&self) -> SetPointForm {
        match (self.form, self.write.as_deref().and_then(SetPointForm::of)) {
            (Some(FormName::Halstreamer), _) => SetPointForm::Halstreamer,
            (None, form) => form.unwrap_or(SetPointForm::Csv),
        }
    }

    /// The quantities of the columns: the effort unless the user names others.
    fn set_points(&self) -> Vec<SetPoint> {
        if self.with.is_empty() {
            return vec![SetPoint::Effort];
        }
        self.with.iter().map(|own| SetPoint::from(*own)).collect()
    }

    /// True for the torque alone, without quantities, cycle and units of its own.
    fn is_plain(&self) -> bool {
        let has_units = !self.units.is_empty() || !self.counts.is_empty();
        self.with.is_empty() && self.side.is_none() && self.cycle.is_none() && !has_units
    }

    /// The joints' names in messages and files of arrays.
    fn names_of_joints(&self, arm: &Arm) -> Result<Vec<String>, Failure> {
        let joints = arm.joints().count();
        let own = &self.joint_names;
        if own.is_empty() {
            let slides = arm.joints().map(|joint| joint.slides());
            let name = |(number, slides): (usize, bool)| {
                if slides { "carriage".to_owned() } else { format!("joint{number}") }
            };
            return Ok((1..).zip(slides).map(name).collect());
        }
        let is_twice = (1..own.len()).any(|k| own[..k].contains(&own[k]));
        if own.len() == joints && !is_twice && own.iter().all(|name| !name.is_empty()) {
            return Ok(own.clone());
        }
        let message =
            format!("--joint-names = {}, but must be {joints} different names", own.join(","));
        Err(Failure::new(Exit::Usage, &message, Some("name each joint once, the inner one first")))
    }

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
        let words = solution.arm.pick(&OF_LINK, &OF_ARM);
        let side = if self.side == Some(SideName::Motor) { Side::Motor } else { Side::Joint };
        let joint_names = self.names_of_joints(&solution.arm)?;
        let has_motor = solution.joints.iter().any(|joint| joint.motor.is_some());
        let refused = |error: SetPointError| table_refused(&error, &solution.arm);
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
        let motor = if self.is_plain() { words.motor } else { BESIDE_MOTOR };
        let motor = (has_motor && side == Side::Joint).then(|| motor.to_owned());
        let tip_tolerance = solution.analysis.tip_tolerance();
        let mut written = self.written((table, errors), tip_tolerance, words, motor);
        for (held, reason) in unknown {
            written.notes.push(format!("not played {}:", where_held(held, side)));
            written.notes.extend(wrapped(&reason, REASON));
        }
        let joint = solution.arm.joint();
        Ok(Some(WrittenTable {
            notes: written.notes.iter().map(|line| joint.worded(line)).collect(),
            warning: written.warning.map(|own| own.worded(&solution.arm)),
            joint_names,
            ..written
        }))
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

    /// The table at its start, its warning, and the lines about it.
    fn written(
        &self,
        (table, errors): (SetPoints, Vec<(Held, TableError)>),
        tip_tolerance: f64,
        words: &Words,
        motor: Option<String>,
    ) -> WrittenTable {
        // The times of a message begin with it.
        let from_0 = self.file_form().is_ros().then_some(0.0);
        let table = match self.start_at.or(from_0) {
            Some(start_s) => table.starting_at(start_s),
            None => table,
        };
        let is_plain = self.is_plain();
        let warning = errors.first().and_then(|own| self.warning(own, tip_tolerance, words));
        let begins = format!("the motion begins at {} s", significant(table.moves_from_s(), 4));
        let columns = if is_plain { Vec::new() } else { described(&table) };
        let cycle = self.cycle.map(|cycle_s| format!("a row each {} s", plain(cycle_s)));
        let size = if table.has_weight() { "range" } else { "peak" };
        let cut = self.window.map(|share| {
            let percent = significant(100.0 * share, 3);
            if is_plain {
                format!("cut below {percent} % of {}torque's {size}", words.of_torque)
            } else {
                format!("cut below {percent} % of every column's peak or range")
            }
        });
        let held = self.hold.map(|hold| match hold {
            Hold::Zero => "values for a converter that holds each until the next".to_owned(),
            Hold::Linear => "values for a drive that draws straight lines between them".to_owned(),
        });
        let found = errors.iter().flat_map(|(held, error)| {
            let place = format!("{}:", where_held(*held, table.side()));
            (!is_plain).then_some(place).into_iter().chain(found(&table, error))
        });
        let until = errors.last().filter(|_| self.window.is_some()).map(|(held, error)| {
            let until = significant(table.solved_until_s(), 3);
            let drifts = error.feedback.is_empty() && *held == Held::Effort;
            let rest = if drifts { words.drift } else { "" };
            format!("measured to {until} s{rest}")
        });
        let notes = [Some(begins)].into_iter().flatten().chain(columns);
        let notes = notes.chain([cycle, cut, held].into_iter().flatten()).chain(found);
        let notes = notes.chain(until).chain(motor).collect();
        WrittenTable { table, errors, warning, notes, joint_names: Vec::new() }
    }

    /// The warning of a table with a larger tip error than allowed.
    fn warning(
        &self,
        (held, error): &(Held, TableError),
        tip_tolerance: f64,
        words: &Words,
    ) -> Option<Notice> {
        let allowed = TIP.max(tip_tolerance);
        let TableError { tip, change_m, .. } = error;
        let share = tip.share * (1.0 + change_m / tip.worst_m.max(f64::MIN_POSITIVE));
        if share <= allowed {
            return None;
        }
        let [share, allowed] = [share, allowed].map(|share| significant(share, 2));
        let table = if self.is_plain() { "the torque table" } else { "the table" };
        let message =
            format!("{table} moves the tip off by {share} of its travel, more than {allowed}");
        let hint = match self.window {
            Some(_) if !self.counts.is_empty() => {
                "use a smaller --window, finer counts or a shorter --cycle"
            }
            None if !self.counts.is_empty() => {
                "use finer counts, a shorter --cycle or --hold linear"
            }
            Some(_) if *held != Held::Effort => "use a smaller --window or a shorter --cycle",
            Some(_) => words.smaller,
            None if self.cycle.is_some() => "use a shorter --cycle, or --hold as the drive has it",
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

/// Place of set-points if there is a motor.
const BESIDE_MOTOR: &str = "at the joint, beyond the gear; --side motor writes the motor's";

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

/// Where a drive holds a quantity.
fn where_held(held: Held, side: Side) -> String {
    let what = match held {
        Held::Position => "position",
        Held::Velocity => "velocity",
        Held::Effort => "effort",
    };
    let of_motor = if side == Side::Motor { " of its motor" } else { "" };
    format!("where the drive holds the {what}{of_motor}")
}

/// Units of the columns, a line each where they are counts.
fn described(table: &SetPoints) -> Vec<String> {
    let (mut units, mut counts) = (Vec::new(), Vec::new());
    for set_point in table.set_points() {
        let mut seen: Vec<&DriveUnit> = Vec::new();
        for own in table.columns_of(set_point) {
            if seen.contains(&&own.unit) {
                continue;
            }
            seen.push(&own.unit);
            let list = if own.unit.is_count { &mut counts } else { &mut units };
            list.push(own.unit.described(set_point, own.slides));
        }
    }
    let side = if table.side() == Side::Motor { "of the motors: " } else { "" };
    // Two quantities a line fit a terminal.
    let lines = units.chunks(2).map(|pair| format!("{side}{}", pair.join(", ")));
    lines.chain(counts.iter().map(|line| format!("{side}{line}"))).collect()
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
        SetPointError::TooManyCounts { .. } => ("--counts", "use fewer counts, or no counts"),
    };
    Failure::new(Exit::Usage, &arm.worded(&format!("{option}: {error}")), Some(hint))
}

/// Parses the cycle of a controller.
fn cycle(text: &str) -> Result<f64, String> {
    let cycle_s = seconds(text)?;
    if cycle_s > 0.0 { Ok(cycle_s) } else { Err("must be a time above 0, such as '2 ms'".into()) }
}

/// Results of playing a table, a line each.
fn found(table: &SetPoints, error: &TableError) -> Vec<String> {
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
        if table.interpolation() != Interpolation::Cubic {
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
