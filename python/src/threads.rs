//! Threads for one process, and Ctrl-C during long work.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};

use flexlink::system::{Stopped, stop_by};

use crate::prelude::*;

/// The threads, and the process that started them. A child of `fork` has the memory of its parent, but not its threads:
/// it would wait for them forever, as in a `multiprocessing.Pool`.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Time between two checks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);

/// Does work without Python on the threads of this process: one for each core, or RAYON_NUM_THREADS.
pub(crate) fn without_python<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Fails<T> + Send,
) -> Raises<T> {
    Ok(py.detach(|| ours()?.install(work))?)
}

fn ours() -> Fails<Arc<ThreadPool>> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let this = process::id();
    if let Some((of, threads)) = &*pool
        && *of == this
    {
        return Ok(Arc::clone(threads));
    }
    let threads = Arc::new(started(ThreadPoolBuilder::new())?);
    // The parent's threads do not exist here and cannot end.
    std::mem::forget(pool.replace((this, Arc::clone(&threads))));
    Ok(threads)
}

/// Does work that holds a lock, without Python, on separate threads. A waiting thread of the shared pool could take up
/// another call, which then waits for the lock.
pub(crate) fn apart<T: Send>(py: Python<'_>, work: impl FnOnce() -> Fails<T> + Send) -> Raises<T> {
    Ok(py.detach(|| started(ThreadPoolBuilder::new())?.install(work))?)
}

/// Starts threads, one for each core unless the builder has another number.
pub(crate) fn started(builder: ThreadPoolBuilder) -> Fails<ThreadPool> {
    let refused = |error| format!("cannot start threads: {error}");
    builder.build().map_err(|error| Failure::new(Exit::NotSolvable, &refused(error), None))
}

/// Does long work without Python on separate threads, until Ctrl-C.
pub(crate) fn until_pressed<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Fails<T> + Send,
) -> Raises<T> {
    interruptible(py, |stop| {
        let flag = Arc::clone(stop);
        let builder = ThreadPoolBuilder::new().start_handler(move |_| stop_by(Arc::clone(&flag)));
        let threads = started(builder)?;
        match catch_unwind(AssertUnwindSafe(|| threads.install(work))) {
            Ok(result) => result,
            Err(panic) if panic.is::<Stopped>() => {
                Err(Failure::new(Exit::Interrupted, &"interrupted", None))
            }
            Err(panic) => resume_unwind(panic),
        }
    })
}

/// Does work without Python in a thread while this one asks Python for Ctrl-C. After Ctrl-C `stop` is true, and the work
/// ends.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Arc<AtomicBool>) -> Fails<T> + Send,
) -> Raises<T> {
    let stop = &Arc::new(AtomicBool::new(false));
    py.detach(|| {
        let (done, is_done) = channel();
        thread::scope(|scope| {
            let worker = scope.spawn(move || done.send(work(stop)));
            let mut pressed: Option<PyErr> = None;
            loop {
                match is_done.recv_timeout(LOOK) {
                    Ok(result) => {
                        break pressed.map_or_else(|| Ok(result?), |error| Err(error.into()));
                    }
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(error) = Python::attach(check_signals) {
                            stop.store(true, Ordering::Relaxed);
                            pressed = Some(error);
                        }
                    }
                    Err(RecvTimeoutError::Disconnected) => {
                        let none = PyRuntimeError::new_err("the work has no result");
                        break worker
                            .join()
                            .map_or_else(|panic| resume_unwind(panic), |_| Err(none.into()));
                    }
                }
            }
        })
    })
}

fn check_signals(py: Python<'_>) -> PyResult<()> {
    py.check_signals()
}
