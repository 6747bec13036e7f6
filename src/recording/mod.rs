//! What a recorded motion is worth: the digits and the times of its samples, the rests at its ends.

mod digits;
mod rests;
mod times;

pub use digits::{Digits, Rounding};
pub use rests::{NoRest, rested};
pub use times::{LARGEST_JITTER, jitter};
