//! How a link is described changes nothing; stiffening it makes it rigid.

use flexlink::beam::{Mesh, MeshPlan, NodalTransfer, nodal_transfer, tip_transfer};
use flexlink::link::{Link, LinkParts, Segment};
use num_complex::Complex64;
use proptest::prelude::*;

use super::links::{any_excitation, any_parts, mesh};
use crate::common::complex_difference;

/// Each segment in its own number of elements.
fn mesh_of(parts: &LinkParts, own: &[usize]) -> Mesh {
    let link = Link::new(parts.clone()).expect("a valid link");
    let own: Vec<Option<usize>> = own.iter().copied().map(Some).collect();
    Mesh::new(&link, &MeshPlan::new(&link, &own, None, 1e-6).expect("a valid plan"))
        .expect("a plan of the link")
}

/// Cuts segment `index` in two behind a fraction of its length.
fn split(parts: &LinkParts, index: usize, fraction: f64) -> LinkParts {
    let mut parts = parts.clone();
    let whole = parts.segments[index].clone();
    let piece = |from: f64, to: f64| Segment {
        name: None,
        length_m: whole.length_m * (to - from),
        bending_stiffness_n_m2: whole.bending_stiffness_n_m2.between(from, to),
        mass_per_length_kg_m: whole.mass_per_length_kg_m.between(from, to),
        cross_section: None,
        timoshenko: whole.timoshenko.map(|own| own.between(from, to)),
    };
    parts.segments.splice(index..=index, [piece(0.0, fraction), piece(fraction, 1.0)]);
    parts
}

fn differ(a: &NodalTransfer, b: &NodalTransfer) -> f64 {
    let off = |a: &[Complex64], b: &[Complex64]| {
        assert_eq!(a.len(), b.len());
        complex_difference(a, b.iter().copied())
    };
    [
        (a.tip.inertia_kg_m / b.tip.inertia_kg_m - 1.0).norm(),
        (a.tip.angle_rad_m / b.tip.angle_rad_m - 1.0).norm(),
        off(&a.deflections_s2, &b.deflections_s2),
        off(&a.moments_kg_m, &b.moments_kg_m),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn splitting_a_segment_in_two_changes_nothing(
        mut parts in any_parts(),
        excitation in any_excitation(),
        elements in 2_usize..7,
        chosen in any::<prop::sample::Index>(),
        cut in any::<prop::sample::Index>(),
    ) {
        // A mass within a segment has a node of its own, and each half would shift the others.
        parts.masses.clear();
        let index = chosen.index(parts.segments.len());
        let inner = 1 + cut.index(elements - 1);
        let mut own = vec![elements; parts.segments.len()];
        let whole = mesh_of(&parts, &own);
        own.splice(index..=index, [inner, elements - inner]);
        let halves = split(&parts, index, inner as f64 / elements as f64);
        let halves = mesh_of(&halves, &own);
        let lambda = excitation.lambda(&whole);
        let off = differ(&nodal_transfer(&whole, lambda), &nodal_transfer(&halves, lambda));
        prop_assert!(off < 1e-10, "{:e}", off);
    }

    /// `T/a_tip → I_rigid/L`, and what is left of the difference falls as 1/EI.
    #[test]
    fn a_stiffer_link_approaches_the_rigid_one_at_first_order(
        parts in any_parts(),
        excitation in any_excitation(),
    ) {
        let lambda = excitation.lambda(&mesh(&parts, 12));
        let rigid = Link::new(parts.clone())?.rigid_inertia_kg_m2();
        let stiffened = |factor: f64| {
            let mut parts = parts.clone();
            for segment in &mut parts.segments {
                segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(factor);
                if let Some(own) = &mut segment.timoshenko {
                    own.shear_stiffness_n = own.shear_stiffness_n.scaled(factor);
                }
            }
            let mesh = mesh(&parts, 12);
            let transfer = tip_transfer(&mesh, lambda);
            let lag = lambda * transfer.deflection_s2;
            (transfer.inertia_kg_m * mesh.length_m() / rigid - 1.0, lag.norm())
        };
        let ((stiff, lag), (stiffer, _)) = (stiffened(1e6), stiffened(1e7));
        prop_assert!(stiff.norm() < 10.0 * lag, "{} against {}", stiff, lag);
        prop_assert!((stiff - stiffer * 10.0).norm() < 0.01 * lag, "{} and {}", stiff, stiffer);
    }
}
