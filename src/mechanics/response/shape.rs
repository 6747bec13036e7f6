//! An elastica's shape at rest and along its length, and its damping as a matrix.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::chain::Chain;
use super::error::SimulationError;
use super::modes::{HubLoop, HubReaction};
use super::state::LinkState;
use crate::modal::DampingLaw;
use crate::numeric::{GaussRule, SymmetricEigen, piece_shapes};

/// Numbers of parts of the weight, tried until one leads to a shape at rest.
const WEIGHT_PARTS: [u32; 4] = [1, 4, 16, 64];

/// Change in rad by an iteration that counts as rest.
const SETTLED_RAD: f64 = 1e-12;

/// Largest change by one iteration towards the shape at rest, in rad, and the most iterations.
const LARGEST_CHANGE_RAD: f64 = 0.3;
const MOST_ITERATIONS: usize = 60;

/// Step in rad of the numerical derivatives of forces.
const PART_RAD: f64 = 1e-6;

/// Most places of a state on a piece: polynomials through more places lose digits.
const MOST_PLACES: usize = 41;

/// Largest distance from the end of a piece, with ends −1 and 1, that counts as the end.
const SAME_PLACE: f64 = 1e-6;

/// Applies the weight at once or, if that fails, in parts; `settled` receives its share and the shape so far.
pub(super) fn in_parts(
    straight: &[f64],
    settled: impl Fn(f64, Vec<f64>) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    WEIGHT_PARTS.into_iter().find_map(|parts| {
        let mut shares = (1..=parts).map(|part| f64::from(part) / f64::from(parts));
        shares.try_fold(straight.to_vec(), |q, share| settled(share, q))
    })
}

/// Newton's iteration for zero remaining forces.
pub(super) fn settled(
    mut q: Vec<f64>,
    mut left: impl FnMut(&[f64]) -> DVector<f64>,
) -> Option<Vec<f64>> {
    for _ in 0..MOST_ITERATIONS {
        let now = left(&q);
        let change = newton_change(&mut q, &now, &mut left)?;
        let most = change.amax();
        if !most.is_finite() {
            return None;
        }
        let share = (LARGEST_CHANGE_RAD / most).min(1.0);
        q.iter_mut().zip(change.iter()).for_each(|(own, change)| *own -= share * change);
        if most < SETTLED_RAD {
            return Some(q);
        }
    }
    None
}

/// Error of the coordinates for these remaining forces, to first order, from numerical derivatives of the forces.
/// `None` where the forces do not depend on all coordinates.
fn newton_change(
    q: &mut [f64],
    now: &DVector<f64>,
    left: &mut impl FnMut(&[f64]) -> DVector<f64>,
) -> Option<DVector<f64>> {
    let mut slopes = DMatrix::zeros(q.len(), q.len());
    for k in 0..q.len() {
        let unmoved = q[k];
        q[k] = unmoved + PART_RAD;
        slopes.set_column(k, &((left(q) - now) / PART_RAD));
        q[k] = unmoved;
    }
    slopes.lu().solve(now)
}

/// The damping matrix. Hysteretic damping of ratio ξ is viscous in every mode ψ of the straight link, with its hub
/// held. In a loop (`loop_at`: reaction, and first frequency of the free hub in rad/s) the hub is free or on a spring,
/// see [`HubLoop`]. With s the link's share of the mode's energy,
///
/// ```text
/// D = 2ξ Σ s ω M ψ ψᵀ M = 2ξ Σ s ω⁻¹ (L z)(L z)ᵀ,    L⁻¹ M L⁻ᵀ z = ω⁻² z,   K = L Lᵀ
/// ```
pub(super) fn viscous(
    chain: &Chain,
    law: &DampingLaw,
    loop_at: Option<(HubReaction, f64)>,
) -> Option<Vec<f64>> {
    let ratio = match law {
        DampingLaw::Hysteretic { ratio } => *ratio,
        DampingLaw::Rayleigh { beta_s, .. } => {
            return Some(chain.stiffness.iter().map(|entry| beta_s * entry).collect());
        }
        _ => return None,
    };
    let count = chain.count;
    let mut damping = vec![0.0; count * count];
    if ratio == 0.0 {
        return Some(damping);
    }
    let mass = chain.straight_mass();
    let held = HubLoop { held_share: 1.0, spring_n_m_rad: None };
    let HubLoop { held_share, spring_n_m_rad } =
        loop_at.map_or(held, |(reaction, first)| HubLoop::of(reaction, mass[0], first));
    for (part, spring_n_m_rad, is_free) in
        [(1.0 - held_share, spring_n_m_rad, true), (held_share, None, false)]
    {
        if part == 0.0 {
            continue;
        }
        let first = usize::from(spring_n_m_rad.is_none());
        let size = count - first;
        let bent = DMatrix::from_fn(size, size, |i, j| {
            let entry = mass[(i + first) * count + j + first];
            // A free hub follows, so that the momentum stays 0.
            let follows = is_free && spring_n_m_rad.is_none();
            entry - if follows { mass[(i + 1) * count] * mass[j + 1] / mass[0] } else { 0.0 }
        });
        let mut stiffness =
            DMatrix::from_fn(size, size, |i, j| chain.stiffness[(i + first) * count + j + first]);
        stiffness[(0, 0)] += spring_n_m_rad.unwrap_or(0.0);
        let factor = stiffness.cholesky()?.l();
        let modes = SymmetricEigen::over(&factor, &bent)?;
        for (k, square) in modes.values.iter().enumerate() {
            let z = modes.vector(k);
            let stiff = &factor * DVector::from_column_slice(z);
            let link_share: f64 = z[1 - first..].iter().map(|z| z * z).sum();
            let share = part * 2.0 * ratio * link_share * square.max(0.0).sqrt();
            for i in 0..size {
                for j in 0..size {
                    damping[(i + first) * count + j + first] += share * stiff[i] * stiff[j];
                }
            }
        }
    }
    Some(damping)
}

