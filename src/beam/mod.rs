//! The finite-element link: how it is meshed, one element, and the recursion that condenses it.

mod condensation;
mod element;
mod elimination;
mod given_nodes;
mod histories;
mod hub_response;
mod mesh;
mod pivoted;
mod plan;
mod rigid_limit;
mod rows;
mod sixteen;
mod spectrum;
mod stretch;
mod tip_transfers;
mod transfer;
#[cfg(test)]
mod undamped;
mod walk;

pub use condensation::{Inertia, Step, condense};
pub use element::{Element, RelativeElement};
pub use elimination::Gain;
pub use histories::NodalHistories;
pub use hub_response::{HubResponse, hub_response, tip_displacement_m};
pub use mesh::Mesh;
pub use pivoted::{DrivenMotion, PivotedScalar, driven_motion};
pub use plan::{ElementCount, MeshPlan, Piece};
pub use sixteen::{Pivots, pivots, tip_displacements_m};
pub use spectrum::{nodal_transfers, tip_transfers};
pub use tip_transfers::{TipTransfer, TipTransfers};
pub use transfer::tip_transfer;
pub use walk::{NodalQuantity, NodalTransfer, nodal_transfer};
