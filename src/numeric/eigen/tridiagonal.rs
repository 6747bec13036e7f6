//! Reduction of a symmetric matrix to a tridiagonal one, and the QL iteration that makes that diagonal.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use pulp::{Simd, WithSimd};

/// Sums that a product of two rows is made of, whatever the processor's width.
const PARTS: usize = 8;

/// A symmetric matrix turned by reflections into a tridiagonal one, `T = Qᵀ A Q`.
pub(super) struct Tridiagonal {
    pub(super) diagonal: Vec<f64>,
    pub(super) off_diagonal: Vec<f64>,
    /// Row k begins with the k numbers u of the reflection `I − u uᵀ`; u is zero for none.
    reflections: Vec<f64>,
}

impl Tridiagonal {
    /// Makes rows of the identity, from the `first` on, those of Qᵀ.
    #[inline(always)]
    pub(super) fn turn(&self, first: usize, rows: &mut [f64]) {
        let size = self.diagonal.len();
        for k in first + 1..size {
            let u = &self.reflections[k * size..][..k];
            // Rows from the k-th on have nothing yet in the columns of this reflection.
            for x in rows.chunks_exact_mut(size).take(k - first) {
                let share = dot(&x[..k], u);
                add(&mut x[..k], -share, u);
            }
        }
    }
}

/// Reduces a matrix given by the rows of its lower triangle, that lies in a square.
pub(super) struct Reduce {
    pub(super) size: usize,
    pub(super) matrix: Vec<f64>,
}

impl WithSimd for Reduce {
    type Output = Tridiagonal;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Tridiagonal {
        let Self { size, mut matrix } = self;
        let mut off_diagonal = vec![0.0; size.saturating_sub(1)];
        let mut product = vec![0.0; size];
        for k in (1..size).rev() {
            let (above, rest) = matrix.split_at_mut(k * size);
            let u = &mut rest[..k];
            off_diagonal[k - 1] = reflection(u);
            let p = &mut product[..k];
            multiply(above, size, u, p);
            add(p, -0.5 * dot(p, u), u);
            // A ← (I − u uᵀ) A (I − u uᵀ) = A − u pᵀ − p uᵀ
            for (j, row) in above.chunks_exact_mut(size).enumerate() {
                let row = &mut row[..=j];
                let (u_j, p_j) = (u[j], p[j]);
                for ((a, u), p) in row.iter_mut().zip(&*u).zip(&*p) {
                    *a -= u_j * p + p_j * u;
                }
            }
        }
        let diagonal = (0..size).map(|k| matrix[k * size + k]).collect();
        Tridiagonal { diagonal, off_diagonal, reflections: matrix }
    }
}

/// Makes a row the u of the reflection `I − u uᵀ` that leaves of it the last number alone, which it
/// gives.
#[inline(always)]
fn reflection(row: &mut [f64]) -> f64 {
    let last = row.len() - 1;
    let others = row[..last].iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if others == 0.0 {
        let kept = row[last];
        row.fill(0.0);
        return kept;
    }
    let scale = others.max(row[last].abs());
    for x in row.iter_mut() {
        *x /= scale;
    }
    let norm = dot(row, row).sqrt();
    let kept = (-norm).copysign(-row[last]);
    // uᵀu = 2
    let per = (norm * (norm + row[last].abs())).sqrt();
    row[last] -= kept;
    for x in row.iter_mut() {
        *x /= per;
    }
    scale * kept
}

/// `p = A u`, of the lower triangle of A.
#[inline(always)]
fn multiply(matrix: &[f64], size: usize, u: &[f64], p: &mut [f64]) {
    p.fill(0.0);
    for (j, row) in matrix.chunks_exact(size).enumerate() {
        let below = dot(&row[..j], &u[..j]);
        add(&mut p[..j], u[j], &row[..j]);
        p[j] = below + row[j] * u[j];
    }
}

