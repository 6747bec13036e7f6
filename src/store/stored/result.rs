use std::fs;
use std::path::{Path, PathBuf};

use super::super::file_names::SUMMARY;
use super::folder::{A_RUN, RunFolder, unreadable};
use super::run::read_run;
use super::sweep::{is_sweep, read_sweep};
use crate::csv::{InputError, InputFile, Place, TableError};
use crate::result::StoredResult;

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
