//! What a fit says: values with standard errors, misfits, and what the data do not determine.

use std::fmt;

use nalgebra::DMatrix;
use serde::Serialize;
use thiserror::Error;

use super::alignment::LONGEST_DELAY;
use super::measurement::Measured;
use super::measurements::{Measurements, Prediction};
use super::overlay::Overlay;
use super::record::Record;
use super::record_misfit::RecordMisfit;
use super::response::ResponseMisfit;
use super::spread::{Spread, correlation};
use super::value::{FittedValue, Free};
use crate::numeric::{NORMAL_95, student_95};

/// Samples of delay that weigh as a factor of e on a free value: within its bounds each may go about as far.
pub(super) const DELAY_UNIT: f64 = 15.0;

/// Share of a direction below which a value takes no part in it.
const NO_PART: f64 = 1e-4;

/// Uncertainties beyond which a measurement is an outlier.
const OUTLIER: f64 = 3.0;

/// Root mean square of the relative misfits of frequencies and responses above which no measurement fits.
const LARGEST_MISFIT: f64 = 0.25;

/// Relative misfit that is taken for usual where neither uncertainties nor differences tell it.
const USUAL_MISFIT: f64 = 0.02;

/// Standard deviations of the sum of squares beyond which it is no chance: one in ten thousand.
const NO_CHANCE: f64 = 3.72;

/// A measurement beside its prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Residual {
    /// The measurement.
    #[serde(flatten)]
    pub measured: Measured,
    /// The fitted link's value.
    pub fitted: f64,
    /// Fitted over measured value, less 1.
    pub relative: f64,
    /// The difference over the measurement's uncertainty, if that is known.
    pub uncertainties: Option<f64>,
    /// True if it lies beyond three uncertainties.
    pub is_outlier: bool,
}

/// Why free values are not determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Openness {
    /// Every measured value stays the same.
    Exact,
    /// The measured values change by less than their uncertainty, over more than a factor of ten.
    Uncertain,
}

/// Free values that may change together while the measured values stay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Undetermined {
    /// How well the measured values stay.
    pub openness: Openness,
    /// Paths, each with the power of the common factor that it may be multiplied by.
    pub powers: Vec<(String, f64)>,
}

impl fmt::Display for Undetermined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let power = |power: f64| match crate::text::significant(power, 3).as_str() {
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

/// Why a fitted link is not to be believed.
#[derive(Debug, Clone, PartialEq, Serialize, Error)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Misfit {
    /// The data do not determine all free values.
    #[error("no link is written: the free values are not all determined")]
    Undetermined,
    /// The sum of squares is larger than the uncertainties explain.
    #[error(
        "no link is written: no values of the free keys bring all measurements within their uncertainties \
         (chi² = {chi_squared:.3e} with {degrees_of_freedom} degrees of freedom)"
    )]
    Contradiction {
        /// Sum of the squared residuals over uncertainties.
        chi_squared: f64,
        /// Measurements less free values.
        degrees_of_freedom: usize,
    },
    /// A free value wants to leave its bounds.
    #[error(
        "no link is written: {path} lies on its bound, {} times the file's value",
        crate::text::significant(*factor, 4)
    )]
    Bound {
        /// Its path.
        path: String,
        /// The bound, as a factor on the file's value.
        factor: f64,
    },
    /// The delay of a record is the longest that is looked for.
    #[error(
        "no link is written: the delay of {name} is the longest that is looked for, {LONGEST_DELAY} samples"
    )]
    Late {
        /// Its file.
        name: String,
    },
    /// The iteration has not come to an end.
    #[error("no link is written: the sum of squares still falls after the last iteration")]
    Unsettled,
    /// The relative misfits are too large for measurements of this link.
    #[error(
        "no link is written: with the best values the link is still {:.0} % off the measurements (root mean \
         square)",
        100.0 * rms
    )]
    Far {
        /// Their root mean square.
        rms: f64,
    },
}

