//! The rigid arm by Newton and Euler, apart from that of the library.

use flexlink::link::{LinkParts, LumpedMass};

use crate::elastica::Turn;

/// Torques of a rigid arm by Newton and Euler, link by link in fixed axes.
pub(super) fn torques_n_m(
    parts: &[LinkParts],
    turns: &[Turn],
    gravity: [f64; 2],
    time_s: f64,
) -> Vec<f64> {
    efforts(parts, turns, gravity, time_s).0
}

/// Torques of a rigid arm, and the force along x and y on its first link.
pub(super) fn efforts(
    parts: &[LinkParts],
    turns: &[Turn],
    gravity: [f64; 2],
    time_s: f64,
) -> (Vec<f64>, [f64; 2]) {
    let mut axis = gravity.map(|part| -part);
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let plus = |a: [f64; 2], b: [f64; 2], times: f64| [a[0] + times * b[0], a[1] + times * b[1]];
    let mut inner = Vec::new();
    for (parts, turn) in parts.iter().zip(turns) {
        let [angle, rate, acceleration] = turn.at(time_s);
        let e = [angle.cos(), angle.sin()];
        let n = [-e[1], e[0]];
        // Acceleration of a place per distance from its joint.
        let per_m = plus([acceleration * n[0], acceleration * n[1]], e, -rate * rate);
        let (mut force, mut moment) = ([0.0; 2], parts.hub.inertia_kg_m2 * acceleration);
        let mut add = |mass_kg: f64, at_m: f64| {
            let own = plus(axis, per_m, at_m);
            force = plus(force, own, mass_kg);
            moment += mass_kg * at_m * cross(e, own);
        };
        let mut from_m = parts.hub.radius_m;
        for segment in &parts.segments {
            // Masses of linear density by Gauss and Legendre's three points: exact for s² m.
            let r = 0.6_f64.sqrt();
            for (x, weight) in
                [(0.5 - 0.5 * r, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + 0.5 * r, 5.0 / 18.0)]
            {
                let mass = segment.mass_per_length_kg_m.at(x) * segment.length_m * weight;
                add(mass, from_m + x * segment.length_m);
            }
            from_m += segment.length_m;
        }
        for LumpedMass { at_m, mass_kg, .. } in &parts.masses {
            add(*mass_kg, *at_m);
        }
        add(parts.payload.mass_kg, from_m + parts.payload.offset_m);
        let inertias = parts.masses.iter().map(|mass| mass.inertia_kg_m2).sum::<f64>();
        moment += (inertias + parts.payload.inertia_kg_m2) * acceleration;
        inner.push((force, moment, e, from_m, rate, parts.hub.viscous_friction_n_m_s_rad));
        axis = plus(axis, per_m, from_m);
    }
    let (mut torques, mut outer, mut torque) = (Vec::new(), [0.0; 2], 0.0);
    for (joint, (force, moment, e, length_m, rate, friction)) in inner.iter().enumerate().rev() {
        torque += moment + length_m * cross(*e, outer);
        outer = plus(*force, outer, 1.0);
        let before = if joint > 0 { inner[joint - 1].4 } else { 0.0 };
        torques.insert(0, torque + friction * (rate - before));
    }
    (torques, outer)
}
