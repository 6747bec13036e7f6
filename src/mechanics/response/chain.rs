//! A link as an inextensible elastica with angles as coordinates: Lagrange's equations at any deflection.
//!
//! The position of the joint comes first: the hub's angle φ, or the displacement u of a carriage. Then come the slopes ψ
//! of the link from its tangent line at the joint: on a spring that of the root, then polynomials on each piece between
//! two masses or segment ends. Places
//! and their derivatives are integrals of cosines and sines along the link, at Gauss's points, so that the discrete link
//! keeps its energy exactly. A carriage moves the axis by u along n, across its link, whose root keeps the direction φ.
//!
//! ```text
//! r(s) = u n + ∫ (cos θ, sin θ) ds,   θ = φ + ψ,   M = Σ m ∂r/∂qᵀ ∂r/∂q,   V = ½ k ψ₀² + ½ ∫ EI ψ'² ds − Σ m g·r
//! ```

use std::ops::Range;

use super::balance::{Balance, Met, Place};
use crate::link::{Link, POSITION_TOLERANCE, Payload, Taper};
use crate::numeric::{GaussRule, dot, piece_shapes};

/// Gauss points of a piece beyond the order of its polynomials.
const MORE_POINTS: usize = 3;

/// Approximate number of matrices in memory at the same time: stiffness, damping and mass of links and chain, and the
/// factors of Radau's and Newton's methods.
const MATRICES: usize = 12;

/// A body fixed to the end of a piece.
#[derive(Debug, Clone, Copy)]
struct Body {
    mass_kg: f64,
    inertia_kg_m2: f64,
    /// Distance of its centre beyond that end in m.
    arm_m: f64,
}

/// A part of the link without a mass or the end of a segment within.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) length_m: f64,
    /// Number of its first coordinate: polynomials that vanish at both ends, then the slope at the outer end. The slope
    /// at its inner end is the coordinate before them; the first piece on a clamped root has no such slope.
    pub(super) first: usize,
    /// For each Gauss point, the factors of the inner end's slope and of each coordinate in its slope.
    pub(super) shapes: Vec<Vec<f64>>,
    masses_kg: Vec<f64>,
    /// Integrals from the inner end to each point, and to the outer end, over the length, per value at each point.
    pub(super) within: Vec<Vec<f64>>,
    bodies: Vec<Body>,
}

/// The link.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    pub(super) pieces: Vec<Piece>,
    pub(super) root_m: f64,
    /// Motion of the axis across the link, and of the root's slope, per unit of the joint's position.
    unit: [f64; 2],
    /// Direction in rad of the root where the joint's position is 0.
    direction_rad: f64,
    /// The joint's inertia.
    at_axis: Body,
    at_root: Vec<Body>,
    /// Number of springs at the root, 0 or 1: the slope of the link on a spring is coordinate 1.
    springs: usize,
    /// Distance in m from the axis to the output, and number of the piece that ends there.
    pub(super) output_m: f64,
    output: usize,
    /// Number of coordinates.
    pub(super) count: usize,
    /// Stiffness row by row; 0 for the joint's position.
    pub(super) stiffness: Vec<f64>,
}

/// A piece without polynomials.
struct PlannedPiece {
    ends_m: [f64; 2],
    order: usize,
    stiffness: Taper,
    mass: Taper,
}

/// The pieces of a link. `order` receives the ends of a piece in m, its mean stiffness in N m² and its mean mass in
/// kg/m. It returns the order of the polynomials there, at least 2.
fn planned(
    link: &Link,
    order: impl Fn([f64; 2], [f64; 2]) -> usize,
) -> impl Iterator<Item = PlannedPiece> {
    let same_m = POSITION_TOLERANCE * link.length_m();
    let mut root_m = link.hub().radius_m;
    link.segments().iter().flat_map(move |segment| {
        let (inner_m, tip_m) = (root_m, root_m + segment.length_m);
        root_m = tip_m;
        let mut from_m = inner_m;
        let piece = |end_m: f64| {
            let [from, to] = [from_m, end_m].map(|x| ((x - inner_m) / segment.length_m).min(1.0));
            let stiffness = segment.bending_stiffness_n_m2.between(from, to);
            let mass = segment.mass_per_length_kg_m.between(from, to);
            let ends_m = [from_m, end_m];
            from_m = end_m;
            let order = order(ends_m, [stiffness.mean(), mass.mean()]).max(2);
            PlannedPiece { ends_m, order, stiffness, mass }
        };
        let pieces: Vec<_> =
            piece_ends_m(link, [inner_m, tip_m], same_m).into_iter().map(piece).collect();
        pieces
    })
}

