//! The terminal and the process: what is printed and how, which files a run may write, how the program
//! ends, how much memory and how many threads it may take.

pub(crate) mod console;
mod exit;
pub(crate) mod files;
pub(crate) mod interrupt;
pub(crate) mod memory;
mod options;
mod progress;
pub(crate) mod shell;
pub(crate) mod text;
mod threads;

pub(crate) use exit::{Ending, Exit, Failure};
pub(crate) use options::{PrintArgs, WarningArgs};
pub(crate) use progress::{CaseBar, StageBar};
pub(crate) use threads::ThreadArgs;
