//! `compare`: tables against tables, within tolerances.

mod command;
mod sides;

pub(crate) use command::Compare;
