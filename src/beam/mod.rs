//! The finite-element link: mesh, elements, and the recursion that condenses it to its hub.
//!
//! | file | holds |
//! |---|---|
//! | `element` | K and M of one element, and in relative coordinates |
//! | `plan`, `given_nodes` | how many elements each piece of the link gets |
//! | `inertia` | apparent inertia A, and the 2×2 system of one element |
//! | `mesh`, `rigid_limit` | all elements and bodies; λ up to which the link is rigid |
//! | `recursion` | from tip to hub: torque, hub angle, tip; back from hub to tip: deflections and moments at the nodes |
//! | `pivoted` | both with row pivoting, for resonances of the outboard part |
//! | `transfer` | transfers per unit of tip motion at one λ; which recursion computes them |
//! | `batch` | the same at many λ, over the processor's vectors |

mod batch;
mod element;
mod given_nodes;
mod inertia;
mod mesh;
mod pivoted;
mod plan;
mod recursion;
mod rigid_limit;
#[cfg(test)]
mod test_links;
mod transfer;

pub use batch::{
    Checkpoints, Pivots, TipTransfers, nodal_transfers, pivots, tip_displacements_m, tip_transfers,
};
pub use element::{Element, RelativeElement};
pub use inertia::{Gain, Inertia};
pub use mesh::Mesh;
pub use pivoted::{DrivenMotion, PivotedScalar, driven_motion};
pub use plan::{ElementCount, MeshPlan, Piece};
pub use recursion::{
    HubResponse, NodalHistories, NodalQuantity, Step, condense, hub_response, tip_displacement_m,
};
pub use transfer::{NodalTransfer, TipTransfer, nodal_transfer, tip_transfer};
