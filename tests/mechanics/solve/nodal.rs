//! Deflections, displacements and bending moments at the nodes.

use std::num::NonZeroUsize;

use super::{Smooth, link, peak, solved};
use crate::common::{apart, difference};
use flexlink::inverse::Solution;
use flexlink::link::{Damping, Link, Payload};

fn all_nodes(solution: &Solution) -> Vec<usize> {
    (0..solution.links[0].mesh().nodes_m().len()).collect()
}

fn undamped() -> Link {
    link(|parts| {
        parts.damping = Damping::None;
        parts.hub.viscous_friction_n_m_s_rad = 0.1;
    })
}

#[test]
fn the_root_does_not_deflect_and_the_last_node_is_the_tip() {
    let loaded = link(|parts| {
        parts.payload = Payload { mass_kg: 0.1, inertia_kg_m2: 0.0, offset_m: 0.0 };
        parts.hub.radius_m = 0.1;
    });
    for link in [undamped(), loaded] {
        let solution = solved(&link, 10, &Smooth::MOVE.motion());
        let deflections =
            solution.deflections(&all_nodes(&solution), NonZeroUsize::MIN).unwrap().histories();
        assert!(deflections.samples[0].iter().all(|w| *w == 0.0));
        let displacements =
            solution.displacements(&all_nodes(&solution), NonZeroUsize::MIN).unwrap().histories();
        let tip = displacements.samples.last().unwrap();
        assert!(apart(tip, &solution.tip[0].displacement_m) < 1e-9 * 0.5);
        let deflection = deflections.samples.last().unwrap();
        assert!(apart(deflection, &solution.tip_deflection_m(0)) < 1e-9);
        let radius_m = link.hub().radius_m;
        let root: Vec<_> = solution.hub().angle_rad.iter().map(|theta| radius_m * theta).collect();
        assert!(apart(&displacements.samples[0], &root) < 1e-15);
    }
}

#[test]
fn chosen_nodes_and_rows_are_those_of_the_whole_table() {
    let solution = solved(&link(|_| ()), 10, &Smooth::MOVE.motion());
    let whole = solution.deflections(&all_nodes(&solution), NonZeroUsize::MIN).unwrap().histories();
    let few = solution.deflections(&[7, 2], NonZeroUsize::new(5).unwrap()).unwrap().histories();
    assert_eq!(few.nodes, [7, 2]);
    assert_eq!(few.grid.len(), solution.grid.len.div_ceil(5));
    for (node, samples) in few.nodes.iter().zip(&few.samples) {
        let expected: Vec<f64> = whole.samples[*node].iter().copied().step_by(5).collect();
        assert_eq!(*samples, expected);
    }
}

/// `M_root = T − I_H θ̈ − b θ̇` on a hub without radius.
#[test]
fn the_moment_at_the_root_is_what_hub_and_friction_leave_of_the_torque() {
    let solution = solved(&undamped(), 10, &Smooth::MOVE.motion());
    let peak_n_m = peak(&solution.hub().torque_n_m);
    let acceleration = solution.acceleration_rad_s2(0);
    let hub = acceleration.iter().zip(&solution.hub().rate_rad_s);
    let left = solution.hub().torque_n_m.iter().zip(hub);
    let left: Vec<_> = left.map(|(t, (a, rate))| t - 0.1 * a - 0.1 * rate).collect();
    assert!(apart(&solution.links[0].root_moment_n_m, &left) < 1e-9 * peak_n_m);
    let at_node = solution.moments(&[0], NonZeroUsize::MIN).unwrap().histories();
    let difference = apart(&at_node.samples[0], &solution.links[0].root_moment_n_m);
    assert!(difference < 1e-12 * peak_n_m);
}

