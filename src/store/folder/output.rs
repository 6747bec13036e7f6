use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use super::aside::{Aside, sync_folder};
use super::error::{FolderAction, FolderError};
use super::lock::FolderLock;
use super::unfinished::{HeldOff, Unfinished, hold_off_the_end, wait_if_ending};

/// Whether a run waits until its files are on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Durability {
    /// It does not: files are whole however the run ends, but a power failure soon after it may cut them
    /// short.
    #[default]
    InMemory,
    /// It waits for each file before that takes its name, and for the folder afterwards: a power failure
    /// leaves whole files or none.
    OnDisk,
}

/// A folder that receives all files of a run, or none.
///
/// Every file is written aside, under a name that begins with a dot, and takes its own name only in
/// [`commit`](Self::commit). Dropped without it, the folder is left as it was found. Another run that
/// writes into the folder is waited for.
#[derive(Debug)]
pub struct OutputFolder {
    dir: PathBuf,
    durability: Durability,
    /// Behind a lock: files are written at the same time, and end in any order.
    staged: Mutex<Vec<Aside>>,
    lock: Option<FolderLock>,
    /// Folders that were not there before, the innermost first.
    created: Vec<(PathBuf, Unfinished)>,
}

impl OutputFolder {
    /// Opens `dir` for a run's files, creating it and the folders above it where they are missing.
    /// If another run writes into it for more than a second, `on_wait` is called once.
    ///
    /// # Errors
    /// [`FolderError`] if the folder cannot be created, or another run keeps writing into it.
    pub fn stage(dir: &Path, on_wait: &dyn Fn(&Path)) -> Result<Self, FolderError> {
        let mut folder = Self {
            dir: dir.to_owned(),
            durability: Durability::default(),
            staged: Mutex::default(),
            lock: None,
            created: Vec::new(),
        };
        let begun = Instant::now();
        while folder.lock.is_none() {
            folder.create().map_err(|cause| folder.error(FolderAction::Create, cause))?;
            match FolderLock::take(dir, on_wait) {
                Ok(lock) => folder.lock = Some(lock),
                // A run that failed has just removed the folder that it had created.
                Err(cause) if is_gone(&cause) && begun.elapsed().as_secs() < 1 => {}
                Err(cause) => return Err(folder.error(FolderAction::Enter, cause)),
            }
        }
        Ok(folder)
    }

    /// Sets whether the run waits for the disk; it does not by default.
    #[must_use]
    pub fn with(mut self, durability: Durability) -> Self {
        self.durability = durability;
        self
    }

