//! Histories of all quantities of a bent link, their differences, and the places of its nodes.

use super::accuracy::PerQuantity;
use crate::elastica::{ElasticaMotion, SecondOrder};
use crate::numeric::{Size, extremes, largest, largest_difference};

/// Places of a link's nodes over time: one history for each node.
#[expect(clippy::struct_field_names, reason = "their units end alike")]
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Shape {
    /// Displacement along the arc less that of the chord, `x atan(w/(x + u))`, in m.
    pub(super) arcs_m: Vec<Vec<f64>>,
    /// Deflection from the hub's tangent line in m.
    pub(super) deflections_m: Vec<Vec<f64>>,
    /// Bending moment in N m.
    pub(super) moments_n_m: Vec<Vec<f64>>,
}

impl Shape {
    pub(super) fn of(motion: &ElasticaMotion, second_order: SecondOrder, nodes_m: &[f64]) -> Self {
        let is_large = second_order == SecondOrder::Full;
        let deflection = |[x, u, w, slope]: [f64; 4]| {
            if is_large { w * libm::cos(slope) - (x + u) * libm::sin(slope) } else { w - x * slope }
        };
        let nodes = 0..nodes_m.len();
        Self {
            arcs_m: nodes.clone().map(|k| Self::arc_m(motion, second_order, nodes_m, k)).collect(),
            deflections_m: nodes.map(|k| history_of(motion, nodes_m, k, deflection)).collect(),
            moments_n_m: motion.moments_n_m.clone(),
        }
    }

    /// [`Self::arcs_m`] of one node.
    pub(super) fn arc_m(
        motion: &ElasticaMotion,
        second_order: SecondOrder,
        nodes_m: &[f64],
        node: usize,
    ) -> Vec<f64> {
        let is_large = second_order == SecondOrder::Full;
        history_of(motion, nodes_m, node, |[x, u, w, _]| {
            if is_large && x > 0.0 { x * libm::atan2(w, x + u) } else { w }
        })
    }
}

/// Maps a node's distance from the axis, its shortening, its deflection and the hub's slope by `of`.
fn history_of(
    motion: &ElasticaMotion,
    nodes_m: &[f64],
    node: usize,
    of: impl Fn([f64; 4]) -> f64,
) -> Vec<f64> {
    let (w, u) = (&motion.deflections[2 * node], &motion.shortenings_m[node]);
    let places = w.iter().zip(u).zip(&motion.hub_slope_rad);
    places.map(|((w, u), slope)| of([nodes_m[node], *u, *w, *slope])).collect()
}

/// Histories of all quantities.
pub(super) struct Curves {
    pub(super) torque_n_m: Vec<f64>,
    pub(super) hub_angle_rad: Vec<f64>,
    pub(super) hub_rate_rad_s: Vec<f64>,
    pub(super) hub_acceleration_rad_s2: Vec<f64>,
    /// One for each of some nodes.
    pub(super) displacement_m: Vec<Vec<f64>>,
    pub(super) moment_n_m: Vec<Vec<f64>>,
    /// Torque in N m and rate in rad/s of the motor, where there is a drive.
    pub(super) motor: Option<[Vec<f64>; 2]>,
}

impl Curves {
    fn each(&self) -> PerQuantity<&[Vec<f64>]> {
        let one = std::slice::from_ref::<Vec<f64>>;
        let motor = self.motor.as_ref();
        PerQuantity {
            torque: one(&self.torque_n_m),
            hub_angle: one(&self.hub_angle_rad),
            hub_rate: one(&self.hub_rate_rad_s),
            hub_acceleration: Some(one(&self.hub_acceleration_rad_s2)),
            displacement: Some(&self.displacement_m),
            bending_moment: Some(&self.moment_n_m),
            motor_torque: motor.map(|motor| one(&motor[0])),
            motor_rate: motor.map(|motor| one(&motor[1])),
        }
    }

    /// Largest value of `of` over pairs of histories of the same quantity.
    fn compared(&self, other: &Self, of: impl Fn(&[f64], &[f64]) -> f64) -> PerQuantity<f64> {
        self.each().zip(&other.each(), |own, others| {
            own.iter().zip(others).map(|(a, b)| of(a, b)).fold(0.0, Size::larger)
        })
    }

    /// Largest difference of each quantity.
    pub(super) fn apart(&self, other: &Self) -> PerQuantity<f64> {
        self.compared(other, largest_difference)
    }

    /// Largest difference of each quantity from histories with twice as many samples.
    pub(super) fn apart_from_finer(&self, finer: &Self) -> PerQuantity<f64> {
        self.compared(finer, |own, finer| {
            let pairs = own.iter().zip(finer.iter().step_by(2));
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, Size::larger)
        })
    }

    /// Largest distance of each quantity from rest, over `reaches` samples at its start and its end. One sample cannot
    /// show it, as ringing passes the rest twice a cycle.
    pub(super) fn left_of(&self, rests: &[Self; 2], reaches: [usize; 2]) -> PerQuantity<f64> {
        let farthest = |samples: &[f64], rest: f64| {
            samples.iter().map(|own| (own - rest).abs()).fold(0.0, Size::larger)
        };
        let first = self.compared(&rests[0], |own, rest| farthest(&own[..reaches[0]], rest[0]));
        let last =
            self.compared(&rests[1], |own, rest| farthest(&own[own.len() - reaches[1]..], rest[0]));
        first.zip(&last, Size::larger)
    }

    /// Size of each quantity, the reference of its errors: its range with weight, else its peak; for the hub angle the
    /// largest turn, for displacements the tip's travel.
    pub(super) fn sizes(&self, has_weight: bool, travel_m: f64) -> PerQuantity<f64> {
        let sizes = self.compared(self, |own, _| size(own, has_weight));
        let start = self.hub_angle_rad[0];
        let turn =
            self.hub_angle_rad.iter().map(|angle| (angle - start).abs()).fold(0.0, Size::larger);
        let hub_angle = if has_weight { sizes.hub_angle } else { turn };
        PerQuantity { hub_angle, displacement: Some(travel_m), ..sizes }
    }
}

/// Reference of a quantity's errors: its peak or, for a link with weight, its largest value less its smallest.
pub(crate) fn size(history: &[f64], has_weight: bool) -> f64 {
    if !has_weight {
        return largest(history);
    }
    let [low, high] = extremes(history);
    high - low
}
