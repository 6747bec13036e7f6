//! Text of results for the commands: lines of at most 80 columns.

mod compare;
mod fit;
mod learn;
mod lines;
mod played;
mod robust;
mod solve;
mod tables;

pub(crate) use compare::{blessed_text, comparison_text, repetition_text};
pub(crate) use fit::fit_text;
pub(crate) use learn::learn_text;
pub(crate) use lines::{memory_text, rows_text};
pub(crate) use played::simulate_text;
pub(crate) use robust::robust_text;
pub(crate) use solve::solve_text;
pub(crate) use tables::{binding_text, found_text, is_limit_of_carriage, modes_text, verify_text};
