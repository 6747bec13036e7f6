//! All eigenvalues and eigenvectors of a symmetric matrix, with the same bits on every processor: Householder's
//! reduction to a tridiagonal matrix and the implicit QL iteration.
//!
//! Libraries of dense algebra choose fused multiply-add and the order of their sums by the processor, which changes
//! last digits. This solver rounds each product and sum by itself, in a fixed order; only the width of the vectors
//! depends on the processor. nalgebra's solver also has fixed bits, but takes 2.1 to 2.9 times as long on the matrices
//! of 100 to 500 elements. The solver of faer takes 0.6 to 0.85 of the time, but its bits differ between processors.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Rows of Qᵀ that each reflection is applied to before the next one is fetched.
const ROWS: usize = 16;

/// Columns of the eigenvectors that all rotations turn together. This many stay in the processor's cache.
const COLUMNS: usize = 32;

/// Eigenvalues and orthonormal eigenvectors of a symmetric matrix.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SymmetricEigen {
    /// Eigenvalues, ascending.
    pub(crate) values: Vec<f64>,
    /// Eigenvectors as rows, one for each value.
    vectors: Vec<f64>,
}

impl SymmetricEigen {
    /// Solves for all eigenvalues of a square matrix in row order; reads the lower triangle only. Returns `None` if a
    /// number is not finite.
    ///
    /// # Panics
    /// If the matrix has not `size` squared numbers.
    pub(crate) fn new(size: usize, matrix: Vec<f64>) -> Option<Self> {
        assert_eq!(matrix.len(), size * size, "a matrix of {size} rows");
        let rows = matrix.chunks_exact(size.max(1)).enumerate();
        if !rows.flat_map(|(k, row)| &row[..=k]).all(|x| x.is_finite()) {
            return None;
        }
        Arch::new().dispatch(Solve { size, matrix })
    }

    /// Eigenvalues μ of `A x = μ L Lᵀ x`, and eigenvectors `Lᵀ x`: those of `L⁻¹ A L⁻ᵀ`, for a symmetric A and a lower
    /// triangle L. Returns `None` if a number is not finite.
    pub(crate) fn over(lower: &DMatrix<f64>, matrix: &DMatrix<f64>) -> Option<Self> {
        let half = lower.solve_lower_triangular(matrix)?;
        let whole = lower.solve_lower_triangular(&half.transpose())?;
        // Symmetric, so that the order of its entries does not matter.
        Self::new(whole.nrows(), whole.as_slice().to_vec())
    }

    /// The eigenvector of the k-th value.
    pub(crate) fn vector(&self, k: usize) -> &[f64] {
        let size = self.values.len();
        &self.vectors[k * size..][..size]
    }
}

/// [`SymmetricEigen::new`], compiled for the vectors of this processor.
struct Solve {
    size: usize,
    matrix: Vec<f64>,
}

impl WithSimd for Solve {
    type Output = Option<SymmetricEigen>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Option<SymmetricEigen> {
        let ([mut diagonal, mut off_diagonal], reflections) = reduce(self.size, self.matrix);
        let sweeps = diagonalise(&mut diagonal, &mut off_diagonal)?;
        let mut order: Vec<usize> = (0..self.size).collect();
        order.sort_by(|a, b| diagonal[*a].total_cmp(&diagonal[*b]));
        let vectors = vectors(&reflections, &sweeps, &order);
        let values = order.iter().map(|k| diagonal[*k]).collect();
        Some(SymmetricEigen { values, vectors })
    }
}

/// Eigenvectors as rows: turns Qᵀ by the rotations of QL, then sorts its rows.
#[inline(always)]
fn vectors(reflections: &[f64], sweeps: &[Sweep], order: &[usize]) -> Vec<f64> {
    let size = order.len();
    let mut vectors = vec![0.0; size * size];
    for (block, rows) in vectors.chunks_mut(ROWS * size.max(1)).enumerate() {
        let first = block * ROWS;
        for (k, row) in rows.chunks_exact_mut(size).enumerate() {
            row[first + k] = 1.0;
        }
        reflect(reflections, size, first, rows);
    }
    let mut panel = vec![[0.0; COLUMNS]; size];
    for column in (0..size).step_by(COLUMNS) {
        let columns = column..size.min(column + COLUMNS);
        for (held, row) in panel.iter_mut().zip(vectors.chunks_exact(size)) {
            held[..columns.len()].copy_from_slice(&row[columns.clone()]);
        }
        for sweep in sweeps {
            rotate(&mut panel, sweep);
        }
        for (k, row) in order.iter().zip(vectors.chunks_exact_mut(size)) {
            row[columns.clone()].copy_from_slice(&panel[*k][..columns.len()]);
        }
    }
    vectors
}

