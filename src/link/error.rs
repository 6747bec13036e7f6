use std::fmt;

use thiserror::Error;

use crate::numeric::plain;

/// Characters of a number that is written with all its digits.
const LONGEST_NUMBER: usize = 24;

/// A physical parameter outside its range.
///
/// The text reads `parameter = found unit, but must …`, as every refusal of this program does.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{parameter} = {found}, but {must}")]
pub struct ParameterError {
    /// Dotted path of the parameter, as in the link file: `segments.1.length`.
    pub parameter: String,
    /// What was found, with its unit.
    pub found: String,
    /// What must be.
    pub must: String,
}

impl ParameterError {
    /// Refuses `parameter`, found to be `value` in `unit` (empty for a pure number).
    pub(crate) fn new(
        parameter: impl Into<String>,
        value: impl fmt::Display,
        unit: &str,
        must: impl Into<String>,
    ) -> Self {
        let space = if unit.is_empty() { "" } else { " " };
        let text = value.to_string();
        // One far from 1 has up to three hundred digits.
        let is_long = text.len() > LONGEST_NUMBER;
        let value = if is_long { text.parse().map_or(text, plain) } else { text };
        Self {
            parameter: parameter.into(),
            found: format!("{value}{space}{unit}"),
            must: must.into(),
        }
    }
}

/// Refuses a value that is not finite and above zero.
pub(crate) fn positive(parameter: &str, value: f64, unit: &str) -> Result<(), ParameterError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(ParameterError::new(parameter, value, unit, "must be finite and above 0"))
    }
}

/// Refuses a value that is not finite and zero or above.
pub(crate) fn not_negative(parameter: &str, value: f64, unit: &str) -> Result<(), ParameterError> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(ParameterError::new(parameter, value, unit, "must be finite and at least 0"))
    }
}
