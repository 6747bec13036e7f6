//! The physical link: segments, hub, lumped masses, payload and damping, checked at construction.
//!
//! A [`Link`] that exists is valid, so nothing downstream checks it again. It knows no file; a
//! refusal names the parameter by its dotted path, and whoever read the file adds the line.

mod builder;
mod damping;
mod error;
mod joint;
mod large_deflection;
mod section;
mod segment;
mod whole;

pub use builder::LinkBuilder;
pub use damping::Damping;
pub(crate) use damping::in_unit_interval;
pub use error::ParameterError;
pub use joint::{Drive, Hub, Joint};
pub use section::Section;
pub use segment::{CrossSection, Segment, Taper};
pub(crate) use whole::POSITION_TOLERANCE;
pub use whole::{Link, LinkParts, LumpedMass, Payload};
#[cfg(test)]
pub(crate) use whole::{uniform, uniform_segment};
