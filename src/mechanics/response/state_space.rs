//! Small motions in state space, for the design of controllers: the matrices of the first modes, from the efforts of the
//! joints to what sensors measure.
//!
//! ```text
//! q̈ + C q̇ + diag(ω²) q = P u,    x = (q, q̇),    ẋ = A x + B u,    y = C x + D u
//! ```
//!
//! q are mass-normalised modes with free joints, and P their motions of the joints. Viscous damping and the friction of the
//! joints are exact. Hysteretic damping is a loss G q at each frequency, which no real matrix has: C has the viscous damping
//! `G_ij/√(ω_i ω_j)` in its place, with the same ratio at each natural frequency.

use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use crate::numeric::{Size, magnitude};

/// Most modes for which the stand-in of hysteretic damping is measured, and the number of frequencies.
const MEASURED_MODES: usize = 30;
const MEASURED_FREQUENCIES: u32 = 400;

/// An input, an output or a state, with its SI unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signal {
    /// Name, as in `hub_angle`.
    pub name: String,
    /// Unit, as in `rad`.
    pub unit: String,
}

impl Signal {
    pub(super) fn new(name: impl Into<String>, unit: &str) -> Self {
        Self { name: name.into(), unit: unit.to_owned() }
    }
}

/// Modes of a state space.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ModeChoice {
    /// This many modes beyond the motion of the rigid link, or beyond the swings of an arm, and these.
    First(usize),
    /// Numbers of modes as in tables of modes. Mode 0, the motion of a rigid link or the swing of one link, is always there.
    Numbers(Vec<usize>),
}

impl Default for ModeChoice {
    fn default() -> Self {
        Self::First(0)
    }
}

impl ModeChoice {
    /// Number of modes beyond the first `rigid` ones, up to the last one of the choice.
    pub fn count(&self) -> usize {
        match self {
            Self::First(count) => *count,
            Self::Numbers(numbers) => numbers.iter().copied().max().unwrap_or(0),
        }
    }

    /// True for a mode of the choice, from its number and the numbers of the rigid ones.
    pub(super) fn has(&self, number: usize, rigid: RangeInclusive<usize>) -> bool {
        match self {
            Self::First(count) => number <= rigid.end() + count,
            Self::Numbers(numbers) => number == 0 || numbers.contains(&number),
        }
    }
}

/// Extent of a state space.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StateSpaceScope {
    /// Its modes.
    pub modes: ModeChoice,
    /// Places on each link in m from its joint, whose displacement is an output.
    pub stations_m: Vec<f64>,
    /// Whether D has the static response of the other modes.
    pub has_residual: bool,
}

/// Small motions of a link or an arm in state space, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// Coordinates of the modes, then their rates.
    pub states: Vec<Signal>,
    /// Torques of the joints, or the force on a carriage.
    pub inputs: Vec<Signal>,
    /// Measured quantities.
    pub outputs: Vec<Signal>,
    /// A, a row for each state.
    pub a: DMatrix<f64>,
    /// B, a row for each state.
    pub b: DMatrix<f64>,
    /// C, a row for each output.
    pub c: DMatrix<f64>,
    /// D, a row for each output.
    pub d: DMatrix<f64>,
    /// Largest difference of the tip's response from the one of hysteretic damping, over its magnitude, from a tenth of the
    /// first natural frequency to the last one of the first 30 modes. `None` without hysteretic damping.
    pub hysteretic_difference: Option<f64>,
}

impl StateSpace {
    /// Numbers of the modes, as in the names of the states.
    pub fn numbers(&self) -> impl Iterator<Item = usize> {
        let names = self.states[..self.states.len() / 2].iter();
        names.filter_map(|own| own.name.strip_prefix("mode_")?.parse().ok())
    }

    /// M, K and C of the modal equations `M q̈ + C q̇ + K q = P u` for coordinates in kg^½ m: the unit matrix, 1/s² and 1/s. P
    /// is the lower half of B.
    pub fn second_order(&self) -> [DMatrix<f64>; 3] {
        let count = self.a.nrows() / 2;
        // No entry is −0.
        let lower = |column| self.a.view((count, column), (count, count)).map(|own| 0.0 - own);
        [DMatrix::identity(count, count), lower(0), lower(count)]
    }

    /// `C (iω − A)⁻¹ B + D` at ω > 0, a row for each output. `None` on a pole of an undamped link.
    pub fn response(&self, omega_rad_s: f64) -> Option<DMatrix<Complex64>> {
        let complex = |real: &DMatrix<f64>| real.map(Complex64::from);
        let size = self.a.nrows();
        let rate = Complex64::new(0.0, omega_rad_s);
        let left = DMatrix::from_diagonal_element(size, size, rate) - complex(&self.a);
        Some(complex(&self.c) * left.lu().solve(&complex(&self.b))? + complex(&self.d))
    }
}

/// Derivative of the displacement that an output is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Motion {
    Displacement,
    Rate,
    Acceleration,
}

/// A measured quantity.
pub(super) struct Output {
    pub(super) signal: Signal,
    pub(super) motion: Motion,
    /// Displacement in each mode.
    pub(super) modes: Vec<f64>,
    /// Static displacement by the other modes, per unit of each input.
    pub(super) rest: Vec<f64>,
}

/// The first modes of a link or an arm.
pub(super) struct Modes {
    /// Their numbers in tables of modes.
    pub(super) numbers: Vec<usize>,
    pub(super) squares_per_s2: Vec<f64>,
    /// Viscous damping in 1/s, and loss of hysteretic damping in 1/s².
    pub(super) viscous: DMatrix<f64>,
    pub(super) loss: DMatrix<f64>,
    /// Motion of the joint in each mode.
    pub(super) inputs: Vec<(Signal, Vec<f64>)>,
    /// Viscous friction of each joint.
    pub(super) frictions: Vec<f64>,
    pub(super) outputs: Vec<Output>,
    /// Numbers of the outputs of the tip.
    pub(super) tip: Vec<usize>,
}

