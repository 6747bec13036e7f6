use nalgebra::Vector2;

use crate::beam::{Mesh, driven_motion};

/// Shape of one mode: free vibration of the link on its hub.
///
/// Mass-normalised, ∫ m̄ v² dx + Σ (m v² + J φ²) + `I_H` θ² = 1 with consistent mass, so that v
/// has the unit 1/√kg. The tip's displacement is positive.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeShape {
    /// Hub angle θ in 1/(m √kg).
    pub hub_angle: f64,
    /// Total displacement v of nodes 0 … n in 1/√kg.
    pub displacements: Vec<f64>,
}

/// Shape at a natural frequency `omega_rad_s` > 0, from the recursion at λ = ω².
pub fn mode_shape(mesh: &Mesh, omega_rad_s: f64) -> ModeShape {
    let motion = driven_motion(mesh, (omega_rad_s * omega_rad_s).into());
    let theta = motion.theta.re;
    let deflections: Vec<Vector2<f64>> =
        motion.deflections.iter().map(|e| e.map(|e| e.re)).collect();
    let total = |node: usize| deflections[node] + Vector2::new(mesh.nodes_m()[node] * theta, theta);
    let scale = modal_mass(mesh, theta, &deflections, total).sqrt().recip();
    let last = deflections.len() - 1;
    let scale = if total(last)[0] < 0.0 { -scale } else { scale };
    ModeShape {
        hub_angle: scale * theta,
        displacements: (0..=last).map(|node| scale * total(node)[0]).collect(),
    }
}

/// ∫ m̄ v² dx + Σ (m v² + J φ²) + `I_H` θ², element by element in relative coordinates.
fn modal_mass(
    mesh: &Mesh,
    theta: f64,
    deflections: &[Vector2<f64>],
    total: impl Fn(usize) -> Vector2<f64>,
) -> f64 {
    let hub = mesh.hub_inertia_kg_m2() * theta * theta;
    let elements = mesh.relative_elements().iter().enumerate().map(|(inner, element)| {
        let (u, e) = (total(inner), deflections[inner]);
        let carried = Vector2::new(e[0] + element.length_m * e[1], e[1]);
        let d = deflections[inner + 1] - carried;
        u.dot(&(element.m_uu * u)) + 2.0 * u.dot(&(element.m_ud * d)) + d.dot(&(element.m_dd * d))
    });
    let lumped = (0..deflections.len() - 1)
        .filter_map(|node| Some((mesh.lumped_inertia(node)?, total(node))));
    let tip = (mesh.tip_inertia(), total(deflections.len() - 1));
    let bodies = lumped.chain([tip]).map(|(inertia, u)| {
        inertia.vv * u[0] * u[0] + 2.0 * inertia.vp * u[0] * u[1] + inertia.pp * u[1] * u[1]
    });
    hub + elements.sum::<f64>() + bodies.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};
    use crate::modal::natural_frequencies;

    fn mesh(elements: usize, hub: Hub, masses: Vec<LumpedMass>, payload: Payload) -> Mesh {
        let link = Link::new(LinkParts {
            title: String::new(),
            segments: vec![Segment {
                name: None,
                length_m: 1.5,
                bending_stiffness_n_m2: Taper::constant(5.0),
                mass_per_length_kg_m: Taper::constant(0.8),
            }],
            hub,
            masses,
            payload,
            damping: Damping::None,
        })
        .unwrap();
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(elements)), 1e-6);
        Mesh::new(&link, &plan.unwrap())
    }

    #[test]
    fn a_pinned_free_link_swings_in_its_closed_form() {
        let mesh = mesh(100, Hub::default(), vec![], Payload::default());
        let b = 3.926_602_312_047_919_f64;
        let omega = natural_frequencies(&mesh, 1)[0];
        let shape = mode_shape(&mesh, omega);
        // v = sin(bx/L)/sin b + sinh(bx/L)/sinh b has the norm ∫v² dx = L.
        let norm = (0.8_f64 * 1.5).sqrt();
        for (x, v) in mesh.nodes_m().iter().zip(&shape.displacements) {
            let s = b * x / 1.5;
            let exact = (s.sin() / b.sin() + s.sinh() / b.sinh()) / norm;
            assert!((v - exact).abs() < 1e-8, "at {x} m: {v} is not {exact}");
        }
        let slope = b / 1.5 * (1.0 / b.sin() + 1.0 / b.sinh()) / norm;
        assert!((shape.hub_angle - slope).abs() < 1e-7, "{} is not {slope}", shape.hub_angle);
    }

    #[test]
    fn shapes_of_different_modes_are_orthogonal_and_of_unit_mass() {
        let hub = Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.0 };
        let masses = vec![LumpedMass { at_m: 0.8, mass_kg: 0.3, inertia_kg_m2: 0.0 }];
        let payload = Payload { mass_kg: 0.2, inertia_kg_m2: 0.0, offset_m: 0.0 };
        let mesh = mesh(600, hub, masses, payload);
        let shapes: Vec<ModeShape> =
            natural_frequencies(&mesh, 4).iter().map(|w| mode_shape(&mesh, *w)).collect();
        // Simpson's rule on nodes 0, 2, 4, … needs a node pattern that the mass does not disturb:
        // the trapezoid on all nodes is within 1e-4 here.
        let x = mesh.nodes_m();
        let mass = x.iter().position(|x| (x - 0.8).abs() < 1e-9).unwrap();
        for (i, a) in shapes.iter().enumerate() {
            for (j, b) in shapes.iter().enumerate() {
                let product = |k: usize| a.displacements[k] * b.displacements[k];
                let beam: f64 = (1..x.len())
                    .map(|k| 0.8 * 0.5 * (x[k] - x[k - 1]) * (product(k) + product(k - 1)))
                    .sum();
                let bodies = 0.1 * a.hub_angle * b.hub_angle
                    + 0.3 * product(mass)
                    + 0.2 * product(x.len() - 1);
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((beam + bodies - expected).abs() < 1e-4, "modes {i} and {j}");
            }
        }
        assert!(shapes.iter().all(|s| s.displacements[x.len() - 1] > 0.0), "the tip leads");
    }
}
