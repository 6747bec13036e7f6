//! Memory, asked about before it is taken.

use flexlink::numeric::significant;
use flexlink::tables::available_memory;

use super::exit::{Exit, Failure};

/// Refuses work that takes more memory than there is; where that cannot be known, it goes on.
pub(crate) fn check_memory(work: &str, bytes: usize, remedy: &str) -> Result<(), Failure> {
    let Some(available) = available().filter(|available| bytes > *available) else {
        return Ok(());
    };
    let message = format!(
        "{work} would need {} of memory, but must fit in the {} available",
        gigabytes(bytes as f64),
        gigabytes(available as f64)
    );
    Err(Failure::new(Exit::NotSolvable, &message, Some(remedy)))
}

/// Memory in bytes that can be taken, where the system tells.
pub(crate) fn available() -> Option<usize> {
    available_memory().map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX))
}

/// Bytes in GB.
pub(crate) fn gigabytes(bytes: f64) -> String {
    format!("{} GB", significant(bytes / 1e9, 2))
}
