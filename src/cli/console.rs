//! The only place that prints.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

use flexlink::tables::write_file;

use super::exit::{Exit, Failure};
use super::files::is_standard_output;

/// Prints an error and its hint to standard error.
pub(crate) fn error(message: &str, hint: Option<&str>) {
    told("error", message, hint);
}

/// Prints a warning and its hint to standard error.
pub(crate) fn warning(message: impl Display, hint: &str) {
    told("warning", &message.to_string(), Some(hint));
}

fn told(kind: &str, message: &str, hint: Option<&str>) {
    let mut err = io::stderr().lock();
    // There is nowhere left to tell that standard error is closed.
    let _ = writeln!(err, "{kind}: {message}");
    if let Some(hint) = hint {
        let _ = writeln!(err, "hint: {hint}");
    }
}

/// Writes text to standard output; a reader that has gone away is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    print_bytes(text.as_bytes())
}

/// Writes what a command makes to the file `output`, or to standard output where there is none or
/// it is `-`.
pub(crate) fn deliver(output: Option<&Path>, text: &[u8]) -> Result<(), Failure> {
    match output.filter(|path| !is_standard_output(path)) {
        None => print_bytes(text),
        Some(path) => Ok(write_file(path, text)?),
    }
}

/// Writes a table to standard output; a reader that has gone away is no error.
pub(crate) fn print_bytes(text: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(cause) if cause.kind() != io::ErrorKind::BrokenPipe => {
            let cause = cause.to_string();
            // The system's number for the error says nothing beside its words.
            let words = cause.split(" (os error").next().unwrap_or(&cause);
            let message = format!("standard output: cannot write: {words}");
            Err(Failure::new(Exit::CannotWrite, &message, None))
        }
        _ => Ok(()),
    }
}
