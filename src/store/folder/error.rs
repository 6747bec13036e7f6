use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::csv::system_words;

/// What could not be done with an output folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FolderAction {
    /// Creating the folder itself.
    Create,
    /// Writing into the folder at all.
    Enter,
    /// Writing the file of this name.
    Write(String),
    /// Removing the file of this name, left by an earlier run.
    Remove(String),
}

/// An output folder or a file in it that cannot be written.
#[derive(Debug)]
pub struct FolderError {
    /// The folder, as the caller named it.
    pub folder: PathBuf,
    /// What could not be done.
    pub action: FolderAction,
    /// What the system said.
    pub cause: io::Error,
}

impl fmt::Display for FolderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: cannot ", self.folder.display())?;
        match &self.action {
            FolderAction::Create => write!(f, "create the folder")?,
            FolderAction::Enter => write!(f, "write into the folder")?,
            FolderAction::Write(name) => write!(f, "write {name}")?,
            FolderAction::Remove(name) => write!(f, "remove {name}")?,
        }
        write!(f, ": {}", system_words(&self.cause))
    }
}

// The cause is part of the text, so it is no `source` that would be told a second time.
impl std::error::Error for FolderError {}
