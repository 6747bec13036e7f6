//! Ctrl-C, and the system's request to end.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use flexlink::tables::abandon_unfinished;

use super::console;
use super::exit::Exit;

static STOPPED: AtomicBool = AtomicBool::new(false);

/// From now on a request to end removes what is not finished and ends the program.
pub(crate) fn end_in_order() {
    // Where signals are ignored, as under nohup, or cannot be heard they stay as they are: the next
    // run removes what this one leaves.
    let _ = ctrlc::try_set_handler(end);
}

/// From now on the first request to end turns the returned flag true, and leaves it to the work to
/// end in order; the second ends the program at once.
pub(crate) fn watch() -> &'static AtomicBool {
    let asked = || {
        if STOPPED.swap(true, Ordering::Relaxed) {
            end();
        }
        console::note("finishing the cases that have begun; once more ends at once");
    };
    // As above; whole rows are on the disk.
    let _ = ctrlc::try_set_handler(asked);
    &STOPPED
}

#[expect(clippy::exit, reason = "whoever asks to end does not want to wait")]
fn end() {
    abandon_unfinished();
    // A shell ends its script only if what it ran was ended by the signal.
    #[cfg(unix)]
    let _ = signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGINT);
    process::exit(Exit::Interrupted as i32);
}
