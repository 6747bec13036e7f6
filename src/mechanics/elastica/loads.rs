//! Nonlinear terms at one instant, as loads on the nodes of the linear link.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::chord::{ChordHistories, TipLoad};
use super::error::{ElasticaError, STEEPEST};
use super::points::{Body, POINTS, Points, dot};
use crate::modal::DampingLaw;
use crate::model::Model;
use crate::numeric::Size;

/// Number of instants in one parallel task.
const BLOCK: usize = 64;

/// Second-order terms in deflections and rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SecondOrder {
    /// No terms: the link is linear along its chord.
    #[default]
    None,
    /// Axial force turned by a slope, and centripetal and Coriolis accelerations of the deflection.
    First,
    /// All terms: the inextensible elastica.
    Full,
}

/// The motion at one instant, seen from the chord: (w, w') of nodes 0 … n, and their derivatives.
#[derive(Clone, Copy)]
pub(super) struct Instant<'a> {
    pub(super) w: &'a [f64],
    pub(super) rate: &'a [f64],
    /// Second derivatives, unused for terms of first order.
    pub(super) acceleration: &'a [f64],
    pub(super) chord_rate_rad_s: f64,
    pub(super) chord_acceleration_rad_s2: f64,
    pub(super) along_m_s2: f64,
    pub(super) across_m_s2: f64,
    pub(super) tip: TipLoad<f64>,
}

/// A place on the link and its motion in the chord's frame: x = s + u along the chord, w across it.
#[derive(Clone, Copy, Default)]
pub(super) struct Place {
    pub(super) x: f64,
    x_rate: f64,
    x_acceleration: f64,
    /// x − s, neglected at first order.
    pub(super) shortened: f64,
    pub(super) w: f64,
    w_rate: f64,
}

/// Slope w' with its derivatives and the resulting shortening u' = cos ψ − 1.
#[derive(Clone, Copy, Default)]
pub(super) struct Slope {
    sine: f64,
    cosine: f64,
    /// 1/cos ψ.
    secant: f64,
    rate: f64,
    pub(super) acceleration: f64,
    u: [f64; 3],
}

impl Slope {
    fn of(second_order: SecondOrder, [sine, rate, acceleration]: [f64; 3]) -> Self {
        let mut slope = Self { sine, cosine: 1.0, secant: 1.0, rate, acceleration, u: [0.0; 3] };
        if second_order == SecondOrder::Full {
            slope.cosine = (1.0 - sine * sine).sqrt();
            slope.secant = slope.cosine.recip();
            let (sec, turn) = (slope.secant, sine * rate);
            slope.u = [
                -shortening(sine),
                -turn * sec,
                -(rate * rate + sine * acceleration) * sec - turn * turn * (sec * sec * sec),
            ];
        }
        slope
    }

    /// Second derivative of ψ.
    pub(super) fn turning(&self) -> f64 {
        let sec = self.secant;
        self.acceleration * sec + self.sine * self.rate * self.rate * (sec * sec * sec)
    }
}

/// A link that bends in its plane: everything that determines its loads except its motion.
#[derive(Debug, Clone)]
pub(super) struct BentLink {
    pub(super) points: Points,
    pub(super) nodes_m: Vec<f64>,
    /// Bodies from the axis outward.
    pub(super) bodies: Vec<Body>,
    /// Stiffness in N m/rad of a spring between nodes 0 and 1.
    spring_n_m_rad: Option<f64>,
    /// β in s: share of the curvature's rate in the bending moment.
    beta_s: f64,
    pub(super) second_order: SecondOrder,
}

/// Working memory for one instant.
#[derive(Default)]
pub(super) struct Scratch {
    slopes: Vec<[Slope; POINTS]>,
    pub(super) places: Vec<[Place; POINTS]>,
    pub(super) body_places: Vec<Place>,
    /// x − s of nodes 0 … n.
    pub(super) shortened: Vec<f64>,
}

/// Histories of the loads of a link's second-order terms.
pub(super) struct LoadHistories {
    /// Force in N and moment in N m on each node in turn.
    pub(super) nodal: Vec<Vec<f64>>,
    /// Axial force at the root in N, which accelerates the masses and the tip along the chord.
    pub(super) axial_n: Vec<f64>,
    /// Force across the chord in N that accelerates the masses, beyond the force of the linear link.
    pub(super) left_n: Vec<f64>,
    pub(super) largest_slope: f64,
}

