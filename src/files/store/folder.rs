//! Results on the disk: a run's folder, whose files appear all together, or one file; whole or not at all, whatever
//! ends the program.
//!
//! A run writes its files into a hidden folder inside its folder, and renames them when all are whole. A lock makes
//! runs into one folder take turns.

use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use thiserror::Error;

use super::lock::{Lock, PATIENCE, Unfinished, hold_off_the_end};
use crate::csv::system_words;

#[cfg(test)]
mod tests;

const LOCK: &str = ".flexlink.lock";

/// Beginning of the name of the folder into which a run writes its files. It sorts after [`LOCK`], so that an
/// interrupted program removes the lock last.
pub(super) const STAGING: &str = ".flexlink.run-";

/// Whether a run waits until its files are on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Durability {
    /// The run does not wait: files are whole however the run ends, but a power failure soon after it may cut them
    /// short.
    #[default]
    InMemory,
    /// The run waits for each file before it renames it, and for the folder afterwards: after a power failure every
    /// file is whole or absent.
    OnDisk,
}

impl Durability {
    /// Writes all of a file.
    fn write(
        self,
        file: File,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut buffered = BufWriter::with_capacity(1 << 16, file);
        write(&mut buffered)?;
        let file = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
        self.sync(|| Ok(file))
    }

    /// Waits until a file, or the names in a folder, are on the disk. Accepts the refusal of a network file
    /// system that cannot wait, of one that is read-only, and of a folder that may not be read.
    fn sync(self, open: impl FnOnce() -> io::Result<File>) -> io::Result<()> {
        use io::ErrorKind::{InvalidInput, PermissionDenied, ReadOnlyFilesystem, Unsupported};
        if self == Self::InMemory {
            return Ok(());
        }
        let refusals = [InvalidInput, PermissionDenied, ReadOnlyFilesystem, Unsupported];
        match open().and_then(|file| file.sync_all()) {
            Err(cause) if refusals.contains(&cause.kind()) => Ok(()),
            synced => synced,
        }
    }

    /// Waits for the names in a folder and in those above it, which may be new. Only Unix opens folders;
    /// Windows keeps their names in order.
    fn sync_folder(self, dir: &Path) -> io::Result<()> {
        let dir = std::path::absolute(dir)?;
        let mut folders = dir.ancestors().filter(|_| cfg!(unix));
        folders.try_for_each(|folder| self.sync(|| File::open(folder)))
    }
}

/// Error of an output folder or a file in it.
// Without `source`: the text already holds the cause.
#[derive(Debug, Error)]
#[error("{}: cannot {action}: {}", folder.display(), system_words(cause))]
pub struct FolderError {
    /// The folder, as the caller named it.
    pub folder: PathBuf,
    /// Action that failed: `write torque.csv`.
    pub action: String,
    /// The error of the system.
    pub cause: io::Error,
}

impl FolderError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self.cause.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                Some("free some space, or write to another disk")
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                Some("write into a folder of your own")
            }
            _ => None,
        }
    }

    pub(super) fn new(folder: &Path, action: impl Into<String>, cause: io::Error) -> Self {
        Self { folder: folder.to_owned(), action: action.into(), cause }
    }

    /// The error of a folder that does not accept files.
    pub(super) fn of_folder(folder: &Path, cause: io::Error) -> Self {
        Self::new(folder, "write into the folder", cause)
    }

    /// The error of a file that cannot be written.
    pub(super) fn of_file(path: &Path, cause: io::Error) -> Self {
        let name = path.file_name().unwrap_or(path.as_os_str());
        Self::new(folder_of(path), format!("write {}", name.display()), cause)
    }
}

/// A folder that receives all files of a run, or none.
///
/// [`commit`](Self::commit) or [`replace`](Self::replace) gives the files their names. Without either, dropping it
/// changes no file in the folder.
#[derive(Debug)]
pub struct OutputFolder {
    dir: PathBuf,
    durability: Durability,
    /// Names of the written files. Threads write several at the same time.
    names: Mutex<BTreeSet<OsString>>,
    // Removed before the lock.
    staging: Unfinished,
    _lock: Lock,
}

impl OutputFolder {
    /// Opens `dir` for a run's files, and creates it and the folders above it if they are missing. Waits for another
    /// run that writes into it; after more than a second, calls `on_wait` once.
    ///
    /// # Errors
    /// [`FolderError`] if the folder cannot be created, or another run keeps writing into it.
    pub fn stage(dir: &Path, on_wait: &dyn Fn(&Path)) -> Result<Self, FolderError> {
        create(dir)?;
        let lock = Lock::take(&dir.join(LOCK), PATIENCE, &|| on_wait(dir));
        let lock = lock.map_err(|cause| FolderError::of_folder(dir, cause))?;
        let staging = || {
            if lock.is_exclusive {
                remove_left(dir)?;
            }
            Unfinished::make(
                |path| fs::remove_dir_all(path),
                || Ok((tempfile::Builder::new().prefix(STAGING).tempdir_in(dir)?.keep(), ())),
            )
        };
        let (staging, ()) = staging().map_err(|cause| FolderError::of_folder(dir, cause))?;
        let (durability, names) = (Durability::default(), Mutex::default());
        Ok(Self { dir: dir.to_owned(), durability, names, staging, _lock: lock })
    }

    /// Sets whether the run waits for the disk; it does not by default.
    #[must_use]
    pub fn with(mut self, durability: Durability) -> Self {
        self.durability = durability;
        self
    }

