//! Results read back: folders of runs, or the table of a sweep.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use super::json::{Head, unreadable};
use super::names::SUMMARY;
use super::read_run::read_run;
use super::read_tables::RunFolder;
use super::robust::{COMMAND, RobustFiles};
use super::summary::{A_RUN, RESULTS};
use super::sweep::{is_sweep, read_sweep};
use crate::csv::{InputError, Place, TableError};
use crate::result::{StoredRun, StoredSweep};
use crate::robust::StoredRobust;

/// A result from a folder or a file.
#[derive(Debug, Clone)]
pub enum StoredResult {
    /// Folders of runs of `solve` or `simulate`. A page shows the first run; others may stand beside it, for comparison.
    Runs(Vec<StoredRun>),
    /// The table of a sweep.
    Sweep(Box<StoredSweep>),
    /// Folders of studies of `robust`. A page shows the first study; others may stand beside it.
    Robust(Vec<StoredRobust>),
}

/// Reads a result back: the folder of a run of `solve` or `simulate` or of a study of `robust`, the table of a sweep, or
/// a folder with one such table.
///
/// # Errors
/// [`TableError`] names the file and its missing, damaged or foreign part.
pub fn read_result(path: &Path) -> Result<StoredResult, TableError> {
    let folder = RunFolder(path);
    if folder.has(SUMMARY) {
        if head(path).is_some_and(|head| head.command.as_deref() == Some(COMMAND)) {
            let study = RobustFiles::read(folder)?.stored()?;
            let name = path.display().to_string();
            return Ok(StoredResult::Robust(vec![StoredRobust { name, ..study }]));
        }
        return Ok(StoredResult::Runs(vec![read_run(folder)?]));
    }
    let table = if path.is_dir() { only_sweep(path)? } else { path.to_owned() };
    Ok(StoredResult::Sweep(Box::new(read_sweep(&table)?)))
}

/// Reads several results back: one of any kind, or several runs, or several studies of `robust`, that a page shows side by
/// side. Their names distinguish them.
///
/// # Errors
/// Errors of [`read_result`]; several results, unless all are runs or all are studies.
pub fn read_results(first: &Path, others: &[PathBuf]) -> Result<StoredResult, TableError> {
    let mut result = read_result(first)?;
    for path in others {
        let kind = result.kind();
        let other = read_result(path)?;
        let of_other = other.kind();
        match (&mut result, other) {
            (StoredResult::Runs(runs), StoredResult::Runs(more)) => runs.extend(more),
            (StoredResult::Robust(studies), StoredResult::Robust(more)) => studies.extend(more),
            _ => {
                let shown = path.display().to_string();
                let place = Place { file: &shown, line: None };
                let must = match kind {
                    SWEEP => "must be left out: a sweep has a page of its own".to_owned(),
                    kind => format!("must be {kind}, as the first"),
                };
                return Err(place.refuse("result", of_other, must));
            }
        }
    }
    match &mut result {
        StoredResult::Runs(runs) => distinguish(runs.iter_mut().map(|run| &mut run.name).collect()),
        StoredResult::Robust(all) => distinguish(all.iter_mut().map(|own| &mut own.name).collect()),
        StoredResult::Sweep(_) => {}
    }
    Ok(result)
}

/// Kind of a sweep's table in messages.
const SWEEP: &str = "the table of a sweep";

impl StoredResult {
    /// Its kind in messages.
    fn kind(&self) -> &'static str {
        match self {
            Self::Runs(_) => "a run of solve or simulate",
            Self::Sweep(_) => SWEEP,
            Self::Robust(_) => "a study of robust",
        }
    }
}

/// Shortens the names of folders to their last parts if these differ. Repeated names have a number.
fn distinguish(mut names: Vec<&mut String>) {
    let last = |name: &&mut String| {
        Some(Path::new(name.as_str()).file_name()?.to_string_lossy().into_owned())
    };
    let short = names.iter().map(last).collect::<Option<Vec<String>>>().filter(|short| {
        short.iter().collect::<BTreeSet<_>>().len() == names.iter().collect::<BTreeSet<_>>().len()
    });
    if let Some(short) = short {
        names.iter_mut().zip(short).for_each(|(name, short)| **name = short);
    }
    let mut known = BTreeSet::new();
    for name in names {
        let own = name.clone();
        for number in 2.. {
            if known.insert(name.clone()) {
                break;
            }
            *name = format!("{own} ({number})");
        }
    }
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
    match &sweeps[..] {
        [] => {
            let error = place.refuse_whole(&format!("{SUMMARY} is missing: this is not {A_RUN}"));
            Err(error.with_hint(RESULTS.to_owned()))
        }
        [only] => Ok(only.clone()),
        several => {
            let names = several.iter().filter_map(|path| path.file_name());
            let names: Vec<_> = names.map(OsStr::to_string_lossy).collect();
            let error = place.refuse("tables of sweeps", names.join(", "), "must be one");
            Err(error.with_hint("name the file of one of them".to_owned()))
        }
    }
}

/// Whether a folder has the summary of a run, of any version.
pub fn is_run(folder: &Path) -> bool {
    head(folder).is_some_and(|head| head.flexlink.is_some())
}

/// Head of the summary in a folder.
fn head(folder: &Path) -> Option<Head> {
    let file = RunFolder(folder).file(SUMMARY).ok()?;
    serde_json::from_slice(&file.bytes).ok()
}
