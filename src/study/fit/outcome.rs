//! Result of a fit: values with standard errors, misfits, and combinations that the data do not determine.

use std::fmt;

use faer::Mat;
use serde::Serialize;

use super::decay::Decay;
use super::measurements::{Measurements, Prediction};
use super::misfits::{DELAY_UNIT, Misfit, Misfits, RecordMisfit, Residual};
use super::record::Record;
use super::response::{Overlay, ResponseMisfit};
use super::value::{FittedValue, Free, Spread, correlation};

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
        let misfits = Misfits::of(measurements, free.len(), predicted);
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
        let mut misfits = misfits;
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
