//! Options of the table for a controller.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, ValueEnum};

use crate::link::Arm;
use crate::motion::Ends;
use crate::result::{SetPoint, UnitChoice};
use crate::store::{SUMMARY, SetPointForm, is_result_file};
use crate::text::{plain, significant};

use crate::cli::options::common::{option, seconds};
use crate::cli::terminal::console::is_standard_output;
use crate::cli::terminal::files::keep_inputs;
use crate::cli::terminal::{Exit, Failure};

/// Largest error of the time of a row, as a share of a step.
const TIME: f64 = 1e-3;

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
    pub(super) start_at: Option<f64>,

    /// Cut the rows at both ends of FILE where every torque stays below this share of its peak, `2%` or 0.02. The
    /// table is then played, and the tip's error printed.
    #[arg(long, value_name = "SHARE", requires = "write", value_parser = share)]
    pub(super) window: Option<f64>,

    /// Output between the rows of FILE: a converter holds each value until the next row (zero), or a drive draws straight
    /// lines (linear). The values are corrected for it, so that the tip moves as wanted; its remaining error is printed.
    #[arg(long, value_name = "KIND", requires = "write", value_enum)]
    pub(super) hold: Option<Hold>,

    /// Columns of FILE for every joint; effort is the torque or force. The tip's error is played for a drive that holds the
    /// position, else the velocity, and for one that holds the effort.
    #[arg(long, value_name = "LIST", requires = "write", value_delimiter = ',', value_enum)]
    #[arg(help_heading = CONTROLLER)]
    pub(super) with: Vec<Quantity>,

    /// Side of the columns: the joint, or its motor before gear and elastic transmission, as in motor.csv
    /// [default: joint].
    #[arg(long, value_name = "SIDE", requires = "write", value_enum, help_heading = CONTROLLER)]
    pub(super) side: Option<SideName>,

    /// Cycle of the controller, `2 ms`: the time between two rows [default: the step of MOTION].
    #[arg(long, value_name = "TIME", requires = "write", value_parser = cycle, help_heading = CONTROLLER)]
    pub(super) cycle: Option<f64>,

    /// Units of the columns: position=deg,effort='N cm'; of one joint position2=deg [default: SI].
    #[arg(long, value_name = "QUANTITY=UNIT", requires = "write", value_delimiter = ',')]
    #[arg(value_parser = UnitChoice::of_unit, help_heading = CONTROLLER)]
    pub(super) units: Vec<UnitChoice>,

    /// Columns in whole counts of the drive: counts over a range, in --units unless it has a unit, and the count at 0:
    /// position=4096/'360 deg'+2048, effort=1000/2.5. A negative number turns the sign. The rounding is played.
    #[arg(long, value_name = "QUANTITY=COUNTS/RANGE", requires = "write", value_delimiter = ',')]
    #[arg(value_parser = UnitChoice::of_counts, help_heading = CONTROLLER)]
    pub(super) counts: Vec<UnitChoice>,

    /// Form of FILE where its ending does not say it: lines for LinuxCNC's halstreamer, .txt.
    #[arg(long, value_name = "FORM", requires = "write", value_enum, help_heading = CONTROLLER)]
    pub(super) form: Option<FormName>,

    /// Names of the joints in .yaml, .json, .mat and .npz [default: joint1, joint2, …, carriage].
    #[arg(long, value_name = "LIST", requires = "write", value_delimiter = ',')]
    #[arg(help_heading = CONTROLLER)]
    pub(super) joint_names: Vec<String>,
}

/// Output of a converter or a drive between two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Hold {
    Zero,
    Linear,
}

/// A quantity of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Quantity {
    Position,
    Velocity,
    Acceleration,
    Effort,
}

/// A side of a joint's gear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum SideName {
    Joint,
    Motor,
}

/// A form without an ending of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum FormName {
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
    pub(super) fn arguments(&self) -> Vec<String> {
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
    pub(super) fn name(&self) -> String {
        let name = self.write.as_deref().and_then(Path::file_name).unwrap_or("-".as_ref());
        name.to_string_lossy().into_owned()
    }

    pub(super) fn file_form(&self) -> SetPointForm {
        match (self.form, self.write.as_deref().and_then(SetPointForm::of)) {
            (Some(FormName::Halstreamer), _) => SetPointForm::Halstreamer,
            (None, form) => form.unwrap_or(SetPointForm::Csv),
        }
    }

    /// The quantities of the columns: the effort unless the user names others.
    pub(super) fn set_points(&self) -> Vec<SetPoint> {
        if self.with.is_empty() {
            return vec![SetPoint::Effort];
        }
        self.with.iter().map(|own| SetPoint::from(*own)).collect()
    }

    /// True for the torque alone, without quantities, cycle and units of its own.
    pub(super) fn is_plain(&self) -> bool {
        let has_units = !self.units.is_empty() || !self.counts.is_empty();
        self.with.is_empty() && self.side.is_none() && self.cycle.is_none() && !has_units
    }

    /// The joints' names in messages and files of arrays.
    pub(super) fn names_of_joints(&self, arm: &Arm) -> Result<Vec<String>, Failure> {
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
}

/// Parses the cycle of a controller.
fn cycle(text: &str) -> Result<f64, String> {
    let cycle_s = seconds(text)?;
    if cycle_s > 0.0 { Ok(cycle_s) } else { Err("must be a time above 0, such as '2 ms'".into()) }
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
