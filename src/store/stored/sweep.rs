//! The table of a sweep, read back.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;

use super::super::sweep_record::read_record;
use super::super::sweep_table::{ERROR, SweepColumn, SweepRecord, WARNINGS};
use crate::compare::{Cell, Table};
use crate::csv::{CHECK, InputFile, Place, TableError, quoted, read_table};
use crate::result::StoredSweep;
use crate::sweep::{PlayedCase, SolvedCase};

/// The first column after those of the values varied.
const FIRST: &str = "period_1_s";

/// Said of files that are none of a sweep.
const THE_FOLDER: &str = "of a run of solve or simulate, give the folder";

/// The longest row of names that is looked at.
const LONGEST_HEADER: u64 = 1 << 20;

/// Reads the table of a sweep at `path`, and the record beside it.
pub(super) fn read_sweep(path: &Path, file: &InputFile) -> Result<StoredSweep, TableError> {
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
    let known = [told(&driven), told(SolvedCase::COLUMNS), told(PlayedCase::COLUMNS)];
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

/// What a sweep tells of its cases, in the order of its columns.
fn told<C>(columns: &[SweepColumn<C>]) -> Vec<&'static str> {
    columns.iter().map(|(name, _)| *name).chain([WARNINGS, ERROR]).collect()
}

/// Refuses what is neither a finite number nor nothing where numbers are told.
fn check_cells(table: &Table, varied: usize, place: Place) -> Result<(), TableError> {
    let told = varied..table.columns.len() - 2;
    for column in &table.columns[told] {
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
pub(super) fn is_sweep(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let lines = BufReader::new(file.take(LONGEST_HEADER)).lines();
    let header = lines.map_while(Result::ok).find(|line| !line.starts_with('#'));
    header.is_some_and(|header| {
        let header = header.trim_end();
        header.contains(&format!(",{FIRST},")) && header.ends_with(&format!(",{ERROR}"))
    })
}
