//! What a program that is being ended removes: every path is noted here while its run may still fail.

use std::collections::BTreeMap;
use std::fs;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How a path is removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Removal {
    File,
    /// A folder, if nothing else is in it by then.
    EmptyFolder,
    FolderWithFiles,
}

type Paths = BTreeMap<PathBuf, Removal>;

static UNFINISHED: Mutex<Paths> = Mutex::new(BTreeMap::new());

/// A file or folder that is removed when this is dropped, or when the program is ended.
#[derive(Debug)]
pub(super) struct Unfinished(PathBuf);

impl Unfinished {
    /// Makes a file or folder and notes it. `make` returns its path and something more; a path that it
    /// makes and then refuses with an error is not noted.
    pub(super) fn make<T, E>(
        removal: Removal,
        make: impl FnOnce() -> Result<(PathBuf, T), E>,
    ) -> Result<(Self, T), E> {
        let mut paths = hold_off_the_end();
        let (path, made) = make()?;
        paths.insert(path.clone(), removal);
        Ok((Self(path), made))
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Leaves the path where it is, for good.
    pub(super) fn keep(self) {
        hold_off_the_end().remove(&self.0);
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let mut paths = hold_off_the_end();
        if let Some(removal) = paths.remove(&self.0) {
            removal.apply(&self.0);
        }
    }
}

impl Removal {
    /// What cannot be removed is left to the next run.
    fn apply(self, path: &Path) {
        let _ = match self {
            Self::File => fs::remove_file(path),
            Self::EmptyFolder => fs::remove_dir(path),
            Self::FolderWithFiles => fs::remove_dir_all(path),
        };
    }
}

/// Delays [`abandon_unfinished`] until the guard is dropped. Meanwhile the same thread must neither call
/// this again nor make or drop an [`Unfinished`].
pub(super) fn hold_off_the_end() -> MutexGuard<'static, Paths> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns if the program is not being ended, and never if it is: a file that is missing then was
/// removed by the end, which is no error to report.
pub fn wait_if_ending() {
    drop(hold_off_the_end());
}

/// Removes everything unfinished of a program that is about to exit. A run that is just renaming its
/// files finishes that first; afterwards no thread creates or renames a file of a run.
pub fn abandon_unfinished() {
    let paths = hold_off_the_end();
    // Files before their folder, and a run's files before its lock: see `STAGING`.
    for (path, removal) in paths.iter().rev() {
        removal.apply(path);
    }
    mem::forget(paths);
}
