//! What `compare` holds against each other: two files, or the files of two folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use flexlink::compare::{
    Comparison, FileComparison, FileOutcome, Rule, Table, Tolerances, compare_tables,
};
use flexlink::csv::{InputError, InputFile, read_table};
use flexlink::store::{CsvFolder, GoldenChanges, REPORT, SUMMARY, is_run};

use crate::terminal::files::is_standard_input;
use crate::terminal::{Exit, Failure, memory};

/// Name of the file of tolerances beside the golden files.
pub(crate) const TOLERANCES: &str = "tolerances.toml";

/// Memory that reading and comparing two tables takes besides their files, over the size of these, as
/// measured.
const TABLE_TIMES: usize = 3;

/// What becomes of EXPECTED.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// It stays as it is.
    Compare,
    /// It becomes like ACTUAL, and need not be there yet.
    Bless,
}

/// The files of both sides.
#[derive(Debug, Default)]
pub(crate) struct Sides {
    /// The folder of the golden files; `None`: EXPECTED is standard input.
    pub(crate) golden: Option<PathBuf>,
    /// The folder ACTUAL; `None`: it is a file.
    actual: Option<PathBuf>,
    pairs: Vec<Pair>,
    /// Whether they are single files, of which the file of tolerances may have others, too.
    pub(crate) are_single: bool,
    /// Number of files that are no tables.
    not_compared: usize,
    /// Files of tolerances in folders of the folder EXPECTED, by their paths from there.
    pub(crate) unread_tolerances: Vec<String>,
}

/// A file that one side has, or both.
#[derive(Debug)]
struct Pair {
    /// Its path from the folders that are compared, with slashes.
    name: String,
    expected: Option<PathBuf>,
    actual: Option<PathBuf>,
}

impl Sides {
    /// Finds the files of both sides.
    pub(crate) fn find(expected: &Path, actual: &Path, purpose: Purpose) -> Result<Self, Failure> {
        let [expected_piped, actual_piped] = [expected, actual].map(is_standard_input);
        if purpose == Purpose::Bless && (expected_piped || actual_piped) {
            return Err(usage("--bless = standard input, but must be a file or a folder"));
        }
        if purpose == Purpose::Bless && lie_in_each_other(expected, actual) {
            let must = "but must not be blessed where one lies in the other";
            let paths = format!("{}, {}", expected.display(), actual.display());
            return Err(usage(&format!("{paths}: EXPECTED and ACTUAL = folders, {must}")));
        }
        if let Some(failure) = absence(actual) {
            return Err(failure);
        }
        let new = match (absence(expected), purpose) {
            (None, _) => false,
            (Some(_), Purpose::Bless) => true,
            (Some(failure), Purpose::Compare) => {
                let hint = "flexlink compare --bless makes it from ACTUAL".to_owned();
                return Err(Failure { hint: Some(hint), ..failure });
            }
        };
        // What is new becomes what ACTUAL is.
        let actual_is_folder = actual.is_dir();
        let expected_is_folder = if new { actual_is_folder } else { expected.is_dir() };
        match (expected_is_folder, actual_is_folder) {
            (true, true) => Self::of_folders(expected, actual, purpose),
            (false, false) => Self::of_files(expected, actual, purpose),
            (folder, _) => {
                let kinds = if folder { "a folder and a file" } else { "a file and a folder" };
                let paths = format!("{}, {}", expected.display(), actual.display());
                let must = "but must be two files or two folders";
                Err(usage(&format!("{paths}: EXPECTED and ACTUAL = {kinds}, {must}")))
            }
        }
    }

