use nalgebra::DMatrix;

use super::driving::{Driving, Jump, Step};
use super::losses::{Losses, mean, part_of};
use super::modes::{Equations, HubReaction};
use crate::numeric::{TimeGrid, dot};
use crate::system::end_if_stopped;

/// Terms of a step's input, a cubic.
const TERMS: usize = 4;

/// Steps the modal equations by one time step, exactly for a torque that is cubic over the step.
///
/// ```text
/// d/dτ (x, w) = [[A Δt, B Δt e₀ᵀ], [0, D]] (x, w),   w_j the cubic's derivatives u⁽ʲ⁾Δtʲ/j!
/// ```
///
/// The exponential of this matrix contains the transition of the state and its answer to each term of the cubic (Van
/// Loan 1978).
#[derive(Debug, Clone)]
pub(super) struct Stepper {
    count: usize,
    transition: Transition,
    /// Answers of the state to the terms of the input's cubic.
    answers: [Vec<f64>; TERMS],
    /// Answers to the terms of the reference's rate; the damping of a loop turns with it.
    of_turning: Option<[Vec<f64>; TERMS]>,
    /// Scales s = max(ω, 1/Δt) that give coordinates the unit of rates: s q and q̇.
    scales: Vec<f64>,
    /// Scaled coordinates, then rates.
    state: Vec<f64>,
    next: Vec<f64>,
    losses: Option<Lossy>,
    /// Changes of the state by a unit jump of a prescribed joint's position, and of its rate.
    by_jumps: Option<[Vec<f64>; 2]>,
}

/// Losses of a drive, solved in every step.
#[derive(Debug, Clone)]
struct Lossy {
    own: Losses,
    /// Length of a step of the losses in s.
    step_s: f64,
    /// The hub's rate as a sum of the state.
    hub_rate: Vec<f64>,
}

/// Transition of the state over a step without a torque, column by column so that the rows are vectors.
#[derive(Debug, Clone)]
enum Transition {
    /// Uncoupled coordinates: the factors on each and on its rate.
    Alone { on_coordinates: Vec<f64>, on_rates: Vec<f64> },
    /// Coordinates coupled by a reaction at the hub: the columns one after the other.
    Coupled(Vec<f64>),
}

impl Stepper {
    /// A stepper at rest.
    pub(super) fn new(equations: &Equations, step_s: f64) -> Self {
        let count = equations.coordinates.len();
        let parts = equations.losses.map_or(1, |losses| losses.substeps);
        let step_s = if parts == 1 { step_s } else { step_s / parts as f64 };
        let scale = |square: f64| square.sqrt().max(step_s.recip());
        let scales: Vec<f64> = equations.coordinates.iter().map(|c| scale(c.square)).collect();
        // Without a reaction at the hub, or damping between them, the modes are not coupled.
        let HubReaction { stiffness_n_m_rad, damping_n_m_s_rad, .. } = equations.reaction;
        let reacts = stiffness_n_m_rad != 0.0 || damping_n_m_s_rad != 0.0;
        let is_coupled = reacts || equations.damping.is_some();
        let step = |first, size| exponential(&generator(equations, &scales, first, size, step_s));
        let (transition, answers, of_turning) = if is_coupled {
            let step = step(0, count);
            let column = |column: usize| (0..2 * count).map(|row| step[(row, column)]).collect();
            let transition = (0..2 * count).flat_map(|k| -> Vec<f64> { column(k) }).collect();
            let answers = |first: usize| [0, 1, 2, 3].map(|term| column(first + term));
            let of_turning = equations.drags.as_deref();
            let of_turning = of_turning.map(|_| answers(2 * count + TERMS));
            (Transition::Coupled(transition), answers(2 * count), of_turning)
        } else {
            let steps: Vec<DMatrix<f64>> = (0..count).map(|first| step(first, 1)).collect();
            let column = |column: usize| {
                let rows = [0, 1].into_iter();
                rows.flat_map(|row| steps.iter().map(move |step| step[(row, column)])).collect()
            };
            let (on_coordinates, on_rates) = (column(0), column(1));
            (Transition::Alone { on_coordinates, on_rates }, [2, 3, 4, 5].map(column), None)
        };
        let rest = || vec![0.0; 2 * count];
        let of_hub = || equations.coordinates.iter().map(|c| c.hub_angle);
        let losses = equations.losses.map(|own| {
            let hub_rate = vec![0.0; count].into_iter().chain(of_hub()).collect();
            Lossy { own, step_s, hub_rate }
        });
        let by_jumps = equations.prescribed.map(|_| by_jumps(equations, &scales));
        let (state, next) = (rest(), rest());
        Self { count, transition, answers, of_turning, scales, state, next, losses, by_jumps }
    }

