//! Memory, asked about before it is taken.

use flexlink::numeric::gigabytes;
use flexlink::tables::available_memory;

use super::exit::{Exit, Failure};

/// Refuses nodal tables that take more memory than there is; where that cannot be known, it goes
/// on.
pub(crate) fn check_nodal_memory(bytes: usize) -> Result<(), Failure> {
    let Some(available) = available().filter(|available| bytes > *available) else {
        return Ok(());
    };
    let message = format!(
        "the motion of the nodes would need {} of memory, but must fit in the {} available",
        gigabytes(bytes),
        gigabytes(available)
    );
    Err(Failure::new(Exit::NotSolvable, &message, Some("use --nodes or --every")))
}

/// Memory in bytes that can be taken, where the system tells.
pub(crate) fn available() -> Option<usize> {
    available_memory().map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX))
}
