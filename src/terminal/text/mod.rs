//! Results in words, as the commands print them: lines of at most 80 columns.

mod compare;
mod lines;
mod modes;
mod repeat;
mod simulate;
mod solve;
mod trajectory;
mod verify;

pub(crate) use compare::{blessed_text, comparison_text};
pub(crate) use lines::counted;
pub(crate) use modes::modes_text;
pub(crate) use repeat::repetition_text;
pub(crate) use simulate::simulate_text;
pub(crate) use solve::{memory_text, solve_text};
pub(crate) use trajectory::{binding_text, found_text};
pub(crate) use verify::verify_text;
