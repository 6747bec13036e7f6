//! Memory, asked about before it is taken.

use flexlink::numeric::gigabytes;
use flexlink::tables::available_memory;

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

/// Memory in bytes that can be taken, where the system tells.
pub(crate) fn available() -> Option<usize> {
    available_memory().map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX))
}
