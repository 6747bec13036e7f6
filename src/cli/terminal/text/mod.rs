//! Text of results for the commands: lines of at most 80 columns.

mod arm;
mod compare;
mod fit;
mod layout;
mod played;
mod runs;
mod tables;

pub(crate) use arm::solve_text;
pub(crate) use compare::{blessed_text, comparison_text, counted, repetition_text};
pub(crate) use fit::fit_text;
pub(crate) use played::simulate_text;
pub(crate) use runs::{memory_text, rows_text};
pub(crate) use tables::{binding_text, found_text, modes_text, verify_text};
