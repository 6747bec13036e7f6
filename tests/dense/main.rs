//! The recursion against the dense matrices that the paper assembles and factorises.

mod assembly;
#[path = "../laws/links.rs"]
mod links;
mod paper;
mod whole_link;