    /// Writes one file aside; `write` receives a buffered writer. Several may be written at the same
    /// time.
    ///
    /// # Errors
    /// [`FolderError`] if the file cannot be created or `write` fails.
    pub fn file(
        &self,
        name: impl AsRef<OsStr>,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<(), FolderError> {
        let name = name.as_ref();
        let aside = Aside::write(&self.dir, name, write)
            .map_err(|cause| self.error(FolderAction::Write(lossy(name)), cause))?;
        self.staged.lock().unwrap_or_else(PoisonError::into_inner).push(aside);
        Ok(())
    }

    /// Gives all files their names, the file `last` after all others.
    ///
    /// `owned` are the names that this program may write. What an earlier run left of these and of
    /// the names of this one is removed first, `last` before all others: at no moment are files of
    /// two runs there, and who sees `last`, sees a whole run.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be removed or written; no file `last` is
    /// there then. Where a folder has the name of a file, nothing is changed.
    pub fn commit(mut self, last: impl AsRef<OsStr>, owned: &[&str]) -> Result<(), FolderError> {
        let last = last.as_ref();
        let staged = self.take_staged();
        self.refuse_folders(&staged)?;
        self.sync_files(&staged)?;
        // From here on: who is ended meanwhile must not tell of files that are gone.
        let held_off = hold_off_the_end();
        if self.dir.join(last).exists() {
            self.remove(last)?;
            self.sync_names()?;
        }
        owned.iter().try_for_each(|name| self.remove(OsStr::new(name)))?;
        staged.iter().try_for_each(|aside| self.remove(&aside.name))?;
        let (end, others): (Vec<_>, Vec<_>) =
            staged.into_iter().partition(|file| file.name == last);
        let names: Vec<_> = others.iter().map(|file| file.name.clone()).collect();
        self.name(others, &held_off)?;
        self.name(end, &held_off)?;
        // Who removes the folder meanwhile may have met these, and not the last.
        if let Some(name) = names.iter().find(|name| !self.dir.join(name).exists()) {
            self.remove(last)?;
            let cause = io::Error::other("it was removed meanwhile");
            return Err(self.error(FolderAction::Write(lossy(name)), cause));
        }
        self.keep()
    }

    /// Gives all files their names in the place of those that have them: at no moment is a name
    /// without a whole file, and each keeps the permissions of the one before it.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be written; where a folder has its name, no
    /// file is changed.
    pub fn replace(mut self) -> Result<(), FolderError> {
        let staged = self.take_staged();
        self.refuse_folders(&staged)?;
        self.sync_files(&staged)?;
        let held_off = hold_off_the_end();
        for aside in &staged {
            aside.take_permissions_of(&self.dir.join(&aside.name));
        }
        self.name(staged, &held_off)?;
        self.keep()
    }

    /// Creates the folder, and notes which folders were not there.
    fn create(&mut self) -> io::Result<()> {
        let held_off = hold_off_the_end();
        self.created.clear();
        let missing = self.dir.ancestors().take_while(|dir| {
            let named = !dir.as_os_str().is_empty();
            named && !dir.exists()
        });
        self.created =
            missing.map(|dir| (dir.to_owned(), Unfinished::note(dir, &held_off))).collect();
        fs::create_dir_all(&self.dir)
    }

    /// All files that are aside, in an order that does not depend on which was written first.
    fn take_staged(&mut self) -> Vec<Aside> {
        let staged = self.staged.get_mut().unwrap_or_else(PoisonError::into_inner);
        staged.sort_by(|a, b| a.name.cmp(&b.name));
        std::mem::take(staged)
    }

    fn refuse_folders(&self, staged: &[Aside]) -> Result<(), FolderError> {
        let Some(aside) = staged.iter().find(|aside| self.dir.join(&aside.name).is_dir()) else {
            return Ok(());
        };
        let cause = io::Error::other("a folder has this name");
        Err(self.error(FolderAction::Write(lossy(&aside.name)), cause))
    }

    fn sync_files(&self, staged: &[Aside]) -> Result<(), FolderError> {
        if self.durability == Durability::InMemory {
            return Ok(());
        }
        staged.chunks(AT_ONCE).try_for_each(sync_together).map_err(|(name, cause)| {
            // Nothing holds off the end here: the disk may take its time.
            wait_if_ending();
            self.error(FolderAction::Write(name), cause)
        })
    }

    fn sync_names(&self) -> Result<(), FolderError> {
        if self.durability == Durability::InMemory {
            return Ok(());
        }
        sync_folder(&self.dir).map_err(|cause| self.error(FolderAction::Enter, cause))
    }

    /// Gives files their names, for good.
    fn name(&self, files: Vec<Aside>, held_off: &HeldOff) -> Result<(), FolderError> {
        for file in files {
            let name = lossy(&file.name);
            let named = file.take_name(&self.dir, held_off);
            named.map_err(|cause| self.error(FolderAction::Write(name), cause))?;
        }
        self.sync_names()
    }

    /// Keeps the folders that were created, for good.
    fn keep(&mut self) -> Result<(), FolderError> {
        for (dir, _) in std::mem::take(&mut self.created) {
            let above = dir.parent().filter(|above| !above.as_os_str().is_empty());
            if self.durability == Durability::OnDisk {
                let synced = sync_folder(above.unwrap_or(Path::new(".")));
                synced.map_err(|cause| self.error(FolderAction::Create, cause))?;
            }
        }
        Ok(())
    }

    fn remove(&self, name: &OsStr) -> Result<(), FolderError> {
        match fs::remove_file(self.dir.join(name)) {
            Err(cause) if cause.kind() != io::ErrorKind::NotFound => {
                Err(self.error(FolderAction::Remove(lossy(name)), cause))
            }
            _ => Ok(()),
        }
    }

    fn error(&self, action: FolderAction, cause: io::Error) -> FolderError {
        FolderError { folder: self.dir.clone(), action, cause }
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // The files first: a folder goes only when it is empty.
        drop(self.take_staged());
        self.lock = None;
        for (dir, _) in &self.created {
            // Someone else's file may be there by now; then the folder stays, rightly.
            let _ = fs::remove_dir(dir);
        }
    }
}

/// A name as a message tells it.
fn lossy(name: &OsStr) -> String {
    name.to_string_lossy().into_owned()
}

/// Files that are waited for together.
const AT_ONCE: usize = 16;

/// Waits for files at once, which the system then writes down together; else the name of the first
/// that cannot be written.
fn sync_together(files: &[Aside]) -> Result<(), (String, io::Error)> {
    let failed = |file: &Aside| {
        let name = lossy(&file.name);
        move |cause| (name, cause)
    };
    let [first, others @ ..] = files else { return Ok(()) };
    thread::scope(|scope| {
        let wait = |file| thread::Builder::new().spawn_scoped(scope, move || Aside::sync(file));
        let waits: Vec<_> = others.iter().map(|file| (file, wait(file))).collect();
        first.sync().map_err(failed(first))?;
        waits.into_iter().try_for_each(|(file, wait)| {
            // Where there is no thread to be had, or it ended badly, this one waits.
            let synced = wait.ok().and_then(|wait| wait.join().ok());
            synced.unwrap_or_else(|| file.sync()).map_err(failed(file))
        })
    })
}

/// Whether a folder is not there any more.
fn is_gone(cause: &io::Error) -> bool {
    cause.kind() == io::ErrorKind::NotFound
}
