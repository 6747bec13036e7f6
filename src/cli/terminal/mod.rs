//! The terminal and the process: printing, checks of files to write, end of the program, memory and threads.

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
pub use progress::StageBar;
pub(crate) use progress::{CaseBar, PrintArgs};
