//! Free values of a link file, before and after a fit.

use serde::Serialize;

/// Distance from a bound, in the logarithm, at which a value lies on it.
const AT_BOUND: f64 = 1e-9;

/// A value of the link file that is free.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Its path in the link file.
    pub path: String,
    /// Smallest and largest factor on the file's value.
    pub factors: [f64; 2],
    /// The file's value, where the path names one alone.
    pub number: Option<FreeNumber>,
}

/// A value as its link file writes it.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeNumber {
    /// The number.
    pub value: f64,
    /// Its unit; empty for a number without one, which is in SI.
    pub unit: String,
}

/// A value that was replaced in a link file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Replaced {
    /// Its path.
    pub path: String,
    /// Its text before.
    pub before: String,
    /// Its text now.
    pub after: String,
}

/// A free value, fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedValue {
    /// Its path in the link file.
    pub path: String,
    /// Factor on the file's value.
    pub factor: f64,
    /// The file's value, where the path names one alone.
    pub before: Option<f64>,
    /// The same, fitted.
    pub after: Option<f64>,
    /// Unit of both; empty without one, as of SI.
    pub unit: Option<String>,
    /// Smallest and largest factor that were allowed.
    pub bounds: [f64; 2],
    /// Standard error over the value; none where it is not known.
    pub relative_standard_error: Option<f64>,
    /// Factors on the fitted value between which the true one lies in 95 of 100 cases, by Student's
    /// distribution where the standard error is that of the differences; none where it is not known.
    pub relative_interval_95: Option<[f64; 2]>,
    /// True if it lies on one of its bounds.
    pub is_at_bound: bool,
}

impl FittedValue {
    /// A value at the logarithm `x` of its factor; its logarithm lies within `reach` standard errors in 95 of
    /// 100 cases.
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
