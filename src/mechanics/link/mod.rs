//! The physical link: segments, hub, lumped masses, payload and damping, checked at construction.
//!
//! A [`Link`] that exists is valid, so nothing downstream checks it again. It knows no file: an error names the
//! parameter by its dotted path, and the reader of the file adds the line.

mod arm;
mod joint;
#[expect(clippy::module_inception, reason = "the whole link")]
mod link;
mod parts;
mod segment;

pub(crate) use arm::MOST_LINKS;
pub use arm::{Arm, ArmCarriage, ArmLink, ArmParts, Elbow};
pub use joint::Joint;
pub use link::{Link, LinkParts};
#[cfg(test)]
pub(crate) use link::{uniform, uniform_segment};
pub use parts::{
    Carriage, Damping, Drive, Gravity, Hub, Lossy, LumpedMass, MotorKnown, ParameterError, Payload,
};
pub(crate) use parts::{POSITION_TOLERANCE, in_unit_interval, not_negative, positive};
pub use segment::{CrossSection, Section, Segment, Taper, Timoshenko};
