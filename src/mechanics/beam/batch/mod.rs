//! The recursion at several λ at a time, one for each lane of the processor's vectors.
//!
//! Neither the width of the vectors nor the neighbours in the list change a bit of any λ. The plain versions are
//! [`tip_transfer`], [`nodal_transfer`], [`condense`] and [`tip_displacement_m`], and the tests compare both bit by
//! bit.
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
