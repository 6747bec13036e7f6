use super::inertia::flexible_modes;
use crate::beam::{Inertia, Mesh, condense};
use crate::numeric::bisect;

/// Highest angular frequency that is searched, in rad/s: no link of this world comes near.
const SEARCH_LIMIT_RAD_S: f64 = 1e15;

/// Number of modes below `omega_rad_s` > 0, the rigid rotation included.
///
/// By Sylvester's law of inertia it is the number of negative pivots of the dynamic stiffness
/// (Wittrick and Williams), here of the blocks `K_d − λ(M_dd + A)` and of the hub's
/// `−(A_0[φφ] + I_H)`; so none is missed, however close two of them lie.
pub fn modes_below(mesh: &Mesh, omega_rad_s: f64) -> usize {
    let (negative, root) = negative_pivots(mesh, omega_rad_s * omega_rad_s);
    let at_axis = root.about(mesh.nodes_m()[0]) + mesh.hub_inertia_kg_m2();
    if at_axis.is_finite() {
        negative + usize::from(at_axis > 0.0)
    } else {
        // Exactly on a pole of the apparent inertia: a hair beside it everything is finite.
        modes_below(mesh, omega_rad_s * (1.0 + 4.0 * f64::EPSILON))
    }
}

/// Number of negative pivots outboard of the hub at λ = ω², which is the number of modes below ω of
/// the link clamped at its hub, and the apparent inertia at the root.
pub(super) fn negative_pivots(mesh: &Mesh, lambda: f64) -> (usize, Inertia<f64>) {
    let mut negative = 0;
    let root = condense(mesh, lambda, |_, step| {
        negative += step.pivots.iter().filter(|p| **p < 0.0).count();
    });
    (negative, root)
}

/// The first `count` natural frequencies in rad/s, ascending, the rigid rotation left out.
///
/// Torque-free hub: what vibrates when the motor lets go. Undamped. Fewer than `count` where the
/// mesh has fewer.
pub fn natural_frequencies(mesh: &Mesh, count: usize) -> Vec<f64> {
    let count = count.min(flexible_modes(mesh));
    let mut found: Vec<f64> = Vec::with_capacity(count);
    while found.len() < count {
        // The rigid rotation is always below.
        let sought = found.len() + 2;
        let mut high = found.last().copied().unwrap_or(1.0);
        while modes_below(mesh, high) < sought {
            high *= 2.0;
            if high > SEARCH_LIMIT_RAD_S {
                return found;
            }
        }
        let mut low = found.last().copied().unwrap_or(high);
        while modes_below(mesh, low) >= sought {
            low *= 0.5;
        }
        found.push(bisect(low, high, |omega| modes_below(mesh, omega) >= sought));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{Damping, Hub, Link, LinkParts, Payload, Segment, Taper};

    fn massless(hub_kg_m2: f64, payload_kg: f64) -> Mesh {
        let link = Link::new(LinkParts {
            title: String::new(),
            segments: vec![Segment {
                name: None,
                length_m: 1.5,
                bending_stiffness_n_m2: Taper::constant(5.0),
                mass_per_length_kg_m: Taper::constant(0.0),
            }],
            hub: Hub { inertia_kg_m2: hub_kg_m2, ..Hub::default() },
            masses: vec![],
            payload: Payload { mass_kg: payload_kg, ..Payload::default() },
            damping: Damping::None,
        })
        .unwrap();
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(10)), 1e-6);
        Mesh::new(&link, &plan.unwrap())
    }

    #[test]
    fn a_massless_beam_between_two_bodies_has_their_one_mode() {
        // A spring 3EI/L³ at the tip, and the hub that yields as I_H/L².
        let found = natural_frequencies(&massless(0.1, 0.1), 5);
        let stiffness = 3.0 * 5.0 / 1.5_f64.powi(3);
        let (hub, tip) = (0.1 / 1.5_f64.powi(2), 0.1);
        let exact = (stiffness * (1.0 / hub + 1.0 / tip)).sqrt();
        assert_eq!(found.len(), 1);
        assert!((found[0] / exact - 1.0).abs() < 1e-12, "{} is not {exact}", found[0]);
        assert_eq!(natural_frequencies(&massless(0.0, 1.0), 5), Vec::<f64>::new());
    }
}
