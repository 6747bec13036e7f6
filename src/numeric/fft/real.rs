//! The real transforms by a complex one of half the length.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;
use std::sync::Arc;

use num_complex::Complex64;
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Arch, Simd, WithSimd};

use super::complex::{Scratch, complex, room};
use super::eight::{Eight, Vector};
use super::pass::Band;
use super::plan::Plan;
use super::shuffle::Shuffle;

/// Fourier transforms of an even number of real samples, both ways, without scaling.
#[derive(Debug, Clone)]
pub(in crate::numeric) struct RealFft(Arc<Plan>);

impl RealFft {
    /// For `len` samples, an even number above 0.
    pub(in crate::numeric) fn new(len: usize) -> Self {
        Self(Plan::of(len / 2))
    }

    pub(in crate::numeric) fn len(&self) -> usize {
        2 * self.0.points
    }

    /// `X_k = s Σ_j x_j e^{−2πi jk/N}`, k = 0 … N/2, with the scale s.
    pub(in crate::numeric) fn forward(
        &self,
        samples: &[f64],
        scale: f64,
        scratch: &mut Scratch,
        amplitudes: &mut [Complex64],
    ) {
        let plan = &*self.0;
        Arch::new().dispatch(Forward { plan, samples, scale, scratch, amplitudes });
    }

    /// `x_j = Σ_k X_k e^{+2πi jk/N}` over all k from −N/2 + 1 to N/2, with `X_{−k} = conj X_k`, and
    /// those beyond the end of `amplitudes` zero.
    pub(in crate::numeric) fn inverse(
        &self,
        amplitudes: &[Complex64],
        scratch: &mut Scratch,
        samples: &mut [f64],
    ) {
        Arch::new().dispatch(Inverse { plan: &self.0, amplitudes, scratch, samples });
    }
}

struct Forward<'a> {
    plan: &'a Plan,
    samples: &'a [f64],
    scale: f64,
    scratch: &'a mut Scratch,
    amplitudes: &'a mut [Complex64],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { plan, samples, scale, scratch, amplitudes } = self;
        let (shuffle, points) = (Shuffle::of::<S>(), plan.points);
        let width = plan.columns.len.div_ceil(8);
        let rows = room(&mut scratch.rows, plan.rows.len * width, Eight::ZERO);
        for (row, eights) in rows.chunks_exact_mut(width).enumerate() {
            for (j, out) in eights.iter_mut().enumerate() {
                let k = row * plan.columns.len + 8 * j;
                let z = shuffle.apart(sixteen(samples, 2 * k + 16, &mut [0.0; 16]));
                // Real and imaginary parts exchanged turn the sign of the exponent.
                out.re = z.im;
                out.im = z.re;
            }
        }
        let mut numbers = std::mem::take(&mut scratch.numbers);
        let spectrum = room(&mut numbers, 2 * points + 2, 0.0);
        complex(simd, plan, Band::All, scratch, &mut spectrum[..2 * points]);
        let [im, re] = [spectrum[0], spectrum[1]];
        (spectrum[2 * points], spectrum[2 * points + 1]) = (im, re);
        unfold(simd, plan, spectrum, 0.5 * scale, amplitudes);
        amplitudes[0] = Complex64::from(scale * (re + im));
        amplitudes[points] = Complex64::from(scale * (re - im));
        scratch.numbers = numbers;
    }
}

struct Inverse<'a> {
    plan: &'a Plan,
    amplitudes: &'a [Complex64],
    scratch: &'a mut Scratch,
    samples: &'a mut [f64],
}

impl WithSimd for Inverse<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { plan, amplitudes, scratch, samples } = self;
        let rows = plan.rows.len;
        let end = plan.rows.passes.first().map_or(rows, |pass| pass.groups);
        let band = if amplitudes.len() <= end * plan.columns.len { Band::Ends } else { Band::All };
        if band == Band::Ends {
            fold(simd, plan, amplitudes, scratch, 0..end);
            fold(simd, plan, amplitudes, scratch, rows - end..rows);
        } else {
            fold(simd, plan, amplitudes, scratch, 0..rows);
        }
        complex(simd, plan, band, scratch, samples);
    }
}

