//! Memory and threads available to a run.

use std::num::NonZero;

use clap::Args;
use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

use crate::system::{available_addresses, available_memory, is_data_limited};
use crate::text::gigabytes;

use super::allocator::{keep_freed_memory, limit_arenas, reserve};
use super::exit::{Exit, Failure};
use super::interrupt::end_aborts;

/// Address space in bytes that does not grow with the inputs: buffers, and the stacks of a few threads.
const OWN_BYTES: usize = 24 << 20;

/// Bytes of a limited address space for each arena.
const ARENA_SHARE: usize = 512 << 20;

/// Ratio of the share to an allocation above which it is not checked, because the check takes as long as a small run.
const SMALL: usize = 16;

/// Free memory in bytes, less the memory of the program itself. `None` if the system does not state it.
pub fn available() -> Option<usize> {
    available_memory().map(|bytes| size(bytes).saturating_sub(OWN_BYTES))
}

/// Address space in bytes below a limit (`ulimit -v`); `None` without a limit.
fn address_space() -> Option<usize> {
    available_addresses().map(size)
}

fn size(bytes: u64) -> usize {
    usize::try_from(bytes).unwrap_or(usize::MAX)
}

/// Returns an error if the limit of the address space is below the program's need. With a larger limit, threads share
/// arenas; without a limit, they keep the memory that they free. Call it before the program starts threads.
pub(crate) fn check_program() -> Result<(), Failure> {
    reserve();
    let Some(left) = address_space() else {
        keep_freed_memory();
        return Ok(());
    };
    if left < OWN_BYTES {
        return Err(too_much("the program", OWN_BYTES, left, "the system limits it (`ulimit -v`)"));
    }
    end_aborts();
    limit_arenas((left / ARENA_SHARE).max(1));
    Ok(())
}

/// Returns an error if nodal tables of `bytes` exceed the free memory, or their `share` of it.
pub fn check_nodes(bytes: usize, share: Option<usize>) -> Result<(), Failure> {
    check("the motion of the nodes", bytes, share, "use --nodes or --every")
}

/// Returns an error if tables exceed the free memory: their files have `bytes`, and the work on them needs `times` as
/// much.
pub(crate) fn check_tables(bytes: usize, times: usize) -> Result<(), Failure> {
    let bytes = bytes.saturating_mul(times);
    if bytes < OWN_BYTES / 2 {
        return Ok(());
    }
    let hint = "a result of fewer rows or nodes needs less (--nodes, --every)";
    check("the tables", bytes, None, hint)
}

/// Returns an error if `what` needs more bytes than the free memory, or than its `share` of it. A system that does not
/// state its free memory has no limit.
pub fn check(what: &str, bytes: usize, share: Option<usize>, hint: &str) -> Result<(), Failure> {
    if share.is_some_and(|share| bytes <= share / SMALL) {
        return Ok(());
    }
    match share.into_iter().chain(available()).min() {
        Some(available) if bytes > available => Err(too_much(what, bytes, available, hint)),
        _ => Ok(()),
    }
}

fn too_much(what: &str, bytes: usize, available: usize, hint: &str) -> Failure {
    let [bytes, available] = [bytes, available].map(gigabytes);
    let must = format!("but must fit in the {available} available");
    let message = format!("{what} would need {bytes} of memory, {must}");
    let failure = Failure::new(Exit::NotSolvable, &message, Some(hint));
    Failure { is_of_memory: true, ..failure }
}

/// Address space in bytes of a thread of a sweep: its stack, that of its worker thread, and the memory of a case.
const THREAD_BYTES: usize = 2 * ((2 << 20) + (1 << 18)) + (8 << 20);

/// How many threads to use.
#[derive(Debug, Default, Args)]
pub(crate) struct ThreadArgs {
    /// Threads to use [default: all cores]; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// Starts the threads; the calling thread is the first. Call it once, before any work.
    ///
    /// If the system has no threads left and the command line gives no number, the calling thread does all the work.
    pub(crate) fn start(&self) -> Result<(), Failure> {
        let (builder, is_limited) = self.builder();
        // The global pool would wait for the start of all threads, as long as a small run.
        match builder.use_current_thread().build() {
            Ok(pool) => {
                // The threads serve until the program ends.
                let pool = Box::leak(Box::new(pool));
                if is_limited {
                    pool.broadcast(|_| ());
                }
                Ok(())
            }
            Err(error) if self.threads.is_some() => Err(no_threads(&error)),
            Err(_) => Ok(()),
        }
    }

    /// Starts the threads besides the calling one, which only waits for them.
    pub(crate) fn start_apart(&self) -> Result<(), Failure> {
        let (builder, is_limited) = self.builder();
        builder.build_global().map_err(|error| no_threads(&error))?;
        if is_limited {
            rayon::broadcast(|_| ());
        }
        Ok(())
    }

    /// A pool of threads that fit into a limited address space, and true if addresses or data are limited. Every
    /// thread must then take its memory before the work begins. Glibc aborts the program without our message if a
    /// thread has too little memory for its first thread-local value.
    fn builder(&self) -> (ThreadPoolBuilder, bool) {
        let threads = self.threads.map(usize::from);
        let most = address_space().map(|left| left.saturating_sub(OWN_BYTES) / THREAD_BYTES);
        let threads = match most {
            Some(most) => threads.unwrap_or_else(default_number).min(most.max(1)),
            None => threads.unwrap_or(0),
        };
        (ThreadPoolBuilder::new().num_threads(threads), most.is_some() || is_data_limited())
    }
}

/// Default number of threads, as in rayon.
fn default_number() -> usize {
    let set = std::env::var("RAYON_NUM_THREADS").ok().and_then(|number| number.parse().ok());
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    set.filter(|threads| *threads > 0).unwrap_or_else(cores)
}

fn no_threads(error: &ThreadPoolBuildError) -> Failure {
    let hint = "the system limits threads and memory (`ulimit -u`, `ulimit -v`)";
    Failure::new(Exit::NotSolvable, &format!("cannot start threads: {error}"), Some(hint))
}