    /// The state after a jump of a prescribed joint.
    pub(super) fn jumped(mut self, jump: Jump) -> Self {
        self.jump(jump);
        self
    }

    fn jump(&mut self, jump: Jump) {
        for (by, part) in self.by_jumps.iter().flatten().zip(jump).filter(|(_, part)| *part != 0.0)
        {
            self.state.iter_mut().zip(by).for_each(|(state, by)| *state += part * by);
        }
    }

    /// Continues from these coordinates and rates.
    pub(super) fn starting_at(mut self, coordinates: &[f64], rates: &[f64]) -> Self {
        self.start_at(coordinates, rates);
        self
    }

    /// Goes to these coordinates and rates.
    pub(super) fn start_at(&mut self, coordinates: &[f64], rates: &[f64]) {
        let (scaled, rate) = self.state.split_at_mut(self.count);
        rate.copy_from_slice(rates);
        for ((scaled, scale), coordinate) in scaled.iter_mut().zip(&self.scales).zip(coordinates) {
            *scaled = scale * coordinate;
        }
    }

    /// Advances by one step of the input.
    pub(super) fn advance(&mut self, step: &Step) {
        let parts = self.losses.as_ref().map_or(1, |losses| losses.own.substeps);
        if parts == 1 && self.losses.is_none() {
            self.advance_once(step);
            return self.jump(step.jump);
        }
        for part in 0..parts {
            let [input, turning] = [step.input, step.turning].map(|own| part_of(own, part, parts));
            self.advance_once(&Step { input, turning, ..*step });
        }
    }

    fn advance_once(&mut self, step: &Step) {
        match &self.transition {
            Transition::Alone { on_coordinates, on_rates } => {
                let (coordinates, rates) = self.state.split_at(self.count);
                let factors = on_coordinates.chunks_exact(self.count);
                let factors = factors.zip(on_rates.chunks_exact(self.count));
                for ((on_own, on_rate), next) in factors.zip(self.next.chunks_exact_mut(self.count))
                {
                    for (k, next) in next.iter_mut().enumerate() {
                        *next = on_own[k] * coordinates[k] + on_rate[k] * rates[k];
                    }
                }
            }
            Transition::Coupled(columns) => {
                self.next.fill(0.0);
                for (column, state) in columns.chunks_exact(2 * self.count).zip(&self.state) {
                    for (next, factor) in self.next.iter_mut().zip(column) {
                        *next += factor * state;
                    }
                }
            }
        }
        let parts = [(Some(&self.answers), &step.input), (self.of_turning.as_ref(), &step.turning)];
        for (answers, cubic) in parts {
            let Some([first, second, third, fourth]) = answers else { continue };
            for (k, next) in self.next.iter_mut().enumerate() {
                let driven = first[k] * cubic[0] + second[k] * cubic[1];
                *next += driven + third[k] * cubic[2] + fourth[k] * cubic[3];
            }
        }
        if let Some(Lossy { own, step_s, hub_rate }) = &self.losses {
            // The loss acts like a torque that opposes the input.
            let of = |state: &[f64]| dot(hub_rate, state);
            let [before, after, slope] = [&self.state, &self.next, &self.answers[0]].map(|x| of(x));
            let rate = [0.5 * (before + after), -0.5 * slope];
            let acceleration = [(after - before) / step_s, -slope / step_s];
            let loss = own.solve(mean(step.input), rate, acceleration);
            let pairs = self.next.iter_mut().zip(&self.answers[0]);
            pairs.for_each(|(next, answer)| *next -= loss * answer);
        }
        std::mem::swap(&mut self.state, &mut self.next);
    }