/// A fitted link's numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitOutcome {
    /// The free values in their order.
    pub values: Vec<FittedValue>,
    /// The measurements in their order.
    pub residuals: Vec<Residual>,
    /// The responses in their order.
    pub responses: Vec<ResponseMisfit>,
    /// The records in their order.
    pub records: Vec<RecordMisfit>,
    /// Correlation of the free values, row by row; empty where a value is not determined.
    pub correlation: Vec<Vec<f64>>,
    /// Combinations of free values that the data do not determine.
    pub undetermined: Vec<Undetermined>,
    /// Root mean square of the relative misfits.
    pub rms_misfit: f64,
    /// Sum of the squared differences over their uncertainties; none without uncertainties.
    pub chi_squared: Option<f64>,
    /// Measured numbers less free values.
    pub degrees_of_freedom: usize,
    /// True if another start than the file's own values led to a better fit.
    pub is_from_other_start: bool,
    /// Iterations of the final descent.
    pub iterations: usize,
    /// Where the iteration from each start ended, the file's own values first.
    pub starts: Vec<StartEnd>,
    /// Measured and fitted over frequency or time.
    #[serde(skip)]
    pub overlays: Vec<Overlay>,
    /// Why the link is not to be believed; none where it is.
    pub misfit: Option<Misfit>,
}

/// A start, and where the iteration from it ended, on a mesh that is exact to 1e-5.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartEnd {
    /// Factors on the free values at the start.
    pub from: Vec<f64>,
    /// The same at the end; none where the start makes no link with the measured modes.
    pub to: Option<Vec<f64>>,
    /// Sum of the squared residuals there.
    pub sum_of_squares: Option<f64>,
    /// Iterations.
    pub iterations: usize,
}

/// How the iterations went.
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
        jacobian: DMatrix<f64>,
        course: Course,
    ) -> Self {
        let misfits = Misfits::of(measurements, free.len(), predicted);
        let scale = misfits.scale();
        let spread = Spread::of(jacobian, measurements.weight(), scale.unwrap_or(USUAL_MISFIT));
        let paths = free.iter().map(|free| free.path.clone());
        let late: Vec<&str> = measurements.late().map(Record::name).collect();
        let delays = late.iter().map(|name| format!("the delay of {name}"));
        let undetermined = Undetermined::all(&spread, &paths.chain(delays).collect::<Vec<_>>());
        let covariance = undetermined.is_empty().then(|| spread.covariance());
        let reach = misfits.reach_95();
        let values = free.iter().zip(x).enumerate().map(|(k, (free, x))| {
            let error = scale.zip(covariance.as_ref()).map(|(scale, c)| scale * c[(k, k)].sqrt());
            FittedValue::of(free, *x, error, reach)
        });
        let values: Vec<FittedValue> = values.collect();
        let of_values = covariance.map(|all| all.view((0, 0), (free.len(), free.len())).into());
        let correlation = of_values.as_ref().map(correlation).unwrap_or_default();
        let at_bound = values.iter().find(|value| value.is_at_bound);
        let at_bound =
            at_bound.map(|value| Misfit::Bound { path: value.path.clone(), factor: value.factor });
        let is_longest = |delay: &f64| delay.abs() >= LONGEST_DELAY / DELAY_UNIT;
        let longest = x[free.len()..].iter().position(is_longest);
        let longest = longest.map(|k| Misfit::Late { name: late[k].to_owned() });
        let at_bound = at_bound.or(longest);
        let open = (!undetermined.is_empty()).then_some(Misfit::Undetermined);
        let unsettled = (!course.has_settled).then_some(Misfit::Unsettled);
        let misfit = match misfits.judged() {
            // The bound is why the rest does not fit.
            Some(Misfit::Contradiction { .. }) if at_bound.is_some() => at_bound,
            judged => judged.or(at_bound).or(open).or(unsettled),
        };
        Self {
            chi_squared: misfits.has_uncertainties.then_some(misfits.sum),
            degrees_of_freedom: misfits.degrees_of_freedom,
            values,
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
        }
    }
}

/// How far a fitted link is from the measurements.
struct Misfits {
    residuals: Vec<Residual>,
    responses: Vec<ResponseMisfit>,
    records: Vec<RecordMisfit>,
    has_uncertainties: bool,
    /// Residuals less free values, those of files among them.
    degrees_of_freedom: usize,
    /// Sum of the squared residuals; NaN of a link that lacks a measured mode.
    sum: f64,
    /// Root mean square of the relative misfits.
    rms: f64,
}

