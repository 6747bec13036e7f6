//! Whether warnings are errors.

use clap::Args;

use super::exit::{Exit, Failure};

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