/// `Z_k = X_k + conj X_{M−k} + i e^{2πi k/N} (X_k − conj X_{M−k})` for the points of some rows; its
/// transform is `x_{2j} + i x_{2j+1}`.
#[inline(always)]
fn fold<S: Simd>(
    simd: S,
    plan: &Plan,
    amplitudes: &[Complex64],
    scratch: &mut Scratch,
    rows: Range<usize>,
) {
    let (shuffle, columns) = (Shuffle::of::<S>(), plan.columns.len);
    let numbers: &[f64] = cast_slice(amplitudes);
    let width = columns.div_ceil(8);
    let mut own = [0.0; 16];
    let points = room(&mut scratch.rows, plan.rows.len * width, Eight::ZERO);
    for row in rows {
        let halves = &plan.halves[row * width..][..width];
        let out = &mut points[row * width..][..width];
        for (j, (out, turn)) in out.iter_mut().zip(halves).enumerate() {
            let k = row * columns + 8 * j;
            if k >= amplitudes.len() && k + amplitudes.len() + 7 <= plan.points {
                *out = Eight::ZERO;
                continue;
            }
            let mut near = shuffle.apart(sixteen(numbers, 2 * k + 16, &mut own));
            let mut far =
                shuffle.apart_backwards(sixteen(numbers, 2 * (plan.points - k) + 2, &mut own));
            if k == 0 {
                (near.im[0], far.im[0]) = (0.0, 0.0);
            }
            let turn = Vector::splat(simd, *turn);
            for v in 0..Vector::<S>::PER_EIGHT {
                let (near, far) = (near.vector(simd, v), far.vector(simd, v));
                let turn = turn * plan.halves_in_eight.vector(simd, v);
                let difference = near.minus_conjugate(far);
                out.set(v, near.plus_conjugate(far).plus_i_times(difference * turn));
            }
        }
    }
}

/// `X_k = s [Z_k + conj Z_{M−k} − i e^{−2πi k/N} (Z_k − conj Z_{M−k})]`, k < M, of Z with real and
/// imaginary parts exchanged and its first number once more at its end.
#[inline(always)]
fn unfold<S: Simd>(
    simd: S,
    plan: &Plan,
    exchanged: &[f64],
    scale: f64,
    amplitudes: &mut [Complex64],
) {
    let (shuffle, columns) = (Shuffle::of::<S>(), plan.columns.len);
    let numbers: &mut [f64] = cast_slice_mut(amplitudes);
    let width = columns.div_ceil(8);
    let mut own = [0.0; 16];
    for (at, turn) in plan.halves.iter().enumerate() {
        let (row, j) = (at / width, at % width);
        let k = row * columns + 8 * j;
        let near = shuffle.apart(sixteen(exchanged, 2 * k + 16, &mut own));
        let far = shuffle.apart_backwards(sixteen(exchanged, 2 * (plan.points - k) + 2, &mut own));
        let turn = Vector::splat(simd, *turn);
        let mut out = Eight::ZERO;
        for v in 0..Vector::<S>::PER_EIGHT {
            let near = near.vector(simd, v).exchanged();
            let far = far.vector(simd, v).exchanged();
            let turn = turn * plan.halves_in_eight.vector(simd, v);
            let difference = near.minus_conjugate(far).times_conjugate(turn);
            out.set(v, near.plus_conjugate(far).minus_i_times(difference) * scale);
        }
        shuffle.write(&out, &mut numbers[2 * k..], columns - 8 * j);
    }
}

/// The sixteen of `numbers` before number `end`. Those that there are not are zero; `own` holds the
/// rest then. Otherwise nothing is copied: that would take as long as all that follows.
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

#[cfg(test)]
mod tests;
