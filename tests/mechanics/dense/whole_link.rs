//! Links with tapers, lumped masses, a hub radius and a body at the tip, integrated and assembled
//! here from the link's own data.

use faer::c64;
use flexlink::beam::{Mesh, nodal_transfer, tip_transfer};
use flexlink::link::{
    Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper, Timoshenko,
};
use flexlink::modal::held_frequencies;
use proptest::prelude::*;

use super::assembly::{Assembly, Load};
use super::links::{any_excitation, any_parts, mesh};
use crate::common::complex_difference;

/// What round-off in K*/ω² costs the dense solve of links like these at most.
const DENSE_ERROR: f64 = 1e-8;

fn arm() -> LinkParts {
    let segment = |length_m, stiffness: (f64, f64), mass: (f64, f64)| Segment {
        bending_stiffness_n_m2: Taper { inner: stiffness.0, outer: stiffness.1 },
        mass_per_length_kg_m: Taper { inner: mass.0, outer: mass.1 },
        ..Segment::uniform(length_m, 1.0, 1.0)
    };
    let mass = |at_m, mass_kg, inertia_kg_m2| LumpedMass { at_m, mass_kg, inertia_kg_m2 };
    LinkParts {
        title: String::new(),
        segments: vec![
            segment(0.3, (60.0, 25.0), (1.4, 1.0)),
            Segment {
                timoshenko: Some(Timoshenko {
                    shear_stiffness_n: Taper { inner: 900.0, outer: 500.0 },
                    rotary_inertia_per_length_kg_m: Taper { inner: 3e-3, outer: 1e-3 },
                }),
                ..segment(0.7, (20.0, 8.0), (0.9, 0.5))
            },
            segment(0.5, (8.0, 3.0), (0.5, 0.3)),
        ],
        hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.08, ..Hub::default() },
        carriage: None,
        root_stiffness_n_m_rad: None,
        output_m: None,
        // At the root, within a segment, where two meet, at the tip.
        masses: vec![
            mass(0.08, 0.5, 2e-3),
            mass(0.6, 0.2, 1e-3),
            mass(1.08, 0.1, 5e-4),
            mass(1.58, 0.05, 1e-4),
        ],
        payload: Payload { mass_kg: 0.3, inertia_kg_m2: 4e-3, offset_m: 0.06 },
        damping: Damping::None,
        drive: None,
        gravity: None,
    }
}

/// Largest difference between recursion and dense solve, over torque, hub angle, deflections and
/// bending moments, each relative to its largest value.
fn difference(parts: &LinkParts, mesh: &Mesh, lambda: c64) -> f64 {
    let nodes_m = mesh.nodes_m();
    let link = Link::new(parts.clone()).expect("a valid link");
    let assembly = Assembly::of_link(&link, nodes_m);
    let a = assembly.accelerations(lambda, Load::HubTorque);
    let (tip, theta) = (a[a.len() - 2], a[1]);
    let found = nodal_transfer(mesh, lambda);
    let at_nodes = |found: &[c64], dense: &dyn Fn(usize) -> c64| {
        complex_difference(found, (0..found.len()).map(|k| dense(k) / tip))
    };
    [
        (found.tip.inertia_kg_m * tip - 1.0).norm(),
        (found.tip.angle_rad_m * tip / theta - 1.0).norm(),
        at_nodes(&found.deflections_s2, &|k| (a[2 * k] - theta * nodes_m[k]) / lambda),
        at_nodes(&found.moments_kg_m, &|k| assembly.moment(k, lambda, &a)),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

#[test]
fn an_arm_with_everything_on_it_moves_as_its_dense_matrices_say() {
    for elements in [5, 8, 12] {
        for omega in [5.0, 12.0, 34.0, 71.0, 160.0, 400.0_f64] {
            for xi in [0.0, 0.02] {
                let lambda = c64::from(omega * omega) / c64::new(1.0, 2.0 * xi);
                let off = difference(&arm(), &mesh(&arm(), elements), lambda);
                assert!(off < 1e-10, "{elements} elements, {omega} rad/s, ξ = {xi}: {off:e}");
            }
        }
    }
}

#[test]
fn at_rest_the_arm_is_rigid() {
    let parts = arm();
    let link = Link::new(parts.clone()).expect("a valid link");
    let mesh = mesh(&parts, 9);
    let assembly = Assembly::of_link(&link, mesh.nodes_m());
    let expected = assembly.rigid_inertia_kg_m2(mesh.nodes_m());
    let found = tip_transfer(&mesh, c64::ZERO);
    assert!((found.inertia_kg_m * mesh.length_m() / expected - 1.0).norm() < 1e-14);
    assert!((found.angle_rad_m * mesh.length_m() - 1.0).norm() < 1e-15);
    assert!((link.rigid_inertia_kg_m2() / expected - 1.0).abs() < 1e-14);
}

proptest! {
    #[test]
    fn any_link_moves_as_its_dense_matrices_say(
        parts in any_parts(),
        excitation in any_excitation(),
        elements in 7_usize..14,
    ) {
        let mesh = mesh(&parts, elements);
        let off = difference(&parts, &mesh, excitation.lambda(&mesh));
        prop_assert!(off < DENSE_ERROR, "{:e}", off);
    }

    /// The hub angle under a tip force is the tip displacement under a hub torque.
    #[test]
    fn the_torque_moves_the_tip_as_a_tip_force_moves_the_hub(
        parts in any_parts(),
        excitation in any_excitation(),
        elements in 7_usize..14,
    ) {
        let mesh = mesh(&parts, elements);
        let link = Link::new(parts).expect("a valid link");
        let assembly = Assembly::of_link(&link, mesh.nodes_m());
        let lambda = excitation.lambda(&mesh);
        let angle = assembly.accelerations(lambda, Load::TipForce)[1];
        let off = (tip_transfer(&mesh, lambda).inertia_kg_m * angle - 1.0).norm();
        prop_assert!(off < DENSE_ERROR, "{:e}", off);
    }

    /// All of them: none is missed and none is found twice.
    #[test]
    fn held_frequencies_are_the_eigenvalues_of_the_dense_matrices(
        parts in any_parts(),
        elements in 7_usize..14,
        decades in -2.0..5.0_f64,
    ) {
        let mesh = mesh(&parts, elements);
        let link = Link::new(parts).expect("a valid link");
        let spring = 10.0_f64.powf(decades);
        let dense = Assembly::of_link(&link, mesh.nodes_m()).squared_frequencies(spring);
        let found = held_frequencies(&mesh, spring, 1000);
        prop_assert_eq!(found.len(), dense.len());
        // The round-off of dense eigenvalues is a share of the largest.
        let round_off = 1e-12 * dense[dense.len() - 1];
        for (omega, square) in found.iter().zip(&dense) {
            let off = (omega * omega - square).abs();
            let allowed = DENSE_ERROR * square + round_off;
            prop_assert!(off < allowed, "{omega}² is {off:e} off {square}");
        }
    }
}
