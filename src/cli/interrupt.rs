//! Ctrl-C, and the system's request to end.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use super::exit::Exit;

static STOPPED: AtomicBool = AtomicBool::new(false);

/// From now on the first request to end turns the returned flag true, and leaves it to the work to
/// end in order; the second ends the program at once.
pub(crate) fn watch() -> &'static AtomicBool {
    #[expect(clippy::exit, reason = "whoever asks twice does not want to wait")]
    let asked = || {
        if STOPPED.swap(true, Ordering::Relaxed) {
            process::exit(Exit::Interrupted as i32);
        }
    };
    // A system that cannot be asked ends the program its own way; whole rows are on the disk.
    let _ = ctrlc::set_handler(asked);
    &STOPPED
}
