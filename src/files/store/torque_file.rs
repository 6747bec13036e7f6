//! A torque table in a separate file: CSV, a C header, or a MATLAB script.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;

use serde::Serialize;
use serde_json::json;

use super::names::{Form, TORQUE};
use super::run_summary::tip_numbers;
use super::summary::Summary;
use crate::csv::{Column, ColumnGroup, Digits, NumberFormat, sha256, time_format, write_csv};
use crate::numeric::largest;
use crate::response::Interpolation;
use crate::result::{Notice, TorqueTable};
use crate::text::{in_shell, path_in_shell, plain, visible};
use crate::verify::TableError;

/// Form of a file with a torque table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TorqueForm {
    /// CSV, as torque.csv or force.csv, or torques.csv of an arm.
    Csv,
    /// Arrays in a C header.
    C,
    /// A script that makes a `timeseries`.
    Matlab,
}

impl TorqueForm {
    /// The form by the ending of a file's name: .csv, .h or .m.
    pub fn of(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "h" => Some(Self::C),
            "m" => Some(Self::Matlab),
            _ => None,
        }
    }

    /// True if the file's name may begin the names in a file of this form. In C and MATLAB it must be an identifier;
    /// a changed one could give two files the same names.
    pub fn takes(self, stem: &str) -> bool {
        let is_name = stem.starts_with(|c: char| c.is_ascii_alphabetic())
            && stem.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        self == Self::Csv || is_name
    }
}

/// Record of the torque table that a run writes.
#[derive(Debug, Clone, Copy)]
pub struct TableRecord<'a> {
    /// The table.
    pub table: &'a TorqueTable,
    /// Name of its file, `-` for standard output.
    pub file: &'a str,
    /// Form of its file.
    pub form: TorqueForm,
    /// The arguments that made it, as the program takes them.
    pub arguments: &'a [String],
    /// Error of the tip under the table, if the table differs from the torque.
    pub error: Option<&'a TableError>,
    /// Warning of the table.
    pub warning: Option<&'a Notice>,
}

impl Summary {
    /// The summary of a run that writes a torque table, too.
    #[must_use]
    pub fn with_table(mut self, record: &TableRecord<'_>) -> Self {
        let TableRecord { table, file, form, arguments, error, warning } = *record;
        let grid = table.grid();
        let tip_error = error.map(|error| {
            let mut values = tip_numbers(&error.tip);
            values["time_s"] = table.time_s(error.tip.time_s).into();
            values["known_to_m"] = error.change_m.into();
            values["feedback"] = json!(error.feedback);
            values
        });
        self.values["table"] = json!({
            "file": file,
            "form": form,
            "arguments": arguments,
            "rows": grid.len,
            "start_s": grid.time_s(0),
            "end_s": grid.end_s(),
            "step_s": grid.step_s,
            "moves_from_s": table.moves_from_s(),
            "window": table.window(),
            "hold": (table.interpolation() == Interpolation::Zero).then_some("zero"),
            "tip_error": tip_error,
        });
        self.warnings.extend(warning.cloned());
        self
    }
}

/// A torque table, and its description in the file.
#[derive(Debug, Clone, Copy)]
pub struct TorqueFile<'a> {
    /// The table.
    pub table: &'a TorqueTable,
    /// The run, with its record of the table.
    pub summary: &'a Summary,
    /// Changes of the torque, a line each.
    pub notes: &'a [String],
    /// Digits of the torques.
    pub digits: Digits,
}

