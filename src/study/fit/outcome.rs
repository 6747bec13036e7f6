//! Result of a fit: values with standard errors, misfits, and combinations that the data do not determine.

use std::fmt;

use faer::Mat;
use serde::Serialize;

use super::decay::Decay;
use super::measurements::{Measurements, Prediction};
use super::misfits::{DELAY_UNIT, Misfit, Misfits, RecordMisfit, Residual};
use super::record::Record;
use super::response::{Overlay, ResponseMisfit};
use crate::text::significant;

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
fn correlation(covariance: &Mat<f64>, count: usize) -> Vec<Vec<f64>> {
    let size = |k: usize| covariance[(k, k)].sqrt();
    let share = |k: usize, j: usize| covariance[(k, j)] / (size(k) * size(j));
    (0..count).map(|k| (0..count).map(|j| share(k, j)).collect()).collect()
}

/// Values from another start that fit the measurements about as well as the best ones. Their sum of squares is less
/// than 3.84 above the least, in units of the variance of the residuals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OtherAnswer {
    /// Factors on the free values in their order.
    pub factors: Vec<f64>,
    /// Sum of squared residuals.
    pub sum_of_squares: f64,
}

/// Share of a direction below which a value takes no part in it.
const NO_PART: f64 = 1e-4;

/// Relative misfit assumed if neither uncertainties nor differences determine it.
pub(super) const USUAL_MISFIT: f64 = 0.02;

/// Reason why free values are not determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Openness {
    /// Every measured value stays the same.
    Exact,
    /// The measured values change by less than their uncertainty, over more than a factor of ten.
    Uncertain,
}

/// Free values that can change together without a change of the measured values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Undetermined {
    /// Degree to which the measured values stay.
    pub openness: Openness,
    /// Paths, each with its power of the common factor.
    pub powers: Vec<(String, f64)>,
}

impl fmt::Display for Undetermined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let power = |power: f64| match significant(power, 3).as_str() {
            "1" | "1.00" => "c".to_owned(),
            text => format!("c^{text}"),
        };
        let paths: Vec<&str> = self.powers.iter().map(|(path, _)| path.as_str()).collect();
        if let [path] = paths[..] {
            let why = match self.openness {
                Openness::Exact => "no measured value depends on it",
                Openness::Uncertain => "it may change by more than a factor of ten",
            };
            return write!(f, "the data do not determine {path}: {why}");
        }
        let factors: Vec<String> =
            self.powers.iter().map(|(path, p)| format!("{path} times {}", power(*p))).collect();
        write!(
            f,
            "the data do not determine {}: with {} every measured value stays {}",
            paths.join(", "),
            factors.join(", "),
            match self.openness {
                Openness::Exact => "the same",
                Openness::Uncertain => "within its uncertainty",
            }
        )
    }
}

/// Results of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitOutcome {
    /// The free values in their order.
    pub values: Vec<FittedValue>,
    /// Other values that fit about as well, best first.
    pub other_answers: Vec<OtherAnswer>,
    /// The measurements in their order.
    pub residuals: Vec<Residual>,
    /// The responses in their order.
    pub responses: Vec<ResponseMisfit>,
    /// The records in their order.
    pub records: Vec<RecordMisfit>,
    /// Decays behind some of the measurements.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub decays: Vec<Decay>,
    /// Correlation of the free values, row by row; empty if a value is not determined.
    pub correlation: Vec<Vec<f64>>,
    /// Combinations of free values that the data do not determine.
    pub undetermined: Vec<Undetermined>,
    /// Root mean square of the relative misfits.
    pub rms_misfit: f64,
    /// Sum of squared ratios of differences to uncertainties; `None` without uncertainties.
    pub chi_squared: Option<f64>,
    /// Measured numbers minus free values.
    pub degrees_of_freedom: usize,
    /// True if another start than the file's values led to a better fit.
    pub is_from_other_start: bool,
    /// Iterations of the final descent.
    pub iterations: usize,
    /// End of the iteration from each start, the file's values first.
    pub starts: Vec<StartEnd>,
    /// Measured and fitted curves over frequency or time.
    #[serde(skip)]
    pub overlays: Vec<Overlay>,
    /// Reason to distrust the link; `None` for a credible link.
    pub misfit: Option<Misfit>,
}

/// A start, and the end of its iteration on a mesh that is exact to 1e-5.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartEnd {
    /// Factors on the free values at the start.
    pub from: Vec<f64>,
    /// Factors at the end; `None` if the start makes no link with the measured modes.
    pub to: Option<Vec<f64>>,
    /// Sum of squared residuals at the end.
    pub sum_of_squares: Option<f64>,
    /// Number of iterations.
    pub iterations: usize,
}

