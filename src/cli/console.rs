//! The only place that prints.

use std::fmt::Display;
use std::io::{self, Write};

use indicatif::{ProgressBar, ProgressStyle};

use super::exit::{Exit, Failure};

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

/// Progress on a terminal, with rate and time left; nothing in a pipe.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// Shows `done` of `all`.
    pub(crate) fn new(done: usize, all: usize) -> Self {
        let bar = ProgressBar::new(all as u64).with_position(done as u64);
        let style = ProgressStyle::with_template("[{bar:30}] {pos}/{len}, {per_sec}, {eta} left");
        // The template is a constant that the library reads.
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
        bar.set_style(style);
        // What an earlier run has done says nothing about the rate of this one.
        bar.reset_eta();
        Self(bar)
    }

    /// Shows nothing.
    pub(crate) fn hidden() -> Self {
        Self(ProgressBar::hidden())
    }

    /// Shows one more.
    pub(crate) fn advance(&self) {
        self.0.inc(1);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
