//! Set-points, or the torque alone, in a separate file.

use std::borrow::Cow;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use super::names::{ANGLE, Form, MOTOR, TORQUE};
use super::run_summary::tip_numbers;
use super::summary::Summary;
use crate::csv::{Digits, MotionBegins, NumberFormat, write_formatted};
use crate::numeric::largest;
use crate::response::Interpolation;
use crate::result::{DriveUnit, Held, Notice, SetPoint, SetPointColumn, SetPoints, Side};
use crate::text::{in_shell, path_in_shell, visible};
use crate::verify::TableError;

/// Form of a file with set-points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SetPointForm {
    /// CSV; the torque alone as torque.csv or force.csv, or torques.csv of an arm.
    Csv,
    /// Arrays in a C header.
    C,
    /// A script that makes a `timeseries`.
    Matlab,
    /// Arrays in a `.mat` file of level 5.
    Mat,
    /// Arrays in NumPy's `.npz`.
    Npz,
    /// A message `trajectory_msgs/JointTrajectory` of ROS 2 in YAML.
    RosYaml,
    /// The same message in JSON.
    RosJson,
    /// Lines of numbers for `LinuxCNC`'s halstreamer.
    Halstreamer,
}

impl SetPointForm {
    /// The form by the ending of a file's name: .csv, .h, .m, .mat, .npz, .yaml, .yml or .json.
    pub fn of(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "h" => Some(Self::C),
            "m" => Some(Self::Matlab),
            "mat" => Some(Self::Mat),
            "npz" => Some(Self::Npz),
            "yaml" | "yml" => Some(Self::RosYaml),
            "json" => Some(Self::RosJson),
            _ => None,
        }
    }

    /// True if the file's name may begin the names in a file of this form. In C and MATLAB it must be an identifier;
    /// a changed one could give two files the same names.
    pub fn takes(self, stem: &str) -> bool {
        let is_name = stem.starts_with(|c: char| c.is_ascii_alphabetic())
            && stem.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        !matches!(self, Self::C | Self::Matlab) || is_name
    }

    /// True for a message of ROS, whose numbers are in SI and whose times begin at 0.
    pub fn is_ros(self) -> bool {
        matches!(self, Self::RosYaml | Self::RosJson)
    }
}

/// Record of the table that a run writes.
#[derive(Debug, Clone, Copy)]
pub struct TableRecord<'a> {
    /// The table.
    pub table: &'a SetPoints,
    /// Name of its file, `-` for standard output.
    pub file: &'a str,
    /// Form of its file.
    pub form: SetPointForm,
    /// The arguments that made it, as the program takes them.
    pub arguments: &'a [String],
    /// Errors of the tip under what drives hold of the table, if it differs from the solution.
    pub errors: &'a [(Held, TableError)],
    /// Whether the record has the quantities of the table.
    pub has_set_points: bool,
    /// Warning of the table.
    pub warning: Option<&'a Notice>,
}

impl Summary {
    /// The summary of a run that writes a table of set-points, too.
    #[must_use]
    pub fn with_table(mut self, record: &TableRecord<'_>) -> Self {
        let TableRecord { table, file, form, arguments, errors, has_set_points, warning } = *record;
        let grid = table.grid();
        let of_error = |error: &TableError| {
            let mut values = tip_numbers(&error.tip);
            values["time_s"] = table.time_s(error.tip.time_s).into();
            values["known_to_m"] = error.change_m.into();
            values["feedback"] = json!(error.feedback);
            values
        };
        let hold = match table.interpolation() {
            Interpolation::Zero => Some("zero"),
            Interpolation::Linear => Some("linear"),
            Interpolation::Cubic => None,
        };
        let mut values = json!({
            "file": file,
            "form": form,
            "arguments": arguments,
            "rows": grid.len,
            "start_s": grid.time_s(0),
            "end_s": grid.end_s(),
            "step_s": grid.step_s,
            "moves_from_s": table.moves_from_s(),
            "window": table.window(),
            "hold": hold,
            "tip_error": errors.first().map(|(_, error)| of_error(error)),
        });
        if has_set_points {
            let columns = table.columns().iter().map(|own| {
                json!({
                    "name": heading(table, own),
                    "quantity": own.set_point.word(),
                    "joint": own.joint + 1,
                    "unit": own.unit.label,
                    "per_si": own.unit.per_si,
                    "zero": own.unit.zero,
                })
            });
            values["side"] = json!(if table.side() == Side::Motor { "motor" } else { "joint" });
            values["columns"] = columns.collect();
            let errors =
                errors.iter().map(|(held, error)| (held_word(*held).to_owned(), of_error(error)));
            values["tip_errors"] = Value::Object(errors.collect());
        }
        self.values["table"] = values;
        self.warnings.extend(warning.cloned());
        self
    }
}

