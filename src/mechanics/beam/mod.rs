//! The finite-element link: mesh, elements, and the recursion that condenses it to its hub.
//!
//! | file | holds |
//! |---|---|
//! | `element` | K and M of one element, and in relative coordinates; with shear and rotary inertia |
//! | `plan`, `stations` | number of elements of each piece of the link; nodes at places and through those of a table |
//! | `inertia` | apparent inertia A, and the 2×2 system of one element |
//! | `mesh` | all elements and bodies; λ up to which the link is rigid |
//! | `recursion` | from tip to hub: torque, hub angle, tip; back from hub to tip: deflections and moments at the nodes |
//! | `loaded` | the recursion with forces on the nodes and an axis that moves |
//! | `pivoted` | both with row pivoting, for resonances of the outboard part |
//! | `transfer` | transfers per unit of tip motion at one λ; which recursion computes them |
//! | `batch` | the same at many λ, over the processor's vectors |

mod batch;
mod element;
mod inertia;
mod loaded;
mod mesh;
mod pivoted;
mod plan;
mod recursion;
mod transfer;

pub(crate) use batch::{Checkpoints, Pivots, nodal_transfers_from, pivots, tip_displacements_m};
pub use batch::{nodal_transfers, tip_transfers};
pub use element::{Element, RelativeElement};
pub use inertia::{Gain, Inertia};
pub use loaded::{LoadedMotion, Loads, loaded_motion};
pub(crate) use mesh::nearest_node;
pub use mesh::{Mesh, node_at};
pub(crate) use pivoted::{DrivenMotion, driven_motion};
pub use plan::{ElementCount, MeshPlan, Piece};
pub use recursion::{
    HubResponse, NodalHistories, NodalQuantity, Step, condense, hub_response, tip_displacement_m,
};
pub use transfer::{NodalTransfer, TipTransfer, nodal_transfer, tip_transfer};

/// Test link of the recursion: has every part of a mesh, and no damping, so that it resonates.
#[cfg(test)]
mod test_links {
    use super::{ElementCount, Mesh, MeshPlan};
    use crate::link::{
        Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper, uniform, uniform_segment,
    };

    impl Mesh {
        /// A mesh of a link of one segment with this number of elements.
        pub(crate) fn on(link: &Link, elements: usize) -> Self {
            let plan = MeshPlan::new(link, &[None], Some(ElementCount::Total(elements)), 1e-6);
            Self::planned(link, &plan.unwrap())
        }
    }

    /// A link with segments of half a metre of these stiffnesses, and masses at these places in m.
    pub(super) fn of_stiffnesses(stiffnesses: &[f64], masses_at_m: &[f64]) -> Link {
        let segment = |ei: &f64| Segment {
            length_m: 0.5,
            bending_stiffness_n_m2: Taper::constant(*ei),
            ..uniform_segment()
        };
        let mass = |at_m: &f64| LumpedMass { at_m: *at_m, mass_kg: 0.1, inertia_kg_m2: 0.0 };
        let segments = stiffnesses.iter().map(segment).collect();
        let masses = masses_at_m.iter().map(mass).collect();
        Link::new(LinkParts { segments, masses, ..uniform() }).unwrap()
    }

    const SI: Units = Units { length: 1.0, mass: 1.0 };

    /// The test link on this many elements.
    pub(super) fn mesh(elements: usize) -> Mesh {
        mesh_in(elements, SI)
    }

    /// Other units per metre and per kilogram, with the second unchanged: powers of two, which cost no digit.
    #[derive(Debug, Clone, Copy)]
    pub(super) struct Units {
        pub(super) length: f64,
        pub(super) mass: f64,
    }

    /// The test link on this many elements, in these units.
    pub(super) fn mesh_in(elements: usize, units: Units) -> Mesh {
        let (ei, per_length) = (Taper { inner: 6.0, outer: 4.0 }, Taper { inner: 0.9, outer: 0.7 });
        let Units { length, mass } = units;
        let inertia = mass * length * length;
        let (stiffness, density) = (inertia * length, mass / length);
        let link = Link::new(LinkParts {
            segments: vec![Segment {
                length_m: 1.5 * length,
                bending_stiffness_n_m2: ei.scaled(stiffness),
                mass_per_length_kg_m: per_length.scaled(density),
                ..uniform_segment()
            }],
            hub: Hub {
                inertia_kg_m2: 0.1 * inertia,
                radius_m: 0.05 * length,
                viscous_friction_n_m_s_rad: 0.0,
            },
            masses: vec![LumpedMass {
                at_m: 0.8 * length,
                mass_kg: 0.1 * mass,
                inertia_kg_m2: 1e-3 * inertia,
            }],
            payload: Payload { mass_kg: 0.05 * mass, inertia_kg_m2: 0.0, offset_m: 0.0 },
            ..uniform()
        });
        let link = link.unwrap();
        Mesh::on(&link, elements)
    }
}
