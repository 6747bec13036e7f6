//! The shape of an arm at rest, and small motions about it: the matrices of Lagrange's equations in a pose.
//!
//! ```text
//! M q̈ + D q̇ + (K + iG) q = Σ T_j e_j,    K = S − ∂²(Σ m g·r)/∂q²,    r_tip = R q
//! ```
//!
//! q are the angles of the joints and the slopes of the links, S resists bending, and G is hysteretic damping, 2ξS of
//! each link. A torque acts on the angle of its joint alone.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use thiserror::Error;

use super::balance::{Balance, Met, Place};
use super::chain::Chain;
use super::linkage::Linkage;
use super::shape::{direction, in_parts, settled};
use crate::elastica::reaching;
use crate::link::{Arm, Damping, Elbow};
use crate::numeric::dot;
use crate::system::end_if_stopped;

/// Most coordinates: each of many frequencies solves a matrix of this size.
const MOST_COORDINATES: usize = 400;

/// Step in rad of the numerical derivatives of weights, and the factors of their values at one, two and three steps.
/// Exact to the sixth order, to 1e-14 of the weights.
const PART_RAD: f64 = 1e-2;
const SHARES: [f64; 3] = [45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0];

/// Share of a size below which sums over the links are round-off.
const NOISE: f64 = 1e-13;

/// Reason why an arm has no small motions about a pose here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum PoseError {
    /// Another number of directions than links.
    #[error("{given} directions, but must be {links}, one for each link")]
    Directions {
        /// Number of directions.
        given: usize,
        /// Links of the arm.
        links: usize,
    },
    /// A link with shear and rotary inertia.
    #[error("link {} has shear and rotary inertia, but a pose needs links without them", link + 1)]
    Shear {
        /// Number of the link, from 0.
        link: usize,
    },
    /// A damping law with drag on masses, or with separate ratios of modes.
    #[error(
        "the damping of link {} = {law}, but must be none, hysteretic or rayleigh with alpha = 0",
        link + 1
    )]
    Damping {
        /// Number of the link, from 0.
        link: usize,
        /// Name of the law.
        law: &'static str,
    },
    /// A weight that bends the links without limit.
    #[error("the arm has no shape at rest in this pose: its weight bends it too far")]
    NoShape,
    /// Numbers too far apart for dense algebra.
    #[error("the stiffnesses and the masses of the arm differ by too much to find its modes")]
    Spread,
    /// More coordinates than the limit.
    #[error("the bending of all links takes {count} coordinates, but must take at most {most}")]
    TooMany {
        /// Number of coordinates needed.
        count: usize,
        /// Largest number of coordinates.
        most: usize,
    },
}

impl PoseError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Directions { .. } => Some("write --at '30 deg,75 deg', the inner link first"),
            Self::Shear { .. } => Some("set theory = \"euler-bernoulli\""),
            Self::Damping { .. } => Some("set damping = { model = \"rayleigh\", beta = … }"),
            Self::NoShape => Some("use stiffer links, or a pose in which they carry less"),
            Self::Spread => Some("check the units of the links and of their joints' stiffness"),
            Self::TooMany { .. } => Some("use fewer segments and masses, or a lower frequency"),
        }
    }
}

/// An arm about its shape at rest in a pose.
#[derive(Debug, Clone)]
pub struct ArmPose {
    chain: Linkage,
    /// The coordinates at rest.
    rest: Vec<f64>,
    pub(super) count: usize,
    /// Numbers of the coordinates that are joint angles.
    pub(super) joints: Vec<usize>,
    /// M, K, G and the links' part of D, row by row.
    pub(super) mass: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    pub(super) loss: Vec<f64>,
    pub(super) damping: Vec<f64>,
    pub(super) friction_n_m_s_rad: Vec<f64>,
    /// Place of the tip in m, and R of x and y.
    tip_m: [f64; 2],
    pub(super) tip_rows: [Vec<f64>; 2],
    /// Turn of each link's chord by the coordinates.
    chord_rows: Vec<Vec<f64>>,
    holding_n_m: Vec<f64>,
    pub(super) has_weight: bool,
}