/// Signs before, between and after the numbers of a row.
type Signs = [&'static str; 3];

const C_NUMBER: Signs = ["    ", "", ",\n"];
const C_ROW: Signs = ["    {", ", ", "},\n"];
const MATLAB_ROW: Signs = ["", " ", "\n"];

impl TorqueFile<'_> {
    /// Writes the table; `stem`, the file's name without its ending, begins the names in C and MATLAB.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn write(
        &self,
        out: &mut (dyn Write + Send),
        form: TorqueForm,
        stem: &str,
    ) -> io::Result<()> {
        match form {
            TorqueForm::Csv => self.write_csv(out),
            TorqueForm::C => out.write_all(&self.c(stem)),
            TorqueForm::Matlab => out.write_all(&self.matlab(stem)),
        }
    }

    fn write_csv(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        let columns = self.table.torques_n_m();
        let form = match columns.len() {
            1 if self.slides() => Form::Carriage,
            1 => Form::Hub,
            _ => Form::Arm,
        };
        let name = |k: usize| {
            let is_carriage = self.table.has_carriage() && k + 1 == columns.len();
            TORQUE.column(if is_carriage { Form::Carriage } else { form }, k, 0)
        };
        let columns =
            columns.iter().enumerate().map(|(k, values)| Column { name: name(k), values });
        let group = ColumnGroup { columns: columns.collect() };
        let times = self.table.grid().thinned(NonZeroUsize::MIN);
        write_csv(out, &times, &[group], self.digits)
    }

    /// The C header.
    fn c(&self, stem: &str) -> Vec<u8> {
        let line = |line: String| {
            let line = line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?");
            format!(" * {line}\n")
        };
        let comment: String = self.comment().into_iter().map(line).collect();
        let (macros, grid) = (stem.to_ascii_uppercase(), self.table.grid());
        let (length, step) = (grid.len, floating(grid.step_s));
        let (joints, columns, signs) = match self.table.torques_n_m().len() {
            1 => (String::new(), String::new(), C_NUMBER),
            joints => {
                let define = format!("#define {macros}_JOINTS {joints}\n");
                (define, format!("[{macros}_JOINTS]"), C_ROW)
            }
        };
        let head = format!(
            "#define {macros}_LENGTH {length}\n{joints}#define {macros}_STEP_S {step}\n\n\
             /* Time in s */\nstatic const double {stem}_time_s[{macros}_LENGTH] = {{\n"
        );
        let (what, unit) = (self.what(), self.unit());
        let middle = format!(
            "}};\n\n/* {what} */\n\
             static const double {stem}_{unit}[{macros}_LENGTH]{columns} = {{\n"
        );
        let (times, torques) = (self.times(C_NUMBER), self.torques(signs));
        let body = [head.as_bytes(), &times, middle.as_bytes(), &torques, b"};\n"].concat();
        // A compiler refuses the second of two tables of one name; a guard of the name alone would omit it.
        let guard = format!("{macros}_H_{}", &sha256(&body)[..16].to_ascii_uppercase());
        let begin = format!("/*\n{comment} */\n#ifndef {guard}\n#define {guard}\n\n");
        [begin.as_bytes(), &body, b"\n#endif\n"].concat()
    }

    /// The MATLAB script. Octave, which lacks `timeseries`, runs it up to that line.
    fn matlab(&self, stem: &str) -> Vec<u8> {
        let line = |line: String| format!("% {line}\n");
        let comment: String = self.comment().into_iter().map(line).collect();
        let step = plain(self.table.grid().step_s);
        let head = format!("{comment}{stem}_step_s = {step};\n{stem}_time_s = [\n");
        let (unit, text) = (self.unit(), self.table.joint().worded("N m"));
        let middle = format!("];\n{stem}_{unit} = [\n");
        let method = if self.is_held() { "zoh" } else { "linear" };
        let tail = format!(
            "];\n{stem}_series = timeseries({stem}_{unit}, {stem}_time_s, 'Name', '{stem}');\n\
             {stem}_series.TimeInfo.Units = 'seconds';\n{stem}_series.DataInfo.Units = '{text}';\n\
             {stem}_series = setinterpmethod({stem}_series, '{method}');\n"
        );
        let (times, torques) = (self.times(MATLAB_ROW), self.torques(MATLAB_ROW));
        [head.as_bytes(), &times, middle.as_bytes(), &torques, tail.as_bytes()].concat()
    }

    /// A row for each time in s.
    fn times(&self, signs: Signs) -> Vec<u8> {
        let grid = self.table.grid();
        let times_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
        rows(&[&times_s], time_format(|k| times_s[k], grid.len), signs)
    }

    /// A row for the torques in N m at each time.
    fn torques(&self, signs: Signs) -> Vec<u8> {
        let columns = self.table.torques_n_m();
        let peak = columns.iter().map(|column| largest(column)).fold(0.0, f64::max);
        rows(&columns, self.digits.for_peak(peak), signs)
    }

    fn is_held(&self) -> bool {
        self.table.interpolation() == Interpolation::Zero
    }

    fn slides(&self) -> bool {
        self.table.joint().slides()
    }

    /// Unit of the torques, or of the force, at the end of a name.
    fn unit(&self) -> &'static str {
        if self.slides() { "n" } else { "n_m" }
    }

    /// Description of the columns beside the time.
    fn what(&self) -> &'static str {
        match self.table.torques_n_m().len() {
            1 if self.slides() => "Force on the carriage in N",
            1 => "Torque at the hub in N m",
            _ if self.table.has_carriage() => {
                "Torque at each joint in N m, the inner one first, then the force on the carriage in N"
            }
            _ => "Torque at each joint in N m, the inner one first",
        }
    }

    /// Comment at the head of the file, line by line.
    fn comment(&self) -> Vec<String> {
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

/// Columns as rows of numbers.
fn rows(columns: &[&[f64]], format: NumberFormat, [before, between, after]: Signs) -> Vec<u8> {
    let mut text = Vec::new();
    for k in 0..columns[0].len() {
        text.extend(before.bytes());
        for (place, column) in columns.iter().enumerate() {
            text.extend(if place > 0 { between } else { "" }.bytes());
            format.write(&mut text, column[k]);
        }
        text.extend(after.bytes());
    }
    text
}

/// A number in the form of a C floating-point number.
fn floating(value: f64) -> String {
    let text = plain(value);
    if text.contains(['.', 'e']) { text } else { text + ".0" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_c_and_matlab_take() {
        for form in [TorqueForm::C, TorqueForm::Matlab] {
            assert!(form.takes("torque") && form.takes("lift_up2"));
            for stem in ["", "lift up", "a-b", "2nd", "_a", "µ"] {
                assert!(!form.takes(stem) && TorqueForm::Csv.takes(stem), "{stem}");
            }
        }
    }

    #[test]
    fn the_ending_says_the_form() {
        let form = |name: &str| TorqueForm::of(Path::new(name));
        assert_eq!(form("a/torque.H"), Some(TorqueForm::C));
        assert_eq!(form("torque.m"), Some(TorqueForm::Matlab));
        assert_eq!((form("torque.txt"), form("csv"), form("-")), (None, None, None));
    }
}