/// Turns the rows of the identity, from row `first` on, into those of Qᵀ.
#[inline(always)]
fn reflect(reflections: &[f64], size: usize, first: usize, rows: &mut [f64]) {
    for k in first + 1..size {
        let u = &reflections[k * size..][..k];
        // Rows from the k-th on are still zero in the columns of this reflection.
        for x in rows.chunks_exact_mut(size).take(k - first) {
            let share = dot(&x[..k], u);
            add(&mut x[..k], -share, u);
        }
    }
}

/// Turns rows as QL turned the matrix.
#[inline(always)]
fn rotate(rows: &mut [[f64; COLUMNS]], Sweep { last, rotations }: &Sweep) {
    let mut lower = rows[*last];
    for ([c, s], k) in rotations.iter().zip((0..*last).rev()) {
        let upper = rows[k];
        let turned = &mut rows[k + 1];
        for j in 0..COLUMNS {
            turned[j] = s * upper[j] + c * lower[j];
            lower[j] = c * upper[j] - s * lower[j];
        }
    }
    rows[last - rotations.len()] = lower;
}

/// Number of partial sums in a product of two rows, whatever the processor's width.
const PARTS: usize = 8;

/// Reduces a matrix A to a tridiagonal one, `T = Qᵀ A Q`; reads the lower triangle of the square `matrix`. Returns the
/// diagonal of T, the numbers beside it, and the reflections `I − u uᵀ` that make Q: row k begins with the k numbers u,
/// all zero for no reflection.
#[inline(always)]
fn reduce(size: usize, mut matrix: Vec<f64>) -> ([Vec<f64>; 2], Vec<f64>) {
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
            let (u_j, p_j) = (u[j], p[j]);
            for ((a, u), p) in row[..=j].iter_mut().zip(&*u).zip(&*p) {
                *a -= u_j * p + p_j * u;
            }
        }
    }
    let diagonal = (0..size).map(|k| matrix[k * size + k]).collect();
    ([diagonal, off_diagonal], matrix)
}

/// Replaces a row by the u of the reflection `I − u uᵀ` that zeroes all its numbers but the last; returns the new last
/// number.
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

/// `p = A u`, from the lower triangle of A.
#[inline(always)]
fn multiply(matrix: &[f64], size: usize, u: &[f64], p: &mut [f64]) {
    p.fill(0.0);
    for (j, row) in matrix.chunks_exact(size).enumerate() {
        let below = dot(&row[..j], &u[..j]);
        add(&mut p[..j], u[j], &row[..j]);
        p[j] = below + row[j] * u[j];
    }
}

/// Product of two rows, summed in a fixed order.
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

/// Limit of QL sweeps for one eigenvalue; two are usual.
const MOST_SWEEPS: usize = 60;

/// Plane rotations of neighbouring rows from the last of them upwards.
struct Sweep {
    /// Lower row of the first rotation.
    last: usize,
    /// Cosine and sine of each rotation: `upper ← c upper − s lower, lower ← s upper + c lower`.
    rotations: Vec<[f64; 2]>,
}

