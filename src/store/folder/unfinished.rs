use std::collections::BTreeSet;
use std::fs;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError, RwLock, RwLockReadGuard, TryLockError};
use std::thread;
use std::time::{Duration, Instant};

use super::lock::LOCK;

static PATHS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
static END: RwLock<()> = RwLock::new(());

/// A file or folder that goes if the program is ended now.
#[derive(Debug)]
pub(crate) struct Unfinished(PathBuf);

impl Unfinished {
    /// Notes what is there, or is about to be, while the end is held off.
    pub(crate) fn note(path: &Path, _: &HeldOff) -> Self {
        let [noted, own] = [path, path].map(Path::to_owned);
        PATHS.lock().unwrap_or_else(PoisonError::into_inner).insert(noted);
        Self(own)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        PATHS.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.0);
    }
}

/// What keeps [`abandon_unfinished`] waiting.
pub(crate) type HeldOff = RwLockReadGuard<'static, ()>;

/// Holds off the end until the guard is dropped; not to be asked for twice by one thread.
pub(crate) fn hold_off_the_end() -> HeldOff {
    END.read().unwrap_or_else(PoisonError::into_inner)
}

/// Returns if no end has begun, and else waits for it: what is missing then went with the end, and
/// nobody is to be told of it. Not to be called while the end is held off.
pub fn wait_if_ending() {
    drop(hold_off_the_end());
}

/// Removes all that is written aside and not finished, for a program that is about to end: files
/// that are taking their names take them first, and no file is begun or named afterwards.
pub fn abandon_unfinished() {
    mem::forget(END.write().unwrap_or_else(PoisonError::into_inner));
    remove_all(&mem::take(&mut *PATHS.lock().unwrap_or_else(PoisonError::into_inner)));
}

/// The same for a thread that may itself hold off the end: it waits no longer than `patience` for any
/// thread.
pub fn abandon_unfinished_soon(patience: Duration) {
    let begun = Instant::now();
    let is_time_left = || {
        thread::sleep(Duration::from_millis(1));
        begun.elapsed() < patience
    };
    loop {
        match END.try_write() {
            Ok(held) => break mem::forget(held),
            Err(TryLockError::Poisoned(held)) => break mem::forget(held.into_inner()),
            Err(TryLockError::WouldBlock) if is_time_left() => {}
            Err(TryLockError::WouldBlock) => break,
        }
    }
    loop {
        match PATHS.try_lock() {
            Ok(mut paths) => return remove_all(&mem::take(&mut *paths)),
            Err(TryLockError::Poisoned(paths)) => {
                return remove_all(&mem::take(&mut *paths.into_inner()));
            }
            Err(TryLockError::WouldBlock) if is_time_left() => {}
            Err(TryLockError::WouldBlock) => return,
        }
    }
}

fn remove_all(paths: &BTreeSet<PathBuf>) {
    // A lock after the files that it tells of: what cannot be removed is left to the next run.
    for path in paths.iter().filter(|path| !path.ends_with(LOCK)) {
        let _ = fs::remove_file(path);
    }
    // What lies in a folder before it; a folder goes only if nothing else is in it.
    for path in paths.iter().rev() {
        let _ = fs::remove_dir(path).or_else(|_| fs::remove_file(path));
    }
}
