//! What is asked of the paths on the command line before any work begins.

use std::path::{Path, PathBuf};

use flexlink::store::{ForeignRecord, REPORT, is_result_file, sweep_files};

use super::console::is_standard_output;
use super::exit::{Exit, Failure};

const ONE_RUN: &str = "a folder holds one run: the results would replace those read";

/// Whether a path means standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    ["-", "/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"].iter().any(|name| path.as_os_str() == *name)
}

/// Refuses to read standard input twice.
pub(crate) fn read_once(inputs: &[&Path]) -> Result<(), Failure> {
    if inputs.iter().filter(|path| is_standard_input(path)).count() < 2 {
        return Ok(());
    }
    let message = "standard input = several files, but must be one";
    Err(Failure::new(Exit::Usage, &message, None))
}

/// Refuses standard output for a folder; `argument` is what names the folder.
pub(crate) fn check_folder(argument: &str, folder: &Path) -> Result<(), Failure> {
    if !is_standard_output(folder) {
        return Ok(());
    }
    let message = format!("{argument} = {}, but must be a folder", folder.display());
    let hint = "standard output takes one file, and these are several";
    Err(Failure::new(Exit::Usage, &message, Some(hint)))
}

/// Refuses to read standard input twice, and to write results over a file that is read, or over the
/// run that it belongs to.
pub(crate) fn keep(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    read_once(inputs)?;
    check_folder("--output", output)?;
    let Ok(folder) = output.canonicalize() else { return Ok(()) };
    let is_of_a_run = |file: &&&Path| {
        file.canonicalize().is_ok_and(|file| {
            file.parent() == Some(&folder) && file.file_name().is_some_and(is_result_file)
        })
    };
    let Some(file) = inputs.iter().find(is_of_a_run) else { return Ok(()) };
    let message = format!(
        "--output = {}, but must be another folder than that of {}",
        output.display(),
        file.display()
    );
    Err(Failure::new(Exit::Usage, &message, Some(ONE_RUN)))
}

/// Refuses to write the results of many cases, each into a numbered folder of `outputs`, over a file
/// that is read, or over the run that it belongs to.
pub(crate) fn keep_cases(outputs: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    check_folder("--outputs", outputs)?;
    let Ok(outer) = outputs.canonicalize() else { return Ok(()) };
    if !outer.is_dir() {
        let message = format!("--outputs = {}, but must be a folder", outputs.display());
        return Err(Failure::new(Exit::Usage, &message, None));
    }
    let is_of_a_case = |file: &&&Path| {
        let Ok(file) = file.canonicalize() else { return false };
        let Some(folder) = file.parent().filter(|folder| folder.parent() == Some(&outer)) else {
            return false;
        };
        let name = folder.file_name().unwrap_or_default().as_encoded_bytes();
        name.iter().all(u8::is_ascii_digit) && file.file_name().is_some_and(is_result_file)
    };
    let Some(file) = inputs.iter().find(is_of_a_case) else { return Ok(()) };
    let message = format!(
        "--outputs = {}, but must be another folder than that of {}",
        outputs.display(),
        file.display()
    );
    Err(Failure::new(Exit::Usage, &message, Some(ONE_RUN)))
}

/// Refuses to write a file over one that is read.
pub(crate) fn keep_files(output: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    let Ok(there) = output.canonicalize() else { return Ok(()) };
    let is_output = |file: &&&Path| file.canonicalize().is_ok_and(|file| file == there);
    // A device is written through, not over.
    if !there.is_file() || !inputs.iter().any(|file| is_output(&file)) {
        return Ok(());
    }
    let message = format!("--output = {}, but must not be a file that is read", output.display());
    Err(Failure::new(Exit::Usage, &message, None))
}

/// Refuses a table of a sweep in or in the place of the folders of its cases, OUTPUTS/1, OUTPUTS/2, …
pub(crate) fn keep_from_cases(output: &Path, outputs: &Path) -> Result<(), Failure> {
    let folder = resolved(outputs);
    let is_case = |path: &Path| {
        let first = path.strip_prefix(&folder).ok().and_then(|inner| inner.iter().next());
        first.is_some_and(|name| name.as_encoded_bytes().iter().all(u8::is_ascii_digit))
    };
    let meets = |file: &PathBuf| {
        // A link is written through, and its record beside it.
        let followed = resolved(file);
        let beside = file.file_name().map(|name| resolved(&with_folder(file)).join(name));
        [Some(followed), beside]
            .into_iter()
            .flatten()
            .any(|file| is_case(&file) || folder.starts_with(&file))
    };
    if is_standard_output(output) || !sweep_files(output).iter().any(meets) {
        return Ok(());
    }
    let message = format!(
        "--output = {}, but must not be, or lie in, a folder that --outputs {} writes",
        output.display(),
        outputs.display()
    );
    let hint = "another name for the table: the folders of the cases are numbered";
    Err(Failure::new(Exit::Usage, &message, Some(hint)))
}

/// The folder of a file, as a path that leads there from here.
fn with_folder(file: &Path) -> PathBuf {
    Path::new(".").join(file.parent().unwrap_or(file))
}

/// A path without symbolic links, as far as it is there.
fn resolved(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let there = path.ancestors().find_map(|outer| Some((outer, outer.canonicalize().ok()?)));
    let Some((outer, real)) = there else { return path };
    match path.strip_prefix(outer) {
        Ok(rest) if rest.as_os_str().is_empty() => real,
        Ok(rest) => real.join(rest),
        Err(_) => path,
    }
}

/// Refuses to write the record of a sweep's table over any other kind of file.
pub(crate) fn keep_record(output: &Path) -> Result<(), Failure> {
    if is_standard_output(output) {
        return Ok(());
    }
    let Some(foreign) = ForeignRecord::beside(output) else { return Ok(()) };
    let message = format!(
        "--output = {}, but its record {} would replace {}",
        output.display(),
        foreign.path.display(),
        foreign.what
    );
    let hint = "another name for the table, or for that file";
    Err(Failure::new(Exit::Usage, &message, Some(hint)))
}

/// Refuses to write the page of a run over a file of the run.
pub(crate) fn keep_page(output: &Path, run: &Path) -> Result<(), Failure> {
    let (Ok(there), Ok(folder)) = (output.canonicalize(), run.canonicalize()) else {
        return Ok(());
    };
    let name = there.file_name().unwrap_or_default();
    if there.parent() != Some(&folder) || !is_result_file(name) || name == REPORT {
        return Ok(());
    }
    let message = format!("--output = {}, but must not be a file of the run", output.display());
    Err(Failure::new(Exit::Usage, &message, None))
}
