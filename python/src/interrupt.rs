//! Ctrl-C during long work.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::messages::Raised;
use flexlink::cli::terminal::Failure;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::pool;

/// Time between two checks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);

/// Does work in a thread while this one asks Python for Ctrl-C. After Ctrl-C `stop` is true, and the work ends.
pub(crate) fn interruptible<T: Send>(
    work: impl FnOnce(&Arc<AtomicBool>) -> Result<T, Failure> + Send,
) -> Result<T, Raised> {
    let stop = &Arc::new(AtomicBool::new(false));
    let (done, is_done) = channel();
    thread::scope(|scope| {
        let worker = scope.spawn(move || done.send(work(stop)));
        let mut pressed: Option<PyErr> = None;
        loop {
            match is_done.recv_timeout(LOOK) {
                Ok(found) => {
                    return match pressed {
                        None => Ok(found?),
                        Some(error) => Err(error.into()),
                    };
                }
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(error) = Python::attach(check_signals) {
                        stop.store(true, Ordering::Relaxed);
                        pressed = Some(error);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => match worker.join() {
                    Err(panic) => resume_unwind(panic),
                    Ok(_) => return Err(PyRuntimeError::new_err("the work has no result").into()),
                },
            }
        }
    })
}

/// Does long work on separate threads, without Python, until Ctrl-C.
pub(crate) fn until_pressed<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Raised> {
    py.detach(|| interruptible(|stop| pool::stoppable(stop, work)))
}

fn check_signals(py: Python<'_>) -> PyResult<()> {
    py.check_signals()
}
