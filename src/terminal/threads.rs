//! The threads that share the work of a run.

use std::num::NonZero;

use clap::Args;
use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

use super::exit::{Exit, Failure};
use super::memory::available_address_space;

/// Address space in bytes of a thread of a sweep: for itself and for the thread that it starts for its
/// own work a stack and an arena of the C library each, and the memory of a case.
const THREAD_BYTES: usize = 2 * ((2 << 20) + (1 << 18) + (64 << 20)) + (8 << 20);

/// How many threads to use.
#[derive(Debug, Default, Args)]
pub(crate) struct ThreadArgs {
    /// Threads to use [default: all cores]; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// Starts the threads; the calling thread is the first of them. Call it once, before any work.
    ///
    /// If the system has no threads left and the user has not asked for a number, the calling thread
    /// does all the work.
    pub(crate) fn start(&self) -> Result<(), Failure> {
        let (builder, is_limited) = builder(self.threads);
        // The global pool would wait until all threads run, as long as a small run takes.
        match builder.use_current_thread().build() {
            Ok(pool) => {
                // The threads serve until the program ends.
                let pool = Box::leak(Box::new(pool));
                if is_limited {
                    pool.broadcast(|_| ());
                }
                Ok(())
            }
            Err(error) if self.threads.is_some() => Err(refused(&error)),
            Err(_) => Ok(()),
        }
    }

    /// Starts the threads beside the calling one, which only waits for them.
    pub(crate) fn start_apart(&self) -> Result<(), Failure> {
        let (builder, is_limited) = builder(self.threads);
        builder.build_global().map_err(|error| refused(&error))?;
        if is_limited {
            rayon::broadcast(|_| ());
        }
        Ok(())
    }
}

/// A pool of the threads that are asked for, at most as many as a limited address space holds; and
/// whether it is limited: then every thread takes its memory before the work begins.
fn builder(asked: Option<u16>) -> (ThreadPoolBuilder, bool) {
    let asked = asked.map(usize::from);
    let most = available_address_space().map(|left| (left / THREAD_BYTES).max(1));
    let threads = match most {
        Some(most) => asked.unwrap_or_else(default_number).min(most),
        None => asked.unwrap_or(0),
    };
    (ThreadPoolBuilder::new().num_threads(threads), most.is_some())
}

/// Number of threads by default, as rayon counts them.
fn default_number() -> usize {
    let set = std::env::var("RAYON_NUM_THREADS").ok().and_then(|number| number.parse().ok());
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    set.filter(|threads| *threads > 0).unwrap_or_else(cores)
}

fn refused(error: &ThreadPoolBuildError) -> Failure {
    let hint = "the system limits threads and memory (`ulimit -u`, `ulimit -v`)";
    Failure::new(Exit::NotSolvable, &format!("cannot start threads: {error}"), Some(hint))
}
