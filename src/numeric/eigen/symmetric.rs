#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use pulp::{Arch, Simd, WithSimd};

use super::tridiagonal::{Reduce, Sweep, Tridiagonal, diagonalise};

/// Rows of Qᵀ that each reflection is applied to before the next one is fetched.
const ROWS: usize = 16;

/// Columns of the eigenvectors that are turned by all rotations together: so many stay near the
/// processor.
const COLUMNS: usize = 32;

/// Eigenvalues and orthonormal eigenvectors of a symmetric matrix.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SymmetricEigen {
    /// Ascending.
    pub(crate) values: Vec<f64>,
    /// One for each value, row by row.
    vectors: Vec<f64>,
}

impl SymmetricEigen {
    /// Solves for all eigenvalues of a square matrix, row by row, of which the lower triangle is
    /// read; none where the numbers are not finite.
    ///
    /// # Panics
    /// If the matrix has not `size` squared numbers.
    pub(crate) fn new(size: usize, matrix: Vec<f64>) -> Option<Self> {
        assert_eq!(matrix.len(), size * size, "a matrix of {size} rows");
        let rows = matrix.chunks_exact(size.max(1)).enumerate();
        if !rows.flat_map(|(k, row)| &row[..=k]).all(|x| x.is_finite()) {
            return None;
        }
        let arch = Arch::new();
        let tridiagonal = arch.dispatch(Reduce { size, matrix });
        let mut values = tridiagonal.diagonal.clone();
        let sweeps = diagonalise(&mut values, &mut tridiagonal.off_diagonal.clone())?;
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        let vectors = arch.dispatch(Vectors { tridiagonal, sweeps, order: &order });
        let values = order.iter().map(|k| values[*k]).collect();
        Some(Self { values, vectors })
    }

    /// The eigenvector of the k-th value.
    pub(crate) fn vector(&self, k: usize) -> &[f64] {
        let size = self.values.len();
        &self.vectors[k * size..][..size]
    }
}

/// Eigenvectors as rows: Qᵀ turned by the rotations of QL, its rows then put in order.
struct Vectors<'a> {
    tridiagonal: Tridiagonal,
    sweeps: Vec<Sweep>,
    order: &'a [usize],
}

impl WithSimd for Vectors<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        let size = self.order.len();
        let mut vectors = vec![0.0; size * size];
        for (block, rows) in vectors.chunks_mut(ROWS * size.max(1)).enumerate() {
            let first = block * ROWS;
            for (k, row) in rows.chunks_exact_mut(size).enumerate() {
                row[first + k] = 1.0;
            }
            self.tridiagonal.turn(first, rows);
        }
        let mut panel = vec![[0.0; COLUMNS]; size];
        for column in (0..size).step_by(COLUMNS) {
            let columns = column..size.min(column + COLUMNS);
            for (held, row) in panel.iter_mut().zip(vectors.chunks_exact(size)) {
                held[..columns.len()].copy_from_slice(&row[columns.clone()]);
            }
            for sweep in &self.sweeps {
                rotate(&mut panel, sweep);
            }
            for (k, row) in self.order.iter().zip(vectors.chunks_exact_mut(size)) {
                row[columns.clone()].copy_from_slice(&panel[*k][..columns.len()]);
            }
        }
        vectors
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

#[cfg(test)]
mod tests {
    use faer::linalg::solvers::SelfAdjointEigen;
    use faer::{Mat, Side};

    use super::*;

    /// Rows of the lower triangle, in a square of numbers that must not be read.
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

    /// Numbers without order between -1 and 1.
    fn scattered(row: usize, column: usize) -> f64 {
        let mixed = (row * 1_000_003 + column * 7_919 + 17) % 65_537;
        (mixed * mixed % 65_537) as f64 / 32_768.0 - 1.0
    }

    /// Every eigenvalue twice or more, and rows of nothing.
    fn repeated(row: usize, column: usize) -> f64 {
        if row == column && row % 4 != 3 { (row % 3) as f64 } else { 0.0 }
    }

    /// Seventeen powers of ten of each other, down to numbers whose squares underflow.
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
        let wide = Arch::new().dispatch(Reduce { size, matrix: matrix.clone() });
        let narrow = Reduce { size, matrix: matrix.clone() }.with_simd(pulp::Scalar);
        assert!(wide.diagonal == narrow.diagonal && wide.off_diagonal == narrow.off_diagonal);
        let (mut d, mut e) = (narrow.diagonal.clone(), narrow.off_diagonal.clone());
        let sweeps = diagonalise(&mut d, &mut e).unwrap();
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|a, b| d[*a].total_cmp(&d[*b]));
        let narrow = Vectors { tridiagonal: narrow, sweeps, order: &order };
        let vectors = narrow.with_simd(pulp::Scalar);
        assert!(vectors == SymmetricEigen::new(size, matrix).unwrap().vectors);
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
