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
    /// Folders of runs of `solve` or `simulate`. A page shows the first run. Runs of arms with equally many links may
    /// stand beside it, for comparison.
    Runs(Vec<StoredRun>),
    /// The table of a sweep.
    Sweep(Box<StoredSweep>),
    /// The folder of a study of `robust`.
    Robust(Box<StoredRobust>),
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
            return Ok(StoredResult::Robust(Box::new(study)));
        }
        return Ok(StoredResult::Runs(vec![read_run(folder)?]));
    }
    let table = if path.is_dir() { only_sweep(path)? } else { path.to_owned() };
    Ok(StoredResult::Sweep(Box::new(read_sweep(&table)?)))
}

/// Largest difference in m between the lengths of links of the same arm.
const SAME_M: f64 = 1e-9;

/// Reads several results back: one of any kind, or runs of an arm that a page shows beside the first.
///
/// # Errors
/// Errors of [`read_result`]; several results, unless all are runs of arms with equally many links.
pub fn read_results(first: &Path, others: &[PathBuf]) -> Result<StoredResult, TableError> {
    let mut result = read_result(first)?;
    for path in others {
        let shown = path.display().to_string();
        let place = Place { file: &shown, line: None };
        let runs = match &mut result {
            StoredResult::Runs(runs) if runs[0].arc.is_none() => runs,
            _ => {
                let must = "must be left out: only runs of arms stand side by side";
                return Err(place.refuse("BESIDE", "a result beside that of one link", must));
            }
        };
        let links = runs[0].links.len();
        let is_same = |other: &StoredRun| {
            let lengths = runs[0].links.iter().zip(&other.links);
            let mut apart_m = lengths.map(|(a, b)| (a.link.length_m() - b.link.length_m()).abs());
            other.links.len() == links && apart_m.all(|apart_m| apart_m <= SAME_M)
        };
        match read_result(path)? {
            StoredResult::Runs(more) if is_same(&more[0]) => runs.extend(more),
            _ => {
                let must = format!(
                    "must be a run of an arm of {links} links as long as those of the first"
                );
                return Err(place.refuse("result", "another", must));
            }
        }
    }
    if let StoredResult::Runs(runs) = &mut result {
        shorten_names(runs);
    }
    Ok(result)
}

/// Shortens the names of folders to their last part, if it distinguishes them.
fn shorten_names(runs: &mut [StoredRun]) {
    let last = |run: &StoredRun| Some(Path::new(&run.name).file_name()?.to_string_lossy().into());
    let Some(names) = runs.iter().map(last).collect::<Option<Vec<String>>>() else { return };
    if names.iter().collect::<BTreeSet<_>>().len() == names.len() {
        runs.iter_mut().zip(names).for_each(|(run, name)| run.name = name);
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
