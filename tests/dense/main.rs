//! The recursion against the dense matrices that the paper assembles and factorises.

mod assembly;
mod damping;
#[path = "../laws/links.rs"]
mod links;
mod modal_damping;
mod paper;
mod whole_link;
