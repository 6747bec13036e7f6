//! Is the answer right: every approximation of a solution measured by other means.

mod check;
mod playback;
mod report;
mod transfer;

pub use check::{Check, Outcome};
pub use report::{Answer, Verification, VerificationError, verify};