    /// Advances by all `steps`; calls `each` before the first and after each of them.
    pub(super) fn run(
        mut self,
        steps: impl IntoIterator<Item = impl Into<Step>>,
        mut each: impl FnMut(&Self),
    ) {
        each(&self);
        for step in steps {
            end_if_stopped();
            self.advance(&step.into());
            each(&self);
        }
    }

    /// Transition of the state over `steps` steps without a torque.
    pub(super) fn transition_over(&self, steps: usize) -> DMatrix<f64> {
        let (count, states) = (self.count, 2 * self.count);
        let mut step = DMatrix::zeros(states, states);
        match &self.transition {
            Transition::Coupled(columns) => step.copy_from_slice(columns),
            Transition::Alone { on_coordinates, on_rates } => {
                for k in 0..count {
                    for row in 0..2 {
                        step[(row * count + k, k)] = on_coordinates[row * count + k];
                        step[(row * count + k, count + k)] = on_rates[row * count + k];
                    }
                }
            }
        }
        let mut all = DMatrix::identity(states, states);
        // Each binary digit doubles the steps so far.
        for digit in (0..usize::BITS - steps.leading_zeros()).rev() {
            all = &all * &all;
            if steps >> digit & 1 == 1 {
                all = &step * &all;
            }
        }
        all
    }

    /// Scaled coordinates, then rates.
    pub(super) fn state(&self) -> &[f64] {
        &self.state
    }

    /// The coordinates and rates of a state.
    pub(super) fn of_state(&self, state: &[f64]) -> [Vec<f64>; 2] {
        let (scaled, rates) = state.split_at(self.count);
        let coordinates = scaled.iter().zip(&self.scales).map(|(x, scale)| x / scale).collect();
        [coordinates, rates.to_vec()]
    }

    /// Factors on the state for [`Stepper::weighted`], from factors on coordinates and rates.
    pub(super) fn factors(&self, on_coordinates: &[f64], on_rates: &[f64]) -> Vec<f64> {
        let scaled = on_coordinates.iter().zip(&self.scales).map(|(factor, scale)| factor / scale);
        scaled.chain(on_rates.iter().copied()).collect()
    }

    /// The sum of the state times these factors.
    pub(super) fn weighted(&self, factors: &[f64]) -> f64 {
        let (coordinates, rates) = self.state.split_at(self.count);
        let (on_coordinates, on_rates) = factors.split_at(self.count);
        let terms = on_coordinates.iter().zip(coordinates);
        let mut sums = [0.0; 2];
        for ((a, q), (b, r)) in terms.zip(on_rates.iter().zip(rates)) {
            sums[0] += a * q;
            sums[1] += b * r;
        }
        sums[0] + sums[1]
    }

    /// The coordinates q.
    pub(super) fn coordinates(&self) -> Vec<f64> {
        let scaled = self.state[..self.count].iter().zip(&self.scales);
        scaled.map(|(x, scale)| x / scale).collect()
    }

    /// Their rates q̇.
    pub(super) fn rates(&self) -> Vec<f64> {
        self.state[self.count..].to_vec()
    }
}

/// Coordinates and their rates at every sample, one row a sample.
#[derive(Debug, Clone)]
pub(super) struct Record {
    pub(super) coordinates: Vec<f64>,
    rates: Vec<f64>,
    modes: usize,
}

impl Record {
    /// A record without samples.
    pub(super) fn with_capacity(modes: usize, samples: usize) -> Self {
        let room = || Vec::with_capacity(modes * samples);
        Self { coordinates: room(), rates: room(), modes }
    }

