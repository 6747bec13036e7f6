//! Mathematics that knows no beam: time grids, Fourier pairs, roots, eigenvalues, splines, units, Student's
//! distribution.

mod eigen;
mod fft;
mod grid;
mod legendre;
mod roots;
mod sampling;
mod scalar;
mod spline;
mod student;
mod units;

pub(crate) use eigen::SymmetricEigen;
pub use fft::FourierPair;
pub(crate) use fft::{angular_frequency, fast_length};
pub use grid::{NotUniform, ThinnedGrid, TimeGrid};
pub(crate) use legendre::{GaussRule, piece_shapes};
pub use roots::root;
pub(crate) use roots::{SECTIONS, geometric_scan, next_places};
pub(crate) use sampling::{PANEL, Sampling, Transforms};
#[cfg(test)]
pub(crate) use scalar::wide::Wide;
pub use scalar::{Scalar, Size, largest, largest_difference, magnitude};
pub(crate) use scalar::{dot, extremes, relative_change, rounded};
pub(crate) use spline::{CubicSpline, QuinticSpline, SplineEnds, TimeCurve};
pub use student::{NORMAL_95, student_95};
pub use units::{Dimension, Unit, UnitError, parse_quantity};
pub(crate) use units::{
    may_count_turns, parse_hertz, quantity_pattern, reads_as_unit, split_number,
};
