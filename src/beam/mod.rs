//! The finite-element link: mesh, element, and the recursion that condenses it.

mod plan;

pub use plan::{ElementCount, MeshPlan};