#[test]
fn a_tip_without_payload_is_free_of_moment_and_one_with_inertia_is_not() {
    let solution = solved(&undamped(), 10, &Smooth::MOVE.motion());
    let tip = solution.links[0].mesh().nodes_m().len() - 1;
    assert!(
        solution.moments(&[tip], NonZeroUsize::MIN).unwrap().histories().samples[0]
            .iter()
            .all(|m| *m == 0.0)
    );
    let heavy = link(|parts| {
        parts.payload = Payload { mass_kg: 0.1, inertia_kg_m2: 0.001, offset_m: 0.02 };
    });
    let solution = solved(&heavy, 10, &Smooth::MOVE.motion());
    assert!(
        peak(&solution.moments(&[tip], NonZeroUsize::MIN).unwrap().histories().samples[0]) > 1e-3
    );
}

/// EI w″ = −m, the curvature from second differences of the deflections.
#[test]
fn the_moment_bends_the_link_against_its_sign() {
    let solution = solved(&undamped(), 60, &Smooth::MOVE.motion());
    let nodes = all_nodes(&solution);
    let w =
        solution.deflections(&nodes, NonZeroUsize::new(4).unwrap()).unwrap().histories().samples;
    let moments =
        solution.moments(&nodes, NonZeroUsize::new(4).unwrap()).unwrap().histories().samples;
    let spacing: f64 = 1.5 / 60.0;
    for node in [1, 20, 40, 55] {
        let bending = |k: usize| {
            -5.0 * (w[node - 1][k] - 2.0 * w[node][k] + w[node + 1][k]) / spacing.powi(2)
        };
        let bending: Vec<_> = (0..w[node].len()).map(bending).collect();
        let difference = difference(&bending, &moments[node]);
        assert!(difference < 0.01, "node {node}: {difference}");
    }
}

/// `T = I_H θ̈ + b θ̇ + ∫ m̄ x v̈ dx`, by Simpson and second differences in time.
#[test]
fn the_torque_balances_the_angular_momentum_of_the_moving_link() {
    let solution = solved(&undamped(), 24, &Smooth { steps: 1024, ..Smooth::MOVE }.motion());
    let nodes = all_nodes(&solution);
    let v = solution.displacements(&nodes, NonZeroUsize::MIN).unwrap().histories().samples;
    let (step_s, spacing) = (solution.grid.step_s, 1.5 / 24.0);
    let weight = |node: usize| match node {
        0 | 24 => 1.0,
        _ if node % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let hub_acceleration_rad_s2 = solution.acceleration_rad_s2(0);
    let balance = (1..solution.grid.len - 1).map(|k| {
        let second = |v: &Vec<f64>| (v[k - 1] - 2.0 * v[k] + v[k + 1]) / step_s.powi(2);
        let moment = |node: usize| weight(node) * spacing * node as f64 * second(&v[node]);
        let beam = 0.8 * nodes.iter().map(|node| moment(*node)).sum::<f64>() * spacing / 3.0;
        0.1 * hub_acceleration_rad_s2[k] + 0.1 * solution.hub().rate_rad_s[k] + beam
    });
    let balance: Vec<_> = balance.collect();
    let difference = difference(&balance, &solution.hub().torque_n_m[1..solution.grid.len - 1]);
    assert!(difference < 5e-4, "{difference:e}");
}

#[test]
fn a_thinned_table_of_displacements_ends_with_the_tip_at_the_same_times() {
    let solution = solved(&link(|_| ()), 10, &Smooth::SHORT.motion());
    let last = solution.links[0].mesh().nodes_m().len() - 1;
    for every in [1, 3, 7] {
        let rows = solution
            .displacements(&[last], NonZeroUsize::new(every).unwrap())
            .unwrap()
            .histories()
            .samples
            .concat();
        assert_eq!(rows.len(), solution.grid.len.div_ceil(every));
        for (row, v) in rows.iter().enumerate() {
            let tip = solution.tip[0].displacement_m[row * every];
            assert!((v - tip).abs() < 1e-12, "row {row} of every {every}: {v} is not {tip}");
        }
    }
}
