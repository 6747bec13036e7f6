//! A link for the tests of the recursion: everything that a mesh can carry, and no damping, so that it
//! resonates.

use super::{ElementCount, Mesh, MeshPlan};
use crate::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};

/// The link on this many elements.
pub(super) fn mesh(elements: usize) -> Mesh {
    let link = Link::new(LinkParts {
        title: String::new(),
        segments: vec![Segment {
            name: None,
            length_m: 1.5,
            bending_stiffness_n_m2: Taper { inner: 6.0, outer: 4.0 },
            mass_per_length_kg_m: Taper { inner: 0.9, outer: 0.7 },
        }],
        hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.0 },
        masses: vec![LumpedMass { at_m: 0.8, mass_kg: 0.1, inertia_kg_m2: 1e-3 }],
        payload: Payload { mass_kg: 0.05, inertia_kg_m2: 0.0, offset_m: 0.0 },
        damping: Damping::None,
    });
    let link = link.unwrap();
    let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(elements)), 1e-6);
    Mesh::new(&link, &plan.unwrap())
}
