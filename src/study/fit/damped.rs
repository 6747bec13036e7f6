//! A sum of damped vibrations, an offset and a drift, fitted to samples at a uniform step.
//!
//! ```text
//! x(τ) = c₀ + c₁ (τ − ½) + Σ e^(−σ τ) (a cos ωτ + b sin ωτ),   0 ≤ τ < 1
//! ```
//!
//! Time runs from 0 to 1 over the samples. The amplitudes are linear: every step of the iteration solves for them, and
//! only moves σ and ω.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "shares of a number of samples, and numbers of periods"
)]

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use num_complex::Complex64;

use crate::numeric::{NORMAL_95, magnitude, student_95};

/// A damped vibration: its decay rate σ and its frequency ω in rad, over the time of all samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pole {
    pub(super) sigma: f64,
    pub(super) omega: f64,
}

/// Number of columns for the offset and the drift.
const LINE: usize = 2;

/// Number of samples after which a vibration is recomputed, to limit rounding errors.
const RENEWED: usize = 64;

/// Limit of steps of the iteration.
const MOST_STEPS: usize = 100;

/// Change of σ and ω below which the iteration ends.
const SETTLED: f64 = 1e-9;

/// Periods of a vibration over which the remaining differences are summed.
const SPANS: [f64; 2] = [1.0, 3.0];

/// Largest and smallest number of spans for measuring the amplitude, and the periods in each.
const MOST_SPANS: usize = 12;
const LEAST_SPANS: usize = 5;
const PERIODS_OF_SPAN: f64 = 1.0;

/// Smallest ratio of amplitude to noise for a usable logarithm.
const CLEAR: f64 = 6.0;

/// Ratio of the amplitude to the fitted decay below which a vibration has stopped.
const STOPPED: f64 = 0.05;

/// Vibrations that fit samples best.
#[derive(Debug, Clone)]
pub(super) struct Damped {
    pub(super) poles: Vec<Pole>,
    /// c₀, c₁, then a and b of each pole.
    coefficients: DVector<f64>,
    /// Sum of squared differences.
    pub(super) cost: f64,
    /// `Jᵀr` and `JᵀJ`; the columns of J belong to the coefficients, then to σ and ω of each pole.
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

impl Damped {
    /// Solves for the amplitudes of these vibrations; `None` if the samples cannot distinguish them.
    pub(super) fn of(samples: &[f64], poles: Vec<Pole>) -> Option<Self> {
        let width = LINE + 4 * poles.len();
        let (mut gram, mut right) = (vec![0.0; width * width], vec![0.0; width]);
        each_row(&poles, samples.len(), |k, row| {
            for (i, own) in row.iter().enumerate() {
                right[i] += own * samples[k];
                for (sum, other) in gram[i * width..=i * width + i].iter_mut().zip(row) {
                    *sum += own * other;
                }
            }
        });
        let gram = DMatrix::from_fn(width, width, |i, j| gram[i.max(j) * width + i.min(j)]);
        let right = DVector::from_vec(right);
        let linear = LINE + 2 * poles.len();
        let known = DVector::from_fn(linear, |i, _| right[place(i)]);
        let own = DMatrix::from_fn(linear, linear, |i, j| gram[(place(i), place(j))]);
        let coefficients = solved(&own, &known)?;
        // Columns of J as combinations of the sums' columns: those of the coefficients, then −τ(aC + bS), τ(bC − aS).
        let mut columns = DMatrix::zeros(width, linear + 2 * poles.len());
        for column in 0..linear {
            columns[(place(column), column)] = 1.0;
        }
        for pole in 0..poles.len() {
            let [a, b] = [0, 1].map(|k| coefficients[LINE + 2 * pole + k]);
            let (row, column) = (LINE + 4 * pole + 2, linear + 2 * pole);
            columns[(row, column)] = -a;
            columns[(row + 1, column)] = -b;
            columns[(row, column + 1)] = b;
            columns[(row + 1, column + 1)] = -a;
        }
        let mut all = DVector::zeros(width);
        (0..linear).for_each(|column| all[place(column)] = coefficients[column]);
        let energy: f64 = samples.iter().map(|x| x * x).sum();
        let cost = (energy - coefficients.dot(&known)).max(0.0);
        let gradient = columns.tr_mul(&(right - &gram * all));
        let hessian = columns.tr_mul(&(gram * &columns));
        Some(Self { poles, coefficients, cost, gradient, hessian })
    }

