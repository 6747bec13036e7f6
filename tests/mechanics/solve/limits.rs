//! The rigid limit.

use super::{Smooth, link, peak, solved};
use flexlink::inverse::Solution;
use flexlink::link::{Damping, Taper};

/// Largest difference from the rigid torque over its peak.
fn distance_from_rigid(solution: &Solution) -> f64 {
    let pairs = solution.hub().torque_n_m.iter().zip(&solution.hub().rigid_torque_n_m);
    let difference: Vec<f64> = pairs.map(|(torque, rigid)| torque - rigid).collect();
    peak(&difference) / peak(&solution.hub().rigid_torque_n_m)
}

fn stiff(ei: f64, damping: Damping) -> Solution {
    let link = link(|parts| {
        parts.segments[0].bending_stiffness_n_m2 = Taper::constant(ei);
        parts.payload.mass_kg = 0.1;
        parts.hub.viscous_friction_n_m_s_rad = 0.05;
        parts.damping = damping;
    });
    solved(&link, 6, &Smooth::MOVE.motion())
}

#[test]
fn the_torque_tends_to_the_rigid_one_as_one_over_the_stiffness() {
    for damping in [
        Damping::None,
        Damping::Hysteretic { ratio: 0.02 },
        Damping::Rayleigh { alpha_per_s: 0.7, beta_s: 1e-4 },
    ] {
        let distances = [4e3, 4e4, 4e5].map(|ei| distance_from_rigid(&stiff(ei, damping.clone())));
        assert!(distances[0] < 1e-2, "{damping:?}: {distances:?}");
        for pair in distances.windows(2) {
            assert!((pair[0] / pair[1] / 10.0 - 1.0).abs() < 0.05, "{damping:?}: {distances:?}");
        }
    }
}

#[test]
fn the_hub_angle_tends_to_the_rigid_one() {
    let solution = stiff(1e8, Damping::None);
    for (angle, rigid) in solution.hub().angle_rad.iter().zip(&solution.hub().rigid_angle_rad) {
        assert!((angle - rigid).abs() < 1e-7);
    }
}

#[test]
fn the_mass_part_of_rayleigh_damping_drags_a_nearly_rigid_link_by_its_inertia() {
    let (alpha_per_s, ei) = (0.7, 1e7);
    let dragged = stiff(ei, Damping::Rayleigh { alpha_per_s, beta_s: 0.0 });
    let inertia = 1.0 + 0.1 * 1.5 * 1.5;
    let expected = dragged.tip[0].acceleration_m_s2.iter().zip(&dragged.tip[0].velocity_m_s);
    let expected: Vec<f64> =
        expected.map(|(a, v)| (inertia * a + (alpha_per_s * inertia + 0.05) * v) / 1.5).collect();
    let difference: Vec<f64> =
        dragged.hub().torque_n_m.iter().zip(&expected).map(|(t, e)| t - e).collect();
    assert!(peak(&difference) < 1e-5 * peak(&expected), "{:e}", peak(&difference));
    // Without the drag the torque differs by α I v_max / L.
    let free = peak(&stiff(ei, Damping::None).hub().torque_n_m);
    assert!(peak(&dragged.hub().torque_n_m) > 1.01 * free);
}
