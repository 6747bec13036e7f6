//! Values that carry their unit as text, such as `"5e4 N cm^2"`, and the SI value they stand for.

mod dimension;
mod error;
mod known;
mod pattern;
mod quantity;
mod unit;

pub use dimension::Dimension;
pub use error::UnitError;
pub(crate) use known::reads_as_unit;
pub(crate) use pattern::quantity_pattern;
pub use quantity::parse_quantity;
pub(crate) use quantity::split_number;
pub use unit::Unit;
