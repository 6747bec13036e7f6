//! Free memory, compared with what a command is about to take.

use flexlink::csv::{available_addresses, available_memory};
use flexlink::numeric::gigabytes;

use super::exit::{Exit, Failure};

/// Address space in bytes that the program takes besides what grows with its inputs: buffers, and the
/// stacks of a few threads.
const OWN_BYTES: usize = 24 << 20;

/// An allocation below this part of the share is not checked: the check takes as long as a small run.
const SMALL: usize = 16;

/// Memory in bytes that can be taken besides [`OWN_BYTES`], where the system tells.
pub(crate) fn available() -> Option<usize> {
    available_memory().map(|bytes| size(bytes).saturating_sub(OWN_BYTES))
}

/// Address space in bytes that a limit (`ulimit -v`) leaves besides [`OWN_BYTES`]; `None`: no limit.
pub(crate) fn available_address_space() -> Option<usize> {
    available_addresses().map(|bytes| size(bytes).saturating_sub(OWN_BYTES))
}

fn size(bytes: u64) -> usize {
    usize::try_from(bytes).unwrap_or(usize::MAX)
}

/// Returns an error if the address space is limited to less than the program itself takes.
pub(crate) fn check_program() -> Result<(), Failure> {
    let Some(left) = available_addresses().map(size).filter(|left| *left < OWN_BYTES) else {
        return Ok(());
    };
    let hint = "the system limits it (`ulimit -v`)";
    Err(too_much("the program", OWN_BYTES, left, hint))
}

/// Returns an error if nodal tables of so many bytes exceed the free memory, or their `share` of it.
pub(crate) fn check_nodes(bytes: usize, share: Option<usize>) -> Result<(), Failure> {
    check("the motion of the nodes", bytes, share, "use --nodes or --every")
}

/// Returns an error if tables exceed the free memory: their files have so many bytes, and the work on
/// them takes so many `times` that.
pub(crate) fn check_tables(bytes: usize, times: usize) -> Result<(), Failure> {
    let bytes = bytes.saturating_mul(times);
    if bytes < OWN_BYTES / 2 {
        return Ok(());
    }
    let hint = "a result of fewer rows or nodes needs less (--nodes, --every)";
    check("the tables", bytes, None, hint)
}

/// Returns an error if `what` takes more bytes than the free memory, or than its `share` of it. A
/// system that does not tell its free memory has no limit.
pub(crate) fn check(
    what: &str,
    bytes: usize,
    share: Option<usize>,
    hint: &str,
) -> Result<(), Failure> {
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
