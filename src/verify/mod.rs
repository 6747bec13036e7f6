//! Is the answer right: every approximation of a solution measured by other means.

mod check;
mod limits;
mod measured;
mod playback;
mod report;
mod step;
mod transfer;

pub use check::{Check, Outcome};
pub use report::{Answer, Verification, VerificationError, verify};
