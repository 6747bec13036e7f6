//! Mathematics that knows no beam: time grids, Fourier pairs, roots, splines, units.

mod grid;

pub use grid::{ThinnedGrid, TimeGrid};
