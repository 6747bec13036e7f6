use std::ops::Range;

use nalgebra::DMatrix;

use super::modes::{Equations, HubReaction};
use super::play::{Cubic, Driving};
use crate::numeric::TimeGrid;

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

/// Coupled coordinates: all of them where a reaction at the hub couples them, else each alone.
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
        // Without a reaction at the hub, or damping between them, the modes are not coupled.
        let HubReaction { stiffness_n_m_rad, damping_n_m_s_rad, .. } = equations.reaction;
        let reacts = stiffness_n_m_rad != 0.0 || damping_n_m_s_rad != 0.0;
        let is_coupled = reacts || equations.damping.is_some();
        let size = if is_coupled { count } else { 1 };
        let block = |first: usize| Block::new(equations, &scales, first, size, step_s);
        let blocks = (0..count).step_by(size).map(block).collect();
        Self { blocks, scales, state: vec![0.0; 2 * count], next: vec![0.0; 2 * count] }
    }

    /// Continues from these coordinates and rates.
    pub(super) fn starting_at(mut self, coordinates: &[f64], rates: &[f64]) -> Self {
        for block in &self.blocks {
            let own = block.first..block.first + block.count;
            let (scaled, rate) = self.state[block.states()].split_at_mut(block.count);
            rate.copy_from_slice(&rates[own.clone()]);
            for (k, scaled) in own.zip(scaled) {
                *scaled = self.scales[k] * coordinates[k];
            }
        }
        self
    }

    /// Advances by one step.
    pub(super) fn advance(&mut self, cubic: &Cubic) {
        for block in &self.blocks {
            let (state, next) = (&self.state[block.states()], &mut self.next[block.states()]);
            for (row, next) in block.rows.chunks_exact(state.len() + TERMS).zip(next) {
                let (transition, answers) = row.split_at(state.len());
                let free: f64 = transition.iter().zip(state).map(|(a, x)| a * x).sum();
                let driven: f64 = answers.iter().zip(cubic).map(|(a, c)| a * c).sum();
                *next = free + driven;
            }
        }
        std::mem::swap(&mut self.state, &mut self.next);
    }

    /// Advances by all `steps`; calls `each` before the first and after each of them.
    pub(super) fn run(
        mut self,
        steps: impl IntoIterator<Item = Cubic>,
        mut each: impl FnMut(&Self),
    ) {
        each(&self);
        for cubic in steps {
            self.advance(&cubic);
            each(&self);
        }
    }

    /// The coordinates q.
    pub(super) fn coordinates(&self) -> Vec<f64> {
        let scaled =
            self.blocks.iter().flat_map(|block| &self.state[block.states()][..block.count]);
        scaled.zip(&self.scales).map(|(x, scale)| x / scale).collect()
    }

    /// Their rates q̇.
    pub(super) fn rates(&self) -> Vec<f64> {
        let rates = self.blocks.iter().flat_map(|block| &self.state[block.states()][block.count..]);
        rates.copied().collect()
    }
}

/// Modal coordinates and their rates at every sample, one row a sample.
#[derive(Debug, Clone)]
pub(super) struct Record {
    pub(super) coordinates: Vec<f64>,
    rates: Vec<f64>,
    modes: usize,
}

impl Record {
    /// Steps from rest through all samples.
    pub(super) fn of(equations: &Equations, driving: &Driving, grid: &TimeGrid) -> Self {
        let modes = equations.coordinates.len();
        let mut coordinates = Vec::with_capacity(grid.len * modes);
        let mut rates = Vec::with_capacity(grid.len * modes);
        Stepper::new(equations, grid.step_s).run(driving.steps(grid.len), |stepper| {
            coordinates.extend(stepper.coordinates());
            rates.extend(stepper.rates());
        });
        Self { coordinates, rates, modes }
    }

    /// Coordinates and rates at a sample.
    pub(super) fn at(&self, sample: usize) -> (&[f64], &[f64]) {
        let row = sample * self.modes..(sample + 1) * self.modes;
        (&self.coordinates[row.clone()], &self.rates[row])
    }
}

impl Block {
    /// Places of its scaled coordinates and, after them, of their rates.
    fn states(&self) -> Range<usize> {
        2 * self.first..2 * (self.first + self.count)
    }

