//! A run's folder: its files appear all together or not at all, whatever ends the program.
//!
//! Files are written into a folder of their own inside it, and renamed when all are whole. A lock makes
//! runs into one folder take turns.

use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::lock::{FolderLock, STAGING};
use super::unfinished::{Removal, Unfinished, hold_off_the_end};
use crate::csv::system_words;

#[cfg(test)]
mod tests;

/// Whether a run waits until its files are on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Durability {
    /// It does not: files are whole however the run ends, but a power failure soon after it may cut them
    /// short.
    #[default]
    InMemory,
    /// It waits for each file before it is renamed, and for the folder afterwards: a power failure leaves
    /// whole files or none.
    OnDisk,
}

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
    /// The error of the system.
    pub cause: io::Error,
}

impl FolderError {
    /// The error of a file that cannot be written.
    pub(super) fn of_file(path: &Path, cause: io::Error) -> Self {
        let name = path.file_name().unwrap_or(path.as_os_str());
        Self { folder: folder_of(path).to_owned(), action: FolderAction::Write(lossy(name)), cause }
    }
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

// Without `source`: the text already holds the cause.
impl std::error::Error for FolderError {}

/// A folder that receives all files of a run, or none.
///
/// [`commit`](Self::commit) or [`replace`](Self::replace) gives the files their names. Dropped without
/// either, the folder is left as it was found.
#[derive(Debug)]
pub struct OutputFolder {
    dir: PathBuf,
    durability: Durability,
    /// Names of the files that are written. Threads write several at the same time.
    names: Mutex<BTreeSet<OsString>>,
    // Dropped in this order: a folder is removed only if it is empty.
    staging: Unfinished,
    _lock: FolderLock,
    /// Folders that were not there before, the innermost first.
    created: Vec<Unfinished>,
}

impl OutputFolder {
    /// Opens `dir` for a run's files, creating it and the folders above it where they are missing. Another
    /// run that writes into it is waited for; if that takes more than a second, `on_wait` is called once.
    ///
    /// # Errors
    /// [`FolderError`] if the folder cannot be created, or another run keeps writing into it.
    pub fn stage(dir: &Path, on_wait: &dyn Fn(&Path)) -> Result<Self, FolderError> {
        let error = |action| move |cause| FolderError { folder: dir.to_owned(), action, cause };
        let begun = Instant::now();
        loop {
            let created = create(dir).map_err(error(FolderAction::Create))?;
            let lock = match FolderLock::take(dir, on_wait) {
                Ok(lock) => lock,
                // A run that failed has just removed the folder that it had created.
                Err(cause)
                    if cause.kind() == io::ErrorKind::NotFound
                        && begun.elapsed() < Duration::from_secs(1) =>
                {
                    continue;
                }
                Err(cause) => return Err(error(FolderAction::Enter)(cause)),
            };
            let staging = Unfinished::make(Removal::FolderWithFiles, || {
                Ok((tempfile::Builder::new().prefix(STAGING).tempdir_in(dir)?.keep(), ()))
            });
            let (staging, ()) = staging.map_err(error(FolderAction::Enter))?;
            let (durability, names) = (Durability::default(), Mutex::default());
            return Ok(Self {
                dir: dir.to_owned(),
                durability,
                names,
                staging,
                _lock: lock,
                created,
            });
        }
    }

    /// Sets whether the run waits for the disk; it does not by default.
    #[must_use]
    pub fn with(mut self, durability: Durability) -> Self {
        self.durability = durability;
        self
    }

    /// Writes one file, which does not appear yet; `write` receives a buffered writer. Several may be
    /// written at the same time.
    ///
    /// # Errors
    /// [`FolderError`] if the file cannot be created or `write` fails.
    pub fn file(
        &self,
        name: impl AsRef<OsStr>,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<(), FolderError> {
        let name = name.as_ref();
        self.stage_file(name, write)
            .map_err(|cause| self.error(FolderAction::Write(lossy(name)), cause))?;
        self.names.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned());
        Ok(())
    }

