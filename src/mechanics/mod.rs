//! The mechanics: from a motion to torques, and back. It reads no file and prints nothing.

pub mod beam;
pub mod elastica;
pub mod inverse;
pub mod link;
pub mod modal;
pub mod model;
pub mod motion;
pub mod numeric;
pub mod recording;
pub mod response;
pub mod system;
pub mod text;
