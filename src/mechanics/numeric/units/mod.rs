//! Values with their unit as text, such as `"5e4 N cm^2"`, and their conversion to SI.

mod known;
mod unit;

pub use known::Dimension;
pub(crate) use known::{may_count_turns, quantity_pattern, reads_as_unit};
pub(crate) use unit::split_number;
pub use unit::{Unit, UnitError, parse_quantity};
