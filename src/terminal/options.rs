//! Options of every command on what it prints and how it ends.

use clap::Args;

use super::console;
use super::exit::{Exit, Failure};
use super::progress::StageBar;

/// What to print on standard output.
#[derive(Debug, Args)]
pub(crate) struct PrintArgs {
    #[arg(long, conflicts_with = "quiet", help = "Print summary.json instead of the summary")]
    pub(crate) json: bool,

    /// Print nothing but warnings and errors.
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl PrintArgs {
    /// A bar that shows how far the work is.
    pub(crate) fn stages(&self) -> StageBar {
        if self.quiet { StageBar::hidden() } else { StageBar::new() }
    }

    /// Prints the result as JSON or as text, or not at all.
    pub(crate) fn print(
        &self,
        json: impl FnOnce() -> String,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        match (self.quiet, self.json) {
            (true, _) => Ok(()),
            (_, true) => console::print_bytes(json().as_bytes()),
            _ => console::print(&text()),
        }
    }
}

/// What becomes of a run with warnings.
#[derive(Debug, Args)]
pub(crate) struct WarningArgs {
    #[arg(long, help = "Fail with exit code 4 if there is a warning; all output is written")]
    deny_warnings: bool,
}

impl WarningArgs {
    /// Whether no warning is allowed.
    pub(crate) fn are_denied(&self) -> bool {
        self.deny_warnings
    }

    /// Ends a program that has written its output and printed so many warnings, if none is allowed.
    pub(crate) fn refuse(&self, warnings: usize) -> Result<(), Failure> {
        if warnings == 0 || !self.are_denied() {
            return Ok(());
        }
        let message = format!(
            "--deny-warnings: warnings = {warnings}, but must be none; all output is written"
        );
        Err(Failure::new(Exit::NotSolvable, &message, None))
    }
}