/// Number of coordinates of [`Chain::of`], computed without its matrices.
pub(super) fn coordinates(link: &Link, order: impl Fn([f64; 2], [f64; 2]) -> usize) -> usize {
    let spring = usize::from(link.root_stiffness_n_m_rad().is_some());
    1 + spring + planned(link, order).map(|piece| piece.order).sum::<usize>()
}

/// Approximate memory in bytes of a simulated chain with `count` coordinates: its matrices, and `numbers` for each
/// sample.
pub(super) fn play_bytes(count: usize, samples: usize, numbers: usize) -> usize {
    let matrices = MATRICES.saturating_mul(count.saturating_mul(count));
    samples.saturating_mul(numbers).saturating_add(matrices).saturating_mul(size_of::<f64>())
}

impl Chain {
    /// An undamped link with polynomials of the orders of [`planned`].
    pub(super) fn of(link: &Link, order: impl Fn([f64; 2], [f64; 2]) -> usize) -> Self {
        let joint = link.joint();
        let (root_m, unit) = (joint.radius_m(), joint.rigid(0.0));
        let [mass_kg, inertia_kg_m2] = unit.map(|part| part * part * joint.inertia());
        let springs = usize::from(link.root_stiffness_n_m_rad().is_some());
        let mut chain = Self {
            pieces: Vec::new(),
            root_m,
            unit,
            direction_rad: link.direction_rad().unwrap_or(0.0),
            at_axis: Body { mass_kg, inertia_kg_m2, arm_m: 0.0 },
            at_root: bodies_at(link, root_m),
            springs,
            output_m: link.output_m(),
            output: 0,
            count: 1 + springs,
            stiffness: Vec::new(),
        };
        let mut bends = Vec::new();
        for PlannedPiece { ends_m: [from_m, end_m], order, stiffness, mass } in planned(link, order)
        {
            let length_m = end_m - from_m;
            let rule = GaussRule::new(order + MORE_POINTS);
            let bodies = bodies_at(link, end_m);
            if end_m <= chain.output_m + POSITION_TOLERANCE * link.length_m() {
                chain.output = chain.pieces.len();
            }
            chain.pieces.push(Piece::new(length_m, chain.count, (order, &rule), mass, bodies));
            bends.push((rule, order, stiffness));
            chain.count += order;
        }
        let Payload { mass_kg, inertia_kg_m2, offset_m: arm_m } = *link.payload();
        if let Some(last) = chain.pieces.last_mut() {
            last.bodies.push(Body { mass_kg, inertia_kg_m2, arm_m });
        }
        let count = chain.count;
        chain.stiffness = vec![0.0; count * count];
        if let Some(stiffness) = link.root_stiffness_n_m_rad() {
            chain.stiffness[count + 1] = stiffness;
        }
        for (piece, (rule, order, stiffness)) in chain.pieces.iter().zip(bends) {
            for (weight, t) in rule.weights.iter().zip(&rule.places) {
                // ds = l/2 dt, and each derivative has 2/l; the weights belong to (0, 1).
                let factor = 4.0 * weight * stiffness.at(0.5 * (1.0 + t)) / piece.length_m;
                let slopes = piece_shapes(order, *t).1;
                for (i, own) in piece.coordinates() {
                    for (j, other) in piece.coordinates() {
                        chain.stiffness[i * count + j] += factor * slopes[own] * slopes[other];
                    }
                }
            }
        }
        chain
    }

    /// True if the joint slides.
    pub(super) fn slides(&self) -> bool {
        self.unit[1] == 0.0
    }

    /// Direction in rad of the root.
    pub(super) fn root_rad(&self, q: &[f64]) -> f64 {
        self.direction_rad + self.unit[1] * q[0]
    }

    /// Rate in rad/s of the root's direction.
    pub(super) fn root_rad_s(&self, rates: &[f64]) -> f64 {
        self.unit[1] * rates[0]
    }

    /// Motion of the axis along x and y per unit of the joint's position.
    fn slide(&self) -> [f64; 2] {
        let (sine, cosine) = (libm::sin(self.direction_rad), libm::cos(self.direction_rad));
        [-self.unit[0] * sine, self.unit[0] * cosine]
    }

