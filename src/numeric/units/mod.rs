//! Values that carry their unit as text, such as `"5e4 N cm^2"`, and the SI value they stand for.

mod dimension;
mod known;
mod quantity;
mod unit;

pub use dimension::Dimension;
pub(crate) use known::{quantity_pattern, reads_as_unit};
pub use quantity::parse_quantity;
pub(crate) use quantity::split_number;
pub use unit::{Unit, UnitError};