    fn stage_file(
        &self,
        name: &OsStr,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> io::Result<()> {
        let held = hold_off_the_end();
        let file = File::create(self.staged(name))?;
        drop(held);
        let mut buffered = BufWriter::with_capacity(1 << 16, file);
        write(&mut buffered)?;
        let file = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
        match self.durability {
            Durability::InMemory => Ok(()),
            Durability::OnDisk => as_far_as_supported(file.sync_all()),
        }
    }

    /// Gives all files their names, the file `last` after all others.
    ///
    /// `owned` are the names that this program may write. What an earlier run left of these and of
    /// the names of this one is removed first, `last` before all others: at no moment are files of
    /// two runs there, and a folder with `last` holds a whole run.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be removed or written; no file `last` is
    /// there then. If a folder has the name of a file, nothing is changed.
    pub fn commit(mut self, last: impl AsRef<OsStr>, owned: &[&str]) -> Result<(), FolderError> {
        let last = last.as_ref();
        let mut names = self.take_names()?;
        let held = hold_off_the_end();
        if self.dir.join(last).exists() {
            self.remove(last)?;
            self.sync()?;
        }
        owned
            .iter()
            .map(OsStr::new)
            .chain(names.iter().map(|name| &**name))
            .try_for_each(|name| self.remove(name))?;
        let end = names.take(last);
        self.rename(&names)?;
        self.rename(&end)?;
        // Someone who removes the folder meanwhile may have removed some of them, and not the last.
        if let Some(name) = names.iter().find(|name| !self.dir.join(name).exists()) {
            self.remove(last)?;
            let cause = io::Error::other("it was removed meanwhile");
            return Err(self.error(FolderAction::Write(lossy(name)), cause));
        }
        drop(held);
        self.keep()
    }

    /// Gives all files their names in the place of those that have them: at no moment is a name
    /// without a whole file, and each keeps the permissions of the one before it.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be written; if a folder has its name, no file is
    /// changed.
    pub fn replace(mut self) -> Result<(), FolderError> {
        let names = self.take_names()?;
        let held = hold_off_the_end();
        for name in &names {
            // A file system without permissions has none to keep.
            let _ = fs::metadata(self.dir.join(name))
                .map(|old| fs::set_permissions(self.staged(name), old.permissions()));
        }
        self.rename(&names)?;
        drop(held);
        self.keep()
    }

    /// Names of all files; refuses one that a folder has.
    fn take_names(&mut self) -> Result<BTreeSet<OsString>, FolderError> {
        let names = std::mem::take(self.names.get_mut().unwrap_or_else(PoisonError::into_inner));
        match names.iter().find(|name| self.dir.join(name).is_dir()) {
            None => Ok(names),
            Some(name) => {
                let cause = io::Error::other("a folder has this name");
                Err(self.error(FolderAction::Write(lossy(name)), cause))
            }
        }
    }

    /// Where a file is before it has its name.
    fn staged(&self, name: &OsStr) -> PathBuf {
        self.staging.path().join(name)
    }

    fn rename<'a>(&self, names: impl IntoIterator<Item = &'a OsString>) -> Result<(), FolderError> {
        for name in names {
            let renamed = fs::rename(self.staged(name), self.dir.join(name));
            renamed.map_err(|cause| self.error(FolderAction::Write(lossy(name)), cause))?;
        }
        self.sync()
    }

    fn remove(&self, name: &OsStr) -> Result<(), FolderError> {
        match fs::remove_file(self.dir.join(name)) {
            Err(cause) if cause.kind() != io::ErrorKind::NotFound => {
                Err(self.error(FolderAction::Remove(lossy(name)), cause))
            }
            _ => Ok(()),
        }
    }

    /// Waits until the names in the folder are on the disk, if the run waits for it.
    fn sync(&self) -> Result<(), FolderError> {
        match self.durability {
            Durability::InMemory => Ok(()),
            Durability::OnDisk => {
                sync_folder(&self.dir).map_err(|cause| self.error(FolderAction::Enter, cause))
            }
        }
    }

    /// Keeps the folders that were created.
    fn keep(mut self) -> Result<(), FolderError> {
        for folder in std::mem::take(&mut self.created) {
            let above = folder_of(folder.path()).to_owned();
            folder.keep();
            if self.durability == Durability::OnDisk {
                sync_folder(&above).map_err(|cause| self.error(FolderAction::Create, cause))?;
            }
        }
        Ok(())
    }

    fn error(&self, action: FolderAction, cause: io::Error) -> FolderError {
        FolderError { folder: self.dir.clone(), action, cause }
    }
}

/// Creates a folder; returns those that were not there before, the innermost first.
fn create(dir: &Path) -> io::Result<Vec<Unfinished>> {
    let is_missing = |dir: &&Path| !dir.as_os_str().is_empty() && !dir.exists();
    let missing: Vec<&Path> = dir.ancestors().take_while(is_missing).collect();
    let mut created = Vec::new();
    for folder in missing.into_iter().rev() {
        let make = || fs::create_dir(folder).map(|()| (folder.to_owned(), ()));
        match Unfinished::make(Removal::EmptyFolder, make) {
            Ok((folder, ())) => created.insert(0, folder),
            // Another run is as fast.
            Err(cause) if cause.kind() == io::ErrorKind::AlreadyExists => {}
            Err(cause) => return Err(cause),
        }
    }
    fs::create_dir_all(dir)?;
    Ok(created)
}

/// The folder that a file lies in.
pub(super) fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// A name as messages show it.
fn lossy(name: &OsStr) -> String {
    name.to_string_lossy().into_owned()
}

/// Waits until the names in a folder are on the disk. Only Unix opens folders; Windows keeps their names
/// in order.
fn sync_folder(dir: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    as_far_as_supported(File::open(dir).and_then(|folder| folder.sync_all()))
}

/// Accepts the refusal of a network file system that cannot wait for the disk, and of a folder that may
/// be written but not read.
fn as_far_as_supported(synced: io::Result<()>) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    match synced {
        Err(cause) if matches!(cause.kind(), InvalidInput | PermissionDenied | Unsupported) => {
            Ok(())
        }
        synced => synced,
    }
}
