//! `solve`: link and motion in, torque out; with `--repeat`, the repetition of a run.

mod command;
mod repeat;
pub mod run;
mod table;

pub(crate) use command::Solve;