    fn new(equations: &Equations, scales: &[f64], first: usize, count: usize, step_s: f64) -> Self {
        let coordinates = &equations.coordinates[first..first + count];
        let scales = &scales[first..first + count];
        let (states, size) = (2 * count, 2 * count + TERMS);
        let mut generator = DMatrix::<f64>::zeros(size, size);
        for (i, own) in coordinates.iter().enumerate() {
            generator[(i, count + i)] = step_s * scales[i];
            generator[(count + i, i)] = -step_s * own.square / scales[i];
            match &equations.damping {
                None => generator[(count + i, count + i)] = -step_s * own.rate_per_s,
                Some(damping) => {
                    for j in 0..count {
                        generator[(count + i, count + j)] = -step_s * damping[i * count + j];
                    }
                }
            }
            generator[(count + i, states)] = step_s * own.drive;
            for (j, other) in coordinates.iter().enumerate() {
                let coupling = step_s * own.drive * other.hub_angle;
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

/// Largest norm of a matrix that the series takes.
const LARGEST_NORM: f64 = 1.0;

/// e to the power of a square matrix, by its series for a 2ˢ-th part of it and s squarings.
///
/// nalgebra's own calls the system's logarithm and rounds products differently on each processor, so that
/// the same inputs would give other bytes.
fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let norm = |matrix: &DMatrix<f64>| {
        matrix.row_iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max)
    };
    let (mut part, mut squarings) = (matrix.clone(), 0);
    // The norm of a matrix with NaN never falls: the number of squarings is bounded.
    while norm(&part) > LARGEST_NORM && squarings < 1100 {
        part *= 0.5;
        squarings += 1;
    }
    let size = matrix.nrows();
    let mut sum = DMatrix::identity(size, size);
    let mut term = sum.clone();
    let mut k = 0.0;
    while norm(&term) > f64::EPSILON * f64::EPSILON {
        k += 1.0;
        term = &term * &part / k;
        sum += &term;
    }
    (0..squarings).fold(sum, |root, _| &root * &root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::Mesh;
    use crate::link::{Link, uniform};
    use crate::modal::{DampingLaw, ModalBasis};

    #[test]
    fn a_motion_goes_on_from_the_coordinates_and_rates_that_it_is_given() {
        let link = Link::new(uniform()).unwrap();
        let mesh = Mesh::on(&link, 4);
        for damping_n_m_s_rad in [0.0, 0.3] {
            let law = DampingLaw::of(&link, &mesh).unwrap();
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

    fn largest_difference(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
        (a - b).iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    #[test]
    fn a_rotation_turns_by_its_angle() {
        for angle in [0.0, 1e-9, 0.7, 3.0, 40.0_f64] {
            let found = exponential(&DMatrix::from_row_slice(2, 2, &[0.0, angle, -angle, 0.0]));
            let (sine, cosine) = angle.sin_cos();
            let exact = DMatrix::from_row_slice(2, 2, &[cosine, sine, -sine, cosine]);
            // Each squaring doubles the error: an angle is known to its own round-off only.
            let error = largest_difference(&found, &exact);
            assert!(error < 2e-15 * angle.max(1.0), "{angle}: {error:e}");
        }
    }

    #[test]
    fn a_nilpotent_matrix_gives_the_powers_of_time() {
        let shift = DMatrix::from_row_slice(3, 3, &[0.0, 3.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0]);
        let exact = DMatrix::from_row_slice(3, 3, &[1.0, 3.0, 4.5, 0.0, 1.0, 3.0, 0.0, 0.0, 1.0]);
        assert!(largest_difference(&exponential(&shift), &exact) < 1e-14);
    }

    /// What reaches a coordinate over many others is tiny, and as exact as all else.
    #[test]
    fn a_chain_of_integrators_gives_every_power_of_time_to_its_last_digits() {
        let time = 0.001_f64;
        let chain =
            DMatrix::from_fn(9, 9, |row, column| if column == row + 1 { time } else { 0.0 });
        let found = exponential(&chain);
        let mut exact = 1.0;
        for k in 0..9 {
            let error = (found[(0, k)] / exact - 1.0).abs();
            assert!(error < 1e-14, "t to the power of {k}: {error:e}");
            exact *= time / (k + 1) as f64;
        }
    }

    #[test]
    fn a_strong_decay_leaves_nothing_and_a_matrix_of_no_numbers_ends() {
        let decay = DMatrix::from_diagonal_element(2, 2, -60.0);
        let exact = DMatrix::from_diagonal_element(2, 2, (-60.0_f64).exp());
        assert!(largest_difference(&exponential(&decay), &exact) < 1e-12 * exact[(0, 0)]);
        let nothing = DMatrix::from_diagonal_element(2, 2, f64::NAN);
        assert!(exponential(&nothing).iter().any(|x| x.is_nan()));
    }
}
