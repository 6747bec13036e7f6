use std::env;
use std::io;
use std::path::Path;

use tempfile::{Builder, TempDir};

use super::super::histories::{RESULT_FILES, SUMMARY};
use super::error::{FolderAction, FolderError};
use super::unfinished::{Unfinished, hold_off_the_end};

/// A folder for the files of one run that nobody keeps, for nobody else to read: it goes when it is
/// dropped, or the program is ended. What a killed run leaves is left to the system.
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
        let base = env::temp_dir();
        Self::in_folder(&base).map_err(|cause| FolderError {
            folder: base,
            action: FolderAction::Enter,
            cause,
        })
    }

    fn in_folder(base: &Path) -> io::Result<Self> {
        let held_off = hold_off_the_end();
        let mut builder = Builder::new();
        builder.prefix("flexlink-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        let folder = builder.tempdir_in(base)?;
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

    #[cfg(unix)]
    #[test]
    fn nobody_else_can_read_what_is_in_it() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = TemporaryFolder::new().unwrap();
        let mode = folder.path().metadata().unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o700);
    }

    #[test]
    fn a_folder_that_another_run_has_made_stays() {
        use std::time::{Duration, SystemTime};
        let base = tempfile::tempdir().unwrap();
        let other = base.path().join("flexlink-mine");
        fs::create_dir(&other).unwrap();
        fs::write(other.join("thesis.tex"), "mine").unwrap();
        let marker = fs::File::create_new(other.join(".flexlink.repetition")).unwrap();
        marker.set_modified(SystemTime::now() - Duration::from_secs(1000)).unwrap();
        drop(marker);
        drop(TemporaryFolder::in_folder(base.path()).unwrap());
        assert_eq!(fs::read_to_string(other.join("thesis.tex")).unwrap(), "mine");
        assert_eq!(fs::read_dir(base.path()).unwrap().count(), 1);
    }
}
