//! Laws that hold for every link that follows a chord (energy, rotation, units, the rigid limit).

use flexlink::elastica::{ArmPeriod, ElasticaError, ElasticaMotion, Kept, SecondOrder};
use flexlink::link::{Damping, Hub, LinkParts, LumpedMass, Payload, Segment, Taper};

use super::{STEP_S, Turn, arm, chord, follow, model};
use crate::common::{difference, peak};

pub(crate) const GRAVITY: [f64; 2] = [0.0, -9.81];

fn turn() -> Turn {
    Turn { from_rad: -1.2, by_rad: 1.7, duration_s: 1.2 }
}

/// A link with all that a link can carry but shear: tapers, a hub radius, masses at the root, within and at the tip,
/// and a payload with inertia beyond the tip.
pub(crate) fn loaded_arm() -> LinkParts {
    let segment = |length_m, stiffness: [f64; 2], mass: [f64; 2]| Segment {
        bending_stiffness_n_m2: Taper { inner: stiffness[0], outer: stiffness[1] },
        mass_per_length_kg_m: Taper { inner: mass[0], outer: mass[1] },
        ..Segment::uniform(length_m, 1.0, 1.0)
    };
    let mass = |at_m, mass_kg, inertia_kg_m2| LumpedMass { at_m, mass_kg, inertia_kg_m2 };
    LinkParts {
        segments: vec![
            segment(0.5, [30.0, 22.0], [0.6, 0.5]),
            segment(0.5, [20.0, 14.0], [0.5, 0.3]),
        ],
        hub: Hub { inertia_kg_m2: 0.05, radius_m: 0.1, viscous_friction_n_m_s_rad: 0.3 },
        masses: vec![mass(0.1, 0.2, 1e-3), mass(0.6, 0.1, 5e-4), mass(1.1, 0.05, 2e-4)],
        payload: Payload { mass_kg: 0.15, inertia_kg_m2: 1e-4, offset_m: 0.05 },
        ..arm()
    }
}

/// Potential and strain energy of the elastica at a sample, from its nodes: Hermite's cubics on a fine rule of
/// Simpson's, all in fixed axes.
pub(crate) struct Energy<'a> {
    pub(crate) parts: &'a LinkParts,
    pub(crate) nodes_m: &'a [f64],
    pub(crate) found: &'a ElasticaMotion,
}

