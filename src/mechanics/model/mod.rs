//! A link on a mesh under a motion of its tip, at one frequency.
//!
//! [`Model`] is the interface: torque, hub angle and nodes per unit of tip motion. Its implementations are the
//! recursion, modal superposition and the paper's assembled matrices ([`Dense`]), which check the other two.
//! [`model_of`] chooses one by the link's damping law and the modes to keep.

mod dense;
mod frequency_response;
mod link_on_mesh;
mod recursion;
mod superposition;

pub use dense::{Dense, MOST_ELEMENTS_OF_DENSE_SOLVE};
pub use frequency_response::{FrequencyResponse, Sensor, changes_on_halves, responses_with_weight};
pub use link_on_mesh::{KeptModes, LinkOnMesh, Model, ModelError};
pub(crate) use recursion::check_size;
pub use recursion::model_of;
