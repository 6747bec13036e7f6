use crate::beam::{Mesh, condense};
use crate::numeric::bisect;

/// Highest angular frequency that is searched, in rad/s: no link of this world comes near.
const SEARCH_LIMIT_RAD_S: f64 = 1e15;

/// Number of modes below `omega_rad_s` > 0, the rigid rotation included.
///
/// By Sylvester's law of inertia it is the number of negative pivots of the dynamic stiffness
/// (Wittrick and Williams), here of the blocks `K_d − λ(M_dd + A)` and of the hub's
/// `−(A_0[φφ] + I_H)`; so none is missed, however close two of them lie.
pub fn modes_below(mesh: &Mesh, omega_rad_s: f64) -> usize {
    let mut negative = 0;
    let root = condense(mesh, omega_rad_s * omega_rad_s, |_, step| {
        negative += step.pivots.iter().filter(|p| **p < 0.0).count();
    });
    let at_axis = root.about(mesh.nodes_m()[0]) + mesh.hub_inertia_kg_m2();
    if at_axis.is_finite() {
        negative + usize::from(at_axis > 0.0)
    } else {
        // Exactly on a pole of the apparent inertia: a hair beside it everything is finite.
        modes_below(mesh, omega_rad_s * (1.0 + 4.0 * f64::EPSILON))
    }
}

/// The first `count` natural frequencies in rad/s, ascending, the rigid rotation left out.
///
/// Torque-free hub: what vibrates when the motor lets go. Undamped. Fewer than `count` where the
/// mesh has fewer.
pub fn natural_frequencies(mesh: &Mesh, count: usize) -> Vec<f64> {
    let count = count.min(mesh.inertial_degrees_of_freedom().saturating_sub(1));
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
