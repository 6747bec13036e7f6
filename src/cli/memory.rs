//! Memory, asked about before it is taken.

use flexlink::numeric::gigabytes;
use flexlink::tables::{available_addresses, available_memory};

use super::exit::{Exit, Failure};

/// Refuses nodal tables that take more memory than there is, or than `share` of it is theirs.
pub(crate) fn check_nodal_memory(bytes: usize, share: Option<usize>) -> Result<(), Failure> {
    check_memory("the motion of the nodes", bytes, share, "use --nodes or --every")
}

/// Refuses a page that takes more memory than there is, or than `share` of it is its own.
pub(crate) fn check_page_memory(bytes: usize, share: Option<usize>) -> Result<(), Failure> {
    check_memory("the page", bytes, share, "leave --report out, or use --nodes or --every")
}

/// What was available before is still there for so small a part of it: to ask costs as much as a small
/// run.
const SMALL: usize = 16;

/// Refuses what takes more memory than there is, or than `share` of it is its own; where neither is
/// known, it goes on.
pub(crate) fn check_memory(
    what: &str,
    bytes: usize,
    share: Option<usize>,
    hint: &str,
) -> Result<(), Failure> {
    if share.is_some_and(|share| bytes <= share / SMALL) {
        return Ok(());
    }
    let least = share.into_iter().chain(available()).min();
    let Some(available) = least.filter(|available| bytes > *available) else {
        return Ok(());
    };
    let message = format!(
        "{what} would need {} of memory, but must fit in the {} available",
        gigabytes(bytes),
        gigabytes(available)
    );
    Err(Failure::new(Exit::NotSolvable, &message, Some(hint)))
}

/// Keeps memory that a run frees, some megabytes for each thread, for what it takes next.
///
/// Otherwise the C library gives small amounts back to the system after every case of a sweep and takes
/// them again for the next one, page by page, with all threads interrupted each time. glibc adapts to
/// the largest block that was freed; with other libraries this has no effect.
pub(crate) fn keep_freed() {
    const BYTES: usize = 4 << 20;
    let mut block = Vec::<u8>::new();
    // Where there is not so much, nothing is gained, and the run goes on.
    _ = block.try_reserve_exact(BYTES);
    drop(std::hint::black_box(block));
}

/// Memory in bytes that can be taken besides [`OWN_BYTES`], where the system tells.
pub(crate) fn available() -> Option<usize> {
    let bytes = available_memory().map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX));
    bytes.map(|bytes| bytes.saturating_sub(OWN_BYTES))
}

/// Address space in bytes that the program takes besides what grows with its inputs: buffers, and the
/// stacks of a few threads.
const OWN_BYTES: usize = 24 << 20;

/// Address space in bytes of one more thread, and of one that it begins for its own work.
const THREAD_BYTES: usize = 2 * ((2 << 20) + (1 << 18));

/// Refuses to begin where the address space is limited to less than this program takes with `threads`
/// threads of its own beyond the first few.
pub(crate) fn check_room(threads: usize) -> Result<(), Failure> {
    let bytes = OWN_BYTES + threads * THREAD_BYTES;
    let left = available_addresses().map(|left| usize::try_from(left).unwrap_or(usize::MAX));
    let Some(left) = left.filter(|left| *left < bytes) else { return Ok(()) };
    let message = format!(
        "the program would need {} of memory, but must fit in the {} available",
        gigabytes(bytes),
        gigabytes(left)
    );
    let hint = "the system limits it (`ulimit -v`); fewer --threads need less";
    Err(Failure::new(Exit::NotSolvable, &message, Some(hint)))
}

/// Refuses tables whose files have so many bytes, and take so many times that to work with, where
/// there is not so much memory.
pub(crate) fn check_tables_memory(bytes: usize, times: usize) -> Result<(), Failure> {
    let bytes = bytes.saturating_mul(times);
    // To ask costs more than what is small takes.
    if bytes < OWN_BYTES / 2 {
        return Ok(());
    }
    check_memory(
        "the tables",
        bytes,
        None,
        "a result of fewer rows or nodes needs less (--nodes, --every)",
    )
}

/// From now on memory that the system refuses, where no estimate has foreseen it, ends the program as
/// any other refusal does, by its exit code; the library says how much was asked for.
pub(crate) fn end_where_memory_does() {
    #[cfg(unix)]
    {
        use std::sync::Arc;
        use std::sync::atomic::AtomicBool;

        use signal_hook::{consts::SIGABRT, flag::register_conditional_shutdown};

        let always = Arc::new(AtomicBool::new(true));
        // Where that fails the program is aborted.
        let _ = register_conditional_shutdown(SIGABRT, Exit::NotSolvable as i32, always);
    }
}
