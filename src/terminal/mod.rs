//! The terminal and the process: what is printed and how, how the program ends, how much memory and
//! how many threads it may take.

pub(crate) mod console;
mod exit;
pub(crate) mod memory;
mod progress;
pub(crate) mod text;
pub(crate) mod threads;

pub(crate) use exit::{Ending, Exit, Failure};
pub(crate) use progress::{CaseBar, StageBar};