impl Modes {
    pub(super) fn state_space(&self, has_residual: bool) -> StateSpace {
        let (count, inputs) = (self.squares_per_s2.len(), self.inputs.len());
        let damping = self.damping();
        let b = DMatrix::from_fn(2 * count, inputs, |row, input| {
            if row < count { 0.0 } else { self.inputs[input].1[row - count] }
        });
        let a = DMatrix::from_fn(2 * count, 2 * count, |row, column| match (row, column) {
            _ if row < count => f64::from(u8::from(column == row + count)),
            // Subtracts from 0, so that no entry is −0.
            _ if column >= count => 0.0 - damping[(row - count, column - count)],
            _ if column == row - count => 0.0 - self.squares_per_s2[column],
            _ => 0.0,
        });
        let mut c = DMatrix::zeros(self.outputs.len(), 2 * count);
        let mut d = DMatrix::zeros(self.outputs.len(), inputs);
        for (row, output) in self.outputs.iter().enumerate() {
            let modes = DVector::from_column_slice(&output.modes).transpose();
            match output.motion {
                Motion::Displacement => {
                    c.view_mut((row, 0), (1, count)).copy_from(&modes);
                    let rest = output.rest.iter().filter(|_| has_residual).enumerate();
                    for (input, rest) in rest {
                        d[(row, input)] = *rest;
                        // Friction reduces the effort that the other modes answer.
                        let damped = rest * self.frictions[input];
                        for (mode, angle) in self.inputs[input].1.iter().enumerate() {
                            c[(row, count + mode)] -= damped * angle;
                        }
                    }
                }
                Motion::Rate => c.view_mut((row, count), (1, count)).copy_from(&modes),
                Motion::Acceleration => {
                    c.row_mut(row).copy_from(&(&modes * a.rows(count, count)));
                    d.row_mut(row).copy_from(&(&modes * b.rows(count, count)));
                }
            }
        }
        let mode = |k: usize| format!("mode_{}", self.numbers[k]);
        let states = (0..count).map(|k| Signal::new(mode(k), "kg^0.5 m"));
        let rates = (0..count).map(|k| Signal::new(mode(k) + "_rate", "kg^0.5 m/s"));
        StateSpace {
            states: states.chain(rates).collect(),
            inputs: self.inputs.iter().map(|(signal, _)| signal.clone()).collect(),
            outputs: self.outputs.iter().map(|output| output.signal.clone()).collect(),
            a,
            b,
            c,
            d,
            hysteretic_difference: self.hysteretic_difference(),
        }
    }

    /// Viscous damping, with the one in place of the loss.
    fn damping(&self) -> DMatrix<f64> {
        let scale: Vec<f64> =
            self.squares_per_s2.iter().map(|square| square.abs().sqrt().sqrt()).collect();
        DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
            // A motion without frequency bends nothing.
            let loss = Some(self.loss[(i, j)] / (scale[i] * scale[j]));
            self.viscous[(i, j)] + loss.filter(|own| own.is_finite()).unwrap_or(0.0)
        })
    }

    fn hysteretic_difference(&self) -> Option<f64> {
        if self.loss.iter().all(|loss| *loss == 0.0) {
            return None;
        }
        let count = self.squares_per_s2.len().min(MEASURED_MODES);
        let damping = self.damping();
        let inputs = DMatrix::from_fn(count, self.inputs.len(), |row, input| {
            Complex64::from(self.inputs[input].1[row])
        });
        let tip = DMatrix::from_fn(self.tip.len(), count, |row, mode| {
            Complex64::from(self.outputs[self.tip[row]].modes[mode])
        });
        let response = |omega: f64, of: &dyn Fn((usize, usize)) -> Complex64| {
            let left = DMatrix::from_fn(count, count, |i, j| {
                let own = self.squares_per_s2[i] - omega * omega;
                of((i, j)) + if i == j { own } else { 0.0 }
            });
            Some(&tip * left.lu().solve(&inputs)?)
        };
        let squares = &self.squares_per_s2[..count];
        let bent = (0..count).filter(|k| self.loss[(*k, *k)] > 0.0 && squares[*k] > 0.0);
        let natural_rad_s: Vec<f64> = bent.map(|k| squares[k].sqrt()).collect();
        let (first, last) = (*natural_rad_s.first()?, *natural_rad_s.last()?);
        let ends = [0.1 * first, last];
        let spread = (0..=MEASURED_FREQUENCIES).map(|k| {
            let share = f64::from(k) / f64::from(MEASURED_FREQUENCIES);
            ends[0] * libm::pow(ends[1] / ends[0], share)
        });
        let difference = |omega: f64| {
            let viscous = response(omega, &|at| Complex64::new(0.0, omega * damping[at]))?;
            let exact = response(omega, &|at| {
                Complex64::new(0.0, omega * self.viscous[at] + self.loss[at])
            })?;
            let size = |column: usize, of: &DMatrix<Complex64>| {
                of.column(column).iter().map(|x| magnitude(*x).powi(2)).sum::<f64>().sqrt()
            };
            let apart = &viscous - &exact;
            let each = (0..exact.ncols()).map(|column| size(column, &apart) / size(column, &exact));
            Some(each.fold(0.0, Size::larger))
        };
        let all = spread.chain(natural_rad_s.iter().copied());
        Some(all.filter_map(difference).fold(0.0, Size::larger))
    }
}
