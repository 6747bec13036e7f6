//! What a recorded motion is worth: the digits and the times of its samples, the rests at its ends.

mod digits;
mod times;

pub use digits::{Digits, Rounding};
pub use times::{LARGEST_JITTER, NoRest, jitter, rested};
