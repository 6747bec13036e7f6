//! One transform along the rows or the columns: Stockham's passes over eights, natural order in,
//! natural order out.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::iter::repeat_n;

use pulp::{Simd, WithSimd};

use super::vector::{Eight, Vector};

/// The passes of one transform along the rows or the columns.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) len: usize,
    passes: Vec<Pass>,
}

/// One pass: `groups` times `stride` butterflies of `radix` points each.
#[derive(Debug)]
struct Pass {
    radix: usize,
    groups: usize,
    stride: usize,
    /// Factors of the outputs: `radix` of them a group, the first 1.
    turns: Vec<[f64; 2]>,
    /// e^{2πi k/radix}, for a radix without a written-out butterfly.
    roots: Vec<[f64; 2]>,
}

impl Stages {
    pub(super) fn new(len: usize) -> Self {
        let mut stride = 1;
        let mut passes = Vec::new();
        for radix in radices(len) {
            let groups = len / (stride * radix);
            let turns = (0..groups).flat_map(|p| (0..radix).map(move |j| cis(p * j * stride, len)));
            let roots = if radix > 8 || radix == 7 { 0..radix } else { 0..0 };
            let roots = roots.map(|k| cis(k, radix)).collect();
            passes.push(Pass { radix, groups, stride, turns: turns.collect(), roots });
            stride *= radix;
        }
        Self { len, passes }
    }
}

/// Radices whose product is `len`: as many 8s as possible, and two 4s rather than a 2.
fn radices(len: usize) -> Vec<usize> {
    let twos = len.trailing_zeros() as usize;
    let mut odd = len >> twos;
    let mut found = Vec::new();
    let mut factor = 3;
    while odd > 1 {
        while odd.is_multiple_of(factor) {
            found.push(factor);
            odd /= factor;
        }
        // The rest has no factor up to its root: it is prime.
        factor = if factor * factor > odd { odd } else { factor + 2 };
    }
    let (two, fours) = match twos % 3 {
        0 => (0, 0),
        1 if twos == 1 => (1, 0),
        1 => (0, 2),
        _ => (0, 1),
    };
    let eights = (twos - two - 2 * fours) / 3;
    found.extend(repeat_n(2, two).chain(repeat_n(4, fours)).chain(repeat_n(8, eights)));
    found
}

/// e^{2πi k/n}, real and imaginary part. Integers fold the angle into an eighth of a turn, and `libm` computes its sine
/// and cosine, with the same bits on every machine.
pub(super) fn cis(k: usize, n: usize) -> [f64; 2] {
    let eighths = 8 * (k % n);
    let (octant, rest) = (eighths / n, eighths % n);
    let angle = |eighths: usize| TAU * (eighths as f64 / (8 * n) as f64);
    let (sin, cos) = if octant % 2 == 0 {
        libm::sincos(angle(rest))
    } else {
        let (sin, cos) = libm::sincos(angle(n - rest));
        (cos, sin)
    };
    match octant / 2 {
        0 => [cos, sin],
        1 => [-sin, cos],
        2 => [-cos, -sin],
        _ => [sin, -cos],
    }
}

/// Points to transform: every `step`-th of `eights`, from the first on.
#[derive(Clone, Copy)]
pub(super) struct Points<'a> {
    pub(super) eights: &'a [Eight],
    pub(super) step: usize,
}

/// Transforms `stages.len` points into the front of `out`; overwrites the front of `spare`.
#[inline(always)]
pub(super) fn transform<S: Simd>(
    simd: S,
    stages: &Stages,
    points: Points,
    out: &mut [Eight],
    spare: &mut [Eight],
) {
    simd.vectorize(Transform { stages, points, out, spare });
}

/// Transform compiled once for each width of vectors: rows and columns, forward and inverse transforms share it, and
/// with it the butterflies of all radices.
struct Transform<'a> {
    stages: &'a Stages,
    points: Points<'a>,
    out: &'a mut [Eight],
    spare: &'a mut [Eight],
}

impl WithSimd for Transform<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { stages, points, out, spare } = self;
        let (mut out, mut spare) = (&mut out[..stages.len], &mut spare[..stages.len]);
        if stages.passes.is_empty() {
            out[0] = points.eights[0];
            return;
        }
        // Each pass writes into the other half of the memory, the last one into `out`.
        if stages.passes.len() % 2 == 1 {
            std::mem::swap(&mut out, &mut spare);
        }
        for (number, pass) in stages.passes.iter().enumerate() {
            let points = if number == 0 { points } else { Points { eights: out, step: 1 } };
            one_pass(simd, pass, points, spare);
            std::mem::swap(&mut out, &mut spare);
        }
    }
}

