//! Ctrl-C, and the system's request to end.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::terminal::{Exit, console};
use flexlink::store::abandon_unfinished;

static STOPPED: AtomicBool = AtomicBool::new(false);

/// From now on a request to end removes what is not finished and ends the program.
pub(crate) fn end_in_order() {
    listen(end);
}

/// From now on the first request to end turns the returned flag true, and leaves it to the work to
/// end in order; the second ends the program at once.
pub(crate) fn watch() -> &'static AtomicBool {
    listen(|signal| {
        if STOPPED.swap(true, Ordering::Relaxed) {
            end(signal);
        }
        console::line_below("finishing the cases that have begun; once more ends at once");
    });
    &STOPPED
}

/// From now on each request to end is told by its signal, but for those that the program was started
/// to ignore.
///
/// Where no thread is to be had that hears them they end the program as they do any other: the next
/// run removes what this one leaves.
#[cfg(unix)]
fn listen(asked: impl Fn(i32) + Send + 'static) {
    use std::sync::Arc;
    use std::thread;

    use flexlink::store::ignored_signals;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::flag::register_conditional_default;
    use signal_hook::iterator::Signals;

    const ALL: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];

    // Of a system that does not tell: to end with its terminal is what most often is not wanted.
    let ignored = ignored_signals(&ALL).unwrap_or_else(|| vec![SIGHUP]);
    let heard = ALL.iter().filter(|signal| !ignored.contains(signal));
    let Ok(mut signals) = Signals::new(heard.clone()) else { return };
    let listener = thread::Builder::new().spawn(move || signals.forever().for_each(asked));
    if listener.is_err() {
        for signal in heard {
            // Where that fails, too, the signal that cannot be caught is left.
            let _ = register_conditional_default(*signal, Arc::new(AtomicBool::new(true)));
        }
    }
}

#[cfg(not(unix))]
fn listen(asked: impl Fn(i32) + Send + 'static) {
    const CTRL_C: i32 = 2;
    let _ = ctrlc::try_set_handler(move || asked(CTRL_C));
}

#[expect(clippy::exit, reason = "whoever asks to end does not want to wait")]
#[cfg_attr(not(unix), expect(unused_variables, reason = "there is no signal to end by"))]
fn end(signal: i32) {
    abandon_unfinished();
    // A shell ends its script only if what it ran was ended by the signal.
    #[cfg(unix)]
    let _ = signal_hook::low_level::emulate_default_handler(signal);
    process::exit(Exit::Interrupted as i32);
}
