//! `compare`: tables against tables, within tolerances.

mod sides;

use std::path::{Path, PathBuf};

use clap::Args;

use crate::compare::{ColumnRule, Comparison, Tolerances};
use crate::csv::InputFile;
use crate::result::Notice;
use crate::spec::read_tolerances;
use crate::store::{GoldenChanges, change_golden_files, comparison_json, is_result_file, is_run};
use crate::text::excerpt;

use crate::cli::options::common::not_negative;
use crate::cli::terminal::files::read_once;
use crate::cli::terminal::text::{blessed_text, comparison_text};
use crate::cli::terminal::{Ending, Failure, PrintArgs, WarningArgs, console};
use sides::{Purpose, Sides, TOLERANCES};

const EXAMPLE: &str = "\
Example:
  flexlink compare golden out --rtol 1e-6
  flexlink compare golden/torque.csv out/torque.csv
  flexlink compare golden out --bless

tolerances.toml; every key is optional:
  rtol = 1e-9                  # of the column's peak
  atol = 0.0                   # in the column's unit
  common_rows = true           # as --common-rows
  [[columns]]                  # the last entry that matches a column counts
  file = \"torque.csv\"          # a name, or a path with slashes; * any text, ? one character
  column = \"torque_*\"          # all of the file if left out
  rtol = 1e-6                  # and/or atol; or ignore = true

A first row that holds only numbers is data; the columns are then called `column 1` and so on.
`-` as EXPECTED or ACTUAL reads standard input. Exit code 1 if the two differ.";

const QUIET: &str = "Print nothing but warnings and errors; the exit code says if they differ";

/// Compare tables column by column, within a tolerance of the column's peak.
///
/// EXPECTED and ACTUAL are two CSV files or two folders. In folders and their subfolders, CSV files are compared by
/// name; of runs also the results and the kinds of warnings in summary.json. A number may differ by atol + rtol x the
/// largest absolute value of its column in EXPECTED; words and empty fields may not differ. Columns are matched by
/// name, rows by the first
/// column where it increases on both sides (time_s, frequency_hz), otherwise by number. Columns, rows and files that
/// only one side has are differences, too. A CSV file has the form that this program writes: a row of names, commas, decimal
/// points, and # before comments.
#[derive(Debug, Args)]
#[command(about = "Compare tables column by column", after_help = EXAMPLE)]
#[command(mut_arg("json", |json| json.help("Print everything as JSON instead of the table")))]
#[command(mut_arg("quiet", |quiet| quiet.help(QUIET)))]
pub struct Compare {
    /// Golden file or folder: what is expected.
    #[arg(value_name = "EXPECTED")]
    expected: PathBuf,

    /// File or folder to check.
    #[arg(value_name = "ACTUAL")]
    actual: PathBuf,

    /// Allowed difference, as a share of the column's peak [default: from the file of tolerances,
    /// else 1e-9].
    #[arg(long, value_name = "R", value_parser = not_negative, allow_negative_numbers = true)]
    rtol: Option<f64>,

    /// Allowed difference, in the column's unit [default: from the file of tolerances, else 0].
    #[arg(long, value_name = "A", value_parser = not_negative, allow_negative_numbers = true)]
    atol: Option<f64>,

    /// Tolerances of single columns (TOML) [default: tolerances.toml in the folder EXPECTED, or
    /// beside the file EXPECTED].
    #[arg(long, value_name = "FILE")]
    tolerances: Option<PathBuf>,

    /// Ignore rows at the ends that only one side has, so that a moved window is no difference. All rows count if
    /// they are matched by number, or if less than half of EXPECTED's are common.
    #[arg(long)]
    common_rows: bool,

    /// Accept ACTUAL: copy its CSV files over those of EXPECTED. Files within tolerance and files that
    /// are not compared stay as they are. Where EXPECTED holds the summary.json of a run, all files of the run
    /// are copied.
    #[arg(long)]
    bless: bool,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    warnings: WarningArgs,
}

/// A comparison, and its effect on EXPECTED.
pub struct Compared {
    pub comparison: Comparison,
    /// The changes of EXPECTED, if it accepts ACTUAL.
    pub changes: Option<GoldenChanges>,
    /// Warnings of tolerances without effect, and of a run that no longer matches its summary.
    pub warnings: Vec<Notice>,
}

impl Compare {
    pub(crate) fn run(self) -> Result<Ending, Failure> {
        let Compared { comparison, changes, warnings } = self.compared()?;
        let warned = warnings.len();
        console::warnings(warnings);
        let told = |changes| blessed_text(&self.expected, changes);
        let blessed = || changes.as_ref().map(told).unwrap_or_default();
        self.print.print(
            || comparison_json(&comparison, changes.as_ref()),
            || comparison_text(&comparison) + &blessed(),
        )?;
        self.warnings.refuse(warned)?;
        Ok(if self.bless || comparison.is_equal() { Ending::Done } else { Ending::Different })
    }

