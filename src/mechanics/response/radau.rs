//! Implicit integration of equations of motion: Radau's method IIA with three stages, of order 5 and stable for every
//! step (Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.8).

use nalgebra::{DMatrix, DVector, Dyn, LU};

use super::balance::Balance;
use super::losses::{Answers, Losses, balanced};
use crate::numeric::{Size, dot};
use crate::system::end_if_stopped;

/// Number of stages.
const STAGES: usize = 3;

/// Change of the coordinates by all further iterations, in rad, that ends the iterations.
const SETTLED_RAD: f64 = 1e-14;

/// Largest ratio of a change to the one before with which all further ones are estimated.
const SHRINKS: f64 = 0.1;

/// Largest change in rad that counts as round-off. Without hub inertia the shortest waves have almost no mass at the joint,
/// so round-off of the forces moves them far.
const ROUND_OFF_RAD: f64 = 1e-8;

/// Iterations without a halving of the change after which a small change may be round-off.
const STALLED: usize = 3;

/// Most iterations of a step.
const MOST_ITERATIONS: usize = 30;

/// Iterations of a step before new factors.
const SLOW: usize = 6;

/// Coordinates, rates and accelerations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    pub(super) q: Vec<f64>,
    pub(super) rates: Vec<f64>,
    pub(super) accelerations: Vec<f64>,
}

/// Steps `M(q) q̈ = f(t, q, q̇)` with a linear part −Kq − Dq̇ of f, and losses of drives.
pub(super) struct Radau<'a> {
    count: usize,
    step_s: f64,
    stiffness: &'a [f64],
    damping: &'a [f64],
    /// Aᵢⱼ of the method, and its square.
    once: [[f64; STAGES]; STAGES],
    twice: [[f64; STAGES]; STAGES],
    /// Coordinates of joints whose drives have losses.
    lossy: &'a [(usize, Losses)],
    /// Losses at all stages of the last iteration, stage by stage.
    losses: DVector<f64>,
    /// Factors, and the changes by a unit force on each lossy joint at each stage.
    factors: Option<(LU<f64, Dyn, Dyn>, DMatrix<f64>)>,
    balance: Balance,
    /// The motion at each stage of the last step.
    reached: Vec<Motion>,
}

