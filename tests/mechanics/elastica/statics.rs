//! Links at rest under their weight, against the elastica integrated as an ordinary differential equation.

use std::f64::consts::FRAC_PI_2;

use flexlink::elastica::{ArmPeriod, ElasticaMotion, Kept, SecondOrder};
use flexlink::link::{Damping, Hub, LinkParts, Payload, Segment};

use super::{STEP_S, arm, follow, model};

const G: f64 = 9.81;

/// Soft enough to bend by a fifth of its length.
fn soft() -> LinkParts {
    LinkParts {
        segments: vec![Segment::uniform(1.1, 6.0, 0.5)],
        hub: Hub::default(),
        payload: Payload { mass_kg: 0.1, inertia_kg_m2: 0.0, offset_m: 0.0 },
        damping: Damping::None,
        ..arm()
    }
}

fn at_rest(parts: &LinkParts, elements: usize, chord_rad: f64) -> ElasticaMotion {
    let columns = [vec![chord_rad; 8], vec![0.0; 8], vec![0.0; 8]];
    let chord = ArmPeriod::new(STEP_S, vec![columns], Kept::Angles, [0.0, -G]).expect("a period");
    follow(&model(parts, elements), &chord, SecondOrder::Full, 1e-12).expect("a shape")
}

/// Moment at the axis, and direction there, of a cantilever whose tip lies in the direction `chord_rad`: integrated
/// from the tip inward by Runge and Kutta's rule, the tip's own direction found by bisection.
///
/// ```text
/// dx/ds = cos φ,   dy/ds = sin φ,   EI dφ/ds = −M,   dM/ds = −(m̄ (L − s) + m) g cos φ
/// ```
pub(crate) fn elastica(parts: &LinkParts, chord_rad: f64) -> [f64; 2] {
    const STEPS: usize = 2000;
    let segment = &parts.segments[0];
    let (length, mass) = (segment.length_m, segment.mass_per_length_kg_m.inner);
    let (stiffness, tip) = (segment.bending_stiffness_n_m2.inner, parts.payload.mass_kg);
    // (φ, M, x, y) at a distance r from the tip; x and y are the tip's from there.
    let rate = |r: f64, [phi, m, ..]: [f64; 4]| {
        [m / stiffness, (mass * r + tip) * G * phi.cos(), phi.cos(), phi.sin()]
    };
    let from_tip = |tip_rad: f64| {
        let h = length / STEPS as f64;
        let mut y = [tip_rad, 0.0, 0.0, 0.0];
        for k in 0..STEPS {
            let r = k as f64 * h;
            let moved = |d: [f64; 4], by: f64| [0, 1, 2, 3].map(|i| y[i] + by * d[i]);
            let a = rate(r, y);
            let b = rate(r + 0.5 * h, moved(a, 0.5 * h));
            let c = rate(r + 0.5 * h, moved(b, 0.5 * h));
            let d = rate(r + h, moved(c, h));
            y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        y
    };
    // The direction of the chord less that wanted grows with the tip's.
    let off = |tip_rad: f64| {
        let [.., x, y] = from_tip(tip_rad);
        x.mul_add(-chord_rad.sin(), y * chord_rad.cos())
    };
    let (mut low, mut high) = (chord_rad - 1.2, chord_rad + 1.2);
    assert!(off(low) < 0.0 && off(high) > 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if off(middle) < 0.0 { low = middle } else { high = middle }
    }
    let [phi, m, ..] = from_tip(low);
    [m, phi]
}

#[test]
fn torque_and_direction_at_rest_are_those_of_the_elastica() {
    for chord_rad in [0.0, 0.7, -0.9, 2.4] {
        let [torque, direction] = elastica(&soft(), chord_rad);
        let mut errors = vec![];
        for elements in [4, 8, 16] {
            let found = at_rest(&soft(), elements, chord_rad);
            assert!(found.largest_slope > 0.1, "{}", found.largest_slope);
            let off = found.torque_n_m[3] / torque - 1.0;
            let turned = chord_rad + found.hub_slope_rad[3] - direction;
            errors.push(off.abs().max(turned.abs()));
        }
        assert!(errors[2] < 1e-6 && errors[2] < errors[0] / 150.0, "{chord_rad}: {errors:?}");
    }
}

#[test]
fn upright_and_hanging_links_stay_straight() {
    for chord_rad in [FRAC_PI_2, -FRAC_PI_2] {
        let found = at_rest(&soft(), 8, chord_rad);
        assert!(found.torque_n_m[0].abs() < 1e-12 && found.largest_slope < 1e-12);
    }
}