/// Response to a torque at one joint, per N m, or to a force on the carriage, per N.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueResponse {
    /// Displacement of the tip along x and y in m.
    pub tip_m: [Complex64; 2],
    /// Direction of each link's chord in rad.
    pub chords_rad: Vec<Complex64>,
    /// Angle of each joint in rad, then place of the carriage in m.
    pub joints_rad: Vec<Complex64>,
}

/// Responses of an arm at one frequency, for e^{+iωt}.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmResponse {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Responses to the torque of each joint, the inner one first, then to the force on the carriage.
    pub torques: Vec<TorqueResponse>,
}

impl ArmPose {
    /// The arm at rest with the chord of each link in a direction in rad, counterclockwise from x. Its links bend by
    /// polynomials for waves up to `highest_rad_s`, with `more_orders` added. A carriage is held.
    ///
    /// # Errors
    /// [`PoseError`].
    pub fn of(arm: &Arm, directions_rad: &[f64], orders: (f64, usize)) -> Result<Self, PoseError> {
        Self::of_all_joints(&arm.held(), directions_rad, orders)
    }

    /// [`ArmPose::of`] with the carriage as a joint.
    pub(super) fn of_all_joints(
        arm: &Arm,
        directions_rad: &[f64],
        (highest_rad_s, more_orders): (f64, usize),
    ) -> Result<Self, PoseError> {
        let (given, links) = (directions_rad.len(), arm.links().len());
        if given != links {
            return Err(PoseError::Directions { given, links });
        }
        let count = Linkage::coordinates(arm, highest_rad_s, more_orders, None);
        if count > MOST_COORDINATES {
            return Err(PoseError::TooMany { count, most: MOST_COORDINATES });
        }
        let chain = Linkage::of(arm, highest_rad_s, more_orders, None);
        let (mut betas_s, mut losses) = (vec![0.0; links], vec![0.0; links]);
        for (link, own) in arm.links().iter().enumerate() {
            if own.link.segments().iter().any(|segment| segment.timoshenko.is_some()) {
                return Err(PoseError::Shear { link });
            }
            match own.link.damping() {
                Damping::None => {}
                Damping::Hysteretic { ratio } => losses[link] = 2.0 * ratio,
                Damping::Rayleigh { alpha_per_s: 0.0, beta_s } => betas_s[link] = *beta_s,
                other => return Err(PoseError::Damping { link, law: other.name() }),
            }
        }
        let [damping, loss] = [betas_s, losses].map(|factors| chain.scaled_stiffness(&factors));
        let start = Start::Chords(directions_rad);
        let q = at_rest(arm, &chain, start, 0.0).ok_or(PoseError::NoShape)?;
        let (length_m, weight_n_m) = (arm.length_m(), arm.weight_moment_n_m());
        let rest = vec![0.0; count];
        let mut balance = Balance::default();
        chain.balance(&q, &rest, &mut balance);
        let mut ends = chain.walk(&q, &rest, |_, _| {});
        let base = chain.base(&q, &rest);
        let joints = std::iter::once(&base).chain(&ends);
        let chord_rows = joints.zip(&ends).map(|(from, to)| turn_of_chord(from, to)).collect();
        let tip = ends.pop().unwrap_or_default();
        let mut stiffness = chain.stiffness.clone();
        if arm.has_weight() {
            let added = chain.weight_stiffness(&q);
            stiffness.iter_mut().zip(added).for_each(|(own, added)| *own += added);
        }
        Ok(Self {
            count,
            holding_n_m: chain
                .joints
                .iter()
                .map(|joint| without_noise(-balance.force[*joint], weight_n_m))
                .collect(),
            joints: chain.joints.clone(),
            mass: balance.mass,
            stiffness,
            loss,
            damping,
            friction_n_m_s_rad: chain.friction_n_m_s_rad.clone(),
            tip_m: tip.at_m.map(|part| without_noise(part, length_m)),
            tip_rows: tip.by,
            chord_rows,
            has_weight: arm.has_weight(),
            chain,
            rest: q,
        })
    }