impl Chain {
    /// The slopes, and their rates, at enough places of each piece to determine its polynomials.
    pub(super) fn state(&self, time_s: f64, q: &[f64], rates: &[f64]) -> LinkState {
        let mut state = LinkState {
            time_s,
            x_m: vec![self.root_m],
            slope_rad: vec![self.root_rad(q)],
            slope_rate_rad_s: vec![self.root_rad_s(rates)],
            carriage: self.slides().then_some([q[0], rates[0]]),
            ..LinkState::default()
        };
        let [root_rad, root_rad_s] = [state.slope_rad[0], state.slope_rate_rad_s[0]];
        let mut from_m = self.root_m;
        for piece in &self.pieces {
            let order = piece.shapes[0].len() - 1;
            // On a spring the root has two slopes: the joint's, then the link's.
            for k in usize::from(!piece.is_on_spring())..=order {
                // Chebyshev's places, both ends included.
                let t = -libm::cos(std::f64::consts::PI * k as f64 / order as f64);
                let shape = piece_shapes(order, t).0;
                let at = |root: f64, own: &[f64]| {
                    root + piece.coordinates().map(|(i, j)| own[i] * shape[j]).sum::<f64>()
                };
                state.x_m.push(from_m + 0.5 * (1.0 + t) * piece.length_m);
                state.slope_rad.push(at(root_rad, q));
                state.slope_rate_rad_s.push(at(root_rad_s, rates));
            }
            from_m += piece.length_m;
        }
        state
    }

    /// Coordinates and rates of a state.
    ///
    /// # Errors
    /// [`SimulationError::State`] without places at the ends of a piece, or with too many on it.
    pub(super) fn of_state(
        &self,
        state: &LinkState,
    ) -> Result<(Vec<f64>, Vec<f64>), SimulationError> {
        let [mut q, mut rates] = [(); 2].map(|()| vec![0.0; self.count]);
        [q[0], rates[0]] =
            state.carriage.unwrap_or([state.slope_rad[0], state.slope_rate_rad_s[0]]);
        let mut from_m = self.root_m;
        for piece in &self.pieces {
            let to_m = from_m + piece.length_m;
            let rows = state.piece([from_m, to_m]);
            let order = rows.len().saturating_sub(1);
            let refused = || SimulationError::State {
                found: format!("has {} places from {from_m} to {to_m} m", rows.len()),
                must: format!("have 2 to {MOST_PLACES} there, those at both ends among them"),
            };
            let has_ends = rows.first().is_some_and(|row| row[0] < SAME_PLACE - 1.0)
                && rows.last().is_some_and(|row| row[0] > 1.0 - SAME_PLACE);
            if !has_ends || order == 0 || rows.len() > MOST_PLACES {
                return Err(refused());
            }
            let shapes = DMatrix::from_fn(rows.len(), rows.len(), |row, column| {
                piece_shapes(order, rows[row][0]).0[column]
            });
            let values = DMatrix::from_fn(rows.len(), 2, |row, column| rows[row][1 + column]);
            let factors = shapes.lu().solve(&values).ok_or_else(refused)?;
            // Polynomials of higher order are 0; the last shape is the outer end.
            for k in 1..order {
                (q[piece.first + k - 1], rates[piece.first + k - 1]) =
                    (factors[(k, 0)], factors[(k, 1)]);
            }
            (q[piece.outer()], rates[piece.outer()]) = (factors[(order, 0)], factors[(order, 1)]);
            if piece.is_on_spring() {
                (q[1], rates[1]) = (factors[(0, 0)], factors[(0, 1)]);
            }
            from_m = to_m;
        }
        Ok((q, rates))
    }

