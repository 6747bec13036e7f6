//! Threads that work for one process.

use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::terminal::{Exit, Failure};

/// The threads, and the process that started them. A child of `fork` has the memory of its parent, but not its threads:
/// it would wait for them forever, as in a `multiprocessing.Pool`.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Does work on the threads of this process, as many as cores or as RAYON_NUM_THREADS says.
pub(crate) fn install<T: Send>(
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    ours()?.install(work)
}

fn ours() -> Result<Arc<ThreadPool>, Failure> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let own = process::id();
    if let Some((of, threads)) = &*pool
        && *of == own
    {
        return Ok(Arc::clone(threads));
    }
    let threads = Arc::new(started(0)?);
    // The parent's threads are not here to be ended.
    std::mem::forget(pool.replace((own, Arc::clone(&threads))));
    Ok(threads)
}

/// The same on threads of its own, for work that holds a lock: one of the threads of all calls, while it waits, may take
/// up another call, which then waits for that lock.
pub(crate) fn apart<T: Send>(
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    started(0)?.install(work)
}

/// So many threads, or as many as cores for 0.
pub(crate) fn started(threads: usize) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        Failure::new(Exit::NotSolvable, &format!("cannot start threads: {error}"), None)
    })
}
