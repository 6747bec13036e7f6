//! Checks of the paths on the command line before any work.

use std::path::{Path, PathBuf};

use crate::store::{ForeignRecord, REPORT, is_result_file, sweep_files};

use super::console::is_standard_output;
use super::exit::{Exit, Failure};

/// True if a path means standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    ["-", "/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"].iter().any(|name| path.as_os_str() == *name)
}

/// Returns an error if standard input would be read twice.
pub(crate) fn read_once(inputs: &[&Path]) -> Result<(), Failure> {
    if inputs.iter().filter(|path| is_standard_input(path)).count() < 2 {
        return Ok(());
    }
    let message = "standard input = several files, but must be one";
    Err(Failure::new(Exit::Usage, &message, None))
}

/// Error about the path of an argument.
fn refuse(argument: &str, path: &Path, must: &str, hint: Option<&str>) -> Result<(), Failure> {
    let message = format!("{argument} = {}, but {must}", path.display());
    Err(Failure::new(Exit::Usage, &message, hint))
}

/// Returns an error if a folder is standard output; `argument` names the folder.
pub(crate) fn check_folder(argument: &str, folder: &Path) -> Result<(), Failure> {
    if !is_standard_output(folder) {
        return Ok(());
    }
    let hint = "name a folder: standard output takes one file, and these are several";
    refuse(argument, folder, "must be a folder", Some(hint))
}

/// Returns an error if standard input would be read twice, or if the results would replace an input file, or the run
/// that it belongs to.
pub(crate) fn keep(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    read_once(inputs)?;
    check_folder("--output", output)?;
    let Ok(folder) = output.canonicalize() else { return Ok(()) };
    keep_runs("--output", output, inputs, |run| run == folder)
}

/// Returns an error if the results of many cases, each in a numbered folder of `outputs`, would replace an input file,
/// or the run that it belongs to.
pub(crate) fn keep_cases(outputs: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    check_folder("--outputs", outputs)?;
    let Ok(outer) = outputs.canonicalize() else { return Ok(()) };
    if !outer.is_dir() {
        return refuse("--outputs", outputs, "must be a folder", None);
    }
    let is_case = |run: &Path| {
        let number = run.file_name().unwrap_or_default().as_encoded_bytes();
        run.parent() == Some(&outer) && number.iter().all(u8::is_ascii_digit)
    };
    keep_runs("--outputs", outputs, inputs, is_case)
}

/// Returns an error if an input is a result in a folder to write.
fn keep_runs(
    argument: &str,
    output: &Path,
    inputs: &[&Path],
    is_written: impl Fn(&Path) -> bool,
) -> Result<(), Failure> {
    let is_replaced = |file: &&&Path| {
        let Ok(file) = file.canonicalize() else { return false };
        file.parent().is_some_and(&is_written) && file.file_name().is_some_and(is_result_file)
    };
    let Some(file) = inputs.iter().find(is_replaced) else { return Ok(()) };
    let must = format!("must be another folder than that of {}", file.display());
    let hint = "a folder holds one run: the results would replace those read";
    refuse(argument, output, &must, Some(hint))
}

/// Returns an error if a file would replace an input file.
pub(crate) fn keep_files(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    keep_inputs("--output", output, inputs)
}

/// Like [`keep_files`], for the file of any argument.
pub(crate) fn keep_inputs(argument: &str, output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    let Ok(file) = output.canonicalize() else { return Ok(()) };
    let is_output = |input: &&Path| input.canonicalize().is_ok_and(|input| input == file);
    // Writing to a device does not replace it.
    if !file.is_file() || !inputs.iter().any(is_output) {
        return Ok(());
    }
    refuse(argument, output, "must not be a file that is read", None)
}

/// Returns an error if the page of a fit goes to standard output, which has the table, or would replace another written
/// file.
pub(crate) fn keep_page_apart(page: &Path, others: &[PathBuf]) -> Result<(), Failure> {
    if is_standard_output(page) {
        return refuse("--report", page, "must be a file", Some("standard output has the table"));
    }
    let is_same = |other: &PathBuf| resolved(other) == resolved(page);
    match others.iter().find(|other| is_same(other)) {
        Some(other) => {
            let must = format!("must be another file than {}", other.display());
            refuse("--report", page, &must, None)
        }
        None => Ok(()),
    }
}

/// Returns an error if a sweep's table would be in, or in the place of, a folder of its cases, OUTPUTS/1, OUTPUTS/2, …
pub(crate) fn keep_from_cases(output: &Path, outputs: &Path) -> Result<(), Failure> {
    let folder = resolved(outputs);
    let is_case = |path: &Path| {
        let first = path.strip_prefix(&folder).ok().and_then(|inner| inner.iter().next());
        first.is_some_and(|name| name.as_encoded_bytes().iter().all(u8::is_ascii_digit))
    };
    let meets = |file: &PathBuf| {
        // The table goes through a symbolic link, but its record goes beside the link.
        let outer = Path::new(".").join(file.parent().unwrap_or(file));
        let beside = file.file_name().map(|name| resolved(&outer).join(name));
        let mut files = std::iter::once(resolved(file)).chain(beside);
        files.any(|file| is_case(&file) || folder.starts_with(&file))
    };
    if is_standard_output(output) || !sweep_files(output).iter().any(meets) {
        return Ok(());
    }
    let written = outputs.display();
    let must = format!("must not be, or lie in, a folder that --outputs {written} writes");
    let hint = "use another name for the table: the folders of the cases are numbered";
    refuse("--output", output, &must, Some(hint))
}

/// A path without symbolic links, as far as it exists.
fn resolved(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let found = path.ancestors().find_map(|outer| Some((outer, outer.canonicalize().ok()?)));
    let Some((outer, real)) = found else { return path };
    match path.strip_prefix(outer) {
        Ok(rest) if rest.as_os_str().is_empty() => real,
        Ok(rest) => real.join(rest),
        Err(_) => path,
    }
}

/// Returns an error if the record of a sweep's table would replace another kind of file.
pub(crate) fn keep_record(output: &Path) -> Result<(), Failure> {
    if is_standard_output(output) {
        return Ok(());
    }
    let Some(foreign) = ForeignRecord::beside(output) else { return Ok(()) };
    let (record, what) = (foreign.path.display(), foreign.what);
    let but = format!("its record {record} would replace {what}");
    refuse("--output", output, &but, Some("use another name for the table, or for that file"))
}

/// Returns an error if the page of a run would replace a file of the run.
pub(crate) fn keep_page(output: &Path, run: &Path) -> Result<(), Failure> {
    let (Ok(file), Ok(folder)) = (output.canonicalize(), run.canonicalize()) else {
        return Ok(());
    };
    let name = file.file_name().unwrap_or_default();
    if file.parent() != Some(&folder) || !is_result_file(name) || name == REPORT {
        return Ok(());
    }
    refuse("--output", output, "must not be a file of the run", None)
}
