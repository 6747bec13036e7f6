use nalgebra::DMatrix;

use super::equations::Equations;
use super::exponential::exponential;
use super::forcing::Cubic;

/// Terms of the cubic that drives a step.
const TERMS: usize = 4;

/// Steps the modal equations by one time step, exactly for a torque that is a cubic over it.
///
/// ```text
/// d/dτ (x, w) = [[A Δt, B Δt e₀ᵀ], [0, D]] (x, w),   w_j the cubic's derivatives u⁽ʲ⁾Δtʲ/j!
/// ```
///
/// so that the exponential of this matrix holds the transition of the state and its answer to each
/// term of the cubic (Van Loan 1978).
#[derive(Debug, Clone)]
pub(super) struct Stepper {
    blocks: Vec<Block>,
    /// Coordinates and rates are kept in one unit: s q and q̇, s = max(ω, 1/Δt).
    scales: Vec<f64>,
    state: Vec<f64>,
    next: Vec<f64>,
}

/// Coordinates that feel each other: all of them where the hub reacts, else each by itself.
#[derive(Debug, Clone)]
struct Block {
    first: usize,
    count: usize,
    /// Rows of the transition, 2 × count, each with its four answers to the cubic.
    rows: Vec<f64>,
}

impl Stepper {
    /// At rest.
    pub(super) fn new(equations: &Equations, step_s: f64) -> Self {
        let count = equations.coordinates.len();
        let scale = |square: f64| square.sqrt().max(step_s.recip());
        let scales: Vec<f64> = equations.coordinates.iter().map(|c| scale(c.square)).collect();
        let size = if equations.reaction.is_none() { 1 } else { count };
        let block = |first: usize| Block::new(equations, &scales, first, size, step_s);
        let blocks = (0..count).step_by(size).map(block).collect();
        Self { blocks, scales, state: vec![0.0; 2 * count], next: vec![0.0; 2 * count] }
    }

    /// Goes on from these coordinates and rates.
    pub(super) fn starting_at(mut self, coordinates: &[f64], rates: &[f64]) -> Self {
        for Block { first, count, .. } in &self.blocks {
            for k in 0..*count {
                let own = first + k;
                self.state[2 * first + k] = self.scales[own] * coordinates[own];
                self.state[2 * first + count + k] = rates[own];
            }
        }
        self
    }

    /// Goes one step on.
    pub(super) fn advance(&mut self, cubic: &Cubic) {
        for block in &self.blocks {
            let range = 2 * block.first..2 * (block.first + block.count);
            let (state, next) = (&self.state[range.clone()], &mut self.next[range]);
            for (row, next) in block.rows.chunks_exact(state.len() + TERMS).zip(next) {
                let (transition, answers) = row.split_at(state.len());
                let free: f64 = transition.iter().zip(state).map(|(a, x)| a * x).sum();
                let driven: f64 = answers.iter().zip(cubic).map(|(a, c)| a * c).sum();
                *next = free + driven;
            }
        }
        std::mem::swap(&mut self.state, &mut self.next);
    }

    /// Goes through all pieces; returns what `of` reads off the coordinates before the first and after
    /// each.
    pub(super) fn through(mut self, pieces: &[Cubic], of: impl Fn(&[f64]) -> f64) -> Vec<f64> {
        let mut values = vec![of(&self.coordinates())];
        for piece in pieces {
            self.advance(piece);
            values.push(of(&self.coordinates()));
        }
        values
    }

    /// The coordinates q.
    pub(super) fn coordinates(&self) -> Vec<f64> {
        let scaled = self.read(|_, k| k);
        scaled.iter().zip(&self.scales).map(|(x, scale)| x / scale).collect()
    }

    /// Their rates q̇.
    pub(super) fn rates(&self) -> Vec<f64> {
        self.read(|count, k| count + k)
    }

    /// One value for each coordinate, from its `place` among those of its block.
    fn read(&self, place: impl Fn(usize, usize) -> usize) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.scales.len());
        for Block { first, count, .. } in &self.blocks {
            values.extend((0..*count).map(|k| self.state[2 * first + place(*count, k)]));
        }
        values
    }
}

impl Block {
    fn new(equations: &Equations, scales: &[f64], first: usize, count: usize, step_s: f64) -> Self {
        let coordinates = &equations.coordinates[first..first + count];
        let scales = &scales[first..first + count];
        let (states, size) = (2 * count, 2 * count + TERMS);
        let mut generator = DMatrix::<f64>::zeros(size, size);
        for (i, own) in coordinates.iter().enumerate() {
            generator[(i, count + i)] = step_s * scales[i];
            generator[(count + i, i)] = -step_s * own.square / scales[i];
            generator[(count + i, count + i)] = -step_s * own.rate_per_s;
            generator[(count + i, states)] = step_s * own.hub_angle;
            for (j, other) in coordinates.iter().enumerate() {
                let coupling = step_s * own.hub_angle * other.hub_angle;
                let reaction = equations.reaction;
                generator[(count + i, j)] -= coupling * reaction.stiffness_n_m_rad / scales[j];
                generator[(count + i, count + j)] -= coupling * reaction.damping_n_m_s_rad;
            }
        }
        for term in 1..TERMS {
            generator[(states + term - 1, states + term)] = term as f64;
        }
        let exponential = exponential(&generator);
        let rows = (0..states).flat_map(|row| (0..size).map(move |column| (row, column)));
        Self { first, count, rows: rows.map(|place| exponential[place]).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::equations::HubReaction;
    use super::*;
    use crate::beam::Mesh;
    use crate::link::{Link, uniform};
    use crate::modal::{DampingLaw, ModalBasis};

    #[test]
    fn a_motion_goes_on_from_the_coordinates_and_rates_that_it_is_given() {
        let link = Link::new(uniform()).unwrap();
        let mesh = Mesh::on(&link, 4);
        for damping_n_m_s_rad in [0.0, 0.3] {
            let law = DampingLaw::of(link.damping(), &mesh).unwrap();
            let reaction = HubReaction { damping_n_m_s_rad, ..HubReaction::default() };
            let basis = ModalBasis::lowest(&mesh, 3);
            let equations = Equations::new(&mesh, &law, basis, reaction);
            let count = equations.coordinates.len();
            let coordinates: Vec<f64> = (1..=count).map(|k| 0.1 * k as f64).collect();
            let rates: Vec<f64> = (1..=count).map(|k| 7.0 - k as f64).collect();
            let stepper = Stepper::new(&equations, 0.01).starting_at(&coordinates, &rates);
            assert_eq!(stepper.rates(), rates);
            let pairs = stepper.coordinates().into_iter().zip(coordinates);
            assert!(pairs.map(|(a, b)| (a / b - 1.0).abs()).all(|error| error < 1e-15));
        }
    }
}
