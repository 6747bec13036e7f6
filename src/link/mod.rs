//! The physical link: segments, hub, lumped masses, payload and damping, checked at construction.
//!
//! A [`Link`] that exists is valid, so nothing downstream checks it again. It knows no file; a
//! refusal names the parameter by its dotted path, and whoever read the file adds the line.

mod bodies;
mod cross_section;
mod damping;
mod drive;
mod error;
mod large_deflection;
mod section;
mod segment;
#[cfg(test)]
mod uniform;
mod whole;

pub use bodies::{Hub, LumpedMass, Payload};
pub use cross_section::CrossSection;
pub use damping::Damping;
pub(crate) use damping::in_unit_interval;
pub use drive::Drive;
pub use error::ParameterError;
pub use section::Section;
pub use segment::{Segment, Taper};
#[cfg(test)]
pub(crate) use uniform::{uniform, uniform_segment};
pub(crate) use whole::POSITION_TOLERANCE;
pub use whole::{Link, LinkParts};
