//! Unfinished files of a run, and the locks that make runs take turns.
//!
//! The list holds every path that a run may have to remove, so that an interrupted program removes it.

use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io;
use std::mem;
use std::path::{self, Path, PathBuf};
use std::sync::{self, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use same_file::Handle;

/// Longest wait of a run for another that holds a lock.
pub(super) const PATIENCE: Duration = Duration::from_secs(60);

/// Wait of a run before it reports the wait.
const SHORT: Duration = Duration::from_secs(1);

/// Function that removes a file, or a folder with its files.
type Removal = fn(&Path) -> io::Result<()>;

type Paths = BTreeMap<PathBuf, Removal>;

static UNFINISHED: Mutex<Paths> = Mutex::new(BTreeMap::new());

/// A file or folder that its drop, or the end of the program, removes.
#[derive(Debug)]
pub(super) struct Unfinished(PathBuf);

impl Unfinished {
    /// Makes a file or folder and notes it. `make` returns its path and something more; after an error of `make`
    /// nothing is noted.
    pub(super) fn make<T>(
        removal: Removal,
        make: impl FnOnce() -> io::Result<(PathBuf, T)>,
    ) -> io::Result<(Self, T)> {
        let mut paths = hold_off_the_end();
        let (path, made) = make()?;
        // Absolute paths sort a folder before its files.
        let path = path::absolute(path)?;
        paths.insert(path.clone(), removal);
        Ok((Self(path), made))
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let mut paths = hold_off_the_end();
        if let Some(remove) = paths.remove(&self.0) {
            // The next run removes the remains.
            let _ = remove(&self.0);
        }
    }
}

/// Delays [`abandon_unfinished`] until the guard drops. Meanwhile the same thread must neither call this function
/// again nor make or drop an [`Unfinished`].
pub(super) fn hold_off_the_end() -> MutexGuard<'static, Paths> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns unless the program is ending. Then it never returns, because the end may have removed files whose absence
/// is no error to report.
pub fn wait_if_ending() {
    drop(hold_off_the_end());
}

/// Number of tries of a thread to hold off the end, and the wait between two tries.
const TRIES: usize = 50;
const BETWEEN_TRIES: Duration = Duration::from_millis(2);

/// Removes all unfinished files of a program that is about to exit. A run that is renaming its files finishes first;
/// afterwards no thread creates or renames a file of a run.
pub fn abandon_unfinished() {
    abandon(hold_off_the_end());
}

/// [`abandon_unfinished`] for a thread that may be creating or renaming files. It waits for other threads that do,
/// but not for long, and then removes nothing.
pub fn try_abandon_unfinished() {
    for _ in 0..TRIES {
        match UNFINISHED.try_lock() {
            Ok(paths) => return abandon(paths),
            Err(sync::TryLockError::Poisoned(poisoned)) => return abandon(poisoned.into_inner()),
            Err(sync::TryLockError::WouldBlock) => thread::sleep(BETWEEN_TRIES),
        }
    }
}

fn abandon(paths: MutexGuard<Paths>) {
    // The reverse order removes files before their folder.
    for (path, remove) in paths.iter().rev() {
        let _ = remove(path);
    }
    mem::forget(paths);
}

/// A lock file, which one run at a time holds and removes at its end.
#[derive(Debug)]
pub(super) struct Lock {
    // Removed before the file closes: a run that has opened it meanwhile sees its removal.
    _path: Unfinished,
    /// The system releases its lock with the process, however that ends.
    _file: File,
    /// False on a file system without locks: runs do not wait for each other there.
    pub(super) is_exclusive: bool,
}

impl Lock {
    /// Waits up to `patience` for a run that holds the lock; calls `on_wait` once if the wait is long.
    pub(super) fn take(path: &Path, patience: Duration, on_wait: &dyn Fn()) -> io::Result<Self> {
        let begun = Instant::now();
        let mut has_called = false;
        loop {
            let locked = Unfinished::make(
                |path| fs::remove_file(path),
                || {
                    let file = open(path)?;
                    let is_exclusive = lock(&file, path)?;
                    Ok((path.to_owned(), (file, is_exclusive)))
                },
            );
            match locked {
                Ok((path, (file, is_exclusive))) => {
                    return Ok(Self { _path: path, _file: file, is_exclusive });
                }
                // Another run holds the lock, or has just removed it.
                Err(cause) if cause.kind() == io::ErrorKind::WouldBlock => {}
                Err(cause) => return Err(cause),
            }
            if begun.elapsed() > SHORT && !mem::replace(&mut has_called, true) {
                on_wait();
            }
            if begun.elapsed() > patience {
                let message = format!("another run has been writing into it for {patience:?}");
                return Err(io::Error::other(message));
            }
            thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Locks a file, opened at `path`, for this run alone; false on a file system without locks.
///
/// # Errors
/// [`io::ErrorKind::WouldBlock`] if another run holds the lock, or has removed the file since.
pub(super) fn lock(file: &File, path: &Path) -> io::Result<bool> {
    let is_locked = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::WouldBlock) => return Err(io::ErrorKind::WouldBlock.into()),
        Err(TryLockError::Error(_)) => false,
    };
    if Handle::from_path(path).ok() != Some(Handle::from_file(file.try_clone()?)?) {
        return Err(io::ErrorKind::WouldBlock.into());
    }
    Ok(is_locked)
}

/// Creates or opens a lock file, but never creates one at the target of a link.
fn open(path: &Path) -> io::Result<File> {
    match File::create_new(path) {
        Err(cause) if cause.kind() == io::ErrorKind::AlreadyExists => {}
        created => return created,
    }
    // A lock of another user may be read-only; most systems lock it all the same.
    let opened = File::options().read(true).write(true).open(path);
    opened.or_else(|_| File::open(path)).map_err(|cause| match cause.kind() {
        _ if path.is_symlink() => {
            let name = path.file_name().unwrap_or_default().display();
            io::Error::other(format!("{name} in it is a link that leads nowhere"))
        }
        io::ErrorKind::NotFound => io::ErrorKind::WouldBlock.into(),
        _ => cause,
    })
}
