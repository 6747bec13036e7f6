//! Mathematics that knows no beam: time grids, Fourier pairs, roots, splines, units.

mod grid;
mod spline;

pub use grid::{ThinnedGrid, TimeGrid};
pub use spline::{CubicSpline, SplineEnds};
