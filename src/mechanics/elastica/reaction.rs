//! Results for a bent link: measures of its changes, and forces and bending moments by equilibrium of the outboard
//! part.

use super::chord::{TipLoad, counting};
use super::error::{ElasticaError, STEEPEST};
use super::kinematics::ArmPeriod;
use super::loads::{
    BentLink, Instant, Place, Scratch, SecondOrder, along, left_across, shortening,
};
use super::points::dot;
use num_complex::Complex64;

use crate::beam::{LoadedMotion, Mesh};
use crate::numeric::{Size, extremes, magnitude};

/// Range of a torque over its largest value below which the link counts as at rest.
const AT_REST: f64 = 1e-6;

/// Bending angle in rad below which a link counts as straight.
const STRAIGHT: f64 = 1e-6;

/// A link whose tip stays on the chord, over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticaMotion {
    /// Torque at the hub in N m, including its inertia and friction but not its drive.
    pub torque_n_m: Vec<f64>,
    /// Angle of the hub from the chord in rad; displacement of a carriage from the chord in m.
    pub hub_slope_rad: Vec<f64>,
    /// Deflection in m and slope w' of nodes 0 … n from the chord: a history for each, in turn.
    pub deflections: Vec<Vec<f64>>,
    /// Advance of nodes 0 … n along the chord relative to the link, x − s ≤ 0 in m; zero without all terms.
    pub shortenings_m: Vec<Vec<f64>>,
    /// Bending moment in N m at nodes 0 … n, exerted by the part of the link towards the hub on the part towards the
    /// tip. A body on a node belongs to the outer part.
    pub moments_n_m: Vec<Vec<f64>>,
    /// Largest slope |w'| of the link from its chord.
    pub largest_slope: f64,
}

/// Course of the iteration of second-order terms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Iteration {
    /// Number of iterations; 0 without second order.
    pub iterations: usize,
    /// Ratio of the last iteration's largest change of a torque to the change before; `None` before the second
    /// iteration.
    pub contraction: Option<f64>,
    /// Estimated change of the torques, each relative to its range, by further iterations and by second-order terms of
    /// neglected frequencies. It exceeds the tolerance if the terms of high frequencies do not converge.
    pub error: f64,
    /// The same change of the force in N on the inner end of the first link, measured beside the iteration.
    pub reaction_n: f64,
    /// Largest change of the torques by the second order, each relative to its range; for several links without friction.
    pub second_order_change: f64,
    /// True if second-order terms reach beyond the frequencies that the samples resolve: half the step would change
    /// them.
    pub exceeds_step: bool,
}

/// The motion of one link of an arm over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmLinkMotion {
    /// Torque of its joint, including friction, and the bending of the link.
    pub bent: ElasticaMotion,
    /// Angle of the chord in rad, its rate and its acceleration; of a link that slides its displacement across in m.
    pub chord: [Vec<f64>; 3],
    /// Length of the chord in m.
    pub chord_length_m: Vec<f64>,
    /// Angle of the tip's tangent line from the chord in rad.
    pub tip_slope_rad: Vec<f64>,
    /// Force in N on the inner end along the plane's x and y axes, at the frequencies of the loads.
    pub force_n: [Vec<f64>; 2],
}

/// The motion of an arm over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmMotion {
    /// Links, the inner one first.
    pub links: Vec<ArmLinkMotion>,
    /// Course of the iteration of second-order terms.
    pub iteration: Iteration,
    /// Second-order terms of the motion.
    pub second_order: SecondOrder,
    /// Other approximations: the iteration before the last and, if terms of high frequencies are neglected, the motion
    /// without more of them. The factor on the distance from this motion gives the change by further terms.
    pub(super) others: Vec<(Vec<Vec<LoadedMotion<Complex64>>>, f64)>,
}

/// Force along the chord and across it, and moment about a node, that accelerate the part outboard.
#[derive(Clone, Copy, Default)]
struct Reaction {
    along_n: f64,
    across_n: f64,
    moment_n_m: f64,
}

impl Reaction {
    /// The reaction about a place that lies inward by these distances.
    fn moved(self, x_m: f64, w_m: f64) -> Self {
        let moment_n_m = self.moment_n_m + x_m * self.across_n - w_m * self.along_n;
        Self { moment_n_m, ..self }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            along_n: self.along_n + other.along_n,
            across_n: self.across_n + other.across_n,
            moment_n_m: self.moment_n_m + other.moment_n_m,
        }
    }
}

/// Coefficients of the force on the root of a straight link.
pub(super) struct Straight {
    pub(super) mass_kg: f64,
    /// Mass times distance from the axis.
    pub(super) moment_kg_m: f64,
    /// Force across the chord per acceleration of w and w' of nodes 0 … n, in kg and kg m.
    pub(super) across_kg: Vec<[f64; 2]>,
}

