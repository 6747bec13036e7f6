//! The lock that makes runs into one folder take turns, and removes what a killed run left there.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use same_file::Handle;

use super::unfinished::{Removal, Unfinished};

pub(super) const LOCK: &str = ".flexlink.lock";

/// How the folder begins in which a run writes its files. It sorts after [`LOCK`], so that a program that
/// is ended removes the lock last: a lock that is found tells the next run of files that were left.
pub(super) const STAGING: &str = ".flexlink.run-";

/// How long a run waits for another that writes into the same folder.
const PATIENCE: Duration = Duration::from_secs(60);

/// How long it waits before it says so.
const SHORT: Duration = Duration::from_secs(1);

/// The right to write into a folder, of one run at a time.
#[derive(Debug)]
pub(super) struct FolderLock {
    // Removed before the file is closed: a run that has opened it meanwhile sees that it is gone.
    _path: Unfinished,
    // The system releases the lock with the process, however that ends.
    _file: File,
}

impl FolderLock {
    /// Waits for a run that writes into `folder`, then removes what a killed run left there. `on_wait` is
    /// called once if the wait is long.
    pub(super) fn take(folder: &Path, on_wait: &dyn Fn(&Path)) -> io::Result<Self> {
        Self::take_within(folder, PATIENCE, on_wait)
    }

    pub(super) fn take_within(
        folder: &Path,
        patience: Duration,
        on_wait: &dyn Fn(&Path),
    ) -> io::Result<Self> {
        let begun = Instant::now();
        let mut on_wait = Some(on_wait);
        loop {
            match Self::attempt(folder) {
                Err(cause) if cause.kind() == io::ErrorKind::WouldBlock => {}
                attempted => return attempted,
            }
            if begun.elapsed() > SHORT
                && let Some(tell) = on_wait.take()
            {
                tell(folder);
            }
            if begun.elapsed() > patience {
                let message = format!("another run has been writing into it for {patience:?}");
                return Err(io::Error::other(message));
            }
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// [`io::ErrorKind::WouldBlock`] if another run holds the lock, or has just removed it.
    fn attempt(folder: &Path) -> io::Result<Self> {
        let path = folder.join(LOCK);
        let taken = || -> io::Result<_> {
            let (file, was_there) = open(&path)?;
            let is_locked = lock(&file, &path)?;
            Ok((path.clone(), (file, was_there && is_locked)))
        };
        let (noted, (file, is_left)) = Unfinished::make(Removal::File, taken)?;
        let lock = Self { _path: noted, _file: file };
        if is_left {
            remove_left(folder)?;
        }
        Ok(lock)
    }
}

/// Locks a file that was opened at `path`, for this run alone; false on a file system without locks, where
/// runs do not wait for each other.
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

/// Creates or opens the lock file; also returns whether it was there.
fn open(path: &Path) -> io::Result<(File, bool)> {
    match File::create_new(path) {
        Err(cause) if cause.kind() == io::ErrorKind::AlreadyExists => {}
        created => return Ok((created?, false)),
    }
    // A lock of another user may be read-only; most systems lock it all the same.
    let opened = File::options().read(true).write(true).open(path);
    match opened.or_else(|_| File::open(path)) {
        Ok(file) => Ok((file, true)),
        Err(_) if path.is_symlink() => {
            let message = format!("{LOCK} in it is a link that leads nowhere");
            Err(io::Error::other(message))
        }
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => {
            Err(io::ErrorKind::WouldBlock.into())
        }
        Err(cause) => Err(cause),
    }
}

fn remove_left(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let is_staging = entry.file_name().to_string_lossy().starts_with(STAGING);
        if is_staging && entry.file_type()?.is_dir() {
            // One of another user may have to stay.
            let _ = fs::remove_dir_all(entry.path());
        }
    }
    Ok(())
}
