//! Threads for one process.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

use flexlink::cli::terminal::{Exit, Failure};
use flexlink::system::{Stopped, stop_by};
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// The threads, and the process that started them. A child of `fork` has the memory of its parent, but not its threads:
/// it would wait for them forever, as in a `multiprocessing.Pool`.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Does work on the threads of this process: one for each core, or RAYON_NUM_THREADS.
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
    // The parent's threads do not exist here and cannot end.
    std::mem::forget(pool.replace((own, Arc::clone(&threads))));
    Ok(threads)
}

/// Does work that holds a lock, on separate threads. A waiting thread of the shared pool could take up another call,
/// which then waits for the lock.
pub(crate) fn apart<T: Send>(
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    started(0)?.install(work)
}

/// Does work on separate threads, which end it when `stop` turns true.
pub(crate) fn stoppable<T: Send>(
    stop: &Arc<AtomicBool>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let flag = Arc::clone(stop);
    let builder = ThreadPoolBuilder::new().start_handler(move |_| stop_by(Arc::clone(&flag)));
    let threads = builder.build().map_err(|error| not_started(&error))?;
    match catch_unwind(AssertUnwindSafe(|| threads.install(work))) {
        Ok(found) => found,
        Err(panic) if panic.is::<Stopped>() => {
            Err(Failure::new(Exit::Interrupted, &"interrupted", None))
        }
        Err(panic) => resume_unwind(panic),
    }
}

/// A pool of this many threads; one for each core at 0.
pub(crate) fn started(threads: usize) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| not_started(&error))
}

fn not_started(error: &ThreadPoolBuildError) -> Failure {
    Failure::new(Exit::NotSolvable, &format!("cannot start threads: {error}"), None)
}