impl Energy<'_> {
    /// (w, w', w'') at a place of an element.
    fn bent(&self, sample: usize, element: usize, x: f64) -> [f64; 3] {
        let l = self.nodes_m[element + 1] - self.nodes_m[element];
        let dof = |k: usize| self.found.deflections[2 * element + k][sample];
        let shapes = [
            [
                1.0 - 3.0 * x * x + 2.0 * x.powi(3),
                6.0 * (x * x - x) / l,
                (12.0 * x - 6.0) / (l * l),
            ],
            [l * (x - 2.0 * x * x + x.powi(3)), 1.0 - 4.0 * x + 3.0 * x * x, (6.0 * x - 4.0) / l],
            [3.0 * x * x - 2.0 * x.powi(3), 6.0 * (x - x * x) / l, (6.0 - 12.0 * x) / (l * l)],
            [l * (x.powi(3) - x * x), 3.0 * x * x - 2.0 * x, (6.0 * x - 2.0) / l],
        ];
        [0, 1, 2].map(|order| (0..4).map(|k| shapes[k][order] * dof(k)).sum())
    }

    fn linear(&self, s_m: f64, of: fn(&Segment) -> Taper) -> f64 {
        let mut from_m = self.parts.hub.radius_m;
        for segment in &self.parts.segments {
            if s_m <= from_m + segment.length_m {
                return of(segment).at((s_m - from_m) / segment.length_m);
            }
            from_m += segment.length_m;
        }
        of(self.parts.segments.last().expect("a segment")).outer
    }

    /// Potential, and strain energy, at a sample; the chord's direction is given.
    pub(crate) fn at(&self, sample: usize, chord_rad: f64) -> [f64; 2] {
        const PIECES: usize = 40;
        let (sine, cosine) = chord_rad.sin_cos();
        let height = |x: f64, w: f64| x * sine + w * cosine;
        let slope_of = |node: usize| self.found.deflections[2 * node + 1][sample];
        let weight = -GRAVITY[1];
        let radius = self.parts.hub.radius_m;
        let mut along = radius * (1.0 - slope_of(0).powi(2)).sqrt();
        let (mut potential, mut strain) = (0.0, 0.0);
        let masses = |node: usize| {
            let near = move |mass: &&LumpedMass| (mass.at_m - self.nodes_m[node]).abs() < 1e-9;
            self.parts.masses.iter().filter(near).map(|mass| mass.mass_kg).sum::<f64>()
        };
        for element in 0..self.nodes_m.len() - 1 {
            let l = self.nodes_m[element + 1] - self.nodes_m[element];
            potential += weight
                * masses(element)
                * height(along, self.found.deflections[2 * element][sample]);
            let h = 1.0 / PIECES as f64;
            for piece in 0..PIECES {
                let at = |x: f64| {
                    let [w, slope, curve] = self.bent(sample, element, x);
                    let s_m = self.nodes_m[element] + l * x;
                    let mass = self.linear(s_m, |segment| segment.mass_per_length_kg_m);
                    let stiffness = self.linear(s_m, |segment| segment.bending_stiffness_n_m2);
                    let cosine = (1.0 - slope * slope).sqrt();
                    (cosine, w, mass, 0.5 * stiffness * (curve / cosine).powi(2))
                };
                let from = piece as f64 * h;
                let [first, middle, last] = [from, from + 0.5 * h, from + h].map(at);
                let quarter = at(from + 0.25 * h);
                // The chord's part up to the middle and to the end of the piece.
                let to_middle = along + (first.0 + 4.0 * quarter.0 + middle.0) * 0.5 * h * l / 6.0;
                let to_end = along + (first.0 + 4.0 * middle.0 + last.0) * h * l / 6.0;
                let lifted = |along: f64, of: &(f64, f64, f64, f64)| of.2 * height(along, of.1);
                potential += weight
                    * (lifted(along, &first)
                        + 4.0 * lifted(to_middle, &middle)
                        + lifted(to_end, &last))
                    * h
                    * l
                    / 6.0;
                strain += (first.3 + 4.0 * middle.3 + last.3) * h * l / 6.0;
                along = to_end;
            }
        }
        let tip = self.nodes_m.len() - 1;
        potential += weight * masses(tip) * height(along, 0.0);
        let (slope, payload) = (slope_of(tip), self.parts.payload);
        let beyond = along + payload.offset_m * (1.0 - slope * slope).sqrt();
        potential += weight * payload.mass_kg * height(beyond, payload.offset_m * slope);
        [potential, strain]
    }

    /// Energy that the damping takes, `∫∫ β EI κ̇² ds dt`.
    pub(crate) fn dissipated(&self, beta_s: f64, last: usize) -> f64 {
        let curvature = |sample: usize, element: usize, x: f64| {
            let [_, slope, curve] = self.bent(sample, element, x);
            curve / (1.0 - slope * slope).sqrt()
        };
        let mut sum = 0.0;
        for element in 0..self.nodes_m.len() - 1 {
            let l = self.nodes_m[element + 1] - self.nodes_m[element];
            // Gauss and Legendre's three points.
            let r = 0.6_f64.sqrt();
            for (place, weight) in
                [(0.5 - 0.5 * r, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + 0.5 * r, 5.0 / 18.0)]
            {
                let s_m = self.nodes_m[element] + l * place;
                let stiffness = self.linear(s_m, |segment| segment.bending_stiffness_n_m2);
                for k in 2..last {
                    let at = |k: usize| curvature(k, element, place);
                    let rate =
                        (8.0 * (at(k + 1) - at(k - 1)) - (at(k + 2) - at(k - 2))) / (12.0 * STEP_S);
                    sum += beta_s * stiffness * rate * rate * STEP_S * weight * l;
                }
            }
        }
        sum
    }
}

