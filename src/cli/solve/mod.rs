//! `solve`: link and motion in, torque out; with `--repeat`, a run done again.

mod command;
mod repeat;
pub mod run;
mod table;

pub(crate) use command::Solve;