/// Makes a tridiagonal matrix diagonal in place, by the implicit QL iteration. Returns the rotations, or `None` if the
/// iteration does not converge.
fn diagonalise(diagonal: &mut [f64], off_diagonal: &mut [f64]) -> Option<Vec<Sweep>> {
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

/// Last row of the block of `first`: beyond it the off-diagonal is round-off.
fn end_of_block(diagonal: &[f64], off_diagonal: &[f64], first: usize) -> usize {
    let is_cut = |k: usize| {
        let size = diagonal[k].abs() + diagonal[k + 1].abs();
        off_diagonal[k].abs() <= f64::EPSILON * size
    };
    (first..off_diagonal.len()).find(|k| is_cut(*k)).unwrap_or(off_diagonal.len())
}

/// One QL step on the rows `first ..= last`. The shift is the eigenvalue of the first 2×2 block nearest to the first
/// diagonal number.
fn sweep(d: &mut [f64], e: &mut [f64], first: usize, last: usize) -> Sweep {
    let half_gap = (d[first + 1] - d[first]) / (2.0 * e[first]);
    let root = libm::hypot(half_gap, 1.0).copysign(half_gap);
    let mut g = d[last] - d[first] + e[first] / (half_gap + root);
    let (mut c, mut s, mut p) = (1.0, 1.0, 0.0);
    let mut rotations = Vec::with_capacity(last - first);
    if let Some(beyond) = e.get_mut(last) {
        // Below round-off, otherwise this block would not end here.
        *beyond = 0.0;
    }
    for k in (first..last).rev() {
        let (f, b) = (s * e[k], c * e[k]);
        let r = libm::hypot(f, g);
        if k + 1 < last {
            e[k + 1] = r;
        }
        if r == 0.0 {
            // The block falls apart here; the next step treats the parts.
            d[k + 1] -= p;
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
    Sweep { last, rotations }
}

#[cfg(test)]
mod tests {
    use faer::linalg::solvers::SelfAdjointEigen;
    use faer::{Mat, Side};

    use super::*;

    /// Rows of the lower triangle in a square; NaN elsewhere shows a wrong read.
    fn lower(size: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let square = (0..size * size).map(|at| (at / size, at % size));
        square.map(|(row, k)| if k <= row { entry(row, k) } else { f64::NAN }).collect()
    }

    /// Bending of a cantilever at `row` by a force at `column` of `size` stations.
    fn beam(size: usize) -> impl Fn(usize, usize) -> f64 {
        move |row, k| {
            let station = |k: usize| (k + 1) as f64 / size as f64;
            let (near, far) = (station(row.min(k)), station(row.max(k)));
            near * near * (3.0 * far - near)
        }
    }

    /// Patternless numbers between -1 and 1.
    fn scattered(row: usize, column: usize) -> f64 {
        let mixed = (row * 1_000_003 + column * 7_919 + 17) % 65_537;
        (mixed * mixed % 65_537) as f64 / 32_768.0 - 1.0
    }

    /// Every eigenvalue at least twice, with rows of zeros.
    fn repeated(row: usize, column: usize) -> f64 {
        if row == column && row % 4 != 3 { (row % 3) as f64 } else { 0.0 }
    }

    /// Graded entries, from about 1 down to numbers whose squares underflow.
    fn graded(row: usize, column: usize) -> f64 {
        let power = |k: usize| libm::exp10(-5.0 * k as f64);
        (2.0 + scattered(row, column)) * power(row.min(60)) * power(column.min(60))
    }

    fn check(name: &str, size: usize, entry: impl Fn(usize, usize) -> f64) {
        let symmetric = |row: usize, k: usize| entry(row.max(k), row.min(k));
        let matrix = Mat::from_fn(size, size, symmetric);
        let reference = SelfAdjointEigen::new(matrix.as_ref(), Side::Lower).unwrap();
        let own = SymmetricEigen::new(size, lower(size, &entry)).unwrap();
        let norm =
            reference.S().column_vector().iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
        for k in 0..size {
            let error = (own.values[k] - reference.S()[k]).abs() / norm;
            assert!(error < 2e-14, "{name} of {size}: value {k} {error:e}");
        }
        let vectors = Mat::from_fn(size, size, |row, k| own.vector(k)[row]);
        let product = vectors.transpose() * &vectors;
        let turned = &matrix * &vectors;
        for (row, k) in (0..size).flat_map(|row| (0..size).map(move |k| (row, k))) {
            let unit = if row == k { 1.0 } else { 0.0 };
            let error = (product[(row, k)] - unit).abs();
            assert!(error < 2e-14, "{name} of {size}: vectors {row} and {k} {error:e}");
            let left = (turned[(row, k)] - own.values[k] * vectors[(row, k)]).abs() / norm;
            assert!(left < 2e-14, "{name} of {size}: vector {k} leaves {left:e}");
        }
    }

    #[test]
    fn eigenvalues_and_vectors_are_those_of_an_independent_solver() {
        for size in [1, 2, 3, 7, 8, 17, 33, 100] {
            check("beam", size, beam(size));
            check("scattered", size, scattered);
            check("repeated", size, repeated);
            check("graded", size, graded);
        }
    }

    #[test]
    fn every_width_of_vectors_gives_the_same_bits() {
        let size = 75;
        let matrix = lower(size, scattered);
        let narrow = Solve { size, matrix: matrix.clone() }.with_simd(pulp::Scalar);
        assert!(narrow.is_some() && narrow == SymmetricEigen::new(size, matrix));
    }

    #[test]
    fn numbers_that_are_not_finite_have_no_eigenvalues() {
        for wrong in [f64::NAN, f64::INFINITY] {
            for place in [(0, 0), (5, 2), (9, 9)] {
                let entry = |row, k| if (row, k) == place { wrong } else { scattered(row, k) };
                assert_eq!(SymmetricEigen::new(10, lower(10, entry)), None, "{wrong} {place:?}");
            }
        }
    }
}
