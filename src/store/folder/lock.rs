use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use same_file::Handle;

use super::aside::remove_left;
use super::unfinished::{Unfinished, hold_off_the_end};

pub(super) const LOCK: &str = ".flexlink.lock";

/// How long a run waits for another that writes into the same folder.
const PATIENCE: Duration = Duration::from_secs(60);

/// How long it waits before it says so.
const SHORT: Duration = Duration::from_secs(1);

/// The right to write into a folder, of one run at a time.
#[derive(Debug)]
pub(super) struct FolderLock {
    path: PathBuf,
    // The system releases it with the process, however that ends.
    _file: File,
    _unfinished: Unfinished,
}

impl FolderLock {
    /// Creates `dir` where it is missing, waits for a run that writes there, and removes what a
    /// killed one has left; `on_wait` is called once if the wait is long.
    pub(super) fn take(dir: &Path, on_wait: &dyn Fn(&Path)) -> io::Result<Self> {
        Self::take_within(dir, PATIENCE, on_wait)
    }

    pub(super) fn take_within(
        dir: &Path,
        patience: Duration,
        on_wait: &dyn Fn(&Path),
    ) -> io::Result<Self> {
        let begun = Instant::now();
        let mut on_wait = Some(on_wait);
        loop {
            if let Some(lock) = Self::attempt(dir)? {
                return Ok(lock);
            }
            if begun.elapsed() > SHORT
                && let Some(tell) = on_wait.take()
            {
                tell(dir);
            }
            if begun.elapsed() > patience {
                let message = format!("another run has been writing into it for {patience:?}");
                return Err(io::Error::other(message));
            }
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Nothing where another run holds the lock, or has just removed it.
    fn attempt(dir: &Path) -> io::Result<Option<Self>> {
        let path = dir.join(LOCK);
        let held_off = hold_off_the_end();
        let (file, was_there) = match File::create_new(&path) {
            Ok(file) => (file, false),
            Err(cause) if cause.kind() == io::ErrorKind::AlreadyExists => match open(&path) {
                Err(_) if path.is_symlink() => {
                    let message = format!("{LOCK} in it is a link that leads nowhere");
                    return Err(io::Error::other(message));
                }
                Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(None),
                opened => (opened?, true),
            },
            Err(cause) => return Err(cause),
        };
        let locked = match file.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => return Ok(None),
            // A file system without locks has no say.
            Err(TryLockError::Error(_)) => false,
        };
        // The run before may have removed the file before it was locked here.
        if Handle::from_path(&path).ok() != Some(Handle::from_file(file.try_clone()?)?) {
            return Ok(None);
        }
        let unfinished = Unfinished::note(&path, &held_off);
        let lock = Self { path, _file: file, _unfinished: unfinished };
        // Without locks the files may be those of a run that goes on.
        if was_there && locked {
            remove_left(dir)?;
        }
        Ok(Some(lock))
    }
}

/// Another user's lock may be closed to writing; most systems lock it all the same.
fn open(path: &Path) -> io::Result<File> {
    let opened = File::options().read(true).write(true).open(path);
    opened.or_else(|cause| match cause.kind() {
        io::ErrorKind::PermissionDenied => File::open(path),
        _ => Err(cause),
    })
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Removed while it is held: who opened it meanwhile sees that it is not there any more.
        let _ = fs::remove_file(&self.path);
    }
}