fn held_word(held: Held) -> &'static str {
    match held {
        Held::Position => "position",
        Held::Velocity => "velocity",
        Held::Effort => "effort",
    }
}

/// A column as it is written.
pub(super) struct ShownColumn<'a> {
    pub(super) column: &'a SetPointColumn,
    /// Its name in a table.
    pub(super) heading: String,
    /// Its numbers, one a row.
    pub(super) numbers: Cow<'a, [f64]>,
    pub(super) format: NumberFormat,
}

/// Name of a column without its unit, as the files of a run have it, and with its unit in SI.
fn names(table: &SetPoints, column: &SetPointColumn) -> [String; 2] {
    let is_carriage = table.has_carriage() && column.joint + 1 == table.joints();
    let form = match table.joints() {
        _ if is_carriage => Form::Carriage,
        1 if table.joint().slides() => Form::Carriage,
        1 => Form::Hub,
        _ => Form::Arm,
    };
    let (set_point, joint) = (column.set_point, column.joint);
    let name = match (table.side(), set_point) {
        (Side::Joint, SetPoint::Effort) => TORQUE.column(form, joint, 0),
        (Side::Joint, _) => ANGLE.column(form, joint, set_point as usize),
        (Side::Motor, SetPoint::Effort) => MOTOR.column(form, joint, 0),
        (Side::Motor, SetPoint::Position) => MOTOR.column(form, joint, 1),
        (Side::Motor, SetPoint::Velocity) => MOTOR.column(form, joint, 2),
        (Side::Motor, SetPoint::Acceleration) => {
            let rate = MOTOR.column(form, joint, 2);
            rate.replace("_rate_rad_s", "_acceleration_rad_s2")
        }
    };
    let end = format!("_{}", in_name(set_point.si_unit(column.slides)));
    [name.strip_suffix(&end).unwrap_or(&name).to_owned(), name]
}

/// Heading of a column: its name with its unit in SI, or another unit in brackets.
fn heading(table: &SetPoints, column: &SetPointColumn) -> String {
    let [base, whole] = names(table, column);
    if column.unit == DriveUnit::si(column.set_point, column.slides) {
        whole
    } else {
        format!("{base} [{}]", column.unit.label)
    }
}

/// A unit as the end of a name: `N m` as `n_m`, `rad/s^2` as `rad_s2`.
pub(super) fn in_name(unit: &str) -> String {
    let word = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    unit.chars().filter(|c| *c != '^').map(word).collect()
}

/// A table of set-points, and its description in the file.
#[derive(Debug, Clone, Copy)]
pub struct SetPointFile<'a> {
    /// The table.
    pub table: &'a SetPoints,
    /// The run, with its record of the table.
    pub summary: &'a Summary,
    /// Changes of the table, a line each.
    pub notes: &'a [String],
    /// Digits of the numbers.
    pub digits: Digits,
    /// Whether the table is the torque alone, without quantities, cycle and units of its own.
    pub is_plain: bool,
    /// Names of the joints in a message.
    pub joint_names: &'a [String],
}