    /// Moves σ and ω to the least sum of squares, by the iteration of Levenberg and Marquardt.
    pub(super) fn settled(self, samples: &[f64]) -> Self {
        let energy: f64 = samples.iter().map(|x| x * x).sum();
        let (mut best, mut lambda) = (self, 1e-3);
        for _ in 0..MOST_STEPS {
            let linear = best.coefficients.len();
            let mut damped = best.hessian.clone();
            (linear..damped.nrows()).for_each(|k| damped[(k, k)] *= 1.0 + lambda);
            let Some(step) = solved(&damped, &best.gradient) else { break };
            let step = step.rows_range(linear..);
            let pairs = best.poles.iter().enumerate().map(|(k, pole)| Pole {
                sigma: pole.sigma + step[2 * k],
                omega: pole.omega + step[2 * k + 1],
            });
            let poles: Vec<Pole> = pairs.collect();
            let is_vibration = |pole: &Pole| pole.is_within(samples.len());
            let trial = poles.iter().all(is_vibration).then(|| Self::of(samples, poles)).flatten();
            match trial.filter(|trial| trial.cost <= best.cost + 1e-15 * energy) {
                Some(trial) => {
                    let is_settled = step.amax() < SETTLED;
                    (best, lambda) = (trial, 0.1 * lambda);
                    if is_settled {
                        break;
                    }
                }
                None if lambda > 1e8 => break,
                None => lambda *= 10.0,
            }
        }
        best
    }

    /// The samples minus the vibrations.
    pub(super) fn differences(&self, samples: &[f64]) -> Vec<f64> {
        let mut left = samples.to_vec();
        let c = &self.coefficients;
        each_row(&self.poles, samples.len(), |k, row| {
            let vibrations = (LINE..c.len()).map(|j| c[j] * row[place(j)]);
            left[k] -= c[0] + c[1] * row[1] + vibrations.sum::<f64>();
        });
        left
    }

    /// Amplitude at the first sample, `a − ib` of a vibration.
    fn amplitude(&self, pole: usize) -> Complex64 {
        let at = LINE + 2 * pole;
        Complex64::new(self.coefficients[at], -self.coefficients[at + 1])
    }

    /// Mean square of a vibration.
    pub(super) fn energy(&self, pole: usize) -> f64 {
        let twice = 2.0 * self.poles[pole].sigma;
        let share = if twice.abs() < 1e-6 { 1.0 } else { -libm::expm1(-twice) / twice };
        0.5 * share * self.amplitude(pole).norm_sqr()
    }

    /// The vibration of the largest mean square.
    pub(super) fn strongest(&self) -> Option<&Pole> {
        let places = 0..self.poles.len();
        let strongest = places.max_by(|a, b| self.energy(*a).total_cmp(&self.energy(*b)));
        strongest.map(|place| &self.poles[place])
    }

