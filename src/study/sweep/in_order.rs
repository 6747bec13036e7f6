//! Work on many cases in parallel, with their results in order.

use std::collections::BTreeMap;
use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use rayon::ThreadPoolBuilder;

/// Computes many cases on all threads of the current pool, and passes the results to `take` in the order of the cases,
/// each as soon as all before it are done.
///
/// A case has one thread, or an even share of them if there are fewer cases than threads. When `stop` becomes true, or
/// `take` fails, running cases end and no other begins: the results passed to `take` have no gap.
///
/// The working threads themselves call `take`, one at a time.
///
/// # Errors
/// The first error of `take`.
pub fn in_order<T: Send, E: Send>(
    cases: Range<usize>,
    stop: &AtomicBool,
    work: impl Fn(usize) -> T + Sync,
    take: impl FnMut(usize, T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let threads = rayon::current_num_threads();
    let workers = threads.min(cases.len());
    if workers == 0 {
        return Ok(());
    }
    let next = AtomicUsize::new(cases.start);
    let failed = AtomicBool::new(false);
    let done = Done { waiting: BTreeMap::new(), due: cases.start, take: Some(take) };
    let done = Mutex::new(done);
    let worker = || {
        // Parallel work within a case uses these threads. If the system has no more threads, it shares the threads of
        // the whole program.
        let _own =
            ThreadPoolBuilder::new().num_threads(threads / workers).use_current_thread().build();
        while !stop.load(Ordering::Relaxed) && !failed.load(Ordering::Relaxed) {
            let case = next.fetch_add(1, Ordering::Relaxed);
            if case >= cases.end {
                break;
            }
            hand_over(&done, case, work(case))
                .inspect_err(|_| failed.store(true, Ordering::Relaxed))?;
        }
        Ok(())
    };
    thread::scope(|scope| {
        let begin = |_| thread::Builder::new().spawn_scoped(scope, worker).ok();
        let begun: Vec<_> = (0..workers).filter_map(begin).collect();
        if begun.is_empty() {
            return worker();
        }
        let ended = begun.into_iter().map(|one| one.join().unwrap_or_else(|it| resume_unwind(it)));
        // All threads end before the error is returned.
        ended.fold(Ok(()), Result::and)
    })
}

/// Finished results that were not yet passed to `take`.
struct Done<T, F> {
    waiting: BTreeMap<usize, T>,
    /// The next case for `take`.
    due: usize,
    /// `None` while a thread calls it, and after it failed.
    take: Option<F>,
}

/// Passes a case and all that waited for it to `take`, unless an earlier one is unfinished or another thread is calling
/// `take` and will pass this one.
fn hand_over<T, E>(
    done: &Mutex<Done<T, impl FnMut(usize, T) -> Result<(), E>>>,
    case: usize,
    found: T,
) -> Result<(), E> {
    let mut now = locked(done);
    now.waiting.insert(case, found);
    let Some(mut take) = now.take.take() else { return Ok(()) };
    loop {
        let due = now.due;
        let Some(found) = now.waiting.remove(&due) else { break };
        drop(now);
        take(due, found)?;
        now = locked(done);
        now.due += 1;
    }
    now.take = Some(take);
    Ok(())
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
    }

    /// Uneven work with inner parallelism.
    fn sum(case: usize) -> usize {
        let terms = 1000 * (case % 7);
        (0..terms).into_par_iter().map(|k| k % 3).sum::<usize>() + case
    }

    #[test]
    fn rows_come_in_order_on_any_number_of_threads() {
        let go = AtomicBool::new(false);
        let rows = |threads| {
            on_threads(threads, || {
                let mut rows = Vec::new();
                let take = |case, sum| {
                    rows.push((case, sum));
                    Ok::<(), ()>(())
                };
                in_order(3..200, &go, sum, take).unwrap();
                rows
            })
        };
        let expected: Vec<_> = (3..200).map(|case| (case, sum(case))).collect();
        for threads in [1, 2, 7, 300] {
            assert_eq!(rows(threads), expected, "{threads} threads");
        }
    }

    #[test]
    fn nothing_is_missing_before_the_case_at_which_it_was_stopped() {
        let stop = AtomicBool::new(false);
        let mut rows = Vec::new();
        let work = |case| {
            if case == 50 {
                stop.store(true, Ordering::Relaxed);
            }
            case
        };
        let take = |case, done| {
            assert_eq!(case, done);
            rows.push(case);
            Ok::<(), ()>(())
        };
        on_threads(4, || in_order(0..10_000, &stop, work, take)).unwrap();
        assert!((51..10_000).contains(&rows.len()), "{} rows", rows.len());
        assert!(rows.iter().copied().eq(0..rows.len()));
    }

    #[test]
    fn a_row_that_is_not_taken_ends_the_work() {
        let stop = AtomicBool::new(false);
        let begun = AtomicUsize::new(0);
        let work = |case| {
            begun.fetch_add(1, Ordering::Relaxed);
            case
        };
        let take = |case, _| if case == 5 { Err("full") } else { Ok(()) };
        let ended = on_threads(2, || in_order(0..1_000_000, &stop, work, take));
        assert_eq!(ended, Err("full"));
        assert!(begun.load(Ordering::Relaxed) < 1_000_000);
    }
}
