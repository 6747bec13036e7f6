//! What each part of a bent link needs of the part inboard: forces and bending moments, by equilibrium.

use super::loads::{BentLink, Instant, Place, Scratch, SecondOrder, along, left_across};
use super::points::dot;

/// Force along the chord and across it, and moment about a node, that move all that lies outboard.
#[derive(Clone, Copy, Default)]
struct Reaction {
    along_n: f64,
    across_n: f64,
    moment_n_m: f64,
}

impl Reaction {
    /// The same about a place that lies inward by these distances.
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

impl BentLink {
    /// Writes the shortening x − s in m of nodes 0 … n, and the bending moment in N m there, which the part towards
    /// the hub exerts on the part towards the tip, into pairs of `shape`; returns the largest slope.
    ///
    /// ```text
    /// F_i = F_j + Σ m a,     M_i = M_j + (r_j − r_i) × F_j + Σ ((r − r_i) × m a + J φ̈)
    /// ```
    ///
    /// The sums are over the points of the element and the bodies on its inner node.
    pub(super) fn shape(&self, now: &Instant<'_>, scratch: &mut Scratch, shape: &mut [f64]) -> f64 {
        let largest = self.place(now, scratch);
        let mut outer = Reaction::default();
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

    /// Place of a node along the chord and across it in m.
    fn node(&self, now: &Instant<'_>, scratch: &Scratch, node: usize) -> (f64, f64) {
        (self.nodes_m[node] + scratch.shortened[node], now.w[2 * node])
    }

    /// What moves a mass, about a node.
    fn needed(
        &self,
        now: &Instant<'_>,
        place: &Place,
        mass_kg: f64,
        w_acceleration: f64,
        node: (f64, f64),
    ) -> Reaction {
        let s = place.x - place.shortened;
        let linear = now.across_m_s2 + now.chord_acceleration_rad_s2 * s + w_acceleration;
        let (along_m_s2, left) = match self.second_order {
            SecondOrder::None => (0.0, 0.0),
            _ => (along(now, place), left_across(now, place)),
        };
        let force = Reaction {
            along_n: mass_kg * along_m_s2,
            across_n: mass_kg * (linear + left),
            moment_n_m: 0.0,
        };
        force.moved(place.x - node.0, place.w - node.1)
    }
}
