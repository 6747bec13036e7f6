//! Work of the torque against what the link dissipates, by formulas that the inversion has no
//! part in.

use std::num::NonZeroUsize;

use super::{Smooth, link, peak, sine, solved};
use flexlink::inverse::Solution;
use flexlink::link::{Damping, Payload, Taper};

/// ∫ T θ̇ dt over the window, which begins and ends at rest.
fn work_j(solution: &Solution) -> f64 {
    let power =
        solution.hub().torque_n_m.iter().zip(&solution.hub().rate_rad_s).map(|(t, rate)| t * rate);
    power.sum::<f64>() * solution.grid.step_s
}

/// ∫ m̄ v̇² dx of a uniform link at every sample, from central differences of the displacements.
///
/// Simpson over an even number of elements.
fn velocity_squared_n_m(solution: &Solution, mass_per_length_kg_m: f64) -> Vec<f64> {
    let nodes: Vec<usize> = (0..solution.links[0].mesh().nodes_m().len()).collect();
    let histories = solution.displacements(&nodes, NonZeroUsize::MIN).unwrap().histories().samples;
    let last = nodes.len() - 1;
    let spacing = solution.links[0].mesh().length_m() / last as f64;
    let weight = |node: usize| match node {
        _ if node == 0 || node == last => 1.0,
        _ if node % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let step_s = solution.grid.step_s;
    (0..solution.grid.len)
        .map(|k| {
            if k == 0 || k + 1 == solution.grid.len {
                return 0.0;
            }
            let velocity = |v: &Vec<f64>| (v[k + 1] - v[k - 1]) / (2.0 * step_s);
            let squares =
                histories.iter().enumerate().map(|(node, v)| weight(node) * velocity(v).powi(2));
            mass_per_length_kg_m * squares.sum::<f64>() * spacing / 3.0
        })
        .collect()
}

/// Largest kinetic energy of the link, were it rigid.
fn kinetic_j(solution: &Solution, inertia_kg_m2: f64) -> f64 {
    let rate = peak(&solution.tip[0].velocity_m_s) / solution.links[0].mesh().length_m();
    0.5 * inertia_kg_m2 * rate * rate
}

#[test]
fn an_undamped_link_takes_no_work_from_rest_to_rest() {
    for payload_kg in [0.0, 0.2] {
        let link = link(|parts| {
            parts.damping = Damping::None;
            parts.payload = Payload { mass_kg: payload_kg, ..Payload::default() };
        });
        let solution = solved(&link, 10, &Smooth::SHORT.motion());
        assert!(solution.warnings.is_empty(), "{:?}", solution.warnings);
        let share = work_j(&solution) / kinetic_j(&solution, link.rigid_inertia_kg_m2());
        assert!(share.abs() < 1e-6, "{share:e}");
    }
}

#[test]
fn the_work_of_the_torque_is_what_a_drag_on_the_mass_dissipates() {
    let (alpha_per_s, payload_kg) = (0.4, 0.1);
    let link = link(|parts| {
        parts.damping = Damping::Rayleigh { alpha_per_s, beta_s: 0.0 };
        parts.payload.mass_kg = payload_kg;
    });
    let solution = solved(&link, 24, &Smooth { steps: 1024, ..Smooth::MOVE }.motion());
    // α ∫ (∫ m̄ v̇² dx + I_H θ̇² + m_t v̇_tip²) dt
    let beam = velocity_squared_n_m(&solution, 0.8);
    let hub = solution.hub().rate_rad_s.iter().map(|rate| 0.1 * rate * rate);
    let tip = solution.tip[0].velocity_m_s.iter().map(|v| payload_kg * v * v);
    let all = beam.iter().zip(hub).zip(tip).map(|((beam, hub), tip)| beam + hub + tip);
    let dissipated_j = alpha_per_s * all.sum::<f64>() * solution.grid.step_s;
    let share = work_j(&solution) / dissipated_j - 1.0;
    assert!(share.abs() < 2e-5, "{share:e}");
}

#[test]
fn the_work_of_the_torque_is_what_the_hub_rubs_away() {
    let friction = 0.3;
    let link = link(|parts| {
        parts.damping = Damping::None;
        parts.hub.viscous_friction_n_m_s_rad = friction;
    });
    let solution = solved(&link, 10, &Smooth::MOVE.motion());
    let rubbed = solution.hub().rate_rad_s.iter().map(|rate| friction * rate * rate);
    let rubbed_j = rubbed.sum::<f64>() * solution.grid.step_s;
    assert!((work_j(&solution) / rubbed_j - 1.0).abs() < 1e-5);
}

#[test]
fn damping_of_the_material_takes_work_in_proportion_to_its_ratio() {
    let work = |damping: Damping| {
        let link = link(|parts| parts.damping = damping);
        let solution = solved(&link, 10, &sine(0.5, 0.88, 440));
        work_j(&solution) / kinetic_j(&solution, 1.0)
    };
    let hysteretic = [0.005, 0.01].map(|ratio| work(Damping::Hysteretic { ratio }));
    assert!(hysteretic[0] > 1e-4, "{hysteretic:?}");
    assert!((hysteretic[1] / hysteretic[0] - 2.0).abs() < 0.02, "{hysteretic:?}");
    let viscous = [2e-4, 4e-4].map(|beta_s| work(Damping::Rayleigh { alpha_per_s: 0.0, beta_s }));
    assert!(viscous[0] > 1e-4 && (viscous[1] / viscous[0] - 2.0).abs() < 0.02, "{viscous:?}");
}

#[test]
fn a_nearly_rigid_link_wastes_in_proportion_to_its_compliance() {
    let work = |ei: f64| {
        let link = link(|parts| parts.segments[0].bending_stiffness_n_m2 = Taper::constant(ei));
        work_j(&solved(&link, 10, &Smooth::MOVE.motion()))
    };
    let [soft, stiff] = [1e3, 1e4].map(work);
    assert!(stiff > 0.0 && (soft / stiff / 10.0 - 1.0).abs() < 0.05, "{soft:e} J, {stiff:e} J");
}
