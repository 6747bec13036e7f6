//! The real transforms by a complex one of half the length, itself split into rows and columns; their lengths and
//! factors.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use num_complex::Complex64;
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Simd, WithSimd};

use super::passes::{Points, Stages, cis, transform};
use super::vector::{Eight, Vector, transposed};

/// Lengths and factors of a real transform of 2M samples by a complex one of M = rows · columns points,
/// row by row, each row padded to whole eights.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) points: usize,
    rows: Stages,
    columns: Stages,
    /// e^{2πi 8jk/M}, ordered by eights `j` of a row, then by row `k`.
    turns: Vec<[f64; 2]>,
    /// e^{2πi lk/M} for `l` = 0 … 7 in each eight, ordered by row `k`.
    turns_in_eight: Vec<Eight>,
    /// e^{2πi k/2M} for the first point `k` of each eight.
    halves: Vec<[f64; 2]>,
    /// e^{2πi l/2M} for `l` = 0 … 7.
    halves_in_eight: Eight,
}

impl Plan {
    /// The plan for `points` complex points, at least one.
    pub(super) fn new(points: usize) -> Self {
        let rows = number_of_rows(points);
        let columns = points / rows;
        let eights = columns.div_ceil(8);
        let turns = (0..eights).flat_map(|j| (0..rows).map(move |k| cis(8 * j * k, points)));
        let halves = (0..rows).flat_map(|row| (0..eights).map(move |j| row * columns + 8 * j));
        Self {
            points,
            rows: Stages::new(rows),
            columns: Stages::new(columns),
            turns: turns.collect(),
            turns_in_eight: (0..rows).map(|k| cis_of_eight(k, points)).collect(),
            halves: halves.map(|k| cis(k, 2 * points)).collect(),
            halves_in_eight: cis_of_eight(1, 2 * points),
        }
    }
}

/// The divisor of `points` with the fewest idle lanes along rows and columns. Of equals, the one nearest to the square
/// root, so that a line fits the cache.
fn number_of_rows(points: usize) -> usize {
    let divisors = (1..=points.isqrt()).filter(|n| points.is_multiple_of(*n));
    let shapes = divisors.flat_map(|n| [(n, points / n), (points / n, n)]);
    let cost = |&(rows, columns): &(usize, usize)| {
        let lanes = rows * columns.next_multiple_of(8) + columns * rows.next_multiple_of(8);
        lanes + 8 * rows.max(columns)
    };
    shapes.min_by_key(cost).map_or(1, |(rows, _)| rows)
}

fn cis_of_eight(k: usize, n: usize) -> Eight {
    let mut eight = Eight::ZERO;
    for l in 0..8 {
        [eight.re[l], eight.im[l]] = cis(k * l, n);
    }
    eight
}

pub(super) struct Forward<'a> {
    pub(super) plan: &'a Plan,
    pub(super) samples: &'a [f64],
    pub(super) scale: f64,
    pub(super) scratch: &'a mut Scratch,
    pub(super) amplitudes: &'a mut [Complex64],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { plan, samples, scale, scratch, amplitudes } = self;
        let points = plan.points;
        let width = plan.columns.len.div_ceil(8);
        let rows = room(&mut scratch.rows, plan.rows.len * width, Eight::ZERO);
        for (row, eights) in rows.chunks_exact_mut(width).enumerate() {
            for (j, out) in eights.iter_mut().enumerate() {
                let k = row * plan.columns.len + 8 * j;
                let z = Eight::of_pairs(sixteen(samples, 2 * k + 16, &mut [0.0; 16]));
                // Exchanging real and imaginary parts flips the sign of the exponent.
                out.re = z.im;
                out.im = z.re;
            }
        }
        let mut numbers = std::mem::take(&mut scratch.numbers);
        let spectrum = room(&mut numbers, 2 * points + 2, 0.0);
        complex(simd, plan, scratch, &mut spectrum[..2 * points]);
        let [im, re] = [spectrum[0], spectrum[1]];
        (spectrum[2 * points], spectrum[2 * points + 1]) = (im, re);
        unfold(simd, plan, spectrum, 0.5 * scale, amplitudes);
        amplitudes[0] = Complex64::from(scale * (re + im));
        amplitudes[points] = Complex64::from(scale * (re - im));
        scratch.numbers = numbers;
    }
}

