//! Signals: Ctrl-C, the system's request to end, and the abort when it refuses memory.

use std::process;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::store::abandon_unfinished;

use super::console;
use super::exit::Exit;

static STOPPED: AtomicBool = AtomicBool::new(false);

/// Number of running cases.
static AT_WORK: AtomicUsize = AtomicUsize::new(0);

/// Time for last writes after a request to end, without a running case: a pipe without a reader takes nothing.
const LAST_WRITES: Duration = Duration::from_secs(2);

/// Makes a request to end remove unfinished files and end the program.
pub(crate) fn end_in_order() {
    listen(end);
}

/// Makes an abort end the program with exit code 4. Under a limit of the address space the C library aborts, after a
/// message, when it finds no memory for itself.
pub(crate) fn end_aborts() {
    #[cfg(unix)]
    {
        use signal_hook::{consts::SIGABRT, flag::register_conditional_shutdown};

        let always = std::sync::Arc::new(AtomicBool::new(true));
        let _ = register_conditional_shutdown(SIGABRT, Exit::NotSolvable as i32, always);
    }
}

/// Makes the first request to end set the returned flag, so that the work ends in order, and the second one end the
/// program at once. The first one also ends the program if writing lasts while no case is [`at_work`].
pub(crate) fn watch() -> &'static AtomicBool {
    listen(|signal| {
        if STOPPED.swap(true, Ordering::Relaxed) {
            end(signal);
        }
        // In a separate thread, because standard error may be the pipe that takes nothing.
        let _ = thread::Builder::new().spawn(move || end_idle(signal));
        console::line_below("finishing the cases that have begun; a second signal ends at once");
    });
    &STOPPED
}

/// Works on a case of a sweep; a request to end waits for it.
pub(crate) fn at_work<T>(work: impl FnOnce() -> T) -> T {
    AT_WORK.fetch_add(1, Ordering::Relaxed);
    let found = work();
    AT_WORK.fetch_sub(1, Ordering::Relaxed);
    found
}

/// Ends the program when no case has run for a while.
fn end_idle(signal: i32) {
    let mut busy = Instant::now();
    while busy.elapsed() < LAST_WRITES {
        thread::sleep(Duration::from_millis(50));
        if AT_WORK.load(Ordering::Relaxed) > 0 {
            busy = Instant::now();
        }
    }
    end(signal);
}

/// Makes a thread call `on_signal` with each signal that requests the end, except signals that the program was started
/// to ignore. Without memory for a thread such a signal ends the program in the default way, and the next run removes
/// the remains.
#[cfg(unix)]
fn listen(on_signal: impl Fn(i32) + Send + 'static) {
    use std::sync::mpsc;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    // If the system gives no mask, SIGHUP stays untouched, because `nohup` has it ignored.
    let ignored = ignored_mask(&status).unwrap_or(bit(SIGHUP));
    let heard =
        [SIGINT, SIGTERM, SIGHUP].into_iter().filter(move |signal| ignored & bit(*signal) == 0);
    let (ready, is_ready) = mpsc::channel::<()>();
    let listener = thread::Builder::new().spawn(move || {
        let signals = Signals::new(heard);
        drop(ready);
        if let Ok(mut signals) = signals {
            signals.forever().for_each(on_signal);
        }
    });
    // Returns an error when the listener drops its side: then it is ready.
    let _ = listener.map(|_| is_ready.recv());
}

#[cfg(not(unix))]
fn listen(on_signal: impl Fn(i32) + Send + 'static) {
    const CTRL_C: i32 = 2;
    let _ = ctrlc::try_set_handler(move || on_signal(CTRL_C));
}

/// Signals that the program was started to ignore, such as SIGHUP by `nohup` and SIGINT by a shell for a background
/// command of a script. They are the hexadecimal `SigIgn` in the system's status of the process.
#[cfg(unix)]
fn ignored_mask(status: &str) -> Option<u64> {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

/// Bit n − 1 of the mask stands for signal n.
#[cfg(unix)]
fn bit(signal: i32) -> u64 {
    1 << (signal - 1)
}

#[expect(clippy::exit, reason = "the user does not want to wait")]
#[cfg_attr(not(unix), expect(unused_variables, reason = "there is no signal to end by"))]
fn end(signal: i32) {
    abandon_unfinished();
    // A shell ends its script only if the signal ended the script's command.
    #[cfg(unix)]
    let _ = signal_hook::low_level::emulate_default_handler(signal);
    process::exit(Exit::Interrupted as i32);
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn the_mask_of_ignored_signals_is_read_from_the_status() {
        let status = "Name:\tflexlink\nSigBlk:\tffffffffffffffff\nSigIgn:\t8000000000000003\n";
        let mask = ignored_mask(status).unwrap();
        let ignored: Vec<i32> = (1..=64).filter(|signal| mask & bit(*signal) != 0).collect();
        assert_eq!(ignored, [1, 2, 64]);
        assert_eq!(ignored_mask("Name:\tflexlink\n"), None);
        assert_eq!(ignored_mask("SigIgn:\tmany\n"), None);
    }
}