    /// x and y of the axis in m.
    pub(super) fn axis_m(&self, q: &[f64]) -> [f64; 2] {
        self.slide().map(|part| part * q[0])
    }

    /// Part of a vector across a link that slides.
    pub(super) fn across(&self, vector: [f64; 2]) -> f64 {
        dot(&self.slide(), &vector)
    }

    /// Size of the joint's positions: 1 rad of a hub, the length of the link in m on a carriage.
    pub(super) fn position_size(&self) -> f64 {
        if self.slides() { self.output_m } else { 1.0 }
    }

    /// Walks the link from the axis outward and shows each mass, or rotary inertia, at its place.
    fn walk(&self, q: &[f64], rates: &[f64], mut meet: impl FnMut(&Place, Met<'_>)) {
        self.walk_on(&Place::fixed(self.count), (&[], 0), (q, rates), &mut meet);
    }

    /// Walks a link with its axis on another link, turned by the coordinates `before`; the link's coordinates begin
    /// with number `own`. Shows the ends of pieces up to the output.
    pub(super) fn walk_on(
        &self,
        axis: &Place,
        (before, own): (&[usize], usize),
        (q, rates): (&[f64], &[f64]),
        meet: &mut impl FnMut(&Place, Met<'_>),
    ) {
        let mut axis = axis.clone();
        let mut hub = before.to_vec();
        if self.slides() {
            axis.slide(self.slide(), (q[own], rates[own]), own);
        } else {
            hub.push(own);
        }
        let sum = |of: &[usize], values: &[f64]| of.iter().fold(0.0, |sum, i| sum + values[*i]);
        let (hub_rad, hub_rad_s) = (self.direction_rad + sum(&hub, q), sum(&hub, rates));
        Self::meet_bodies(&[self.at_axis], &axis, (hub_rad, hub_rad_s), &hub, meet);
        let mut inner = axis.beyond(self.root_m, (hub_rad, hub_rad_s), &hub);
        let turned: Vec<usize> =
            hub.iter().copied().chain(own + 1..own + 1 + self.springs).collect();
        let (root_rad, root_rad_s) = (self.direction_rad + sum(&turned, q), sum(&turned, rates));
        Self::meet_bodies(&self.at_root, &inner, (root_rad, root_rad_s), &turned, meet);
        let mut here = inner.clone();
        for (number, piece) in self.pieces.iter().enumerate() {
            let angle = |hub: f64, values: &[f64], shape: &[f64]| {
                let bent = piece.coordinates().map(|(i, k)| values[own + i] * shape[k]);
                hub + bent.sum::<f64>()
            };
            let slopes: Vec<[f64; 4]> = piece
                .shapes
                .iter()
                .map(|shape| {
                    let (angle, rate) = (angle(hub_rad, q, shape), angle(hub_rad_s, rates, shape));
                    let (cosine, sine) = (libm::cos(angle), libm::sin(angle));
                    [cosine, sine, rate, rate * rate]
                })
                .collect();
            let (bent, from) = piece.bent();
            let bent = own + bent.start..own + bent.end;
            for (point, within) in piece.within.iter().enumerate() {
                here.clone_from(&inner);
                let mut turned = [0.0; 2];
                for (k, (share, [cosine, sine, rate, square])) in
                    within.iter().zip(&slopes).enumerate()
                {
                    let (x, y) = (piece.length_m * share * cosine, piece.length_m * share * sine);
                    for (axis, (part, by)) in [(x, -y), (y, x)].into_iter().enumerate() {
                        here.at_m[axis] += part;
                        here.rate_m_s[axis] += by * rate;
                        here.centripetal_m_s2[axis] -= part * square;
                        turned[axis] += by;
                        let entries = here.by[axis][bent.clone()].iter_mut();
                        let shapes = entries.zip(&piece.shapes[k][from..]);
                        shapes.for_each(|(entry, shape)| *entry += by * shape);
                    }
                }
                for i in &hub {
                    here.by[0][*i] += turned[0];
                    here.by[1][*i] += turned[1];
                }
                if let Some(mass_kg) = piece.masses_kg.get(point) {
                    meet(&here, Met::Mass(*mass_kg));
                }
            }
            let outer = own + piece.outer();
            let slope = (hub_rad + q[outer], hub_rad_s + rates[outer]);
            let turned = [&hub[..], &[outer]].concat();
            Self::meet_bodies(&piece.bodies, &here, slope, &turned, meet);
            if number <= self.output {
                meet(&here, Met::End(&turned));
            }
            inner.clone_from(&here);
        }
    }

    fn meet_bodies(
        bodies: &[Body],
        end: &Place,
        slope: (f64, f64),
        turned: &[usize],
        meet: &mut impl FnMut(&Place, Met<'_>),
    ) {
        for body in bodies {
            let centre = end.beyond(body.arm_m, slope, turned);
            meet(&centre, Met::Mass(body.mass_kg));
            meet(&centre, Met::Inertia(body.inertia_kg_m2, turned));
        }
    }

    /// Mass matrix of the straight link, row by row.
    pub(super) fn straight_mass(&self) -> Vec<f64> {
        let (rest, mut balance) = (vec![0.0; self.count], Balance::default());
        // At zero rates the damping does not matter.
        balance.begin(&self.stiffness, &self.stiffness, (&rest, &rest));
        self.walk(&rest, &rest, |place, met| balance.meet(place, &met, [0.0; 2]));
        balance.end();
        balance.mass
    }

    /// The output and its motion.
    pub(super) fn output(&self, q: &[f64], rates: &[f64]) -> Place {
        let mut output = Place::default();
        self.walk(q, rates, |place, met| {
            if let Met::End(_) = met {
                output.clone_from(place);
            }
        });
        output
    }
}

/// Bodies at a distance along the link.
fn bodies_at(link: &Link, at_m: f64) -> Vec<Body> {
    let same_m = POSITION_TOLERANCE * link.length_m();
    let here = link.masses().iter().filter(|mass| (mass.at_m - at_m).abs() <= same_m);
    here.map(|mass| Body { mass_kg: mass.mass_kg, inertia_kg_m2: mass.inertia_kg_m2, arm_m: 0.0 })
        .collect()
}

/// Ends of a segment's pieces: masses and the output within it, and its outer end.
fn piece_ends_m(link: &Link, [root_m, tip_m]: [f64; 2], same_m: f64) -> Vec<f64> {
    let inside = |at_m: &f64| *at_m > root_m + same_m && *at_m < tip_m - same_m;
    let masses_m = link.masses().iter().map(|mass| mass.at_m);
    let mut ends: Vec<f64> = masses_m.chain([link.output_m()]).filter(inside).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b <= same_m);
    ends.push(tip_m);
    ends
}

impl Piece {
    /// A piece with polynomials of an order, at the points of a rule; `first` is the number of its first coordinate.
    fn new(
        length_m: f64,
        first: usize,
        (order, rule): (usize, &GaussRule),
        mass_kg_m: Taper,
        bodies: Vec<Body>,
    ) -> Self {
        let points = || rule.places.iter();
        let mass = |(weight, t): (&f64, &f64)| length_m * weight * mass_kg_m.at(0.5 * (1.0 + t));
        Self {
            length_m,
            first,
            shapes: points().map(|t| piece_shapes(order, *t).0).collect(),
            masses_kg: rule.weights.iter().zip(points()).map(mass).collect(),
            within: points().chain([&1.0]).map(|t| rule.up_to(*t)).collect(),
            bodies,
        }
    }

    /// Order of its polynomials.
    pub(super) fn order(&self) -> usize {
        self.shapes[0].len() - 1
    }

    /// Coordinates that bend the piece, and their numbers among its shapes.
    pub(super) fn coordinates(&self) -> impl Iterator<Item = (usize, usize)> + Clone + use<> {
        let (coordinates, from) = self.bent();
        coordinates.zip(from..)
    }

    /// Coordinates that bend the piece, and the number of the first of its shapes.
    fn bent(&self) -> (Range<usize>, usize) {
        // The joint's position is no slope from its tangent line.
        let from = usize::from(self.first == 1);
        (self.first + from - 1..self.first + self.order(), from)
    }

    /// True on a spring at the root, whose slope is the coordinate between the joint's position and its own.
    pub(super) fn is_on_spring(&self) -> bool {
        self.first == 2
    }

    /// Coordinate of the slope at its outer end.
    pub(super) fn outer(&self) -> usize {
        self.first + self.shapes[0].len() - 2
    }
}
