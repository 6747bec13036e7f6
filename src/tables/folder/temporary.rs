use std::env;
use std::path::Path;

use tempfile::{Builder, TempDir};

use super::super::histories::{RESULT_FILES, SUMMARY};
use super::error::{FolderAction, FolderError};
use super::unfinished::{Unfinished, hold_off_the_end};

/// A folder for the files of one run that nobody keeps: it goes when it is dropped, or the program is
/// ended.
#[derive(Debug)]
pub struct TemporaryFolder {
    folder: TempDir,
    // Dropped after the folder: what is there is noted.
    _unfinished: Vec<Unfinished>,
}

impl TemporaryFolder {
    /// Creates it where the system keeps such folders.
    ///
    /// # Errors
    /// [`FolderError`] if it cannot be created.
    pub fn new() -> Result<Self, FolderError> {
        let held_off = hold_off_the_end();
        let made = Builder::new().prefix("flexlink-").tempdir();
        let folder = made.map_err(|cause| FolderError {
            folder: env::temp_dir(),
            action: FolderAction::Enter,
            cause,
        })?;
        let files = RESULT_FILES.into_iter().chain([SUMMARY]);
        let paths = files.map(|name| folder.path().join(name)).chain([folder.path().to_owned()]);
        let unfinished = paths.map(|path| Unfinished::note(&path, &held_off)).collect();
        Ok(Self { folder, _unfinished: unfinished })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn it_goes_with_all_that_is_in_it() {
        let folder = TemporaryFolder::new().unwrap();
        let path = folder.path().to_owned();
        fs::write(path.join("torque.csv"), "0").unwrap();
        drop(folder);
        assert!(!path.exists());
    }
}