/// Equilibrium of all that lies outboard, summed from the tip inward, against the torque, which the method finds by
/// virtual work. A rigid turn is one of the mesh's motions, so that both are the same, but for large slopes: there
/// they agree as the mesh does.
#[test]
fn the_moment_at_the_axis_is_the_torque_less_what_the_hub_takes() {
    let hub = Hub { radius_m: 0.0, ..loaded_arm().hub };
    let shorter = |mass: &LumpedMass| LumpedMass { at_m: mass.at_m - 0.1, ..*mass };
    let without_radius = LinkParts {
        hub,
        masses: loaded_arm().masses.iter().map(shorter).collect(),
        ..loaded_arm()
    };
    for (parts, gravity) in [(arm(), GRAVITY), (without_radius, GRAVITY), (arm(), [0.0; 2])] {
        for level in [SecondOrder::None, SecondOrder::First, SecondOrder::Full] {
            let off = |elements: usize| {
                let model = model(&parts, elements);
                let found =
                    follow(&model, &chord(&turn(), gravity), level, 1e-10).expect("a motion");
                let last = Turn::sample(turn().duration_s + 1.0);
                let angle = |k: usize| {
                    turn().at(k as f64 * STEP_S - super::BEFORE_S)[0] + found.hub_slope_rad[k]
                };
                let far = (3..last).map(|k| {
                    let (near, next) = ([angle(k - 1), angle(k + 1)], [angle(k - 2), angle(k + 2)]);
                    let middle = angle(k);
                    let rate = (8.0 * (near[1] - near[0]) - (next[1] - next[0])) / (12.0 * STEP_S);
                    let turning =
                        (16.0 * (near[0] + near[1]) - (next[0] + next[1]) - 30.0 * middle)
                            / (12.0 * STEP_S * STEP_S);
                    let taken = parts.hub.inertia_kg_m2 * turning
                        + parts.hub.viscous_friction_n_m_s_rad * rate;
                    (found.torque_n_m[k] - taken - found.moments_n_m[0][k]).abs()
                });
                let range = peak(&found.torque_n_m);
                far.fold(0.0, f64::max) / range
            };
            let (coarse, fine) = (off(4), off(8));
            match level {
                SecondOrder::Full => {
                    assert!(fine < 1e-6 && fine < 0.1 * coarse, "{coarse:e}, {fine:e}");
                }
                _ => assert!(coarse < 1e-9 && fine < 1e-9, "{level:?}: {coarse:e}, {fine:e}"),
            }
        }
    }
}

fn differ(a: &ElasticaMotion, b: &ElasticaMotion) -> f64 {
    difference(&b.torque_n_m, &a.torque_n_m)
}

/// Of a stiffer link the deflections fall as 1/EI: what first order counts falls with them, what it leaves out with
/// their square. A wrong term of first order would leave a part that falls no faster than they do.
#[test]
fn first_order_leaves_out_the_square_of_the_deflections() {
    let apart = |stiffer: f64| {
        let mut parts = loaded_arm();
        for segment in &mut parts.segments {
            segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(stiffer);
        }
        parts.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 3e-4 / stiffer };
        let model = model(&parts, 6);
        let [none, first, full] = [SecondOrder::None, SecondOrder::First, SecondOrder::Full]
            .map(|order| follow(&model, &chord(&turn(), GRAVITY), order, 1e-12).expect("a motion"));
        [differ(&full, &none), differ(&full, &first)]
    };
    let ([counted, left], [counted_less, left_less]) = (apart(400.0), apart(1600.0));
    assert!((3.9..4.1).contains(&(counted / counted_less)), "{counted:e} {counted_less:e}");
    assert!((15.0..17.0).contains(&(left / left_less)), "{left:e} {left_less:e}");
}