#[inline(always)]
fn one_pass<S: Simd>(simd: S, pass: &Pass, points: Points, out: &mut [Eight]) {
    match pass.radix {
        2 => butterflies::<S, 2, RadixTwo>(simd, pass, points, out),
        3 => butterflies::<S, 3, RadixThree>(simd, pass, points, out),
        4 => butterflies::<S, 4, RadixFour>(simd, pass, points, out),
        5 => butterflies::<S, 5, RadixFive>(simd, pass, points, out),
        8 => butterflies::<S, 8, RadixEight>(simd, pass, points, out),
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
                    *x = points.eights[from + j * far].vector(simd, at);
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

/// A pass of any other radix, by the definition of the transform.
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
                    let root = Vector::splat(simd, pass.roots[j * k % radix]);
                    sum = sum + points.eights[from + k * far].vector(simd, at) * root;
                }
                out.set(at, sum * Vector::splat(simd, pass.turns[group * radix + j]));
            }
        }
    }
}

/// A transform of a few points written out, `y_k = Σ_j x_j e^{+2πi jk/R}`. It is a type, not a function, because the
/// compiler inlines every call of its method.
trait Butterfly<const R: usize> {
    fn of<S: Simd>(points: [Vector<S>; R]) -> [Vector<S>; R];
}

struct RadixTwo;

impl Butterfly<2> for RadixTwo {
    #[inline(always)]
    fn of<S: Simd>([a, b]: [Vector<S>; 2]) -> [Vector<S>; 2] {
        [a + b, a - b]
    }
}

struct RadixThree;

impl Butterfly<3> for RadixThree {
    #[inline(always)]
    fn of<S: Simd>([a, b, c]: [Vector<S>; 3]) -> [Vector<S>; 3] {
        const SIN_60: f64 = 0.866_025_403_784_438_6;
        let (sum, turned) = (b + c, (b - c) * SIN_60);
        let middle = a - sum * 0.5;
        [a + sum, middle.plus_i_times(turned), middle.minus_i_times(turned)]
    }
}

struct RadixFour;

impl Butterfly<4> for RadixFour {
    #[inline(always)]
    fn of<S: Simd>([a, b, c, d]: [Vector<S>; 4]) -> [Vector<S>; 4] {
        let ([even, even_1], [odd, odd_1]) = (RadixTwo::of([a, c]), RadixTwo::of([b, d]));
        [even + odd, even_1.plus_i_times(odd_1), even - odd, even_1.minus_i_times(odd_1)]
    }
}

struct RadixFive;

impl Butterfly<5> for RadixFive {
    #[inline(always)]
    fn of<S: Simd>([a, b, c, d, e]: [Vector<S>; 5]) -> [Vector<S>; 5] {
        const COS_72: f64 = 0.309_016_994_374_947_45;
        const COS_144: f64 = -0.809_016_994_374_947_5;
        const SIN_72: f64 = 0.951_056_516_295_153_5;
        const SIN_144: f64 = 0.587_785_252_292_473_1;
        let ([outer, outer_1], [inner, inner_1]) = (RadixTwo::of([b, e]), RadixTwo::of([c, d]));
        let first = a + (outer * COS_72 + inner * COS_144);
        let second = a + (outer * COS_144 + inner * COS_72);
        let first_turned = outer_1 * SIN_72 + inner_1 * SIN_144;
        let second_turned = outer_1 * SIN_144 - inner_1 * SIN_72;
        [
            a + (outer + inner),
            first.plus_i_times(first_turned),
            second.plus_i_times(second_turned),
            second.minus_i_times(second_turned),
            first.minus_i_times(first_turned),
        ]
    }
}

struct RadixEight;

impl Butterfly<8> for RadixEight {
    #[inline(always)]
    fn of<S: Simd>([a, b, c, d, e, f, g, h]: [Vector<S>; 8]) -> [Vector<S>; 8] {
        let [even, even_1, even_2, even_3] = RadixFour::of([a, c, e, g]);
        let [odd, odd_1, odd_2, odd_3] = RadixFour::of([b, d, f, h]);
        // Turned by 45 degrees, and backwards by 135 degrees.
        let odd_1 = odd_1.plus_i_times(odd_1) * FRAC_1_SQRT_2;
        let odd_3 = odd_3.minus_i_times(odd_3) * FRAC_1_SQRT_2;
        [
            even + odd,
            even_1 + odd_1,
            even_2.plus_i_times(odd_2),
            even_3 - odd_3,
            even - odd,
            even_1 - odd_1,
            even_2.minus_i_times(odd_2),
            even_3 + odd_3,
        ]
    }
}
