//! Memory, asked about before it is taken.

use flexlink::csv::{available_addresses, available_memory};
use flexlink::numeric::gigabytes;

use super::allocator::share_arenas;
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
    let failure = Failure::new(Exit::NotSolvable, &message, Some(hint));
    Err(Failure { is_of_memory: true, ..failure })
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

/// Address space in bytes of a thread of a sweep: its stack, that of the thread that it begins for its
/// own work, and the memory of a case.
const THREAD_BYTES: usize = 2 * ((2 << 20) + (1 << 18)) + (8 << 20);

/// Refuses to begin where the address space is limited to less than this program takes.
///
/// If the limit is larger, threads share the C library's arenas, so that these reserve little address
/// space. Call it before the program starts threads.
pub(crate) fn check_room() -> Result<(), Failure> {
    let Some(left) = addresses_left() else { return Ok(()) };
    if left < OWN_BYTES {
        let message = format!(
            "the program would need {} of memory, but must fit in the {} available",
            gigabytes(OWN_BYTES),
            gigabytes(left)
        );
        let hint = "the system limits it (`ulimit -v`)";
        return Err(Failure::new(Exit::NotSolvable, &message, Some(hint)));
    }
    share_arenas(left);
    Ok(())
}

/// How many threads there is room for where the address space is limited, at least one.
pub(crate) fn most_threads() -> Option<usize> {
    let left = addresses_left()?;
    Some((left.saturating_sub(OWN_BYTES) / THREAD_BYTES).max(1))
}

fn addresses_left() -> Option<usize> {
    available_addresses().map(|left| usize::try_from(left).unwrap_or(usize::MAX))
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