impl SetPointFile<'_> {
    /// Writes the table; `stem`, the file's name without its ending, begins the names in C and MATLAB.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn write(
        &self,
        out: &mut (dyn Write + Send),
        form: SetPointForm,
        stem: &str,
    ) -> io::Result<()> {
        match form {
            SetPointForm::Csv => self.write_csv(out),
            SetPointForm::C => out.write_all(&self.c(stem)),
            SetPointForm::Matlab => out.write_all(&self.matlab(stem)),
            SetPointForm::Mat => self.write_mat(out),
            SetPointForm::Npz => self.write_npz(out),
            SetPointForm::RosYaml => out.write_all(&self.ros_yaml()),
            SetPointForm::RosJson => out.write_all(&self.ros_json()),
            SetPointForm::Halstreamer => out.write_all(&self.halstreamer()),
        }
    }

    fn write_csv(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        // The times of a plain torque are those of the motion.
        if !self.is_plain || self.table.is_shifted() {
            writeln!(out, "# {}", self.begins())?;
        }
        if !self.is_plain {
            self.comment().iter().try_for_each(|line| writeln!(out, "# {line}"))?;
        }
        let shown = self.shown();
        let columns = shown.iter().map(|own| (own.heading.as_str(), &own.numbers[..], own.format));
        let times = self.table.grid().thinned(NonZeroUsize::MIN);
        write_formatted(out, &times, &columns.collect::<Vec<_>>())
    }

    /// The columns as they are written. Those of one quantity share the decimals of their peak, counts have none.
    pub(super) fn shown(&self) -> Vec<ShownColumn<'_>> {
        let table = self.table;
        let mut all = Vec::new();
        for set_point in table.set_points() {
            let columns: Vec<_> =
                table.columns_of(set_point).map(|own| (own, table.numbers_of(own))).collect();
            let peaks = columns.iter().filter(|(own, _)| !own.unit.is_count);
            let peak = peaks.map(|(_, numbers)| largest(numbers)).fold(0.0, f64::max);
            all.extend(columns.into_iter().map(|(column, numbers)| ShownColumn {
                heading: heading(table, column),
                format: if column.unit.is_count {
                    NumberFormat::Fixed(0)
                } else {
                    self.digits.for_peak(peak)
                },
                column,
                numbers,
            }));
        }
        all
    }

    /// The line that says when the motion begins.
    pub(super) fn begins(&self) -> MotionBegins {
        let (table, held) = (self.table, Interpolation::Zero);
        let times_s = [table.moves_from_s(), table.moves_from_in_file_s()];
        MotionBegins::new(times_s[0], times_s[1], table.interpolation() == held)
    }

    /// Description of the columns beside the time.
    pub(super) fn what(&self) -> String {
        let table = self.table;
        let is_effort = table.set_points() == [SetPoint::Effort] && table.side() == Side::Joint;
        if !is_effort || !self.is_plain {
            let words = table.set_points().into_iter().map(SetPoint::word);
            let words = words.collect::<Vec<_>>().join(", ");
            let of = match (table.side(), table.joints()) {
                (Side::Motor, 1) => "of the motor",
                (Side::Motor, _) => "of the motor of each joint, the inner one first",
                (Side::Joint, 1) if table.joint().slides() => "of the carriage",
                (Side::Joint, 1) => "of the hub",
                (Side::Joint, _) if table.has_carriage() => {
                    "of each joint, the inner one first, then of the carriage"
                }
                (Side::Joint, _) => "of each joint, the inner one first",
            };
            let first = words[..1].to_ascii_uppercase();
            return format!("{first}{} {of}", &words[1..]);
        }
        let what = match table.joints() {
            1 if table.joint().slides() => "Force on the carriage in N",
            1 => "Torque at the hub in N m",
            _ if table.has_carriage() => {
                "Torque at each joint in N m, the inner one first, then the force on the carriage in N"
            }
            _ => "Torque at each joint in N m, the inner one first",
        };
        what.to_owned()
    }

    /// Comment at the head of the file, line by line.
    pub(super) fn comment(&self) -> Vec<String> {
        let origin = self.summary.origin();
        let mut lines = vec![origin.title];
        lines.push(format!("{}, computed by flexlink {}:", self.what(), origin.version));
        let names = origin.inputs.iter().map(|input| path_in_shell(&input.name));
        let options = origin.arguments.into_iter().chain(self.summary.table_arguments());
        let words = ["flexlink", "solve"].map(str::to_owned).into_iter().chain(names);
        let words = words.chain(options.map(|word| in_shell(&word)));
        lines.push(words.collect::<Vec<_>>().join(" "));
        let sums = origin.inputs.iter().map(|own| format!("{}: SHA-256 {}", own.name, own.sha256));
        lines.extend(sums);
        lines.extend(self.notes.iter().cloned());
        lines.retain(|line| !line.is_empty());
        lines.iter().map(|line| visible(line).into_owned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_c_and_matlab_take() {
        for form in [SetPointForm::C, SetPointForm::Matlab] {
            assert!(form.takes("torque") && form.takes("lift_up2"));
            for stem in ["", "lift up", "a-b", "2nd", "_a", "µ"] {
                assert!(!form.takes(stem) && SetPointForm::Csv.takes(stem), "{stem}");
            }
        }
    }

    #[test]
    fn the_ending_says_the_form() {
        let form = |name: &str| SetPointForm::of(Path::new(name));
        assert_eq!(form("a/torque.H"), Some(SetPointForm::C));
        assert_eq!(form("torque.m"), Some(SetPointForm::Matlab));
        assert_eq!((form("torque.txt"), form("csv"), form("-")), (None, None, None));
        assert_eq!(form("arm.YAML"), Some(SetPointForm::RosYaml));
    }
}