    fn of_files(expected: &Path, actual: &Path, purpose: Purpose) -> Result<Self, Failure> {
        // A pipe can be read once only, but is read again where it takes the place of EXPECTED.
        let is_pipe = |path: &Path| path.exists() && !path.is_file();
        if purpose == Purpose::Bless && (is_pipe(actual) || is_pipe(expected)) {
            return Err(usage("--bless = a pipe, but must be a file or a folder"));
        }
        let expected_piped = is_standard_input(expected);
        let named = if expected_piped { actual } else { expected };
        let name = named.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
        let there = absence(expected).is_none();
        let pair = Pair {
            name,
            expected: there.then(|| expected.to_owned()),
            actual: Some(actual.to_owned()),
        };
        let golden = expected.parent().filter(|_| !expected_piped).map(Path::to_owned);
        Ok(Self { golden, pairs: vec![pair], are_single: true, ..Self::default() })
    }

    fn of_folders(expected: &Path, actual: &Path, purpose: Purpose) -> Result<Self, Failure> {
        let golden =
            if expected.is_dir() { CsvFolder::list(expected)? } else { CsvFolder::default() };
        let found = CsvFolder::list(actual)?;
        let refuse = |path: &Path| {
            let message = format!("{}: CSV files = none, but must be one or more", path.display());
            Err(Failure::new(Exit::InputRefused, &message, None))
        };
        match purpose {
            Purpose::Compare if golden.tables.is_empty() => return refuse(expected),
            Purpose::Bless if found.tables.is_empty() => return refuse(actual),
            _ => {}
        }
        let names: BTreeSet<&String> = golden.tables.keys().chain(found.tables.keys()).collect();
        let pairs = names.into_iter().map(|name| Pair {
            name: name.clone(),
            expected: golden.tables.get(name).cloned(),
            actual: found.tables.get(name).cloned(),
        });
        let mut others: BTreeSet<&String> = golden.others.union(&found.others).collect();
        others.retain(|name| *name != TOLERANCES);
        let inner = format!("/{TOLERANCES}");
        let unread = golden.others.iter().filter(|name| name.ends_with(&inner));
        Ok(Self {
            golden: Some(expected.to_owned()),
            actual: Some(actual.to_owned()),
            pairs: pairs.collect(),
            are_single: false,
            not_compared: others.len(),
            unread_tolerances: unread.cloned().collect(),
        })
    }

    /// Reads and compares them, one pair at a time.
    pub(crate) fn compare(&self, tolerances: &Tolerances) -> Result<Comparison, Failure> {
        let compared = self.pairs.iter().map(|pair| {
            let outcome = pair.compare(tolerances)?;
            Ok(FileComparison { name: pair.name.clone(), outcome })
        });
        let files = compared.collect::<Result<_, Failure>>()?;
        Ok(Comparison { files, not_compared: self.not_compared })
    }

    /// What makes EXPECTED like ACTUAL.
    pub(crate) fn changes(&self, comparison: &Comparison) -> Result<GoldenChanges, Failure> {
        let mut changes = GoldenChanges::default();
        let pairs = self.pairs.iter().zip(&comparison.files);
        for (pair, _) in pairs.filter(|(_, file)| !file.is_equal()) {
            match &pair.actual {
                Some(source) => drop(changes.written.insert(pair.name.clone(), source.clone())),
                None => changes.removed.push(pair.name.clone()),
            }
        }
        if let (Some(expected), Some(actual)) = (&self.golden, &self.actual) {
            take_whole_runs(&mut changes, expected, actual)?;
        }
        Ok(changes)
    }
}

impl Pair {
    fn compare(&self, tolerances: &Tolerances) -> Result<FileOutcome, Failure> {
        let only: fn(Vec<String>) -> FileOutcome = match &self.expected {
            Some(_) => FileOutcome::OnlyExpected,
            None => FileOutcome::OnlyActual,
        };
        let table = match (&self.expected, &self.actual) {
            (Some(expected), Some(actual)) => {
                let (expected, actual) = read_both(expected, actual)?;
                // Of equal bytes one table was read.
                let actual = actual.as_ref().unwrap_or(&expected);
                let compared = compare_tables(&self.name, &expected, actual, tolerances);
                return Ok(FileOutcome::Compared(compared));
            }
            (Some(path), None) | (None, Some(path)) => read(path)?,
            (None, None) => return Ok(only(Vec::new())),
        };
        let names = || only(table.names().map(str::to_owned).collect());
        Ok(self.ignored(&table, tolerances).unwrap_or_else(names))
    }

