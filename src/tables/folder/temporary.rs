use std::env;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::time::Duration;

use tempfile::{Builder, TempDir};

use super::super::histories::{RESULT_FILES, SUMMARY};
use super::error::{FolderAction, FolderError};
use super::unfinished::{Unfinished, hold_off_the_end};

const PREFIX: &str = "flexlink-";

/// Locked as long as the run goes on that the folder is for.
const IN_USE: &str = ".flexlink.repetition";

/// How long a folder may be there before it is in use.
const BEFORE_USE: Duration = Duration::from_secs(60);

/// A folder for the files of one run that nobody keeps, for nobody else to read: it goes when it is
/// dropped, or the program is ended; what a killed run leaves goes with the next one.
#[derive(Debug)]
pub struct TemporaryFolder {
    // The system releases it with the process, however that ends. Dropped before the folder: some
    // systems remove no file that is open.
    _in_use: File,
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
        remove_unused(base);
        let held_off = hold_off_the_end();
        let mut builder = Builder::new();
        builder.prefix(PREFIX);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        let folder = builder.tempdir_in(base)?;
        let in_use = File::create_new(folder.path().join(IN_USE))?;
        // A file system without locks has no say; what is left there stays.
        let _ = in_use.try_lock();
        let files = RESULT_FILES.into_iter().chain([SUMMARY, IN_USE]);
        let paths = files.map(|name| folder.path().join(name)).chain([folder.path().to_owned()]);
        let unfinished = paths.map(|path| Unfinished::note(&path, &held_off)).collect();
        Ok(Self { _in_use: in_use, folder, _unfinished: unfinished })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes the folders of runs that were killed, as far as they are this user's.
fn remove_unused(base: &Path) {
    let Ok(entries) = fs::read_dir(base) else { return };
    for entry in entries.flatten() {
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_folder && entry.file_name().to_string_lossy().starts_with(PREFIX) {
            let folder = entry.path();
            if is_unused(&folder.join(IN_USE)) {
                // Another run may be removing it, too.
                let _ = fs::remove_dir_all(folder);
            }
        }
    }
}

fn is_unused(path: &Path) -> bool {
    let Ok(file) = File::options().read(true).write(true).open(path) else { return false };
    let age = file.metadata().and_then(|found| found.modified()).map(|then| then.elapsed());
    matches!(age, Ok(Ok(age)) if age > BEFORE_USE) && file.try_lock().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

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
    fn what_a_killed_run_has_left_goes_with_the_next_one_and_nothing_else() {
        let base = tempfile::tempdir().unwrap();
        let made = |name: &str, age_s: u64| {
            let folder = base.path().join(name);
            fs::create_dir(&folder).unwrap();
            fs::write(folder.join("torque.csv"), "0").unwrap();
            let file = File::create_new(folder.join(IN_USE)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age_s)).unwrap();
            (folder, file)
        };
        let (killed, file) = made("flexlink-killed", 100);
        drop(file);
        let (running, locked) = made("flexlink-running", 100);
        locked.try_lock().unwrap();
        let (beginning, _) = made("flexlink-beginning", 0);
        let (other, _) = made("other", 100);
        let foreign = base.path().join("flexlink-foreign");
        fs::create_dir(&foreign).unwrap();
        let own = TemporaryFolder::in_folder(base.path()).unwrap();
        assert!(!killed.exists());
        for folder in [&running, &beginning, &other, &foreign, &own.path().to_owned()] {
            assert!(folder.exists(), "{}", folder.display());
        }
    }
}