    /// Adds a sample.
    pub(super) fn push(&mut self, coordinates: &[f64], rates: &[f64]) {
        self.coordinates.extend_from_slice(coordinates);
        self.rates.extend_from_slice(rates);
    }
    /// Steps from coordinates and rates through all samples.
    pub(super) fn of(
        equations: &Equations,
        driving: &Driving,
        grid: &TimeGrid,
        [coordinates, rates]: &[Vec<f64>; 2],
    ) -> Self {
        let modes = equations.coordinates.len();
        let mut record = Self::with_capacity(modes, grid.len);
        let stepper = Stepper::new(equations, grid.step_s).starting_at(coordinates, rates);
        stepper.jumped(driving.first_jump()).run(driving.steps(grid.len), |stepper| {
            record.push(&stepper.coordinates(), &stepper.rates());
        });
        record
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.rates.len() / self.modes
    }

    /// Coordinates and rates at a sample.
    pub(super) fn at(&self, sample: usize) -> (&[f64], &[f64]) {
        let row = sample * self.modes..(sample + 1) * self.modes;
        (&self.coordinates[row.clone()], &self.rates[row])
    }
}

/// Changes of the state, scaled coordinates and rates, by a unit jump of a prescribed joint's position and of its rate.
///
/// The input is δ' or δ. With the drives b and the damping D of the coordinates q, δ' moves q by b at once, and the
/// damping of this motion stops at a rate lower by D b. δ raises the rates by b.
fn by_jumps(equations: &Equations, scales: &[f64]) -> [Vec<f64>; 2] {
    let coordinates = &equations.coordinates;
    let drives: Vec<f64> = coordinates.iter().map(|own| own.drive).collect();
    let damped = |k: usize| match &equations.damping {
        None => coordinates[k].rate_per_s * drives[k],
        Some(damping) => dot(&damping[k * drives.len()..][..drives.len()], &drives),
    };
    let moved = drives.iter().zip(scales).map(|(drive, scale)| drive * scale);
    let moved = moved.chain((0..drives.len()).map(|k| -damped(k))).collect();
    let quicker = scales.iter().map(|_| 0.0).chain(drives.iter().copied()).collect();
    [moved, quicker]
}

/// The matrix with a step as its exponential, for some of the coordinates: scaled coordinates, rates, and the
/// derivatives of the cubic.
fn generator(
    equations: &Equations,
    scales: &[f64],
    first: usize,
    count: usize,
    step_s: f64,
) -> DMatrix<f64> {
    let coordinates = &equations.coordinates[first..first + count];
    let scales = &scales[first..first + count];
    let (states, drags) = (2 * count, equations.drags.as_deref());
    let size = states + if drags.is_some() { 2 * TERMS } else { TERMS };
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
        if let Some(drags) = drags {
            generator[(count + i, states + TERMS)] = step_s * drags[first + i];
        }
        for (j, other) in coordinates.iter().enumerate() {
            let coupling = step_s * own.drive * other.hub_angle;
            let reaction = equations.reaction;
            generator[(count + i, j)] -= coupling * reaction.stiffness_n_m_rad / scales[j];
            generator[(count + i, count + j)] -= coupling * reaction.damping_n_m_s_rad;
        }
    }
    for cubic in (states..size).step_by(TERMS) {
        for term in 1..TERMS {
            generator[(cubic + term - 1, cubic + term)] = term as f64;
        }
    }
    generator
}

/// Largest norm of a matrix for the series.
const LARGEST_NORM: f64 = 1.0;

/// e to the power of a square matrix, by its series for a 2ˢ-th part of it and s squarings.
///
/// nalgebra's function calls the system's logarithm and rounds products differently on each processor: equal inputs
/// would give different bytes.
fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let norm = |matrix: &DMatrix<f64>| {
        matrix.row_iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max)
    };
    let (mut part, mut squarings) = (matrix.clone(), 0);
    // Bounds the number of squarings, as the norm of a matrix with NaN never falls.
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
            // Each squaring doubles the error: an angle is exact only to its round-off.
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

    /// The effect on a coordinate through many others is tiny, and equally exact.
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
