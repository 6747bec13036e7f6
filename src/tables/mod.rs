//! CSV ⇄ data: every column's name and unit once; reading, and writing whole files or none.

mod number;
mod time_format;

pub use number::{Digits, DigitsError, NumberFormat};
pub use time_format::time_format;