impl BentLink {
    /// Writes pairs into `shape`: the shortening x − s in m of nodes 0 … n, and the bending moment in N m there of the
    /// part towards the hub on the part towards the tip. Returns the largest slope.
    ///
    /// ```text
    /// F_i = F_j + Σ m a,     M_i = M_j + (r_j − r_i) × F_j + Σ ((r − r_i) × m a + J φ̈)
    /// ```
    ///
    /// The sums are over the points of the element and the bodies on its inner node.
    pub(super) fn shape(&self, now: &Instant<'_>, scratch: &mut Scratch, shape: &mut [f64]) -> f64 {
        let largest = self.place(now, scratch);
        let TipLoad { along_n, across_n, torque_n_m } = now.tip;
        let (along_n, across_n) = (-self.borne(along_n), -across_n);
        let mut outer = Reaction { along_n, across_n, moment_n_m: torque_n_m };
        let mut bodies = self.bodies.iter().zip(&scratch.body_places).rev().peekable();
        let last = self.points.elements.len();
        for node in (0..=last).rev() {
            let here = self.node(now, scratch, node);
            if let Some(points) = self.points.elements.get(node) {
                let next = self.node(now, scratch, node + 1);
                outer = outer.moved(next.0 - here.0, next.1 - here.1);
                let dofs: [f64; 4] = std::array::from_fn(|k| now.acceleration[2 * node + k]);
                for (point, place) in points.iter().zip(&scratch.places[node]) {
                    let w_acceleration = dot(&point.shape, &dofs);
                    let mass_kg = point.mass_kg_m * point.weight_m;
                    outer = outer.plus(self.needed(now, place, mass_kg, w_acceleration, here));
                }
            }
            while let Some((body, place)) = bodies.next_if(|(body, _)| body.node == node) {
                let slope = self.slope_at(now, node);
                let slope_acceleration = now.acceleration[2 * node + 1];
                let w_acceleration = now.acceleration[2 * node] + body.arm_m * slope_acceleration;
                outer = outer.plus(self.needed(now, place, body.mass_kg, w_acceleration, here));
                let turning = match self.second_order {
                    SecondOrder::Full => slope.turning(),
                    _ => slope_acceleration,
                };
                let turned = now.chord_acceleration_rad_s2 + turning;
                outer.moment_n_m += body.inertia_kg_m2 * turned;
            }
            shape[2 * node] = scratch.shortened[node];
            shape[2 * node + 1] = outer.moment_n_m;
        }
        largest
    }

    /// Shortening of the chord relative to the link at each sample, in m, from histories of (w, w') of each node.
    ///
    /// ```text
    /// Δ = ∫ (1 − cos ψ) ds,       ψ = asin w'
    /// ```
    ///
    /// # Errors
    /// [`ElasticaError::TooSteep`].
    pub(super) fn shortening_m(&self, deflections: &[Vec<f64>]) -> Result<Vec<f64>, ElasticaError> {
        let root = deflections[1].iter();
        let mut by_m: Vec<f64> = root.map(|sine| self.nodes_m[0] * shortening(*sine)).collect();
        let mut slope: f64 = 0.0;
        for (element, points) in self.points.elements.iter().enumerate() {
            let [a, b, c, d] = [0, 1, 2, 3].map(|dof| &deflections[2 * element + dof][..]);
            for point in points {
                for (k, by_m) in by_m.iter_mut().enumerate() {
                    let sine = dot(&point.slope, &[a[k], b[k], c[k], d[k]]);
                    *by_m += point.weight_m * shortening(sine);
                    slope = slope.larger(sine.abs());
                }
            }
        }
        if slope < STEEPEST { Ok(by_m) } else { Err(ElasticaError::TooSteep { slope }) }
    }

    /// Coefficients of the force on the root of a straight link.
    pub(super) fn straight(&self) -> Straight {
        let across_kg = vec![[0.0; 2]; self.nodes_m.len()];
        let mut straight = Straight { mass_kg: 0.0, moment_kg_m: 0.0, across_kg };
        for (element, points) in self.points.elements.iter().enumerate() {
            for point in points {
                let mass_kg = point.mass_kg_m * point.weight_m;
                straight.mass_kg += mass_kg;
                straight.moment_kg_m += mass_kg * point.s_m;
                for (dof, shape) in point.shape.iter().enumerate() {
                    straight.across_kg[element + dof / 2][dof % 2] += mass_kg * shape;
                }
            }
        }
        for body in &self.bodies {
            straight.mass_kg += body.mass_kg;
            straight.moment_kg_m += body.mass_kg * (self.nodes_m[body.node] + body.arm_m);
            straight.across_kg[body.node][0] += body.mass_kg;
            straight.across_kg[body.node][1] += body.mass_kg * body.arm_m;
        }
        straight
    }

