//! Checks every approximation of a solution by other means.

mod check;
mod playback;
mod verification;

pub use check::{Answer, Check, Outcome, VerificationError};
pub use verification::{Verification, verify};
