//! The complex transform by rows and columns.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use pulp::Simd;

use super::eight::{Eight, Vector};
use super::pass::{Band, Points, transform};
use super::plan::Plan;
use super::shuffle::Shuffle;

/// Memory that transforms of any length may use one after another, so that each need not ask the
/// system for its own.
#[derive(Debug, Default)]
pub struct Scratch {
    pub(super) rows: Vec<Eight>,
    columns: Vec<Eight>,
    line: Vec<Eight>,
    spare: Vec<Eight>,
    pub(super) numbers: Vec<f64>,
}

/// The first `len` of `memory`, whatever they hold.
pub(super) fn room<T: Clone>(memory: &mut Vec<T>, len: usize, new: T) -> &mut [T] {
    if memory.len() < len {
        memory.resize(len, new);
    }
    &mut memory[..len]
}

/// `Z_k = Σ_j z_j e^{+2πi jk/M}` of the points in `scratch.rows`, real and imaginary parts in turn
/// into `numbers`.
///
/// The index is split, j = C·r + c and k = s + R·t for R rows and C columns, and the sum with it:
///
/// ```text
/// Z_{s+Rt} = Σ_c e^{2πi ct/C} [ e^{2πi cs/M} Σ_r z_{Cr+c} e^{2πi rs/R} ]
/// ```
///
/// Eight columns are transformed at a time, multiplied, and turned over into rows; then eight of
/// the other direction. No vector ever holds two numbers that are to be added to each other.
#[inline(always)]
pub(super) fn complex<S: Simd>(
    simd: S,
    plan: &Plan,
    band: Band,
    scratch: &mut Scratch,
    numbers: &mut [f64],
) {
    let (rows, columns) = (plan.rows.len, plan.columns.len);
    let shuffle = Shuffle::of::<S>();
    let Scratch { rows: points, columns: turned, line, spare, .. } = scratch;
    let longest = rows.max(columns);
    let line = room(line, longest, Eight::ZERO);
    let spare = room(spare, longest, Eight::ZERO);
    let step = rows.div_ceil(8);
    let turned = room(turned, columns * step, Eight::ZERO);
    let eights = columns.div_ceil(8);
    for at in 0..eights {
        let points = Points { eights: &points[at..], step: eights, band };
        transform(simd, &plan.rows, points, line, spare);
        turn(simd, plan, at, line, turned);
    }
    for at in 0..step {
        let points = Points { eights: &turned[at..], step, band: Band::All };
        transform(simd, &plan.columns, points, line, spare);
        for (z, numbers) in line.iter().zip(numbers.chunks_exact_mut(2 * rows)) {
            shuffle.write(z, &mut numbers[16 * at..], rows - 8 * at);
        }
    }
}

/// Multiplies the eights number `at` of all rows by their factors and turns them over.
#[inline(always)]
fn turn<S: Simd>(simd: S, plan: &Plan, at: usize, line: &[Eight], turned: &mut [Eight]) {
    let (rows, columns) = (plan.rows.len, plan.columns.len);
    let shuffle = Shuffle::of::<S>();
    let step = rows.div_ceil(8);
    let turns = plan.turns[at * rows..][..rows].chunks(8);
    let factors = turns.zip(plan.turns_in_eight.chunks(8)).zip(line.chunks(8));
    for (of_eight, ((turns, turns_in_eight), line)) in factors.enumerate() {
        let (mut re, mut im) = ([[0.0; 8]; 8], [[0.0; 8]; 8]);
        for (l, ((turn, in_eight), z)) in turns.iter().zip(turns_in_eight).zip(line).enumerate() {
            let turn = Vector::splat(simd, *turn);
            for v in 0..Vector::<S>::PER_EIGHT {
                let z = z.vector(simd, v) * (turn * in_eight.vector(simd, v));
                S::as_mut_simd_f64s(&mut re[l]).0[v] = z.re;
                S::as_mut_simd_f64s(&mut im[l]).0[v] = z.im;
            }
        }
        let (re, im) = (shuffle.transpose(&re), shuffle.transpose(&im));
        for l in 0..(columns - 8 * at).min(8) {
            let out = &mut turned[(8 * at + l) * step + of_eight];
            out.re = re[l];
            out.im = im[l];
        }
    }
}