pub(super) struct Inverse<'a> {
    pub(super) plan: &'a Plan,
    pub(super) amplitudes: &'a [Complex64],
    pub(super) scratch: &'a mut Scratch,
    pub(super) samples: &'a mut [f64],
}

impl WithSimd for Inverse<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { plan, amplitudes, scratch, samples } = self;
        fold(simd, plan, amplitudes, scratch);
        complex(simd, plan, scratch, samples);
    }
}

/// `Z_k = X_k + conj X_{M−k} + i e^{2πi k/N} (X_k − conj X_{M−k})` for all points; its
/// transform is `x_{2j} + i x_{2j+1}`.
#[inline(always)]
fn fold<S: Simd>(simd: S, plan: &Plan, amplitudes: &[Complex64], scratch: &mut Scratch) {
    let columns = plan.columns.len;
    let numbers: &[f64] = cast_slice(amplitudes);
    let width = columns.div_ceil(8);
    let mut own = [0.0; 16];
    let points = room(&mut scratch.rows, plan.rows.len * width, Eight::ZERO);
    for row in 0..plan.rows.len {
        let halves = &plan.halves[row * width..][..width];
        let out = &mut points[row * width..][..width];
        for (j, (out, turn)) in out.iter_mut().zip(halves).enumerate() {
            let k = row * columns + 8 * j;
            // Both X_k and X_{M−k} are beyond the amplitudes: the spectrum of a smooth motion is short.
            if k >= amplitudes.len() && k + amplitudes.len() + 7 <= plan.points {
                *out = Eight::ZERO;
                continue;
            }
            let mut near = Eight::of_pairs(sixteen(numbers, 2 * k + 16, &mut own));
            let mut far =
                Eight::of_pairs_backwards(sixteen(numbers, 2 * (plan.points - k) + 2, &mut own));
            if k == 0 {
                (near.im[0], far.im[0]) = (0.0, 0.0);
            }
            let turn = Vector::splat(simd, *turn);
            for v in 0..Vector::<S>::PER_EIGHT {
                let (near, far) = (near.vector(simd, v), far.vector(simd, v).conjugate());
                let turn = turn * plan.halves_in_eight.vector(simd, v);
                out.set(v, (near + far).plus_i_times((near - far) * turn));
            }
        }
    }
}

/// `X_k = s [Z_k + conj Z_{M−k} − i e^{−2πi k/N} (Z_k − conj Z_{M−k})]`, k < M. `exchanged` holds Z with real and
/// imaginary parts exchanged, and its first number again at the end.
#[inline(always)]
fn unfold<S: Simd>(
    simd: S,
    plan: &Plan,
    exchanged: &[f64],
    scale: f64,
    amplitudes: &mut [Complex64],
) {
    let columns = plan.columns.len;
    let numbers: &mut [f64] = cast_slice_mut(amplitudes);
    let width = columns.div_ceil(8);
    let mut own = [0.0; 16];
    for (at, turn) in plan.halves.iter().enumerate() {
        let (row, j) = (at / width, at % width);
        let k = row * columns + 8 * j;
        let near = Eight::of_pairs(sixteen(exchanged, 2 * k + 16, &mut own));
        let far =
            Eight::of_pairs_backwards(sixteen(exchanged, 2 * (plan.points - k) + 2, &mut own));
        let turn = Vector::splat(simd, *turn);
        let mut out = Eight::ZERO;
        for v in 0..Vector::<S>::PER_EIGHT {
            let near = near.vector(simd, v).exchanged();
            let far = far.vector(simd, v).exchanged().conjugate();
            let turn = (turn * plan.halves_in_eight.vector(simd, v)).conjugate();
            out.set(v, (near + far).minus_i_times((near - far) * turn) * scale);
        }
        out.write_pairs(&mut numbers[2 * k..], columns - 8 * j);
    }
}