    /// A file of one side is no difference where all its columns are ignored.
    fn ignored(&self, table: &Table, tolerances: &Tolerances) -> Option<FileOutcome> {
        let is_ignored = |column: &str| tolerances.rule(&self.name, column) == Rule::Ignore;
        let none_counts = table.names().next().is_some() && table.names().all(is_ignored);
        let alike = || compare_tables(&self.name, table, table, tolerances);
        none_counts.then(|| FileOutcome::Compared(alike()))
    }
}

fn read(path: &Path) -> Result<Table, Failure> {
    let file = InputFile::read(path)?;
    memory::check_tables(file.bytes.len(), TABLE_TIMES)?;
    Ok(read_table(&file.shown, &file.bytes)?)
}

/// Reads both tables at once, or one where their bytes are the same.
fn read_both(expected: &Path, actual: &Path) -> Result<(Table, Option<Table>), Failure> {
    let (expected, actual) = (InputFile::read(expected)?, InputFile::read(actual)?);
    memory::check_tables(expected.bytes.len() + actual.bytes.len(), TABLE_TIMES)?;
    let parse = |file: InputFile| read_table(&file.shown, &file.bytes);
    if expected.bytes == actual.bytes {
        return Ok((parse(expected)?, None));
    }
    let (expected, actual) = rayon::join(|| parse(expected), || parse(actual));
    Ok((expected?, Some(actual?)))
}

/// Why a file or folder cannot be read that is not there.
fn absence(path: &Path) -> Option<Failure> {
    let absent = !is_standard_input(path) && !path.exists();
    absent.then(|| InputFile::read(path).err()).flatten().map(Failure::from)
}

/// Whether one of two folders holds the other, or both are one.
fn lie_in_each_other(a: &Path, b: &Path) -> bool {
    let pair = a.canonicalize().ok().zip(b.canonicalize().ok());
    let folders = pair.filter(|(a, b)| a.is_dir() && b.is_dir());
    folders.is_some_and(|(a, b)| a.starts_with(&b) || b.starts_with(&a))
}

fn usage(message: &str) -> Failure {
    Failure::new(Exit::Usage, &message, None)
}

/// Adds to `changes` what keeps each changed folder of EXPECTED that holds a run the folder of one:
/// its tables within tolerance, and summary.json and page, of ACTUAL, or none where it has none.
pub(crate) fn take_whole_runs(
    changes: &mut GoldenChanges,
    expected: &Path,
    actual: &Path,
) -> Result<(), InputError> {
    let names = changes.written.keys().chain(&changes.removed);
    let folders: BTreeSet<String> = names.map(|name| folder_of(name).to_owned()).collect();
    let found = CsvFolder::list(actual)?;
    for folder in folders.iter().filter(|folder| is_run(&expected.join(folder))) {
        let tables = found.tables.iter().filter(|(name, _)| folder_of(name) == *folder);
        for (name, source) in tables.filter(|(name, path)| !is_same(&expected.join(name), path)) {
            changes.written.insert(name.clone(), source.clone());
        }
        for own in [SUMMARY, REPORT] {
            let name = format!("{folder}{own}");
            let source = actual.join(&name);
            match (expected.join(&name).exists(), source.is_file()) {
                (false, _) => {}
                (true, true) => drop(changes.written.insert(name, source)),
                (true, false) => changes.removed.push(name),
            }
        }
    }
    Ok(())
}

/// The folders of a name with slashes, the last slash included.
fn folder_of(name: &str) -> &str {
    &name[..name.rfind('/').map_or(0, |slash| slash + 1)]
}

fn is_same(a: &Path, b: &Path) -> bool {
    matches!((InputFile::read(a), InputFile::read(b)), (Ok(a), Ok(b)) if a.bytes == b.bytes)
}
