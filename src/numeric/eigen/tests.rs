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
    let norm = reference.S().column_vector().iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
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
