//! Folders and files that are written whole or not at all, whatever ends the program.
//!
//! Every file is written aside, brought to the disk, and renamed. While a run writes into a folder
//! it holds a lock there, `.flexlink.lock`, which is gone afterwards: who finds one that no process
//! holds finds the files of a killed run, and removes them.

mod aside;
mod error;
mod lock;
mod output;
mod temporary;
mod unfinished;

#[cfg(test)]
mod tests;

pub use error::{FolderAction, FolderError};
pub use output::{Durability, OutputFolder};
pub use temporary::TemporaryFolder;
pub(super) use unfinished::{Unfinished, hold_off_the_end};
pub use unfinished::{abandon_unfinished, abandon_unfinished_soon, wait_if_ending};