    /// Stations at distances along the link from the axis, for places from coordinates.
    pub(super) fn stations(&self, along_m: &[f64]) -> Vec<Station> {
        let station = |s_m: &f64| {
            let mut from_m = self.root_m;
            let last = self.pieces.len() - 1;
            for (piece, own) in self.pieces.iter().enumerate() {
                let to_m = from_m + own.length_m;
                if *s_m <= to_m || piece == last {
                    let t = (2.0 * (s_m - from_m) / own.length_m - 1.0).clamp(-1.0, 1.0);
                    let points = own.shapes.len();
                    let within = if *s_m < self.root_m {
                        vec![0.0; points]
                    } else {
                        GaussRule::new(points).up_to(t)
                    };
                    return Station { piece, t, within, inside_m: s_m.min(self.root_m) };
                }
                from_m = to_m;
            }
            Station { piece: 0, t: -1.0, within: Vec::new(), inside_m: 0.0 }
        };
        along_m.iter().map(station).collect()
    }

    /// Turn of the link at stations by these coordinates.
    pub(super) fn turns(&self, stations: &[Station], q: &[f64]) -> Vec<f64> {
        let root = self.root_rad_s(q);
        let turn = |station: &Station| {
            if station.inside_m < self.root_m {
                return root;
            }
            let piece = &self.pieces[station.piece];
            let shape = piece_shapes(piece.order(), station.t).0;
            root + piece.coordinates().map(|(i, k)| q[i] * shape[k]).sum::<f64>()
        };
        stations.iter().map(turn).collect()
    }

    /// Curvature at the root in 1/m per coordinate.
    pub(super) fn root_curvature(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.count];
        if let Some(piece) = self.pieces.first() {
            let slopes = piece_shapes(piece.order(), -1.0).1;
            piece.coordinates().for_each(|(i, k)| row[i] = 2.0 / piece.length_m * slopes[k]);
        }
        row
    }

    /// Places of stations in m.
    pub(super) fn places_m(&self, stations: &[Station], q: &[f64]) -> Vec<[f64; 2]> {
        let (root_rad, axis_m) = (self.root_rad(q), self.axis_m(q));
        let hub = [libm::cos(root_rad), libm::sin(root_rad)];
        let inside = |at_m: f64| [0, 1].map(|part| axis_m[part] + at_m * hub[part]);
        let mut inner = vec![inside(self.root_m)];
        let mut slopes = Vec::with_capacity(self.pieces.len());
        for piece in &self.pieces {
            let directions = piece.shapes.iter().map(|shape| {
                let bent: f64 = piece.coordinates().map(|(i, k)| q[i] * shape[k]).sum();
                [libm::cos(root_rad + bent), libm::sin(root_rad + bent)]
            });
            let directions: Vec<[f64; 2]> = directions.collect();
            let whole = piece.within.last().map_or(&[][..], Vec::as_slice);
            let last = inner[inner.len() - 1];
            inner.push(reached(last, piece.length_m, whole, &directions));
            slopes.push(directions);
        }
        let place = |station: &Station| {
            let piece = station.piece;
            let from = if station.inside_m < self.root_m {
                inside(station.inside_m)
            } else {
                inner[piece]
            };
            reached(from, self.pieces[piece].length_m, &station.within, &slopes[piece])
        };
        stations.iter().map(place).collect()
    }
}

/// The place that follows another one along slopes with this cosine and sine at each point.
fn reached(from_m: [f64; 2], length_m: f64, within: &[f64], slopes: &[[f64; 2]]) -> [f64; 2] {
    let parts = within.iter().zip(slopes);
    parts.fold(from_m, |[x, y], (share, [cosine, sine])| {
        [x + length_m * share * cosine, y + length_m * share * sine]
    })
}

/// A place along the link.
#[derive(Debug, Clone)]
pub(super) struct Station {
    piece: usize,
    /// Place on the piece, with ends −1 and 1.
    t: f64,
    within: Vec<f64>,
    /// Distance from the axis within the hub's radius.
    inside_m: f64,
}

/// Direction of a place from the axis in rad, within half a turn of another one.
pub(super) fn direction([x, y]: [f64; 2], near_rad: f64) -> f64 {
    let turn = libm::atan2(y, x) - near_rad;
    near_rad + turn - 2.0 * PI * (turn / (2.0 * PI)).round()
}
