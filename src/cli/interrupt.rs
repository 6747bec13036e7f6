//! Ctrl-C, and the system's request to end.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use super::console;
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
        console::note("finishing the cases that have begun; once more ends at once");
    };
    // Where signals are ignored, as under nohup, or cannot be heard they stay as they are: whole rows
    // are on the disk.
    let _ = ctrlc::try_set_handler(asked);
    &STOPPED
}
