//! The physical link: segments, hub, lumped masses, payload and damping, checked at construction.
//!
//! A [`Link`] that exists is valid, so nothing downstream checks it again. It knows no file: an error names the
//! parameter by its dotted path, and the reader of the file adds the line.

mod arm;
mod builder;
mod damping;
#[expect(clippy::module_inception, reason = "the whole link")]
mod link;
mod parts;
mod section;
mod segment;

pub(crate) use arm::MOST_LINKS;
pub use arm::{Arm, ArmLink, ArmParts, Elbow};
pub use damping::Damping;
pub(crate) use damping::in_unit_interval;
pub use link::{Link, LinkParts};
#[cfg(test)]
pub(crate) use link::{uniform, uniform_segment};
pub use parts::{Drive, Gravity, Hub, Joint, LumpedMass, ParameterError, Payload};
pub(crate) use parts::{POSITION_TOLERANCE, not_negative, positive};
pub use section::Section;
pub use segment::{CrossSection, Segment, Taper, Timoshenko};