/// Product of two rows, summed in an order of its own.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut parts = [0.0; PARTS];
    let (a_whole, a_rest) = a.as_chunks::<PARTS>();
    let (b_whole, b_rest) = b.as_chunks::<PARTS>();
    for (a, b) in a_whole.iter().zip(b_whole) {
        for k in 0..PARTS {
            parts[k] += a[k] * b[k];
        }
    }
    for ((part, a), b) in parts.iter_mut().zip(a_rest).zip(b_rest) {
        *part += a * b;
    }
    let [a, b, c, d, e, f, g, h] = parts;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// `x ← x + factor y`.
#[inline(always)]
fn add(x: &mut [f64], factor: f64, y: &[f64]) {
    for (x, y) in x.iter_mut().zip(y) {
        *x += factor * y;
    }
}

/// Most QL sweeps for one eigenvalue; two are usual.
const MOST_SWEEPS: usize = 60;

/// Plane rotations of neighbouring rows from the last of them upwards.
pub(super) struct Sweep {
    /// Lower row of the first rotation.
    pub(super) last: usize,
    /// Cosine and sine of each: `upper ← c upper − s lower, lower ← s upper + c lower`.
    pub(super) rotations: Vec<[f64; 2]>,
}

/// Makes a tridiagonal matrix diagonal in place, by the implicit QL iteration; gives what it turned
/// the matrix by, or none if that does not converge.
pub(super) fn diagonalise(diagonal: &mut [f64], off_diagonal: &mut [f64]) -> Option<Vec<Sweep>> {
    let mut sweeps = Vec::new();
    for first in 0..diagonal.len() {
        let mut left = MOST_SWEEPS;
        loop {
            let last = end_of_block(diagonal, off_diagonal, first);
            if last == first {
                break;
            }
            left = left.checked_sub(1)?;
            sweeps.push(sweep(diagonal, off_diagonal, first, last));
        }
    }
    Some(sweeps)
}

/// Last row that hangs together with `first` by more than round-off.
fn end_of_block(diagonal: &[f64], off_diagonal: &[f64], first: usize) -> usize {
    let is_cut = |k: usize| {
        let size = diagonal[k].abs() + diagonal[k + 1].abs();
        off_diagonal[k].abs() <= f64::EPSILON * size
    };
    (first..off_diagonal.len()).find(|k| is_cut(*k)).unwrap_or(off_diagonal.len())
}

/// One QL step on the rows `first ..= last`, shifted by the eigenvalue of the first two that is
/// nearest to the first.
fn sweep(d: &mut [f64], e: &mut [f64], first: usize, last: usize) -> Sweep {
    let half_gap = (d[first + 1] - d[first]) / (2.0 * e[first]);
    let root = libm::hypot(half_gap, 1.0).copysign(half_gap);
    let mut g = d[last] - d[first] + e[first] / (half_gap + root);
    let (mut c, mut s, mut p) = (1.0, 1.0, 0.0);
    let mut rotations = Vec::with_capacity(last - first);
    for k in (first..last).rev() {
        let (f, b) = (s * e[k], c * e[k]);
        let r = libm::hypot(f, g);
        if k + 1 < last {
            e[k + 1] = r;
        }
        if r == 0.0 {
            // The block falls apart here; the next step takes the parts.
            d[k + 1] -= p;
            cut(e, last);
            return Sweep { last, rotations };
        }
        (s, c) = (f / r, g / r);
        g = d[k + 1] - p;
        let t = (d[k] - g) * s + 2.0 * c * b;
        p = s * t;
        d[k + 1] = g + p;
        g = c * t - b;
        rotations.push([c, s]);
    }
    d[first] -= p;
    e[first] = g;
    cut(e, last);
    Sweep { last, rotations }
}

/// The rows down to `last` hang together with nothing below.
fn cut(off_diagonal: &mut [f64], last: usize) {
    if let Some(e) = off_diagonal.get_mut(last) {
        *e = 0.0;
    }
}
