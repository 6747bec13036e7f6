//! The waves of every piece and the banded system of conditions between the pieces.

use num_complex::Complex64;

use super::beam::Frequency;
use super::link::{Payload, Piece};

/// Columns that a row reaches to the right of its piece's own, with what pivoting adds.
const REACH: usize = 12;

/// Rows below the diagonal that hold anything.
const BELOW: usize = 5;

/// Waves e^{ks} of all pieces, k⁴ = β⁴, each scaled to 1 at the end where it is largest.
pub(crate) struct Waves<'a> {
    pieces: &'a [Piece],
    payload: Payload,
    /// Displacement and slope of the joint at the root, and the compliance of the spring there.
    root: ([f64; 2], f64),
    at: Frequency,
    numbers: Vec<Complex64>,
    /// A wave number and a stiffness of the link's order, which make all rows of one size.
    number: f64,
    stiffness: f64,
}

impl<'a> Waves<'a> {
    pub(crate) fn new(
        pieces: &'a [Piece],
        payload: Payload,
        root: ([f64; 2], f64),
        at: Frequency,
    ) -> Self {
        let numbers: Vec<Complex64> = pieces.iter().map(|piece| at.wave_number(piece)).collect();
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            values.map(f64::ln).sum::<f64>() / pieces.len() as f64
        };
        let number = mean(&mut numbers.iter().map(|k| k.norm())).exp();
        let stiffness = mean(&mut pieces.iter().map(|piece| piece.stiffness_n_m2)).exp();
        Self { pieces, payload, root, at, numbers, number, stiffness }
    }

    /// The `order`-th derivatives of the four waves of a piece at a place within it.
    pub(crate) fn waves(&self, piece: usize, within: f64, order: usize) -> [Complex64; 4] {
        let turns = [Complex64::ONE, Complex64::I, -Complex64::ONE, -Complex64::I];
        turns.map(|turn| {
            let k = self.numbers[piece] * turn;
            let from = if k.re <= 0.0 { 0.0 } else { self.pieces[piece].length_m };
            k.powu(order as u32) * (k * (within - from)).exp()
        })
    }

    /// Four rows at an end of a piece: v, v', N and S, scaled.
    fn rows(&self, piece: usize, within: f64) -> [[Complex64; 4]; 4] {
        let stiffness = self.pieces[piece].stiffness_n_m2 * self.at.stiffness / self.stiffness;
        [0, 1, 2, 3].map(|order| {
            let factor = match order {
                0 => Complex64::ONE,
                1 => (1.0 / self.number).into(),
                2 => -stiffness / self.number.powi(2),
                _ => stiffness / self.number.powi(3),
            };
            self.waves(piece, within, order).map(|wave| wave * factor)
        })
    }

    /// Rows of N and S at the outer end of a piece, with what a body there takes: for S its
    /// `mass` and `coupling`, for N its `coupling` and `inertia`.
    fn loaded(&self, piece: usize, [mass, coupling, inertia]: [f64; 3]) -> [[Complex64; 4]; 4] {
        let within = self.pieces[piece].length_m;
        let (v, phi) = (self.waves(piece, within, 0), self.waves(piece, within, 1));
        let mut rows = self.rows(piece, within);
        let load = self.at.square * self.at.mass / self.stiffness;
        for j in 0..4 {
            rows[2][j] += load * (coupling * v[j] + inertia * phi[j]) / self.number.powi(2);
            rows[3][j] += load * (mass * v[j] + coupling * phi[j]) / self.number.powi(3);
        }
        rows
    }

    /// Coefficients of all waves where the joint is moved by 1.
    pub(crate) fn solved(&self) -> Vec<Complex64> {
        let (count, unknowns) = (self.pieces.len(), 4 * self.pieces.len());
        let mut matrix = vec![vec![Complex64::ZERO; unknowns]; unknowns];
        let mut right = vec![Complex64::ZERO; unknowns];
        let root = self.rows(0, 0.0);
        let ([v, phi], compliance) = self.root;
        // The slope jumps by −N/(kκ) at the spring.
        let sprung = self.stiffness * self.number * compliance / self.at.stiffness;
        matrix[0][..4].copy_from_slice(&root[0]);
        for j in 0..4 {
            matrix[1][j] = root[1][j] + sprung * root[2][j];
        }
        right[0] = v.into();
        right[1] = (phi / self.number).into();
        for k in 0..count - 1 {
            let piece = &self.pieces[k];
            let inner = self.loaded(k, [piece.end_kg, 0.0, piece.end_kg_m2]);
            let outer = self.rows(k + 1, 0.0);
            for (row, (inner, outer)) in inner.iter().zip(&outer).enumerate() {
                let target = &mut matrix[2 + 4 * k + row];
                for j in 0..4 {
                    target[4 * k + j] = inner[j];
                    target[4 * k + 4 + j] = -outer[j];
                }
            }
        }
        let (last, Payload { mass_kg, inertia_kg_m2, offset_m: c }) = (count - 1, self.payload);
        let piece = &self.pieces[last];
        let body = [
            piece.end_kg + mass_kg,
            mass_kg * c,
            piece.end_kg_m2 + inertia_kg_m2 + mass_kg * c * c,
        ];
        let tip = self.loaded(last, body);
        matrix[unknowns - 2][4 * last..].copy_from_slice(&tip[2]);
        matrix[unknowns - 1][4 * last..].copy_from_slice(&tip[3]);
        solve(matrix, right)
    }
}

/// Gaussian elimination with partial pivoting within the band.
fn solve(mut matrix: Vec<Vec<Complex64>>, mut right: Vec<Complex64>) -> Vec<Complex64> {
    let n = right.len();
    for k in 0..n {
        let below = (k + BELOW + 1).min(n);
        let largest = |i: &usize, j: &usize| matrix[*i][k].norm().total_cmp(&matrix[*j][k].norm());
        let pivot = (k..below).max_by(largest).expect("a row at least");
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        let reach = (k + REACH).min(n);
        for i in k + 1..below {
            let (upper, lower) = matrix.split_at_mut(i);
            let factor = lower[0][k] / upper[k][k];
            for j in k..reach {
                lower[0][j] -= factor * upper[k][j];
            }
            let above = right[k];
            right[i] -= factor * above;
        }
    }
    for k in (0..n).rev() {
        let known: Complex64 = (k + 1..(k + REACH).min(n)).map(|j| matrix[k][j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k][k];
    }
    right
}
