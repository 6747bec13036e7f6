//! The two sides of `compare`: two files, or the files of two folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::compare::{
    Comparison, FileComparison, FileOutcome, Rule, Table, Tolerances, compare_tables,
};
use crate::csv::{InputError, InputFile, read_table};
use crate::store::{
    CsvFolder, GoldenChanges, REPORT, SUMMARY, different_inputs, is_run, results_table,
};

use crate::cli::terminal::files::is_standard_input;
use crate::cli::terminal::{Exit, Failure, memory};

/// Name of the file of tolerances beside the golden files.
pub(super) const TOLERANCES: &str = "tolerances.toml";

/// Remedy for tables in another form than that of this program.
const FORM: &str = "compare reads tables as this program writes them: one row of names, commas between fields, points before \
                    decimals, UTF-8";

/// Memory for reading and comparing two tables besides their files, over the size of these, as measured.
const TABLE_TIMES: usize = 3;

/// Effect of a comparison on EXPECTED.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// EXPECTED stays as it is.
    Compare,
    /// EXPECTED becomes like ACTUAL, and may be missing.
    Bless,
}

/// The files of both sides.
#[derive(Debug)]
pub(super) struct Sides {
    /// The folder of the golden files; `None`: EXPECTED is standard input.
    pub(super) golden: Option<PathBuf>,
    /// The folder ACTUAL; `None`: it is a file.
    actual: Option<PathBuf>,
    pairs: Vec<Pair>,
    /// Number of files that are neither tables nor a run's results.
    not_compared: usize,
    /// Files of tolerances in folders of the folder EXPECTED, by their paths from there.
    pub(super) unread_tolerances: Vec<String>,
}

/// A file of one side or both.
#[derive(Debug)]
struct Pair {
    /// Its path from the compared folders, with slashes.
    name: String,
    expected: Option<PathBuf>,
    actual: Option<PathBuf>,
}

impl Sides {
    /// Finds the files of both sides.
    pub(super) fn find(expected: &Path, actual: &Path, purpose: Purpose) -> Result<Self, Failure> {
        if purpose == Purpose::Bless {
            check_blessing(expected, actual)?;
        }
        if let Some(failure) = absence(actual) {
            return Err(failure);
        }
        let absence = absence(expected);
        // A missing EXPECTED becomes a folder or a file like ACTUAL.
        let is_folder = if absence.is_some() { actual.is_dir() } else { expected.is_dir() };
        if let (Some(failure), Purpose::Compare) = (absence, purpose) {
            let hint = "make it from ACTUAL with flexlink compare --bless".to_owned();
            return Err(Failure { hint: Some(hint), ..failure });
        }
        match (is_folder, actual.is_dir()) {
            (true, true) => Self::of_folders(expected, actual, purpose),
            (false, false) => Ok(Self::of_files(expected, actual)),
            (is_folder, _) => {
                let kinds = if is_folder { "a folder and a file" } else { "a file and a folder" };
                let must = "but must be two files or two folders";
                Err(both(expected, actual, kinds, must))
            }
        }
    }

    fn of_files(expected: &Path, actual: &Path) -> Self {
        let is_piped = is_standard_input(expected);
        let name = if is_piped { actual } else { expected }.file_name();
        let pair = Pair {
            name: name.map_or_else(String::new, |name| name.to_string_lossy().into()),
            expected: absence(expected).is_none().then(|| expected.to_owned()),
            actual: Some(actual.to_owned()),
        };
        Self {
            golden: expected.parent().filter(|_| !is_piped).map(Path::to_owned),
            actual: None,
            pairs: vec![pair],
            not_compared: 0,
            unread_tolerances: Vec::new(),
        }
    }

    fn of_folders(expected: &Path, actual: &Path, purpose: Purpose) -> Result<Self, Failure> {
        let golden =
            if expected.is_dir() { CsvFolder::list(expected)? } else { CsvFolder::default() };
        let found = CsvFolder::list(actual)?;
        let (source, path) = match purpose {
            Purpose::Compare => (&golden, expected),
            Purpose::Bless => (&found, actual),
        };
        if source.tables.is_empty() {
            let message = format!("{}: the folder holds no CSV files", path.display());
            return Err(Failure::new(Exit::InputRefused, &message, None));
        }
        let names: BTreeSet<&String> = golden.tables.keys().chain(found.tables.keys()).collect();
        let tables = names.into_iter().map(|name| Pair {
            name: name.clone(),
            expected: golden.tables.get(name).cloned(),
            actual: found.tables.get(name).cloned(),
        });
        let summaries = golden.others.iter().filter_map(|name| {
            let own = expected.join(name);
            let actual = found.others.contains(name).then(|| actual.join(name));
            has_results(&own).then_some(Pair { name: name.clone(), expected: Some(own), actual })
        });
        let summaries: Vec<Pair> = summaries.collect();
        let is_compared = |name: &&String| summaries.iter().any(|pair| pair.name == **name);
        let others = golden.others.union(&found.others).filter(|name| *name != TOLERANCES);
        let others = others.filter(|name| !is_compared(name)).count();
        let inner = format!("/{TOLERANCES}");
        let unread = golden.others.iter().filter(|name| name.ends_with(&inner));
        Ok(Self {
            golden: Some(expected.to_owned()),
            actual: Some(actual.to_owned()),
            not_compared: others,
            pairs: tables.chain(summaries).collect(),
            unread_tolerances: unread.cloned().collect(),
        })
    }

    /// True if both are single files. The file of tolerances may then name other files, too.
    pub(super) fn are_single(&self) -> bool {
        self.actual.is_none()
    }