/// Course of the iterations.
#[derive(Debug, Clone)]
pub(super) struct Course {
    pub(super) is_from_other_start: bool,
    pub(super) has_settled: bool,
    pub(super) iterations: usize,
    pub(super) starts: Vec<StartEnd>,
}

impl FitOutcome {
    pub(super) fn of(
        measurements: &Measurements,
        free: &[Free],
        x: &[f64],
        predicted: Option<&Prediction>,
        jacobian: &Mat<f64>,
        course: Course,
    ) -> Self {
        let mut misfits = Misfits::of(measurements, free.len(), predicted);
        let scale = misfits.scale();
        let spread = Spread::of(jacobian, measurements.weight(), scale.unwrap_or(USUAL_MISFIT));
        let paths = free.iter().map(|free| free.path.clone());
        let late: Vec<&Record> = measurements.records_with_free_delay().collect();
        let delays = late.iter().map(|record| format!("the delay of {}", record.name()));
        let undetermined = Undetermined::all(&spread, &paths.chain(delays).collect::<Vec<_>>());
        let covariance = undetermined.is_empty().then(|| spread.covariance());
        let reach = misfits.reach_95();
        let values = free.iter().zip(x).enumerate().map(|(k, (free, x))| {
            let error = scale.zip(covariance.as_ref()).map(|(scale, c)| scale * c[(k, k)].sqrt());
            FittedValue::of(free, *x, error, reach)
        });
        let values: Vec<FittedValue> = values.collect();
        misfits.set_delay_errors(scale.zip(covariance.as_ref()), free.len());
        let correlation = covariance.map(|all| correlation(&all, free.len())).unwrap_or_default();
        let at_bound = values.iter().find(|value| value.is_at_bound);
        let at_bound =
            at_bound.map(|value| Misfit::Bound { path: value.path.clone(), factor: value.factor });
        let mut delays = x[free.len()..].iter().zip(&late);
        let longest = delays.find_map(|(delay, record)| {
            let longest = record.longest_delay();
            let is_longest = delay.abs() * DELAY_UNIT >= longest as f64;
            is_longest.then(|| Misfit::Late { name: record.name().to_owned(), longest })
        });
        let at_bound = at_bound.or(longest);
        let open = (!undetermined.is_empty()).then_some(Misfit::Undetermined);
        let unsettled = (!course.has_settled).then_some(Misfit::Unsettled);
        let misfit = match misfits.judged() {
            // The bound explains why the rest does not fit.
            Some(Misfit::Contradiction { .. }) if at_bound.is_some() => at_bound,
            judged => judged.or(at_bound).or(open).or(unsettled),
        };
        Self {
            chi_squared: misfits.has_uncertainties.then_some(misfits.sum),
            degrees_of_freedom: misfits.degrees_of_freedom,
            values,
            other_answers: Vec::new(),
            correlation,
            undetermined,
            rms_misfit: misfits.rms,
            is_from_other_start: course.is_from_other_start,
            iterations: course.iterations,
            starts: course.starts,
            overlays: predicted.map(|found| measurements.overlays(found)).unwrap_or_default(),
            misfit,
            residuals: misfits.residuals,
            responses: misfits.responses,
            records: misfits.records,
            decays: measurements.decays().to_vec(),
        }
    }
}

impl FitOutcome {
    /// Makes a fit with several answers one that is not to be trusted.
    pub fn refuse_several(&mut self) {
        let others = self.other_answers.len();
        if others > 0 && self.misfit.is_none() {
            self.misfit = Some(Misfit::Ambiguous { others });
        }
    }
}

impl Undetermined {
    /// All combinations that are not determined; those without any effect come first.
    fn all(spread: &Spread, names: &[String]) -> Vec<Self> {
        let along = |openness| {
            let directions = spread.open(openness == Openness::Exact).into_iter();
            directions.map(move |direction| Self::along(&direction, names, openness))
        };
        along(Openness::Exact).chain(along(Openness::Uncertain)).collect()
    }

    /// The values with a part in a direction.
    fn along(direction: &[f64], names: &[String], openness: Openness) -> Self {
        let parts = names.iter().zip(direction).filter(|(_, power)| power.abs() > NO_PART);
        let powers = parts.map(|(name, power)| (name.clone(), *power)).collect();
        Self { openness, powers }
    }
}
