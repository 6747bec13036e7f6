//! Mathematics that knows no beam: time grids, Fourier pairs, roots, eigenvalues, splines, units.

mod complex_lanes;
mod eigen;
mod fft;
mod fourier;
mod grid;
mod lanes;
mod largest;
mod magnitude;
mod roots;
mod round;
mod sampling;
mod scalar;
mod significant;
mod spline;
mod sum;
mod uniform;
mod units;
mod upsampling;
mod visible;
#[cfg(test)]
mod wide;

pub(crate) use complex_lanes::{ComplexLanes, LambdaLanes};
pub(crate) use eigen::SymmetricEigen;
pub use fft::Scratch;
pub use fourier::{FourierPair, angular_frequency, fast_length};
pub use grid::{ThinnedGrid, TimeGrid};
pub(crate) use lanes::RealLanes;
pub use largest::{largest, largest_difference};
pub use magnitude::magnitude;
pub use roots::{SECTIONS, geometric_scan, next_places, root};
pub(crate) use round::rounded;
pub(crate) use sampling::{CHANNELS, Room, Sampling};
pub use scalar::{Scalar, Size};
pub use significant::{gigabytes, plain, significant};
pub use spline::{CubicSpline, SplineEnds};
pub(crate) use sum::sum_over;
pub use uniform::NotUniform;
pub use units::{Dimension, Unit, UnitError, parse_quantity};
pub(crate) use units::{quantity_pattern, reads_as_unit, split_number};
pub use visible::{excerpt, is_hidden, visible, visible_document};
#[cfg(test)]
pub(crate) use wide::{Wide, WideComplex};