    /// x and y of the tip at rest, in m.
    pub fn tip_m(&self) -> [f64; 2] {
        self.tip_m
    }

    /// Torques in N m that hold the arm at rest, the inner joint first.
    pub fn holding_torques_n_m(&self) -> &[f64] {
        &self.holding_n_m
    }

    /// x and y in m of places on each link at rest. `along_m` has their distances in m from the joint of each link.
    pub(super) fn places_m(&self, along_m: &[Vec<f64>]) -> Vec<Vec<[f64; 2]>> {
        self.chain.places_m(&self.chain.stations(along_m), &self.rest)
    }

    /// Movement of these places along x and y, and turn of the link there, by the coordinates, to first order.
    pub(super) fn moved(&self, along_m: &[Vec<f64>], shape: &[f64]) -> Vec<Vec<[f64; 3]>> {
        let stations = self.chain.stations(along_m);
        let turns = self.chain.turns(&stations, shape);
        let only_turned = |own: &Vec<f64>| own.iter().map(|turn| [0.0, 0.0, *turn]).collect();
        let mut moved: Vec<Vec<[f64; 3]>> = turns.iter().map(only_turned).collect();
        let largest = shape.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        if largest == 0.0 {
            return moved;
        }
        // Coordinates may have any size: the largest one changes by these steps.
        let part = PART_RAD / largest;
        for (parts, share) in (1_u8..).zip(SHARES) {
            for sign in [1.0, -1.0] {
                let step = sign * f64::from(parts) * part;
                let q: Vec<f64> = self.rest.iter().zip(shape).map(|(q, x)| q + step * x).collect();
                let places = self.chain.places_m(&stations, &q);
                for (own, place) in moved.iter_mut().flatten().zip(places.iter().flatten()) {
                    own.iter_mut()
                        .zip(place)
                        .for_each(|(own, at)| *own += sign * share / part * at);
                }
            }
        }
        moved
    }

    /// Curvature in 1/m at the root of each link per coordinate of the pose.
    pub(super) fn root_rows(&self) -> Vec<Vec<f64>> {
        let links = self.chain.links.iter().zip(&self.chain.joints);
        let row = |(link, first): (&Chain, &usize)| {
            let mut row = vec![0.0; self.count];
            row[*first..][..link.count].copy_from_slice(&link.root_curvature());
            row
        };
        links.map(row).collect()
    }

    /// Lengths of the links in m, from joint to tip.
    pub(super) fn lengths_m(&self) -> Vec<f64> {
        let pieces = |link: &Chain| link.pieces.iter().map(|piece| piece.length_m).sum::<f64>();
        self.chain.links.iter().map(|link| link.root_m + pieces(link)).collect()
    }

    /// Response to the torque of each joint at `frequency_hz` > 0, friction of the joints included. It is not finite at
    /// a pole of an undamped arm.
    ///
    /// ```text
    /// q = (K + iG + iωD − ω²M)⁻¹ e_j
    /// ```
    pub fn response(&self, frequency_hz: f64) -> ArmResponse {
        end_if_stopped();
        let (count, omega) = (self.count, std::f64::consts::TAU * frequency_hz);
        let mut dynamic = DMatrix::from_fn(count, count, |i, j| {
            let at = i * count + j;
            let real = self.stiffness[at] - omega * omega * self.mass[at];
            Complex64::new(real, self.loss[at] + omega * self.damping[at])
        });
        for (joint, friction) in self.joints.iter().zip(&self.friction_n_m_s_rad) {
            dynamic[(*joint, *joint)].im += omega * friction;
        }
        let torques = DMatrix::from_fn(count, self.joints.len(), |i, j| {
            Complex64::from(if i == self.joints[j] { 1.0 } else { 0.0 })
        });
        let none = Complex64::new(f64::NAN, f64::NAN);
        let solved = dynamic.lu().solve(&torques);
        let moved = solved.unwrap_or_else(|| torques.map(|_| none));
        let of_torque = |column: usize| {
            let q = moved.column(column);
            let along = |row: &Vec<f64>| row.iter().zip(q.iter()).map(|(r, q)| q * *r).sum();
            TorqueResponse {
                tip_m: self.tip_rows.each_ref().map(along),
                chords_rad: self.chord_rows.iter().map(along).collect(),
                joints_rad: self.joints.iter().map(|joint| q[*joint]).collect(),
            }
        };
        ArmResponse { frequency_hz, torques: (0..self.joints.len()).map(of_torque).collect() }
    }
}