    /// Acceleration of a mass along the chord and across it; without second order, of a straight link along the chord.
    pub(super) fn acceleration(
        &self,
        now: &Instant<'_>,
        place: &Place,
        w_acceleration: f64,
    ) -> [f64; 2] {
        let s = place.x - place.shortened;
        let linear = now.across_m_s2 + now.chord_acceleration_rad_s2 * s + w_acceleration;
        match self.second_order {
            SecondOrder::None => {
                [now.along_m_s2 - now.chord_rate_rad_s * now.chord_rate_rad_s * s, linear]
            }
            _ => [along(now, place), linear + left_across(now, place)],
        }
    }

    /// Effect of an axial force on the link's bending: 0 without second order.
    fn borne(&self, axial_n: f64) -> f64 {
        if self.second_order == SecondOrder::None { 0.0 } else { axial_n }
    }

    /// Place of a node along the chord and across it in m.
    fn node(&self, now: &Instant<'_>, scratch: &Scratch, node: usize) -> (f64, f64) {
        (self.nodes_m[node] + scratch.shortened[node], now.w[2 * node])
    }

    /// Reaction about a node that accelerates a mass.
    fn needed(
        &self,
        now: &Instant<'_>,
        place: &Place,
        mass_kg: f64,
        w_acceleration: f64,
        node: (f64, f64),
    ) -> Reaction {
        let [along_m_s2, across_m_s2] = self.acceleration(now, place, w_acceleration);
        let force = Reaction {
            along_n: self.borne(mass_kg * along_m_s2),
            across_n: mass_kg * across_m_s2,
            moment_n_m: 0.0,
        };
        force.moved(place.x - node.0, place.w - node.1)
    }
}

/// Largest difference of two histories; NaN if any difference is.
pub(super) fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, Size::larger)
}

/// Reference for changes of a torque: largest minus smallest value, or the largest if the link is at rest; at least the
/// torque that bends the link by [`STRAIGHT`].
pub(super) fn size(torque_n_m: &[f64], mesh: &Mesh) -> f64 {
    let [low, high] = extremes(torque_n_m);
    let (range, most) = (high - low, low.abs().max(high.abs()));
    let size = if range > AT_REST * most { range } else { most };
    size.max(unfelt_n_m(mesh))
}

/// Number of bins up to the last one whose torque counts: those beyond add up to a negligible share, or each is at most
/// `round_off_n_m`.
pub(super) fn band(
    answers: &[LoadedMotion<Complex64>],
    negligible: f64,
    (mesh, round_off_n_m): (&Mesh, f64),
) -> usize {
    // Relative to the sum, not the largest: the amplitude of the weight at rest is the same over any period, while
    // those of the motion fall with its length.
    let size = |answer: &LoadedMotion<Complex64>| magnitude(answer.torque_n_m);
    let least = negligible * answers.iter().map(size).sum::<f64>().max(unfelt_n_m(mesh));
    let felt = |answer| Some(size(answer)).filter(|size| *size > round_off_n_m).unwrap_or(0.0);
    counting(&answers.iter().map(felt).collect::<Vec<_>>(), least)
}

/// A torque in N m, or a force in N on a carriage, that hardly bends the link.
fn unfelt_n_m(mesh: &Mesh) -> f64 {
    STRAIGHT * softest(mesh) * mesh.rigid_tip() / mesh.length_m().powi(2)
}

/// The smallest bending stiffness of a link in N m²; of a spring at its root that of a link that bends as much.
pub(super) fn softest(mesh: &Mesh) -> f64 {
    let stiffness = mesh.elements().iter().map(|element| {
        // A spring turns by M/k, a beam as long as the link by M L/EI.
        let length_m = if element.is_spring() { mesh.length_m() } else { 1.0 };
        let ei = element.bending_stiffness_n_m2;
        length_m * ei.inner.min(ei.outer)
    });
    stiffness.fold(f64::INFINITY, f64::min)
}

/// Rate in rad/s of a joint: of its hub against the tip of the link before.
pub(super) fn joint_rates(links: &[ArmLinkMotion], link: usize, arm: &ArmPeriod) -> Vec<f64> {
    let before = link.checked_sub(1).map(|before| &links[before]);
    let bent = links[link].bent.hub_slope_rad.iter().enumerate();
    let bent = bent.map(|(k, slope)| slope - before.map_or(0.0, |link| link.tip_slope_rad[k]));
    let rates = arm.at_all(&arm.pair, &bent.collect::<Vec<_>>(), arm.len(), 1);
    let chord = |link: &ArmLinkMotion, k: usize| link.chord[1][k];
    let turned = rates.iter().enumerate();
    turned
        .map(|(k, rate)| rate + chord(&links[link], k) - before.map_or(0.0, |link| chord(link, k)))
        .collect()
}
