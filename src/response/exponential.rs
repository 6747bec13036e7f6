use nalgebra::DMatrix;

/// Norm up to which a matrix is put into the series.
const LARGEST_NORM: f64 = 1.0;

/// e to the power of a square matrix, by its series for a 2ˢ-th part of it and s squarings.
///
/// The library's own needs the system's logarithm and products that each processor rounds in its own
/// way: the same inputs would give other bytes elsewhere.
pub(super) fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let norm = |matrix: &DMatrix<f64>| {
        matrix.row_iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max)
    };
    let (mut part, mut squarings) = (matrix.clone(), 0);
    // A matrix that holds no numbers is not made smaller.
    while norm(&part) > LARGEST_NORM && squarings < 1100 {
        part *= 0.5;
        squarings += 1;
    }
    let size = matrix.nrows();
    let mut sum = DMatrix::identity(size, size);
    let mut term = sum.clone();
    let mut k = 0.0;
    while norm(&term) > f64::EPSILON * f64::EPSILON {
        k += 1.0;
        term = &term * &part / k;
        sum += &term;
    }
    (0..squarings).fold(sum, |root, _| &root * &root)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest_difference(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
        (a - b).iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    #[test]
    fn a_rotation_turns_by_its_angle() {
        for angle in [0.0, 1e-9, 0.7, 3.0, 40.0_f64] {
            let found = exponential(&DMatrix::from_row_slice(2, 2, &[0.0, angle, -angle, 0.0]));
            let (sine, cosine) = angle.sin_cos();
            let exact = DMatrix::from_row_slice(2, 2, &[cosine, sine, -sine, cosine]);
            // Each squaring doubles the error: an angle is known to its own round-off only.
            let error = largest_difference(&found, &exact);
            assert!(error < 2e-15 * angle.max(1.0), "{angle}: {error:e}");
        }
    }

    #[test]
    fn a_nilpotent_matrix_gives_the_powers_of_time() {
        let shift = DMatrix::from_row_slice(3, 3, &[0.0, 3.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0]);
        let exact = DMatrix::from_row_slice(3, 3, &[1.0, 3.0, 4.5, 0.0, 1.0, 3.0, 0.0, 0.0, 1.0]);
        assert!(largest_difference(&exponential(&shift), &exact) < 1e-14);
    }

    /// What reaches a coordinate over many others is tiny, and as exact as all else.
    #[test]
    fn a_chain_of_integrators_gives_every_power_of_time_to_its_last_digits() {
        let time = 0.001_f64;
        let chain =
            DMatrix::from_fn(9, 9, |row, column| if column == row + 1 { time } else { 0.0 });
        let found = exponential(&chain);
        let mut exact = 1.0;
        for k in 0..9 {
            let error = (found[(0, k)] / exact - 1.0).abs();
            assert!(error < 1e-14, "t to the power of {k}: {error:e}");
            exact *= time / (k + 1) as f64;
        }
    }

    #[test]
    fn a_strong_decay_leaves_nothing_and_a_matrix_of_no_numbers_ends() {
        let decay = DMatrix::from_diagonal_element(2, 2, -60.0);
        let exact = DMatrix::from_diagonal_element(2, 2, (-60.0_f64).exp());
        assert!(largest_difference(&exponential(&decay), &exact) < 1e-12 * exact[(0, 0)]);
        let nothing = DMatrix::from_diagonal_element(2, 2, f64::NAN);
        assert!(exponential(&nothing).iter().any(|x| x.is_nan()));
    }
}