    /// Reads and compares the files, one pair at a time.
    pub(super) fn compare(&self, tolerances: &Tolerances) -> Result<Comparison, Failure> {
        let compared = self.pairs.iter().map(|pair| {
            let (outcome, inputs) = pair.compare(tolerances)?;
            Ok(FileComparison { name: pair.name.clone(), outcome, inputs })
        });
        let files = compared.collect::<Result<_, Failure>>()?;
        Ok(Comparison { files, not_compared: self.not_compared })
    }

    /// Changes that make EXPECTED like ACTUAL.
    pub(super) fn changes(&self, comparison: &Comparison) -> Result<GoldenChanges, Failure> {
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
    /// Reads and compares both files, and names the inputs that differ between two runs.
    fn compare(&self, tolerances: &Tolerances) -> Result<(FileOutcome, Vec<String>), Failure> {
        let compared = |expected: &Table, actual: &Table| {
            FileOutcome::Compared(compare_tables(&self.name, expected, actual, tolerances))
        };
        let (path, only): (_, fn(Vec<String>) -> FileOutcome) = match (&self.expected, &self.actual)
        {
            (Some(expected), Some(actual)) => {
                let [expected, actual] = [InputFile::read(expected)?, InputFile::read(actual)?];
                let are_runs = [&expected, &actual].iter().all(|file| file.name == SUMMARY);
                let inputs = are_runs.then(|| different_inputs(&expected.bytes, &actual.bytes));
                let (expected, actual) = both_tables(&expected, &actual)?;
                let outcome = compared(&expected, actual.as_ref().unwrap_or(&expected));
                return Ok((outcome, inputs.unwrap_or_default()));
            }
            (Some(path), None) => (path, FileOutcome::OnlyExpected),
            (None, Some(path)) => (path, FileOutcome::OnlyActual),
            (None, None) => return Ok((FileOutcome::OnlyActual(Vec::new()), Vec::new())),
        };
        let file = InputFile::read(path)?;
        memory::check_tables(file.bytes.len(), TABLE_TIMES)?;
        let table = table_of(&file)?;
        let names: Vec<String> = table.names().map(str::to_owned).collect();
        // A file of one side is not a difference if the tolerances ignore all its columns.
        let is_ignored = |column: &String| tolerances.rule(&self.name, column) == Rule::Ignore;
        if !names.is_empty() && names.iter().all(is_ignored) {
            return Ok((compared(&table, &table), Vec::new()));
        }
        Ok((only(names), Vec::new()))
    }
}

/// Both tables, or one if their bytes are equal.
fn both_tables(
    expected: &InputFile,
    actual: &InputFile,
) -> Result<(Table, Option<Table>), Failure> {
    memory::check_tables(expected.bytes.len() + actual.bytes.len(), TABLE_TIMES)?;
    if expected.bytes == actual.bytes {
        return Ok((table_of(expected)?, None));
    }
    let (expected, actual) = rayon::join(|| table_of(expected), || table_of(actual));
    Ok((expected?, Some(actual?)))
}

/// The table in a file; for a summary.json the table of its results.
fn table_of(file: &InputFile) -> Result<Table, Failure> {
    if file.name != SUMMARY {
        return read_table(&file.shown, &file.bytes).map_err(|error| {
            let hint = Some(file.disguise().unwrap_or(FORM).to_owned());
            Failure { hint, ..Failure::from(error) }
        });
    }
    results_table(&file.bytes).ok_or_else(|| {
        let message = format!("{}: the summary holds no results of a run", file.shown);
        Failure::new(Exit::InputRefused, &message, None)
    })
}

/// True for the summary.json of a run, whose results are compared.
fn has_results(path: &Path) -> bool {
    let summary = || InputFile::read(path).ok().and_then(|file| results_table(&file.bytes));
    path.file_name().is_some_and(|name| name == SUMMARY) && summary().is_some()
}

/// The error of reading a file or folder that does not exist.
fn absence(path: &Path) -> Option<Failure> {
    let is_absent = !is_standard_input(path) && !path.exists();
    is_absent.then(|| InputFile::read(path).err()).flatten().map(Failure::from)
}

/// Returns an error if EXPECTED cannot become like ACTUAL.
fn check_blessing(expected: &Path, actual: &Path) -> Result<(), Failure> {
    let paths = [expected, actual];
    if paths.into_iter().any(is_standard_input) {
        let message = "--bless = standard input, but must be a file or a folder";
        return Err(Failure::new(Exit::Usage, &message, None));
    }
    // A pipe can be read only once, but blessing reads ACTUAL twice.
    if paths.into_iter().any(|path| path.exists() && !path.is_file() && !path.is_dir()) {
        let message = "--bless = a pipe, but must be a file or a folder";
        return Err(Failure::new(Exit::Usage, &message, None));
    }
    let real = paths.map(|path| path.canonicalize().ok().filter(|path| path.is_dir()));
    match real {
        [Some(a), Some(b)] if a.starts_with(&b) || b.starts_with(&a) => {
            let must = "but neither may lie in the other with --bless";
            Err(both(expected, actual, "folders", must))
        }
        _ => Ok(()),
    }
}

/// The error of an unsuitable pair of EXPECTED and ACTUAL.
fn both(expected: &Path, actual: &Path, kinds: &str, must: &str) -> Failure {
    let (expected, actual) = (expected.display(), actual.display());
    let message = format!("{expected}, {actual}: EXPECTED and ACTUAL = {kinds}, {must}");
    Failure::new(Exit::Usage, &message, None)
}

/// Completes the `changes` of each changed folder of EXPECTED that holds a run: ACTUAL's tables within tolerance, and
/// its summary.json and page, removed if ACTUAL lacks them.
fn take_whole_runs(
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
                (true, false) if changes.removed.contains(&name) => {}
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
