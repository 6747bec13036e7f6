//! Free values of a link file, before and after a fit, with the directions and standard errors from the derivatives of
//! the residuals.

use faer::Mat;
use serde::Serialize;

/// Distance from a bound, in the logarithm, within which a value lies on it.
const AT_BOUND: f64 = 1e-9;

/// Singular value over the size of the Jacobian below which a direction is not determined: the derivatives are exact to
/// about 1e-9.
const UNDETERMINED: f64 = 1e-7;

/// Standard error, in the logarithm, above which a direction is not determined either: a factor of ten.
const UNKNOWN: f64 = std::f64::consts::LN_10;

/// A free value of the link file.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Path in the link file.
    pub path: String,
    /// Smallest and largest factor on the file's value.
    pub factors: [f64; 2],
    /// The file's value, if the path names a single one.
    pub number: Option<FreeNumber>,
}

/// A value as written in its link file.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeNumber {
    /// The number.
    pub value: f64,
    /// Unit; empty for a number in SI.
    pub unit: String,
}

/// A replaced value of a link file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Replaced {
    /// Path of the value.
    pub path: String,
    /// Text before.
    pub before: String,
    /// Text after.
    pub after: String,
}

/// A free value, fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedValue {
    /// Path in the link file.
    pub path: String,
    /// Factor on the file's value.
    pub factor: f64,
    /// The file's value, if the path names a single one.
    pub before: Option<f64>,
    /// The fitted value, if the path names a single one.
    pub after: Option<f64>,
    /// Unit of both; empty for numbers in SI.
    pub unit: Option<String>,
    /// Smallest and largest allowed factor.
    pub bounds: [f64; 2],
    /// Standard error over the value; `None` if unknown.
    pub relative_standard_error: Option<f64>,
    /// Factors on the fitted value that enclose the true value in 95 of 100 cases, extended by all other answers; from
    /// Student's distribution if the standard error comes from the differences. `None` if unknown.
    pub relative_interval_95: Option<[f64; 2]>,
    /// True if it lies on one of its bounds.
    pub is_at_bound: bool,
}

impl FittedValue {
    /// A value at the logarithm `x` of its factor; its logarithm lies within `reach` standard errors in 95 of 100
    /// cases.
    pub(super) fn of(free: &Free, x: f64, error: Option<f64>, reach: f64) -> Self {
        let number = free.number.as_ref();
        let factor = libm::exp(x);
        let interval = error.map(|error| [-reach, reach].map(|reach| libm::exp(reach * error)));
        Self {
            path: free.path.clone(),
            factor,
            before: number.map(|number| number.value),
            after: number.map(|number| factor * number.value),
            unit: number.map(|number| number.unit.clone()),
            bounds: free.factors,
            relative_standard_error: error,
            relative_interval_95: interval,
            is_at_bound: free.factors.iter().any(|f| (libm::log(*f) - x).abs() < AT_BOUND),
        }
    }
}

/// Singular values and directions of the Jacobian.
pub(super) struct Spread {
    /// Singular value of each direction; 0 for a direction without effect on any row.
    values: Vec<f64>,
    /// Directions in the free values, row by row.
    directions: Mat<f64>,
    /// Singular values above which a direction changes the measured values at all, and by more than their uncertainty.
    least: [f64; 2],
}

impl Spread {
    /// `weight` is the size of the Jacobian if each residual's value followed one free value; `scale` is the standard
    /// deviation of the residuals, 0 if unknown.
    pub(super) fn of(jacobian: &Mat<f64>, weight: f64, scale: f64) -> Self {
        // At least as many rows as columns, so that every direction has a singular value.
        let columns = jacobian.ncols();
        let mut square = Mat::zeros(jacobian.nrows().max(columns), columns);
        square.get_mut(..jacobian.nrows(), ..).copy_from(jacobian);
        let svd = square.thin_svd();
        let none = (vec![0.0; columns], Mat::identity(columns, columns));
        let (values, directions) = svd.map_or(none, |svd| {
            (svd.S().column_vector().iter().copied().collect(), svd.V().transpose().to_owned())
        });
        let largest = values.iter().copied().fold(weight, f64::max);
        Self { values, directions, least: [UNDETERMINED * largest, scale / UNKNOWN] }
    }

    /// Basis of the directions that change no measured value, if `is_exact`, or else of those that change them by less
    /// than their uncertainty. In each vector the largest part is 1 and belongs to a value in which the other vectors
    /// have no part.
    pub(super) fn open(&self, is_exact: bool) -> Vec<Vec<f64>> {
        let [nothing, little] = self.least;
        let is_open = |value: f64| if is_exact { value < nothing } else { value < little };
        let is_left = |value: f64| is_exact || value >= nothing;
        let open =
            (0..self.values.len()).filter(|k| is_open(self.values[*k]) && is_left(self.values[*k]));
        let mut rows: Vec<Vec<f64>> =
            open.map(|k| self.directions.row(k).iter().copied().collect()).collect();
        for pivot in 0..rows.len() {
            let sizes = rows[pivot].iter().map(|part| part.abs()).enumerate();
            // The first of equals, so that round-off does not decide.
            let largest =
                sizes.fold(
                    (0, 0.0),
                    |best, (k, size)| {
                        if size > 1.000_001 * best.1 { (k, size) } else { best }
                    },
                );
            let part = rows[pivot][largest.0];
            rows[pivot].iter_mut().for_each(|value| *value /= part);
            let own = rows[pivot].clone();
            for (k, row) in rows.iter_mut().enumerate() {
                if k != pivot {
                    let share = row[largest.0];
                    row.iter_mut().zip(&own).for_each(|(value, own)| *value -= share * own);
                }
            }
        }
        rows
    }

    /// (JᵀJ)⁻¹.
    pub(super) fn covariance(&self) -> Mat<f64> {
        let size = self.values.len();
        let v = &self.directions;
        let term = |row, column, k: usize| v[(k, row)] * v[(k, column)] / self.values[k].powi(2);
        Mat::from_fn(size, size, |row, column| (0..size).map(|k| term(row, column, k)).sum())
    }
}

/// Correlation of each pair of the first `count` values.
pub(super) fn correlation(covariance: &Mat<f64>, count: usize) -> Vec<Vec<f64>> {
    let size = |k: usize| covariance[(k, k)].sqrt();
    let share = |k: usize, j: usize| covariance[(k, j)] / (size(k) * size(j));
    (0..count).map(|k| (0..count).map(|j| share(k, j)).collect()).collect()
}
