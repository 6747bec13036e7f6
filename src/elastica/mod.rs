//! A link under gravity and at large angles: the inextensible elastica, its second-order terms as loads.
//!
//! The link is seen from its chord, the line from the axis to the tip, whose motion is given. The recursion
//! answers to loads at every frequency ([`Model::loaded_motion`](crate::model::Model::loaded_motion)); what the
//! linear link leaves out, centripetal terms, axial force, large slopes, is computed in time from the last answer
//! and given back as loads. The fixed point is the exact motion of the inextensible elastica on the mesh.
//!
//! ```text
//! r(s) = e (s + u) + n w,   w(0) = w(L) = 0,   u' = √(1 − w'²) − 1,   ψ = asin w'
//! ```
//!
//! e and n are unit vectors along the chord and across it. Gravity is an upward acceleration of the axis.

mod chord;
mod iteration;
mod loads;
mod points;

pub use chord::{ChordPeriod, ElasticaError, returning};
pub use iteration::{ElasticaMotion, follow};
pub use loads::SecondOrder;