    /// Writes one file, invisible until the end; `write` receives a buffered writer. Threads may write several at the
    /// same time.
    ///
    /// # Errors
    /// [`FolderError`] if the file cannot be created or `write` fails.
    pub fn file(
        &self,
        name: impl AsRef<OsStr>,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<(), FolderError> {
        let name = name.as_ref();
        let create = || {
            let _held = hold_off_the_end();
            File::create(self.staged(name))
        };
        let written = create().and_then(|file| self.durability.write(file, write));
        written.map_err(|cause| self.unwritten(name, cause))?;
        self.names.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned());
        Ok(())
    }

    /// Gives all files their names, the file `last` after all others.
    ///
    /// `owned` are the names that this program may write. The function first removes the files of an earlier run
    /// under these names and the new ones, `last` before all others. At no moment are files of two runs there, and a
    /// folder with `last` holds a whole run.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be removed or written; the folder then has no file `last`. If
    /// a folder has the name of a file, nothing changes.
    pub fn commit(self, last: impl AsRef<OsStr>, owned: &[&str]) -> Result<(), FolderError> {
        let last = last.as_ref();
        let _held = hold_off_the_end();
        let mut names = self.names()?;
        if self.dir.join(last).exists() {
            self.remove(last)?;
            self.sync()?;
        }
        let own = names.iter().map(OsString::as_os_str);
        owned.iter().map(OsStr::new).chain(own).try_for_each(|name| self.remove(name))?;
        let end = names.take(last);
        self.rename(&names)?;
        self.rename(&end)?;
        // Someone who removes the folder meanwhile may have removed some of them, and not the last.
        if let Some(name) = names.iter().find(|name| !self.dir.join(name).exists()) {
            self.remove(last)?;
            return Err(self.unwritten(name, io::Error::other("it was removed meanwhile")));
        }
        Ok(())
    }

    /// Gives all files their names and replaces older ones. At every moment each name has a whole file, and each file
    /// keeps the permissions of its predecessor.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be written; if a folder has its name, no file changes.
    pub fn replace(self) -> Result<(), FolderError> {
        let _held = hold_off_the_end();
        let names = self.names()?;
        for name in &names {
            keep_permissions(&self.dir.join(name), &self.staged(name));
        }
        self.rename(&names)
    }

    /// Names of all files; refuses the name of a folder.
    pub(super) fn names(&self) -> Result<BTreeSet<OsString>, FolderError> {
        let names = self.names.lock().unwrap_or_else(PoisonError::into_inner).clone();
        match names.iter().find(|name| self.dir.join(name).is_dir()) {
            None => Ok(names),
            Some(name) => Err(self.unwritten(name, io::Error::other(TAKEN))),
        }
    }

    /// Path of a file before its renaming.
    fn staged(&self, name: &OsStr) -> PathBuf {
        self.staging.path().join(name)
    }

    fn rename<'a>(&self, names: impl IntoIterator<Item = &'a OsString>) -> Result<(), FolderError> {
        for name in names {
            let renamed = fs::rename(self.staged(name), self.dir.join(name));
            renamed.map_err(|cause| self.unwritten(name, cause))?;
        }
        self.sync()
    }

    fn remove(&self, name: &OsStr) -> Result<(), FolderError> {
        match fs::remove_file(self.dir.join(name)) {
            Err(cause) if cause.kind() != io::ErrorKind::NotFound => {
                Err(FolderError::new(&self.dir, format!("remove {}", name.display()), cause))
            }
            _ => Ok(()),
        }
    }

    /// Waits until the names in the folder are on the disk, if the run waits for it.
    fn sync(&self) -> Result<(), FolderError> {
        let synced = self.durability.sync_folder(&self.dir);
        synced.map_err(|cause| FolderError::of_folder(&self.dir, cause))
    }

    /// The error of a file whose content is refused before the program writes it.
    pub(super) fn refused(
        &self,
        name: &str,
        error: impl std::error::Error + Send + Sync + 'static,
    ) -> FolderError {
        self.unwritten(name.as_ref(), io::Error::new(io::ErrorKind::InvalidInput, error))
    }

    fn unwritten(&self, name: &OsStr, cause: io::Error) -> FolderError {
        FolderError::of_file(&self.dir.join(name), cause)
    }
}

/// Obstacle to the name of a file.
pub(super) const TAKEN: &str = "a folder has this name";

/// Removes the remains of killed runs in a folder. This run must hold its lock.
fn remove_left(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if is_staging(&entry.file_name()) && entry.file_type()?.is_dir() {
            // A folder of another user may have to stay.
            let _ = fs::remove_dir_all(entry.path());
        }
    }
    Ok(())
}

/// Removes the lock and the remains of killed runs in a folder, unless a run is writing into it.
pub(super) fn clear(folder: &Path) {
    let lock = folder.join(LOCK);
    if !lock.is_file() {
        return;
    }
    if let Ok(held) = Lock::take(&lock, Duration::ZERO, &|| {}) {
        // Files of another user may have to stay.
        let _ = held.is_exclusive.then(|| remove_left(folder));
    }
}

/// Whether a folder of this name holds files of an unfinished run.
fn is_staging(name: &OsStr) -> bool {
    name.as_encoded_bytes().starts_with(STAGING.as_bytes())
}

/// Whether a run has an entry of this name while it writes into a folder.
pub(super) fn is_aside(name: &OsStr) -> bool {
    name == LOCK || is_staging(name)
}

/// Gives a file the permissions of its predecessor. A link, and a file system without permissions, provide no
/// permissions.
fn keep_permissions(old: &Path, new: &Path) {
    let old = fs::symlink_metadata(old).ok().filter(|old| !old.is_symlink());
    let _ = old.map(|old| fs::set_permissions(new, old.permissions()));
}

/// Creates a folder and the folders above it, if they are missing.
pub(super) fn create(dir: &Path) -> Result<(), FolderError> {
    fs::create_dir_all(dir).map_err(|cause| FolderError::new(dir, "create the folder", cause))
}

/// The folder of a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}