/// The sixteen of `numbers` before index `end`. Only at the ends of the slice it copies into `own`, padded with zeros:
/// a copy takes as long as all that follows.
#[inline(always)]
fn sixteen<'a>(numbers: &'a [f64], end: usize, own: &'a mut [f64; 16]) -> &'a [f64; 16] {
    let whole = end.checked_sub(16).and_then(|start| numbers.get(start..end));
    if let Some(found) = whole.and_then(<[f64]>::first_chunk) {
        return found;
    }
    some_of_sixteen(numbers, end, own);
    own
}

#[inline(never)]
fn some_of_sixteen(numbers: &[f64], end: usize, own: &mut [f64; 16]) {
    for (i, own) in own.iter_mut().enumerate() {
        let at = (end + i).checked_sub(16);
        *own = at.and_then(|at| numbers.get(at)).copied().unwrap_or_default();
    }
}

/// Working memory, reusable by transforms of any length.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    rows: Vec<Eight>,
    columns: Vec<Eight>,
    line: Vec<Eight>,
    spare: Vec<Eight>,
    numbers: Vec<f64>,
}

/// The first `len` items of `memory`, with arbitrary content.
fn room<T: Clone>(memory: &mut Vec<T>, len: usize, new: T) -> &mut [T] {
    if memory.len() < len {
        memory.resize(len, new);
    }
    &mut memory[..len]
}

/// Writes `Z_k = Σ_j z_j e^{+2πi jk/M}` from the points in `scratch.rows` into `numbers`, real and imaginary parts
/// alternating.
///
/// For R rows and C columns, the indices j = C·r + c and k = s + R·t split the sum:
///
/// ```text
/// Z_{s+Rt} = Σ_c e^{2πi ct/C} [ e^{2πi cs/M} Σ_r z_{Cr+c} e^{2πi rs/R} ]
/// ```
///
/// It transforms eight columns at a time, multiplies them and transposes them into rows; then eight rows at a time. No
/// vector ever holds two numbers that must be added to each other.
#[inline(always)]
fn complex<S: Simd>(simd: S, plan: &Plan, scratch: &mut Scratch, numbers: &mut [f64]) {
    let (rows, columns) = (plan.rows.len, plan.columns.len);
    let Scratch { rows: points, columns: turned, line, spare, .. } = scratch;
    let longest = rows.max(columns);
    let line = room(line, longest, Eight::ZERO);
    let spare = room(spare, longest, Eight::ZERO);
    let step = rows.div_ceil(8);
    let turned = room(turned, columns * step, Eight::ZERO);
    let eights = columns.div_ceil(8);
    for at in 0..eights {
        let points = Points { eights: &points[at..], step: eights };
        transform(simd, &plan.rows, points, line, spare);
        turn(simd, plan, at, line, turned);
    }
    for at in 0..step {
        let points = Points { eights: &turned[at..], step };
        transform(simd, &plan.columns, points, line, spare);
        for (z, numbers) in line.iter().zip(numbers.chunks_exact_mut(2 * rows)) {
            z.write_pairs(&mut numbers[16 * at..], rows - 8 * at);
        }
    }
}

/// Multiplies eight number `at` of all rows by its factors and transposes it.
#[inline(always)]
fn turn<S: Simd>(simd: S, plan: &Plan, at: usize, line: &[Eight], turned: &mut [Eight]) {
    let (rows, columns) = (plan.rows.len, plan.columns.len);
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
        let (re, im) = (transposed(&re), transposed(&im));
        for l in 0..(columns - 8 * at).min(8) {
            let out = &mut turned[(8 * at + l) * step + of_eight];
            out.re = re[l];
            out.im = im[l];
        }
    }
}
