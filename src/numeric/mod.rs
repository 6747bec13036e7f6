//! Mathematics that knows no beam: time grids, Fourier pairs, roots, splines, units.

mod grid;
mod spline;
mod units;

pub use grid::{ThinnedGrid, TimeGrid};
pub use spline::{CubicSpline, SplineEnds};
pub use units::{Dimension, Unit, UnitError, parse_quantity};
