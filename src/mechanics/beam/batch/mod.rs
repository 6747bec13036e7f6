//! The recursion at many λ at a time, as many as the processor's vectors hold.
//!
//! Every λ has the bits that it has alone: neither the width of the vectors nor its neighbours in the
//! list change any. The plain versions are [`tip_transfer`], [`nodal_transfer`], [`condense`] and
//! [`tip_displacement_m`], which the tests compare bit by bit.
//!
//! [`tip_transfer`]: super::tip_transfer
//! [`nodal_transfer`]: super::nodal_transfer
//! [`condense`]: super::condense
//! [`tip_displacement_m`]: super::tip_displacement_m

mod complex_lanes;
mod hub;
mod lanes;
mod nodal;

pub use hub::tip_transfers;
pub(crate) use hub::{Pivots, pivots, tip_displacements_m};
pub use nodal::nodal_transfers;
pub(crate) use nodal::{Checkpoints, nodal_transfers_from};