impl Misfits {
    fn of(measurements: &Measurements, free: usize, predicted: Option<&Prediction>) -> Self {
        let fitted = |k: usize| predicted.and_then(|predicted| predicted.values[k]);
        let values = measurements.values().iter().enumerate();
        let values = values.map(|(k, one)| Residual::of(*one, fitted(k).unwrap_or(f64::NAN)));
        let residuals: Vec<Residual> = values.collect();
        let misfits = predicted.map(|predicted| &predicted.responses[..]).unwrap_or_default();
        let responses = measurements.responses().iter().zip(misfits);
        let responses = responses.map(|(response, misfits)| ResponseMisfit::of(response, misfits));
        let fits = predicted.map(|predicted| &predicted.records[..]).unwrap_or_default();
        let records = measurements.records().iter().zip(fits);
        let records: Vec<RecordMisfit> =
            records.map(|(record, fit)| RecordMisfit::of(record, fit)).collect();
        let [rows, own] = measurements.rows();
        let scaled = predicted.and_then(|predicted| measurements.residuals(predicted));
        // Damping ratios differ by more without being wrong.
        let is_damping = |residual: &&Residual| residual.measured.observable.is_damping();
        let frequencies = residuals.iter().filter(|residual| !is_damping(residual));
        let of_records = records.iter().flat_map(|record: &RecordMisfit| {
            record.channels.iter().map(|channel| channel.rms.powi(2))
        });
        // A channel of a record counts once.
        let squares: Vec<f64> = frequencies
            .map(|residual| residual.relative.powi(2))
            .chain(misfits.iter().flatten().map(|misfit| misfit * misfit))
            .chain(of_records)
            .collect();
        Self {
            responses: responses.collect(),
            records,
            has_uncertainties: measurements.has_uncertainties(),
            degrees_of_freedom: rows.saturating_sub(free + own),
            sum: scaled.map_or(f64::NAN, |scaled| scaled.iter().map(|r| r * r).sum()),
            rms: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
            residuals,
        }
    }

    /// Standard deviation of a residual: 1 of those over their uncertainty; else what the residuals show, if
    /// they are more than the free values.
    fn scale(&self) -> Option<f64> {
        let shown = || (self.sum / self.degrees_of_freedom as f64).sqrt();
        if self.has_uncertainties { Some(1.0) } else { (self.degrees_of_freedom > 0).then(shown) }
    }

    /// Standard errors within which 95 % of the true values lie: more where the residuals show the scale.
    fn reach_95(&self) -> f64 {
        if self.has_uncertainties { NORMAL_95 } else { student_95(self.degrees_of_freedom) }
    }

    /// Whether the misfits are larger than chance, or than any measurement of this link could leave.
    fn judged(&self) -> Option<Misfit> {
        let Self { rms, sum: chi_squared, degrees_of_freedom, .. } = *self;
        if rms.is_nan() || rms > LARGEST_MISFIT {
            return Some(Misfit::Far { rms });
        }
        if !self.has_uncertainties {
            return None;
        }
        // Wilson and Hilferty: the cube root of χ²/k is nearly normal.
        let k = degrees_of_freedom.max(1) as f64;
        let variance = 2.0 / (9.0 * k);
        let most = k * (1.0 - variance + NO_CHANCE * variance.sqrt()).powi(3);
        let is_chance = chi_squared <= most;
        (!is_chance).then_some(Misfit::Contradiction { chi_squared, degrees_of_freedom })
    }
}

impl Undetermined {
    /// All combinations that are not determined: those that nothing depends on first.
    fn all(spread: &Spread, names: &[String]) -> Vec<Self> {
        let along = |openness| {
            let directions = spread.open(openness == Openness::Exact).into_iter();
            directions.map(move |direction| Self::along(&direction, names, openness))
        };
        along(Openness::Exact).chain(along(Openness::Uncertain)).collect()
    }

    /// The values that take part in a direction.
    fn along(direction: &[f64], names: &[String], openness: Openness) -> Self {
        let parts = names.iter().zip(direction).filter(|(_, power)| power.abs() > NO_PART);
        let powers = parts.map(|(name, power)| (name.clone(), *power)).collect();
        Self { openness, powers }
    }
}

impl Residual {
    fn of(measured: Measured, fitted: f64) -> Self {
        let uncertainties = measured.uncertainty.map(|u| (fitted - measured.value) / u);
        Self {
            measured,
            fitted,
            relative: fitted / measured.value - 1.0,
            uncertainties,
            is_outlier: uncertainties.is_some_and(|u| u.abs() > OUTLIER),
        }
    }
}
