//! Results read back, whatever they are: the folder of a run, or the table of a sweep.

use std::fs::{self, File};
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};

use super::super::file_names::SUMMARY;
use super::super::summary::A_RUN;
use super::super::sweep::{ERROR, SweepColumn, SweepRecord, WARNINGS, read_record};
use super::folder::{RunFolder, unreadable};
use super::run::read_run;
use crate::compare::{Cell, Table};
use crate::csv::{CHECK, InputError, InputFile, Place, TableError, quoted, read_table};
use crate::result::{StoredResult, StoredSweep};
use crate::sweep::{PlayedCase, SolvedCase};

/// The first column after those of the values varied.
const FIRST: &str = "period_1_s";

/// Hint for a file that is no table of a sweep.
const THE_FOLDER: &str = "of a run of solve or simulate, give the folder";

/// Bytes of the longest row of names that is read.
const LONGEST_HEADER: u64 = 1 << 20;

/// Reads a result back: the folder of a run of `solve` or `simulate`, the table of a sweep, or a
/// folder with one such table.
///
/// # Errors
/// [`TableError`] names the file and what is missing in it, damaged, or of another run.
pub fn read_result(path: &Path) -> Result<StoredResult, TableError> {
    let table = if path.is_dir() {
        if path.join(SUMMARY).exists() {
            let run = read_run(RunFolder::new(path))?;
            return Ok(StoredResult::Run(Box::new(run)));
        }
        only_sweep(path)?
    } else {
        path.to_owned()
    };
    let file = InputFile::read(&table).map_err(|error| unreadable(&error))?;
    Ok(StoredResult::Sweep(Box::new(read_sweep(&table, &file)?)))
}

/// The one table of a sweep in a folder.
fn only_sweep(folder: &Path) -> Result<PathBuf, TableError> {
    let shown = folder.display().to_string();
    let entries = fs::read_dir(folder);
    let entries = entries.map_err(|cause| unreadable(&InputError::new(shown.clone(), cause)))?;
    let is_table = |path: &PathBuf| {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
            && is_sweep(path)
    };
    let mut sweeps: Vec<PathBuf> =
        entries.filter_map(Result::ok).map(|entry| entry.path()).filter(is_table).collect();
    sweeps.sort();
    let place = Place { file: &shown, line: None };
    match sweeps.len() {
        0 => {
            let hint = "the table of a sweep will do, too";
            let error = place.refuse(SUMMARY, "nothing", format!("must be there: {A_RUN}"));
            Err(error.with_hint(hint.to_owned()))
        }
        1 => Ok(sweeps.swap_remove(0)),
        _ => {
            let name =
                |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
            let names: Vec<String> = sweeps.iter().filter_map(name).collect();
            let error = place.refuse("tables of sweeps", names.join(", "), "must be one");
            Err(error.with_hint("give the file of one of them".to_owned()))
        }
    }
}

/// Reads the table of a sweep at `path`, and the record beside it.
fn read_sweep(path: &Path, file: &InputFile) -> Result<StoredSweep, TableError> {
    let table = read_table(&file.shown, &file.bytes);
    let is_table = file.name.to_lowercase().ends_with(".csv") || file.name == "-";
    let mut table = table
        .map_err(|error| if is_table { error } else { error.or_hint(THE_FOLDER.to_owned()) })?;
    // That of a shard.
    table.columns.pop_if(|column| column.name() == CHECK);
    let place = Place { file: &file.shown, line: None };
    let names: Vec<&str> = table.names().collect();
    let varied = check_columns(&names, place)?;
    if table.lines.is_empty() {
        return Err(place.refuse("rows", "none", "must be one or more cases"));
    }
    check_cells(&table, varied, place)?;
    let origin = read_record(path, file)?.map(|record| record.origin());
    Ok(StoredSweep { name: file.name.clone(), origin, varied, table })
}

/// Number of the columns of values varied.
fn check_columns(names: &[&str], place: Place) -> Result<usize, TableError> {
    let varied = names.iter().position(|name| *name == FIRST).unwrap_or(0);
    if varied == 0 {
        let must = format!("must be those of a sweep: values varied, {FIRST}, …, {ERROR}");
        let error = place.refuse("columns", quoted(&names.join(",")), must);
        return Err(error.with_hint(THE_FOLDER.to_owned()));
    }
    let driven = [SolvedCase::COLUMNS, SolvedCase::MOTOR_COLUMNS].concat();
    let known = [names_of(&driven), names_of(SolvedCase::COLUMNS), names_of(PlayedCase::COLUMNS)];
    let found = &names[varied..];
    if known.iter().any(|known| known == found) {
        return Ok(varied);
    }
    // Of the kinds of sweep the one that shares more names is meant.
    let shared = |known: &&Vec<&str>| known.iter().filter(|name| found.contains(name)).count();
    let known = known.iter().max_by_key(shared).map_or(&[][..], |known| known);
    let must = format!("must be {}", quoted_all(known));
    if !found.contains(&WARNINGS) {
        let error = place.refuse(format!("column {WARNINGS}"), "nothing", "must be there");
        let hint = "an older flexlink wrote it: run the sweep again";
        return Err(error.with_hint(hint.to_owned()));
    }
    match found.iter().position(|name| !known.contains(name)) {
        Some(stray) => {
            let subject = format!("column {}", varied + stray + 1);
            Err(place.refuse(subject, quoted(found[stray]), must))
        }
        None => Err(place.refuse(format!("columns from {FIRST} on"), quoted_all(found), must)),
    }
}

fn quoted_all(names: &[&str]) -> String {
    format!("\"{}\"", names.join(","))
}

/// Names of the columns behind the values varied.
fn names_of<C>(columns: &[SweepColumn<C>]) -> Vec<&'static str> {
    columns.iter().map(|(name, _)| *name).chain([WARNINGS, ERROR]).collect()
}

/// Refuses a field behind the values varied that is neither empty nor a finite number.
fn check_cells(table: &Table, varied: usize, place: Place) -> Result<(), TableError> {
    for column in &table.columns[varied..table.columns.len() - 2] {
        for (row, line) in table.lines.iter().enumerate() {
            let found = match column.cell(row) {
                Cell::Word("") => continue,
                Cell::Number(number) if number.is_finite() => continue,
                Cell::Number(number) => number.to_string(),
                Cell::Word(word) => quoted(word),
            };
            let place = Place { line: Some(*line), ..place };
            return Err(place.refuse(column.name(), found, "must be a finite number or nothing"));
        }
    }
    Ok(())
}

/// Whether a file begins with the row of names of a sweep.
fn is_sweep(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let lines = BufReader::new(file.take(LONGEST_HEADER)).lines();
    let header = lines.map_while(Result::ok).find(|line| !line.starts_with('#'));
    header.is_some_and(|header| {
        let header = header.trim_end();
        header.contains(&format!(",{FIRST},")) && header.ends_with(&format!(",{ERROR}"))
    })
}
