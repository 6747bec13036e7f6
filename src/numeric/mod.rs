//! Mathematics that knows no beam: time grids, Fourier pairs, roots, splines, units.

mod grid;
mod units;

pub use grid::{ThinnedGrid, TimeGrid};
pub(crate) use units::split_number;
pub use units::{Dimension, Unit, UnitError, parse_quantity};
