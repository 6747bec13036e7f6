//! The recursion against the dense matrices that the paper assembles and factorises.

pub(crate) mod assembly;
pub(crate) mod damping;
mod loads;
mod modal_damping;
mod paper;
mod whole_link;

use super::laws::links;