impl BentLink {
    pub(super) fn of(model: &dyn Model, second_order: SecondOrder) -> Self {
        let mesh = model.mesh();
        let beta_s = match model.law() {
            DampingLaw::Rayleigh { beta_s, .. } => *beta_s,
            _ => 0.0,
        };
        Self {
            points: Points::of(mesh),
            nodes_m: mesh.nodes_m().to_vec(),
            bodies: Body::all_of(mesh, model.link().payload()),
            spring_n_m_rad: model.link().root_stiffness_n_m_rad(),
            beta_s,
            second_order,
        }
    }

    /// Evaluates `write` at each instant: returns histories of `columns` numbers, and the largest return value. The
    /// state is a history for each of (w, w') of each node, then for their derivatives.
    pub(super) fn at_each_instant(
        &self,
        columns: usize,
        (histories, chord): (&[Vec<f64>], &ChordHistories),
        write: impl Fn(&Instant<'_>, &mut Scratch, &mut [f64]) -> f64 + Sync,
    ) -> (Vec<Vec<f64>>, f64) {
        let width = 2 * self.nodes_m.len();
        let (len, stride) = (chord.rate_rad_s.len(), histories.len());
        // All derivatives of one instant are adjacent.
        let mut states = vec![0.0; len * stride];
        for (column, history) in histories.iter().enumerate() {
            states.iter_mut().skip(column).step_by(stride).zip(history).for_each(|(s, h)| *s = *h);
        }
        let mut rows = vec![0.0; len * columns];
        let blocks = rows.par_chunks_mut(BLOCK * columns).zip(states.par_chunks(BLOCK * stride));
        let largest = blocks.enumerate().map(|(block, (rows, states))| {
            let mut scratch = Scratch::default();
            let instants = rows.chunks_mut(columns).zip(states.chunks(stride)).enumerate();
            let written = instants.map(|(k, (row, state))| {
                let sample = block * BLOCK + k;
                let now = Instant {
                    w: &state[..width],
                    rate: &state[width..2 * width],
                    acceleration: &state[stride - width..],
                    chord_rate_rad_s: chord.rate_rad_s[sample],
                    chord_acceleration_rad_s2: chord.acceleration_rad_s2[sample],
                    along_m_s2: chord.along_m_s2[sample],
                    across_m_s2: chord.across_m_s2[sample],
                    tip: chord.tip.as_ref().map(|tip| tip.at(sample)).unwrap_or_default(),
                };
                write(&now, &mut scratch, row)
            });
            written.fold(0.0, Size::larger)
        });
        let largest = largest.reduce(|| 0.0, Size::larger);
        let history = |column| rows.iter().skip(column).step_by(columns).copied().collect();
        ((0..columns).map(history).collect(), largest)
    }

    /// Number of histories for the loads: the deflections and their derivatives.
    pub(super) fn orders(&self) -> usize {
        if self.second_order == SecondOrder::Full { 3 } else { 2 }
    }

    /// Loads of the second-order terms, from the histories for [`Self::at_each_instant`].
    ///
    /// # Errors
    /// [`ElasticaError::TooSteep`].
    pub(super) fn loads(
        &self,
        states: (&[Vec<f64>], &ChordHistories),
    ) -> Result<LoadHistories, ElasticaError> {
        let write = |now: &Instant<'_>, scratch: &mut _, row: &mut _| self.write(now, scratch, row);
        let (mut nodal, largest_slope) = self.at_each_instant(self.columns(), states, write);
        if largest_slope.is_nan() || largest_slope >= STEEPEST {
            return Err(ElasticaError::TooSteep { slope: largest_slope });
        }
        let mut last = || nodal.pop().unwrap_or_default();
        let (left_n, axial_n) = (last(), last());
        Ok(LoadHistories { nodal, axial_n, left_n, largest_slope })
    }

    /// Number of columns that [`Self::write`] fills.
    pub(super) fn columns(&self) -> usize {
        2 * self.nodes_m.len() + 2
    }

    /// Writes force and moment on nodes 0 … n, then the axial force at the root and the force across the chord that
    /// accelerates the masses beyond the linear link's; returns the largest slope.
    pub(super) fn write(&self, now: &Instant<'_>, scratch: &mut Scratch, row: &mut [f64]) -> f64 {
        row.fill(0.0);
        let (loads, root_n) = row.split_at_mut(2 * self.nodes_m.len());
        let largest = self.place(now, scratch);
        let [axial_n, left_n] = self.bend(now, scratch, loads);
        root_n.copy_from_slice(&[axial_n, left_n]);
        // The hub's radius is a rigid piece along the root's slope.
        let [root, tip] = [0, self.nodes_m.len() - 1].map(|node| self.slope_at(now, node));
        loads[1] -= self.nodes_m[0] * axial_n * root.sine * root.secant;
        if let Some(stiffness) =
            self.spring_n_m_rad.filter(|_| self.second_order == SecondOrder::Full)
        {
            // As M and b of an element: the spring's moment k(ψ_1 − ψ_0) acts on the angles of both slopes.
            let outer = self.slope_at(now, 1);
            let sines = outer.sine - root.sine + self.beta_s * (outer.rate - root.rate);
            let angle = |own: &Slope| libm::asin(own.sine) + self.beta_s * own.rate * own.secant;
            let angles = angle(&outer) - angle(&root);
            loads[1] -= stiffness * (sines - angles * root.secant);
            loads[3] += stiffness * (sines - angles * outer.secant);
        }
        // A torque acts on the angle of the tip's slope.
        loads[2 * self.nodes_m.len() - 1] -= now.tip.torque_n_m * (tip.secant - 1.0);
        largest
    }

    pub(super) fn slope_at(&self, now: &Instant<'_>, node: usize) -> Slope {
        let at = 2 * node + 1;
        let acceleration =
            if self.second_order == SecondOrder::Full { now.acceleration[at] } else { 0.0 };
        Slope::of(self.second_order, [now.w[at], now.rate[at], acceleration])
    }

    /// Writes slopes and places of all points and bodies, from the axis outward; returns the largest slope.
    pub(super) fn place(&self, now: &Instant<'_>, scratch: &mut Scratch) -> f64 {
        let root = self.slope_at(now, 0);
        let mut u = root.u.map(|part| part * self.nodes_m[0]);
        scratch.shortened.clear();
        scratch.shortened.push(u[0]);
        let mut largest = root.sine.abs();
        // Written in place, because the arrays are long.
        scratch.slopes.resize_with(self.points.elements.len(), <_>::default);
        scratch.places.resize_with(self.points.elements.len(), <_>::default);
        scratch.body_places.clear();
        let mut bodies = self.bodies.iter().peekable();
        for (element, points) in self.points.elements.iter().enumerate() {
            while let Some(body) = bodies.next_if(|body| body.node == element) {
                scratch.body_places.push(self.body_place(now, body, u));
            }
            let four = |values: &[f64]| -> [f64; 4] {
                let first = 2 * element;
                [values[first], values[first + 1], values[first + 2], values[first + 3]]
            };
            let (w, rate) = (four(now.w), four(now.rate));
            let is_full = self.second_order == SecondOrder::Full;
            let acceleration = if is_full { four(now.acceleration) } else { [0.0; 4] };
            let (slopes, places) = (&mut scratch.slopes[element], &mut scratch.places[element]);
            for ((slope, place), point) in slopes.iter_mut().zip(places.iter_mut()).zip(points) {
                let turned = |dofs: &[f64; 4]| dot(&point.slope, dofs);
                let derivatives = [turned(&w), turned(&rate), turned(&acceleration)];
                *slope = Slope::of(self.second_order, derivatives);
                *place = Place {
                    x: point.s_m,
                    w: dot(&point.shape, &w),
                    w_rate: dot(&point.shape, &rate),
                    ..Place::default()
                };
                largest = largest.larger(slope.sine.abs());
            }
            if is_full {
                for (order, u) in u.iter_mut().enumerate() {
                    let values = std::array::from_fn(|k| slopes[k].u[order]);
                    let up_to = self.points.integrated(element, u, &values);
                    for (place, up_to) in places.iter_mut().zip(up_to) {
                        match order {
                            0 => (place.x, place.shortened) = (place.x + up_to, up_to),
                            1 => place.x_rate = up_to,
                            _ => place.x_acceleration = up_to,
                        }
                    }
                }
            }
            scratch.shortened.push(u[0]);
        }
        for body in bodies {
            scratch.body_places.push(self.body_place(now, body, u));
        }
        now.w.iter().skip(1).step_by(2).map(|slope| slope.abs()).fold(largest, Size::larger)
    }

    /// Place of a body at the end of its arm, with its node shortened by `u`.
    fn body_place(&self, now: &Instant<'_>, body: &Body, u: [f64; 3]) -> Place {
        let (slope, at) = (self.slope_at(now, body.node), 2 * body.node);
        let [shortened, x_rate, x_acceleration] =
            [0, 1, 2].map(|order| u[order] + body.arm_m * slope.u[order]);
        Place {
            x: self.nodes_m[body.node] + body.arm_m + shortened,
            x_rate,
            x_acceleration,
            shortened,
            w: now.w[at] + body.arm_m * slope.sine,
            w_rate: now.rate[at] + body.arm_m * slope.rate,
        }
    }

    /// Adds loads of all points and bodies, from the tip inward; returns the axial force at the root, and the force
    /// across the chord that accelerates all masses beyond the linear link's.
    ///
    /// ```text
    /// a_x = a·e − θ̇²(s + u) − θ̈ w − 2 θ̇ ẇ + ü,     N = −∫ m̄ a_x ds outboard
    /// f = −m̄(−θ̇² w + 2 θ̇ u̇ + θ̈ u),   m = −N tan ψ − M w'' w'/cos³ψ,   b = −(M/cos ψ − EI(w'' + β ẇ''))
    /// M = EI(κ + β κ̇),   κ = w''/cos ψ
    /// ```
    fn bend(&self, now: &Instant<'_>, scratch: &Scratch, loads: &mut [f64]) -> [f64; 2] {
        let [mut axial, mut left] = [now.tip.along_n, 0.0];
        let mut bodies = self.bodies.iter().zip(&scratch.body_places).rev().peekable();
        for (element, points) in self.points.elements.iter().enumerate().rev() {
            while let Some((body, place)) = bodies.next_if(|(body, _)| body.node > element) {
                let [along, across] = self.load_body(now, body, place, loads);
                [axial, left] = [axial + along, left - across];
            }
            let (slopes, places) = (&scratch.slopes[element], &scratch.places[element]);
            let forces = std::array::from_fn(|k| {
                -points[k].mass_kg_m * points[k].weight_m * along(now, &places[k])
            });
            let outboard = self.points.outboard(element, &mut axial, &forces);
            let dofs = 2 * element..2 * element + 4;
            let element_loads = &mut loads[dofs.clone()];
            for (k, point) in points.iter().enumerate() {
                let slope = &slopes[k];
                let force = -point.mass_kg_m * left_across(now, &places[k]);
                left -= point.weight_m * force;
                let mut moment = -outboard[k] * slope.sine * slope.secant;
                let mut bending = 0.0;
                if self.second_order == SecondOrder::Full {
                    let curve = |values: &[f64]| -> f64 {
                        point.curvature.iter().zip(&values[dofs.clone()]).map(|(n, w)| n * w).sum()
                    };
                    let (w2, w2_rate) = (curve(now.w), curve(now.rate));
                    let (sec, turn) = (slope.secant, slope.sine * slope.rate);
                    let cubed = sec * sec * sec;
                    let curvature = w2 * sec;
                    let curvature_rate = w2_rate * sec + w2 * turn * cubed;
                    let m = point.stiffness_n_m2 * (curvature + self.beta_s * curvature_rate);
                    moment -= m * w2 * slope.sine * cubed;
                    bending = point.stiffness_n_m2 * (w2 + self.beta_s * w2_rate) - m * sec;
                }
                for (dof, load) in element_loads.iter_mut().enumerate() {
                    *load += point.weight_m
                        * (point.shape[dof] * force
                            + point.slope[dof] * moment
                            + point.curvature[dof] * bending);
                }
            }
        }
        for (body, place) in bodies {
            let [along, across] = self.load_body(now, body, place, loads);
            [axial, left] = [axial + along, left - across];
        }
        [axial, left]
    }

    /// Adds the loads of a body on its node; returns its force along the chord and across it.
    fn load_body(
        &self,
        now: &Instant<'_>,
        body: &Body,
        place: &Place,
        loads: &mut [f64],
    ) -> [f64; 2] {
        let (slope, at) = (self.slope_at(now, body.node), 2 * body.node);
        let axial = -body.mass_kg * along(now, place);
        let across = -body.mass_kg * left_across(now, place);
        loads[at] += across;
        loads[at + 1] += body.arm_m * (across - axial * slope.sine * slope.secant);
        if self.second_order == SecondOrder::Full {
            let chord = now.chord_acceleration_rad_s2;
            let turned = (chord + slope.turning()) * slope.secant;
            loads[at + 1] -= body.inertia_kg_m2 * (turned - (chord + slope.acceleration));
        }
        [axial, across]
    }
}

/// 1 − cos ψ of a slope sin ψ, without cancellation.
#[inline]
pub(super) fn shortening(sine: f64) -> f64 {
    sine * sine / (1.0 + (1.0 - sine * sine).sqrt())
}

/// Acceleration of a place along the chord.
pub(super) fn along(now: &Instant<'_>, place: &Place) -> f64 {
    let (rate, acceleration) = (now.chord_rate_rad_s, now.chord_acceleration_rad_s2);
    now.along_m_s2 - rate * rate * place.x - acceleration * place.w - 2.0 * rate * place.w_rate
        + place.x_acceleration
}

/// Part of a place's acceleration across the chord that the linear link neglects.
pub(super) fn left_across(now: &Instant<'_>, place: &Place) -> f64 {
    let (rate, acceleration) = (now.chord_rate_rad_s, now.chord_acceleration_rad_s2);
    -rate * rate * place.w + 2.0 * rate * place.x_rate + acceleration * place.shortened
}
