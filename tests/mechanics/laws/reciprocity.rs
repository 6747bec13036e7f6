//! What a torque at the hub does to a node, a force at the node does to the hub (Maxwell, Betti).

use flexlink::beam::{Mesh, nodal_transfer};
use flexlink::link::{LinkParts, LumpedMass};
use num_complex::Complex64;
use proptest::prelude::*;

use super::links::{any_excitation, any_parts, mesh};

/// Apparent rotary inertia about the axis, torque per angular acceleration, in kg m²; and the
/// displacement of each node per hub angle in m.
fn answer(mesh: &Mesh, lambda: Complex64) -> (Complex64, Vec<Complex64>) {
    let transfer = nodal_transfer(mesh, lambda);
    let per_angle = transfer.tip.angle_rad_m.inv();
    let nodes = mesh.nodes_m().iter().zip(&transfer.deflections_s2);
    let displacements = nodes.map(|(x, lag)| x + lambda * lag * per_angle).collect();
    (transfer.tip.inertia_kg_m * per_angle, displacements)
}

/// The link with a body more at a place that is a node with or without it.
fn with_body(parts: &LinkParts, at_m: f64, mass_kg: f64) -> LinkParts {
    let mut parts = parts.clone();
    parts.masses.push(LumpedMass { at_m, mass_kg, inertia_kg_m2: 0.0 });
    parts
}

/// Digits that the recursion keeps.
const KEPT: f64 = 1e-11;

proptest! {
    /// A mass m at a node pulls with its weight in inertia; the hub feels of that force what the
    /// node feels of a torque at the hub, both u = v/θ, less what the node gives way by c:
    ///
    /// ```text
    /// I(m) = I(0) + m u²/(1 + m c),  so that  g(m) = (I(m) − I(0))/m  has  2/g(m) − 1/g(2m) = 1/u²
    /// ```
    #[test]
    fn a_mass_is_felt_at_the_hub_by_the_square_of_what_the_hub_does_to_it(
        parts in any_parts(),
        excitation in any_excitation(),
        elements in 12_usize..40,
        mass_kg in 0.01..0.2_f64,
        chosen in any::<prop::sample::Index>(),
    ) {
        let span_m: f64 = parts.segments.iter().map(|s| s.length_m).sum();
        let at_m = parts.hub.radius_m + span_m * (chosen.index(9) as f64 + 0.5) / 9.0;
        let bare = mesh(&with_body(&parts, at_m, 0.0), elements);
        let lambda = excitation.lambda(&bare);
        let (inertia, displacements) = answer(&bare, lambda);
        let gain = |mass_kg: f64| {
            let loaded = mesh(&with_body(&parts, at_m, mass_kg), elements);
            assert_eq!(loaded.nodes_m(), bare.nodes_m());
            (answer(&loaded, lambda).0 - inertia) / mass_kg
        };
        let (once, twice) = (gain(mass_kg), gain(2.0 * mass_kg));
        let found = (once.inv() * 2.0 - twice.inv()).inv();
        let node = bare.nodes_m().iter().position(|x| (x - at_m).abs() < 1e-9).expect("a node");
        let expected = displacements[node] * displacements[node];
        // What the digits lost in the inertia are in what was found.
        let give = |gain: Complex64| (expected / gain).norm_sqr();
        let lost = KEPT * inertia.norm() / mass_kg * (2.0 * give(once) + give(twice));
        let allowed = lost + KEPT * expected.norm();
        prop_assert!((found - expected).norm() <= allowed, "{} for {}", found, expected);
        prop_assert!(allowed < 0.1 * expected.norm() + 1e-9 * inertia.norm(), "nothing is tested");
    }
}
