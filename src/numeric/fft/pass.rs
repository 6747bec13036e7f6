//! Stockham's passes over one column of eights: natural order in, natural order out.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use pulp::Simd;

use super::butterfly::{self, Butterfly};
use super::eight::{Eight, Vector};
use super::plan::{Pass, Stages};

/// The points to transform: of `eights` every `step`-th, from the first on.
#[derive(Clone, Copy)]
pub(super) struct Points<'a> {
    pub(super) eights: &'a [Eight],
    pub(super) step: usize,
    pub(super) band: Band,
}

/// Which points may differ from zero. The others are not even read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Band {
    All,
    /// Those of the first and the last input of the first pass's butterflies.
    Ends,
}

/// Transforms `stages.len` points into the front of `out`; that of `spare` is overwritten.
#[inline(always)]
pub(super) fn transform<S: Simd>(
    simd: S,
    stages: &Stages,
    points: Points,
    out: &mut [Eight],
    spare: &mut [Eight],
) {
    let (mut out, mut spare) = (&mut out[..stages.len], &mut spare[..stages.len]);
    let Some((first, rest)) = stages.passes.split_first() else {
        out[0] = points.eights[0];
        return;
    };
    if rest.len() % 2 == 1 {
        std::mem::swap(&mut out, &mut spare);
    }
    one_pass(simd, first, points, out);
    for pass in rest {
        one_pass(simd, pass, Points { eights: out, step: 1, band: Band::All }, spare);
        std::mem::swap(&mut out, &mut spare);
    }
}

#[inline(always)]
fn one_pass<S: Simd>(simd: S, pass: &Pass, points: Points, out: &mut [Eight]) {
    match pass.radix {
        2 => butterflies::<S, 2, butterfly::Two>(simd, pass, points, out),
        3 => butterflies::<S, 3, butterfly::Three>(simd, pass, points, out),
        4 => butterflies::<S, 4, butterfly::Four>(simd, pass, points, out),
        5 => butterflies::<S, 5, butterfly::Five>(simd, pass, points, out),
        8 => butterflies::<S, 8, butterfly::Eight>(simd, pass, points, out),
        _ => sums(simd, pass, points, out),
    }
}

#[inline(always)]
fn butterflies<S: Simd, const R: usize, B: Butterfly<R>>(
    simd: S,
    pass: &Pass,
    points: Points,
    out: &mut [Eight],
) {
    let Pass { groups, stride, .. } = *pass;
    let far = groups * stride * points.step;
    let (turns, _) = pass.turns.as_chunks::<R>();
    for (group, (turns, out)) in turns.iter().zip(out.chunks_exact_mut(R * stride)).enumerate() {
        for q in 0..stride {
            let from = (group * stride + q) * points.step;
            for at in 0..Vector::<S>::PER_EIGHT {
                let mut x = [Vector::zero(simd); R];
                for (j, x) in x.iter_mut().enumerate() {
                    if points.band == Band::All || j == 0 || j == R - 1 {
                        *x = points.eights[from + j * far].vector(simd, at);
                    }
                }
                let y = B::of(x);
                out[q].set(at, y[0]);
                for j in 1..R {
                    out[q + j * stride].set(at, y[j] * Vector::splat(simd, turns[j]));
                }
            }
        }
    }
}

/// A pass of any other radix, by the definition.
#[inline(always)]
fn sums<S: Simd>(simd: S, pass: &Pass, points: Points, out: &mut [Eight]) {
    let Pass { radix, groups, stride, .. } = *pass;
    let far = groups * stride * points.step;
    for (group, out) in out.chunks_exact_mut(radix * stride).enumerate() {
        for (row, out) in out.iter_mut().enumerate() {
            let (j, q) = (row / stride, row % stride);
            let from = (group * stride + q) * points.step;
            for at in 0..Vector::<S>::PER_EIGHT {
                let mut sum = points.eights[from].vector(simd, at);
                for k in 1..radix {
                    if points.band == Band::All || k == radix - 1 {
                        let root = Vector::splat(simd, pass.roots[j * k % radix]);
                        sum = sum + points.eights[from + k * far].vector(simd, at) * root;
                    }
                }
                out.set(at, sum * Vector::splat(simd, pass.turns[group * radix + j]));
            }
        }
    }
}