/// A stiff link takes the torque of the rigid one: the pendulum's.
#[test]
fn a_link_that_hardly_bends_is_the_rigid_pendulum() {
    let stiff = LinkParts {
        segments: vec![Segment::uniform(1.1, 2e7, 0.5)],
        damping: Damping::None,
        ..arm()
    };
    let found = follow(&model(&stiff, 4), &chord(&turn(), GRAVITY), SecondOrder::Full, 1e-12);
    let found = found.expect("a motion");
    let inertia = 0.05 + 0.5 * 1.1_f64.powi(3) / 3.0 + 0.2 * 1.1 * 1.1 + 1e-4;
    let moment = 9.81 * (0.5 * 1.1 * 1.1 / 2.0 + 0.2 * 1.1);
    for k in 0..Turn::sample(turn().duration_s + 1.0) {
        let [angle, _, acceleration] = turn().at(k as f64 * STEP_S - super::BEFORE_S);
        let torque = inertia * acceleration + moment * angle.cos();
        let off = (found.torque_n_m[k] - torque).abs() / 40.0;
        assert!(off < 1e-6, "{off:e} at {k}");
    }
}

/// At a constant rate, without gravity, every element of a turning link pulls at the axis, and the torque is that of friction.
#[test]
fn a_steady_turn_takes_no_torque_and_does_not_bend() {
    let len = 256;
    let columns = [vec![0.0; len], vec![6.0; len], vec![0.0; len]];
    let chord = ArmPeriod::new(STEP_S, vec![columns], Kept::Angles, [0.0; 2]).expect("a period");
    let found = follow(&model(&loaded_arm(), 6), &chord, SecondOrder::Full, 1e-11);
    let (found, friction) = (found.expect("a motion"), 0.3 * 6.0);
    assert!(found.torque_n_m.iter().all(|t| (t - friction).abs() < 1e-12));
    assert!(found.largest_slope < 1e-12);
}

#[test]
fn what_is_not_derived_is_refused() {
    let refused = |parts: &LinkParts, gravity, second_order| {
        let found = follow(&model(parts, 4), &chord(&turn(), gravity), second_order, 1e-9);
        found.expect_err("a refusal").to_string()
    };
    let damped = |damping| LinkParts { damping, ..arm() };
    let dragged = damped(Damping::Rayleigh { alpha_per_s: 0.1, beta_s: 1e-4 });
    let modal = damped(Damping::Modal { ratios: vec![0.02] });
    assert!(refused(&dragged, GRAVITY, SecondOrder::None).contains("alpha = 0"));
    assert!(refused(&dragged, [0.0; 2], SecondOrder::Full).contains("alpha = 0"));
    assert!(refused(&modal, GRAVITY, SecondOrder::None).contains("hysteretic or rayleigh"));
    let mut soft = arm();
    soft.segments[0].bending_stiffness_n_m2 = Taper::constant(0.5);
    assert!(refused(&soft, GRAVITY, SecondOrder::Full).starts_with("slope of the link"));
    let chord_of_turn = chord(&turn(), GRAVITY);
    for tolerance in [0.0, f64::NAN, 1.0] {
        let found = follow(&model(&arm(), 4), &chord_of_turn, SecondOrder::Full, tolerance);
        assert!(matches!(found, Err(ElasticaError::Tolerance(_))), "{found:?}");
    }
    let jumps = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    let columns = [vec![0.0; 64], vec![0.0; 64], (0..64).map(jumps).collect()];
    let coarse = ArmPeriod::new(STEP_S, vec![columns], Kept::Angles, [0.0; 2]).expect("a period");
    let found = follow(&model(&arm(), 4), &coarse, SecondOrder::Full, 1e-9);
    assert!(matches!(found, Err(ElasticaError::LongStep { .. })), "{found:?}");
    let uneven =
        ArmPeriod::new(STEP_S, vec![[8, 7, 8].map(|len| vec![0.0; len])], Kept::Angles, [0.0; 2]);
    assert!(uneven.expect_err("a refusal").to_string().contains("equally many"));
    let lost = [vec![0.0; 8], vec![0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0], vec![0.0; 8]];
    let lost = ArmPeriod::new(STEP_S, vec![lost], Kept::Angles, [0.0; 2])
        .expect_err("a refusal")
        .to_string();
    assert_eq!(lost, "rate of sample 2 = NaN, but must be a finite number");
}