    /// Compares both sides, and accepts ACTUAL if the options say so.
    pub fn compared(&self) -> Result<Compared, Failure> {
        let sides = self.sides()?;
        let tolerances = self.read_tolerances(&sides)?;
        let comparison = sides.compare(&tolerances)?;
        let mut warnings = self.warnings_of(&sides, &comparison, &tolerances);
        let changes = self.bless.then(|| sides.changes(&comparison)).transpose()?;
        if let Some(changes) = &changes {
            self.accept(&sides, changes)?;
            warnings.extend(self.warning_of_run(&sides, changes));
        }
        Ok(Compared { comparison, changes, warnings })
    }

    /// Finds the files of both sides.
    fn sides(&self) -> Result<Sides, Failure> {
        let inputs = [&self.expected, &self.actual].into_iter().chain(&self.tolerances);
        read_once(&inputs.map(PathBuf::as_path).collect::<Vec<_>>())?;
        let purpose = if self.bless { Purpose::Bless } else { Purpose::Compare };
        Sides::find(&self.expected, &self.actual, purpose)
    }

    /// The file of tolerances, if there is one, with the tolerances of the command line.
    fn read_tolerances(&self, sides: &Sides) -> Result<Tolerances, Failure> {
        let beside = || sides.golden.as_ref().map(|folder| folder.join(TOLERANCES));
        let path = self.tolerances.clone().or_else(|| beside().filter(|path| path.exists()));
        let mut tolerances = match path {
            None => Tolerances::default(),
            Some(path) => {
                let file = InputFile::read_toml(&path)?;
                read_tolerances(&file.shown, file.text()?)?
            }
        };
        let general = &mut tolerances.general;
        general.rtol = self.rtol.unwrap_or(general.rtol);
        general.atol = self.atol.unwrap_or(general.atol);
        tolerances.common_rows |= self.common_rows;
        Ok(tolerances)
    }

    /// Makes EXPECTED like ACTUAL.
    fn accept(&self, sides: &Sides, changes: &GoldenChanges) -> Result<(), Failure> {
        match &sides.golden {
            Some(folder) if !sides.are_single() => {
                Ok(change_golden_files(folder, changes, &console::waiting)?)
            }
            // A file on the command line may be a link to anywhere.
            _ => changes.written.values().try_for_each(|source| {
                let bytes = InputFile::read(source)?.bytes;
                console::deliver(Some(&self.expected), &bytes)
            }),
        }
    }

    /// The warning of a replaced table of a run.
    fn warning_of_run(&self, sides: &Sides, changes: &GoldenChanges) -> Option<Notice> {
        let file = Path::new(".").join(&self.expected);
        let is_of_run =
            file.parent().is_some_and(is_run) && file.file_name().is_some_and(is_result_file);
        if !sides.are_single() || changes.written.is_empty() || !is_of_run {
            return None;
        }
        let message = format!(
            "{}: no longer matches the summary.json beside it: solve --repeat of the folder finds a difference",
            self.expected.display()
        );
        let hint = "compare the two folders with --bless, which copies the whole run";
        Some(Notice::new("run_changed", message, hint))
    }

    /// Warnings of tolerances that have no effect.
    fn warnings_of(
        &self,
        sides: &Sides,
        comparison: &Comparison,
        tolerances: &Tolerances,
    ) -> Vec<Notice> {
        let is_meant = |entry: &&ColumnRule| {
            let mut files = comparison.files.iter();
            !sides.are_single() || files.any(|file| entry.is_of(&file.name))
        };
        let idle = comparison.idle(tolerances);
        let idle = idle.into_iter().filter(is_meant).map(|entry| {
            let ColumnRule { place, column, file, .. } = entry;
            let message = match file.as_ref().map(|file| excerpt(file)) {
                Some(file) if !comparison.files.iter().any(|own| entry.is_of(&own.name)) => {
                    format!("{place}: file = {file:?}, but no file is called that")
                }
                file => {
                    let file = file.map(|file| format!(" of a file {file:?}")).unwrap_or_default();
                    let column = excerpt(column);
                    format!("{place}: column = {column:?}{file}, but no column is called that")
                }
            };
            Notice::new("idle_tolerance", message, "`*` stands for any text, `?` for one character")
        });
        let unread = sides.unread_tolerances.iter().map(|inner| {
            let message = format!("{}: is not read", self.expected.join(inner).display());
            let hint = "move its entries to tolerances.toml of EXPECTED";
            Notice::new("unread_tolerances", message, hint)
        });
        idle.chain(unread).collect()
    }
}
