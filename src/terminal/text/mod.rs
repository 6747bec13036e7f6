//! Results in words, as the commands print them: lines of at most 80 columns.

mod checks;
mod compare;
mod lines;
mod modes;
mod simulate;
mod solve;

pub(crate) use checks::{binding_text, found_text, repetition_text, verify_text};
pub(crate) use compare::{blessed_text, comparison_text};
pub(crate) use lines::counted;
pub(crate) use modes::modes_text;
pub(crate) use simulate::simulate_text;
pub(crate) use solve::{memory_text, solve_text};