impl<'a> Radau<'a> {
    /// Places of the stages within a step, over the step; the last one is its end.
    pub(super) fn places() -> [f64; STAGES] {
        let root = 6.0_f64.sqrt();
        [(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0]
    }

    /// An integrator with steps of `step_s` seconds and linear parts row by row.
    pub(super) fn new(
        step_s: f64,
        [stiffness, damping]: [&'a [f64]; 2],
        lossy: &'a [(usize, Losses)],
    ) -> Self {
        let root = 6.0_f64.sqrt();
        let once = [
            [
                (88.0 - 7.0 * root) / 360.0,
                (296.0 - 169.0 * root) / 1800.0,
                (-2.0 + 3.0 * root) / 225.0,
            ],
            [
                (296.0 + 169.0 * root) / 1800.0,
                (88.0 + 7.0 * root) / 360.0,
                (-2.0 - 3.0 * root) / 225.0,
            ],
            [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0],
        ];
        let twice =
            once.map(|row| [0, 1, 2].map(|j| (0..STAGES).map(|k| row[k] * once[k][j]).sum()));
        let count = stiffness.len().isqrt();
        let balance = Balance::default();
        Self {
            count,
            step_s,
            stiffness,
            damping,
            once,
            twice,
            lossy,
            losses: DVector::zeros(STAGES * lossy.len()),
            factors: None,
            balance,
            reached: Vec::new(),
        }
    }

    /// Makes one step; `balance` receives the stage, coordinates and rates. False where it does not converge.
    pub(super) fn advance(
        &mut self,
        motion: &mut Motion,
        mut balance: impl FnMut(usize, &[f64], &[f64], &mut Balance),
    ) -> bool {
        end_if_stopped();
        let (count, h) = (self.count, self.step_s);
        let mut stages = self.guess(motion);
        let mut residual = DVector::zeros(STAGES * count);
        let mut efforts = Vec::with_capacity(STAGES * self.lossy.len());
        let mut at = (vec![0.0; count], vec![0.0; count]);
        // Whole turns leave fewer digits for the rest.
        let size_rad = motion.q.iter().map(|q| q.abs()).fold(1.0, f64::max);
        let (mut least, mut fell, mut is_fresh) = (f64::INFINITY, 0, self.factors.is_none());
        let (mut previous, mut has_risen) = (f64::INFINITY, false);
        for iteration in 1..=MOST_ITERATIONS {
            // Factors of an earlier step, or of the first stages of this one, may not suit it.
            if iteration == SLOW || iteration == 2 * SLOW {
                self.factors = None;
                (least, fell, is_fresh, has_risen) = (f64::INFINITY, iteration, true, false);
            }
            efforts.clear();
            for stage in 0..STAGES {
                self.reach(motion, &stages, stage, &mut at);
                balance(stage, &at.0, &at.1, &mut self.balance);
                efforts.extend_from_slice(&self.balance.efforts);
                for i in 0..count {
                    let needed = dot(&self.balance.mass[i * count..][..count], &stages[stage]);
                    residual[stage * count + i] = self.balance.force[i] - needed;
                }
            }
            let factors = match self.factors.take() {
                Some(factors) => factors,
                None => self.factorised(),
            };
            let (whole, answers) = &factors;
            if !whole.solve_mut(&mut residual) {
                return false;
            }
            if !self.lossy.is_empty() {
                self.losses = self.lose(motion, (&stages, &residual), &efforts, answers);
                residual -= answers * &self.losses;
            }
            self.factors = Some(factors);
            let mut change = 0.0;
            for (stage, own) in stages.iter_mut().enumerate() {
                for (i, acceleration) in own.iter_mut().enumerate() {
                    let more = residual[stage * count + i];
                    *acceleration += more;
                    change = Size::larger(change, more.abs());
                }
            }
            if change < 0.5 * least {
                (least, fell, has_risen) = (change, iteration, false);
            }
            // Changes that fall without a rise converge, however slowly.
            has_risen |= change > previous;
            // All further changes, if each shrinks as this one did.
            let factor = change / previous;
            let is_estimated = iteration > 1 && factor < SHRINKS;
            let left = if is_estimated { change * factor / (1.0 - factor) } else { change };
            previous = change;
            let is_stalled = is_fresh && has_risen && iteration >= fell + STALLED;
            let least_rad = if is_stalled { ROUND_OFF_RAD } else { SETTLED_RAD };
            if left * h * h <= least_rad * size_rad {
                let reached = (0..STAGES).map(|stage| {
                    self.reach(motion, &stages, stage, &mut at);
                    let (q, rates) = at.clone();
                    Motion { q, rates, accelerations: stages[stage].clone() }
                });
                self.reached = reached.collect();
                // The last stage is the end of the step.
                motion.clone_from(&self.reached[STAGES - 1]);
                if iteration > SLOW {
                    self.factors = None;
                }
                return true;
            }
            if !change.is_finite() {
                return false;
            }
        }
        false
    }

    /// Accelerations at the stages to start from: those of the last step go on as a parabola, or else they are constant.
    fn guess(&self, motion: &Motion) -> Vec<Vec<f64>> {
        if self.reached.last().is_none_or(|last| last.q != motion.q || last.rates != motion.rates) {
            return vec![motion.accelerations.clone(); STAGES];
        }
        let places = Self::places();
        let at = |place: f64| {
            let share = |own: usize| {
                let others = (0..STAGES).filter(|other| *other != own);
                let factor =
                    |other: usize| (1.0 + place - places[other]) / (places[own] - places[other]);
                others.map(factor).product::<f64>()
            };
            let shares = [0, 1, 2].map(share);
            let value = |i: usize| {
                let pairs = shares.iter().zip(&self.reached);
                pairs.map(|(share, own)| share * own.accelerations[i]).sum()
            };
            (0..self.count).map(value).collect()
        };
        places.map(at).into()
    }

    /// The motion at each stage of the last step.
    pub(super) fn reached(&self) -> &[Motion] {
        &self.reached
    }

    /// Integral over the last step of a quantity known at its stages.
    pub(super) fn integral(&self, at_stages: impl Iterator<Item = f64>) -> f64 {
        let weights = self.once[STAGES - 1];
        self.step_s * weights.iter().zip(at_stages).map(|(weight, own)| weight * own).sum::<f64>()
    }

    /// Computes coordinates and rates at a stage with these accelerations.
    fn reach(
        &self,
        motion: &Motion,
        accelerations: &[Vec<f64>],
        stage: usize,
        (q, rates): &mut (Vec<f64>, Vec<f64>),
    ) {
        let (h, place) = (self.step_s, Self::places()[stage]);
        for i in 0..self.count {
            let sum = |row: &[f64; STAGES]| -> f64 {
                row.iter().zip(accelerations).map(|(a, stage)| a * stage[i]).sum()
            };
            rates[i] = motion.rates[i] + h * sum(&self.once[stage]);
            q[i] = motion.q[i] + h * (place * motion.rates[i] + h * sum(&self.twice[stage]));
        }
    }

    /// Losses at all stages, from the accelerations of the stages, their changes without losses, and their `answers` to the
    /// losses.
    fn lose(
        &self,
        motion: &Motion,
        (stages, changes): (&[Vec<f64>], &DVector<f64>),
        efforts: &[f64],
        answers: &DMatrix<f64>,
    ) -> DVector<f64> {
        let (count, each, h) = (self.count, self.lossy.len(), self.step_s);
        let place = |number: usize| (number / each, self.lossy[number % each].0);
        let all = STAGES * each;
        let accelerations = Answers {
            free: DVector::from_fn(all, |number, _| {
                let (stage, joint) = place(number);
                stages[stage][joint] + changes[stage * count + joint]
            }),
            per_loss: DMatrix::from_fn(all, all, |number, loss| {
                let (stage, joint) = place(number);
                answers[(stage * count + joint, loss)]
            }),
        };
        // Rates are sums of the accelerations of all stages.
        let sums = DMatrix::from_fn(all, all, |number, other| {
            let ((stage, joint), (from, of)) = (place(number), place(other));
            if joint == of { h * self.once[stage][from] } else { 0.0 }
        });
        let before = DVector::from_fn(all, |number, _| motion.rates[place(number).1]);
        let rates = Answers {
            free: before + &sums * &accelerations.free,
            per_loss: sums * &accelerations.per_loss,
        };
        let joints = self.lossy.iter().cycle().map(|(_, own)| *own).zip(efforts.iter().copied());
        let joints: Vec<(Losses, f64)> = joints.collect();
        balanced(&joints, [&rates, &accelerations], self.losses.clone())
    }

    /// Factors of the matrix for changes of the stages' accelerations, with the masses of the last balance.
    fn factorised(&self) -> (LU<f64, Dyn, Dyn>, DMatrix<f64>) {
        let (count, h) = (self.count, self.step_s);
        let matrix = DMatrix::from_fn(STAGES * count, STAGES * count, |row, column| {
            let (stage, i, other, j) = (row / count, row % count, column / count, column % count);
            let at = i * count + j;
            let mass = if stage == other { self.balance.mass[at] } else { 0.0 };
            mass + h * self.once[stage][other] * self.damping[at]
                + h * h * self.twice[stage][other] * self.stiffness[at]
        });
        let (factors, each) = (matrix.lu(), self.lossy.len());
        let mut answers = DMatrix::zeros(STAGES * count, STAGES * each);
        for column in 0..STAGES * each {
            answers[(column / each * count + self.lossy[column % each].0, column)] = 1.0;
        }
        // A singular matrix solves nothing else, either.
        let _is_solved = factors.solve_mut(&mut answers);
        (factors, answers)
    }
}
