//! flexlink: the hub torque that makes the tip of a flexible link follow a wanted motion.

pub mod beam;
pub mod inverse;
pub mod link;
pub mod modal;
pub mod motion;
pub mod numeric;
pub mod spec;
pub mod tables;
