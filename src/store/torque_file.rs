//! A torque table in a file of its own: CSV, a C header, or a MATLAB script.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;

use super::arm_run::torque;
use super::run_tables::TORQUE;
use super::summary::Summary;
use crate::csv::{Column, ColumnGroup, Digits, NumberFormat, time_format, write_csv};
use crate::numeric::{TimeGrid, largest};
use crate::response::Interpolation;
use crate::result::TorqueTable;
use crate::text::{plain, visible};

/// Form of a file with a torque table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TorqueForm {
    /// As torque.csv, or torques.csv of an arm.
    Csv,
    /// Arrays in a C header.
    C,
    /// A script that makes a `timeseries`.
    Matlab,
}

impl TorqueForm {
    /// The form that the ending of a file's name asks for: .csv, .h or .m.
    pub fn of(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "h" => Some(Self::C),
            "m" => Some(Self::Matlab),
            _ => None,
        }
    }
}

/// A torque table, and what its file says of it.
#[derive(Debug, Clone, Copy)]
pub struct TorqueFile<'a> {
    /// The table.
    pub table: &'a TorqueTable,
    /// The run.
    pub summary: &'a Summary,
    /// What was done to the torque, a line each.
    pub notes: &'a [String],
    /// Digits of the torques.
    pub digits: Digits,
}

impl TorqueFile<'_> {
    /// Writes the table; `stem`, the file's name without its ending, begins the names in C and MATLAB.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(
        &self,
        out: &mut (dyn Write + Send),
        form: TorqueForm,
        stem: &str,
    ) -> io::Result<()> {
        match form {
            TorqueForm::Csv => self.write_csv(out),
            TorqueForm::C => out.write_all(&self.c(&identifier(stem))),
            TorqueForm::Matlab => out.write_all(&self.matlab(&identifier(stem))),
        }
    }

    fn write_csv(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        let columns = self.table.torques_n_m();
        let name =
            |k: usize| if columns.len() == 1 { TORQUE.1[0].to_owned() } else { torque(k + 1) };
        let columns =
            columns.iter().enumerate().map(|(k, values)| Column { name: name(k), values });
        let group = ColumnGroup { columns: columns.collect() };
        let times = self.table.grid().thinned(NonZeroUsize::MIN);
        write_csv(out, &times, &[group], self.digits)
    }

    /// The C header.
    fn c(&self, stem: &str) -> Vec<u8> {
        let (grid, columns, formats) = self.parts();
        let macros = stem.to_ascii_uppercase();
        let mut text = String::from("/*\n");
        for line in self.comment() {
            text += &[
                " * ",
                &line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?"),
                "\n",
            ]
            .concat();
        }
        let head = format!(
            " */\n#ifndef {macros}_H\n#define {macros}_H\n\n#define {macros}_LENGTH {}\n\
             #define {macros}_STEP_S {}\n",
            grid.len,
            floating(grid.step_s)
        );
        let mut text = (text + &head).into_bytes();
        let mut array =
            |what: &str, name: &str, format: NumberFormat, value: &dyn Fn(usize) -> f64| {
                let head =
                    format!("\n/* {what} */\nstatic const double {name}[{macros}_LENGTH] = {{\n");
                text.extend(head.bytes());
                for k in 0..grid.len {
                    text.extend(b"    ");
                    format.write(&mut text, value(k));
                    text.extend(b",\n");
                }
                text.extend(b"};\n");
            };
        array("Time in s", &format!("{stem}_time_s"), formats[0], &|k| grid.time_s(k));
        for (number, column) in (1..).zip(&columns) {
            let number = if columns.len() == 1 { String::new() } else { number.to_string() };
            array("Torque in N m", &format!("{stem}{number}_n_m"), formats[1], &|k| column[k]);
        }
        text.extend(b"\n#endif\n");
        text
    }

    /// The MATLAB script. Octave, which has no `timeseries`, runs it up to there.
    fn matlab(&self, stem: &str) -> Vec<u8> {
        let (grid, columns, formats) = self.parts();
        let comment = self.comment().into_iter().map(|line| format!("% {line}\n"));
        let step = plain(grid.step_s);
        let head = format!("{stem}_step_s = {step};\n{stem}_time_s = [\n");
        let mut text = (comment.collect::<String>() + &head).into_bytes();
        for k in 0..grid.len {
            formats[0].write(&mut text, grid.time_s(k));
            text.push(b'\n');
        }
        text.extend(format!("];\n{stem}_n_m = [\n").bytes());
        for k in 0..grid.len {
            for (place, column) in columns.iter().enumerate() {
                text.extend((place > 0).then_some(b' '));
                formats[1].write(&mut text, column[k]);
            }
            text.push(b'\n');
        }
        let method = if self.is_held() { "zoh" } else { "linear" };
        let tail = format!(
            "];\n{stem}_series = timeseries({stem}_n_m, {stem}_time_s, 'Name', '{stem}');\n\
             {stem}_series.TimeInfo.Units = 'seconds';\n{stem}_series.DataInfo.Units = 'N m';\n\
             {stem}_series = setinterpmethod({stem}_series, '{method}');\n"
        );
        text.extend(tail.bytes());
        text
    }

    /// Times, torques, and the formats of both.
    fn parts(&self) -> (TimeGrid, Vec<&[f64]>, [NumberFormat; 2]) {
        let (grid, columns) = (self.table.grid(), self.table.torques_n_m());
        let peak = columns.iter().map(|column| largest(column)).fold(0.0, f64::max);
        let times = time_format(|k| grid.time_s(k), grid.len);
        (grid, columns, [times, self.digits.for_peak(peak)])
    }

    fn is_held(&self) -> bool {
        self.table.interpolation() == Interpolation::Zero
    }

    /// What the file says of itself, line by line.
    fn comment(&self) -> Vec<String> {
        let origin = self.summary.origin();
        let mut lines = vec![origin.title];
        lines
            .push(format!("Torque at each joint in N m, computed by flexlink {}:", origin.version));
        let names = origin.inputs.iter().map(|input| input.name.as_str());
        let words = ["flexlink", "solve"].into_iter().chain(names);
        let words = words.chain(origin.arguments.iter().map(String::as_str));
        lines.push(words.collect::<Vec<_>>().join(" "));
        let sums = origin.inputs.iter().map(|own| format!("{}: SHA-256 {}", own.name, own.sha256));
        lines.extend(sums);
        lines.extend(self.notes.iter().cloned());
        lines.retain(|line| !line.is_empty());
        lines.iter().map(|line| visible(line).into_owned()).collect()
    }
}

/// A number as C reads one that is not whole.
fn floating(value: f64) -> String {
    let text = plain(value);
    if text.contains(['.', 'e']) { text } else { text + ".0" }
}

/// A name that C and MATLAB take.
fn identifier(stem: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = stem.chars().map(letter).collect();
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name
    } else {
        format!("torque_{name}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_c_and_matlab_take() {
        for (stem, name) in [
            ("torque", "torque"),
            ("lift up-2", "lift_up_2"),
            ("2nd", "torque_2nd"),
            ("µ", "torque__"),
        ] {
            assert_eq!(identifier(stem), name);
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
