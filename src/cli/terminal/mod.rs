//! The terminal and the process: what is printed and how, which files a run may write, how the program
//! ends, how much memory and how many threads it may take.

pub mod allocator;
pub mod console;
mod exit;
pub(crate) mod files;
pub(crate) mod interrupt;
pub mod memory;
mod progress;
pub(crate) mod text;

pub use exit::{Ending, Exit, Failure, WarningArgs};
pub(crate) use memory::ThreadArgs;
pub(crate) use progress::{CaseBar, PrintArgs, StageBar};
