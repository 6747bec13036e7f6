//! `sweep`: many cases, a row of one table each.

mod cases;
mod command;
mod table;
mod tally;
mod work;

pub(crate) use command::Sweep;