impl Linkage {
    /// Forces of weights along each coordinate, `Σ m g·∂r/∂q`.
    fn weights(&self, q: &[f64]) -> Vec<f64> {
        let (rest, mut found) = (vec![0.0; self.count], vec![0.0; self.count]);
        self.walk(q, &rest, |place, met| {
            if let Met::Mass(mass_kg) = met {
                for (pull, by) in self.gravity_m_s2.iter().zip(&place.by) {
                    found.iter_mut().zip(by).for_each(|(own, by)| *own += mass_kg * pull * by);
                }
            }
        });
        found
    }

    /// Resistance of weights to a change of the coordinates, row by row and symmetric.
    fn weight_stiffness(&self, q: &[f64]) -> Vec<f64> {
        let count = self.count;
        let (mut q, mut slopes) = (q.to_vec(), vec![0.0; count * count]);
        for column in 0..count {
            let rest_rad = q[column];
            for (part, share) in (1_u8..).zip(SHARES) {
                for sign in [1.0, -1.0] {
                    q[column] = rest_rad + sign * f64::from(part) * PART_RAD;
                    let factor = -sign * share / PART_RAD;
                    for (row, force) in self.weights(&q).into_iter().enumerate() {
                        slopes[row * count + column] += factor * force;
                    }
                }
            }
            q[column] = rest_rad;
        }
        let both = |at: usize| 0.5 * (slopes[at] + slopes[at % count * count + at / count]);
        (0..count * count).map(both).collect()
    }
}

/// Turn by the coordinates of the line from one place to another.
fn turn_of_chord(from: &Place, to: &Place) -> Vec<f64> {
    let [x, y] = [0, 1].map(|axis| to.at_m[axis] - from.at_m[axis]);
    let by = |axis: usize, k: usize| to.by[axis][k] - from.by[axis][k];
    (0..to.by[0].len()).map(|k| (x * by(1, k) - y * by(0, k)) / (x * x + y * y)).collect()
}

/// A part of a sum of this size, 0 where it is round-off.
pub(super) fn without_noise(part: f64, size: f64) -> f64 {
    if part.abs() <= NOISE * size { 0.0 } else { part }
}

/// `xᵀ A x` of a matrix row by row.
pub(super) fn quadratic(matrix: &[f64], x: &[f64]) -> f64 {
    let rows = matrix.chunks_exact(x.len()).zip(x);
    rows.map(|(row, own)| own * dot(row, x)).sum()
}