    /// Decay rates of a vibration in the first and in the last samples, and the standard error of their difference.
    /// They come from a parabola through the logarithms of its amplitude in spans of some periods, as far as it exceeds
    /// the noise. `None` for less than five periods.
    pub(super) fn bend(&self, pole: usize, differences: &[f64]) -> Option<([f64; 2], f64)> {
        let (Pole { sigma, omega }, len) = (self.poles[pole], differences.len());
        let amplitude = magnitude(self.amplitude(pole));
        // Only noise jumps from sample to sample.
        let jumps = differences.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        let noise = (jumps.sum::<f64>() / (2 * len) as f64).sqrt();
        let seen = libm::log(amplitude / (CLEAR * noise)) / sigma;
        let end = if sigma > 0.0 { seen.clamp(0.0, 1.0) } else { 1.0 };
        let spans = ((end * omega / PERIODS_OF_SPAN / TAU) as usize).min(MOST_SPANS);
        if spans < LEAST_SPANS {
            return None;
        }
        // Σ of C², CS, S², Cr, Sr in each span.
        let mut sums = vec![[0.0; 5]; spans];
        each_row(&self.poles[pole..=pole], len, |k, row| {
            let span = (k as f64 / len as f64 / end * spans as f64) as usize;
            if let Some(sums) = sums.get_mut(span) {
                let [c, s, r] = [row[LINE], row[LINE + 1], differences[k]];
                [c * c, c * s, s * s, c * r, s * r]
                    .into_iter()
                    .zip(sums)
                    .for_each(|(x, sum)| *sum += x);
            }
        });
        let logarithm = |[cc, cs, ss, cr, sr]: [f64; 5]| {
            let determinant = cc * ss - cs * cs;
            let [a, b] = [(ss * cr - cs * sr) / determinant, (cc * sr - cs * cr) / determinant];
            let change = Complex64::new(a, -b) / self.amplitude(pole);
            let weight = 0.5 * (cc + ss) * (amplitude / noise).powi(2);
            (libm::log(magnitude(1.0 + change).max(STOPPED)), weight)
        };
        let points: Vec<(f64, f64)> = sums.into_iter().map(logarithm).collect();
        let place = |span: usize| 2.0 * (span as f64 + 0.5) / spans as f64 - 1.0;
        let powers = |span: usize| Vector3::new(1.0, place(span), place(span) * place(span));
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (span, (y, weight)) in points.iter().enumerate() {
            normal += *weight * powers(span) * powers(span).transpose();
            right += *weight * *y * powers(span);
        }
        let inverse = normal.try_inverse()?;
        let parabola = inverse * right;
        let off = |(span, (y, weight)): (usize, &(f64, f64))| {
            weight * (y - parabola.dot(&powers(span))).powi(2)
        };
        let scatter = points.iter().enumerate().map(off).sum::<f64>() / (spans - 3) as f64;
        let slope = |x: f64| (parabola[1] + 2.0 * parabola[2] * x) * 2.0 / end;
        let error = 8.0 / end * (inverse[(2, 2)] * scatter.max(1.0)).sqrt();
        let error = error * student_95(spans - 3) / NORMAL_95;
        Some(([-1.0, 1.0].map(|x| sigma - slope(x)), error))
    }

    /// Variances of σ and ω of each vibration, in their order, from the remaining differences: the larger of the value
    /// for independent differences and the sum over neighbours within some periods.
    pub(super) fn variances(&self, differences: &[f64]) -> Option<Vec<[f64; 2]>> {
        let (len, all) = (differences.len(), self.hessian.nrows());
        let freedom = len.checked_sub(all + 1)? as f64;
        let inverse = inverted(&self.hessian)?;
        let linear = self.coefficients.len();
        let variance = differences.iter().map(|r| r * r).sum::<f64>() / freedom;
        let correction = len as f64 / freedom;
        let spans = |pole: &Pole| {
            SPANS.map(|periods| {
                let samples = periods * TAU / pole.omega * len as f64;
                (samples as usize).clamp(1, len / 4 + 1)
            })
        };
        let mut influence = vec![vec![0.0; len]; all - linear];
        let mut columns = vec![0.0; all];
        each_row(&self.poles, len, |k, row| {
            columns.iter_mut().enumerate().for_each(|(j, value)| *value = self.column(j, row));
            for (own, parts) in influence.iter_mut().enumerate() {
                let gains = columns.iter().enumerate().map(|(j, c)| inverse[(linear + own, j)] * c);
                parts[k] = gains.sum::<f64>() * differences[k];
            }
        });
        let of = |own: usize, pole: &Pole| {
            let white = variance * inverse[(linear + own, linear + own)];
            let sums = spans(pole).map(|span| {
                // Sums over spans that are not short compared with the decay are too small, because all differences add
                // up to 0.
                let share = span as f64 / len as f64 * pole.sigma.max(1.0);
                correction * neighbourly(&influence[own], span) / (1.0 - share.min(0.5))
            });
            sums.into_iter().fold(white, f64::max)
        };
        let pairs = self.poles.iter().enumerate();
        Some(pairs.map(|(k, pole)| [of(2 * k, pole), of(2 * k + 1, pole)]).collect())
    }

    /// Value of a column of J in a row of [`each_row`].
    fn column(&self, column: usize, row: &[f64]) -> f64 {
        let linear = self.coefficients.len();
        let Some(moved) = column.checked_sub(linear) else { return row[place(column)] };
        let pole = moved / 2;
        let [a, b] = [0, 1].map(|k| self.coefficients[LINE + 2 * pole + k]);
        let [c, s] = [2, 3].map(|k| row[LINE + 4 * pole + k]);
        if moved % 2 == 0 { -(a * c + b * s) } else { b * c - a * s }
    }
}

/// Place of a coefficient's column in a row of [`each_row`].
fn place(coefficient: usize) -> usize {
    match coefficient.checked_sub(LINE) {
        Some(of_pole) => LINE + 4 * (of_pole / 2) + of_pole % 2,
        None => coefficient,
    }
}

impl Pole {
    /// True for a vibration with a period from two samples to about twelve times the record.
    fn is_within(&self, len: usize) -> bool {
        self.sigma > -2.0
            && self.sigma < self.omega
            && self.omega > 0.5
            && self.omega < PI * len as f64
    }
}

/// Variance of the sum of all parts, with Bartlett's weights for the correlation within `span`.
fn neighbourly(parts: &[f64], span: usize) -> f64 {
    let (mut window, mut sum) = (0.0, 0.0);
    for k in 0..parts.len() + span - 1 {
        window += parts.get(k).copied().unwrap_or(0.0);
        if k >= span {
            window -= parts[k - span];
        }
        sum += window * window;
    }
    sum / span as f64
}

/// Passes every sample's number and row to `each`: 1, τ − ½, then C, S, τC, τS of each pole, where C = e^(−στ) cos ωτ
/// and S = e^(−στ) sin ωτ.
pub(super) fn each_row(poles: &[Pole], len: usize, mut each: impl FnMut(usize, &[f64])) {
    let at = |pole: &Pole, k: usize| {
        let tau = k as f64 / len as f64;
        let turned = Complex64::new(libm::cos(pole.omega * tau), libm::sin(pole.omega * tau));
        turned * libm::exp(-pole.sigma * tau)
    };
    let turns: Vec<Complex64> = poles.iter().map(|pole| at(pole, 1)).collect();
    let mut values: Vec<Complex64> = vec![Complex64::ZERO; poles.len()];
    let mut row = vec![1.0; LINE + 4 * poles.len()];
    for k in 0..len {
        let tau = k as f64 / len as f64;
        row[1] = tau - 0.5;
        for (j, value) in values.iter_mut().enumerate() {
            *value = if k % RENEWED == 0 { at(&poles[j], k) } else { *value * turns[j] };
            let own = &mut row[LINE + 4 * j..];
            (own[0], own[1]) = (value.re, value.im);
            (own[2], own[3]) = (tau * value.re, tau * value.im);
        }
        each(k, &row);
    }
}

/// Solves a symmetric positive definite system, with its columns scaled to equal size.
fn solved(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let (scaled, sizes) = scaled(matrix)?;
    let solution = scaled.cholesky()?.solve(&right.component_mul(&sizes));
    Some(solution.component_mul(&sizes)).filter(|x| x.iter().all(|x| x.is_finite()))
}

fn inverted(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (scaled, sizes) = scaled(matrix)?;
    let inverse = scaled.cholesky()?.inverse();
    let size = matrix.nrows();
    Some(DMatrix::from_fn(size, size, |i, j| sizes[i] * inverse[(i, j)] * sizes[j]))
}

/// The matrix scaled to a diagonal of 1, and the factors on its columns.
fn scaled(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let sizes = DVector::from_fn(matrix.nrows(), |k, _| matrix[(k, k)].sqrt().recip());
    let size = matrix.nrows();
    let is_good = sizes.iter().all(|size| size.is_finite());
    is_good
        .then(|| (DMatrix::from_fn(size, size, |i, j| sizes[i] * matrix[(i, j)] * sizes[j]), sizes))
}