/// Start of an arm at rest.
#[derive(Debug, Clone, Copy)]
pub enum Start<'a> {
    /// Its joints at these angles in rad, from the tip of the link before to each link's root, and then its carriage, if it
    /// has one and the list is so long.
    Joints(&'a [f64]),
    /// The chords of its links in these directions in rad against x.
    Chords(&'a [f64]),
    /// The tip of an arm at x and y in m, its elbow on the side that the arm states.
    Tip {
        /// x and y.
        at_m: [f64; 2],
        /// Directions in rad of the chords from the third on.
        outer_rad: &'a [f64],
    },
}

/// Coordinates of an arm at rest, iterated from unbent links, its carriage at a place unless the start has it. `None`
/// without a shape at rest.
pub(super) fn at_rest(
    arm: &Arm,
    chain: &Linkage,
    start: Start<'_>,
    carriage_m: f64,
) -> Option<Vec<f64>> {
    let mut angles_rad = match start {
        Start::Joints(joints_rad) => joints_rad.to_vec(),
        Start::Chords(chords_rad) => against_each_other(chords_rad),
        Start::Tip { mut at_m, outer_rad } => {
            let axis = arm.carriage().map_or([0.0; 2], |own| own.axis);
            at_m.iter_mut().zip(axis).for_each(|(at, part)| *at -= part * carriage_m);
            against_each_other(&reached(arm, at_m, outer_rad)?)
        }
    };
    angles_rad.resize(chain.joints.len(), carriage_m);
    let mut straight = vec![0.0; chain.count];
    for (joint, angle_rad) in chain.joints.iter().zip(&angles_rad) {
        straight[*joint] = *angle_rad;
    }
    let rest = vec![0.0; chain.count];
    in_parts(&straight, |share, q| {
        let (chain, mut balance) = (chain.weighing(share), Balance::default());
        settled(q, |q: &[f64]| {
            chain.balance(q, &rest, &mut balance);
            let mut left = DVector::from_column_slice(&balance.force);
            let ends = chain.walk(q, &rest, |_, _| {});
            let away = away(arm, (&ends, start), chain.base(q, &rest).at_m);
            for (number, (joint, angle_rad)) in chain.joints.iter().zip(&angles_rad).enumerate() {
                let held = || angle_rad - q[*joint];
                let away = away.as_ref().and_then(|away| away.get(number));
                left[*joint] = away.copied().unwrap_or_else(held);
            }
            left
        })
    })
}

/// Distance from the wanted start, one number a joint: of each chord from its direction in rad (for one link its sine), or
/// of the tip from its place over the arm's length. `None` for prescribed joints.
fn away(arm: &Arm, (ends, start): (&[Place], Start<'_>), base_m: [f64; 2]) -> Option<Vec<f64>> {
    let mut from_m = base_m;
    let mut across = |(end, angle_rad): (&Place, Option<&f64>)| {
        let along_m = [0, 1].map(|axis| end.at_m[axis] - from_m[axis]);
        from_m = end.at_m;
        angle_rad.map(|angle_rad| match (along_m, ends) {
            // The sine of one link's chord keeps the digits of its table at rest.
            ([x, y], [_]) => {
                (x * libm::sin(*angle_rad) - y * libm::cos(*angle_rad)) / (x * x + y * y).sqrt()
            }
            _ => direction(along_m, *angle_rad) - angle_rad,
        })
    };
    match start {
        Start::Joints(_) => None,
        Start::Chords(chords_rad) => {
            ends.iter().zip(chords_rad.iter().map(Some)).map(across).collect()
        }
        Start::Tip { at_m, outer_rad } => {
            let tip_m = ends.last().map_or([0.0; 2], |end| end.at_m);
            let off = |axis: usize| (tip_m[axis] - at_m[axis]) / arm.length_m();
            let outer = [None, None].into_iter().chain(outer_rad.iter().map(Some));
            let outer: Vec<f64> = ends.iter().zip(outer).filter_map(&mut across).collect();
            Some([&[off(0), off(1)], &outer[..]].concat())
        }
    }
}

/// Angles of joints from directions of links.
fn against_each_other(chords_rad: &[f64]) -> Vec<f64> {
    let before = std::iter::once(&0.0).chain(chords_rad);
    chords_rad.iter().zip(before).map(|(own, before)| own - before).collect()
}

/// Directions in rad of the unbent links that reach x and y in m from the first axis, the links from the third on in these
/// directions; `None` out of reach.
pub fn reached(arm: &Arm, at_m: [f64; 2], outer_rad: &[f64]) -> Option<Vec<f64>> {
    let lengths_m = arm.lengths_m();
    if lengths_m.len() != outer_rad.len() + 2 {
        return None;
    }
    let is_left = arm.elbow()? == Elbow::Left;
    let outer: Vec<_> =
        outer_rad.iter().map(|angle_rad| [vec![*angle_rad], vec![0.0], vec![0.0]]).collect();
    let chords = reaching(&[[at_m, [0.0; 2], [0.0; 2]]], &lengths_m, &outer, is_left).ok()?;
    Some(chords.iter().map(|chord| chord[0][0]).collect())
}
