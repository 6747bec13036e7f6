use thiserror::Error;

use crate::numeric::{NotUniform, TimeGrid};

/// Fewest samples of a history.
const MIN_SAMPLES: usize = 4;

/// Why samples over time are no history that a link can be driven with.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum HistoryError {
    /// Fewer than 4 samples, or not as many as there are times.
    #[error(
        "{column} has {samples} samples and time {times}, but both must have equally many, at \
         least 4"
    )]
    Shape {
        /// Name of the column.
        column: &'static str,
        /// Samples of the column.
        samples: usize,
        /// Samples of the time column.
        times: usize,
    },
    /// A sample that is no number, or is infinite.
    #[error("{column} = {found}, but must be a finite number")]
    NotFinite {
        /// Number of the sample, from 0.
        sample: usize,
        /// Name of the column.
        column: &'static str,
        /// What was found.
        found: f64,
    },
    /// A time that does not stand on the uniform grid.
    #[error(transparent)]
    NotUniform(#[from] NotUniform),
}

impl HistoryError {
    /// Number of the sample, from 0, that is to blame, where one is.
    pub fn sample(&self) -> Option<usize> {
        match self {
            Self::NotFinite { sample, .. } | Self::NotUniform(NotUniform { sample, .. }) => {
                Some(*sample)
            }
            Self::Shape { .. } => None,
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NotUniform(error) => Some(error.hint()),
            Self::Shape { .. } | Self::NotFinite { .. } => None,
        }
    }
}

/// The uniform grid of times in s on which each of the named columns has its samples.
pub(super) fn grid_of(
    time_s: &[f64],
    columns: &[(&'static str, &[f64])],
) -> Result<TimeGrid, HistoryError> {
    let times = time_s.len();
    for &(column, samples) in columns {
        let samples = samples.len();
        if samples != times || times < MIN_SAMPLES {
            return Err(HistoryError::Shape { column, samples, times });
        }
    }
    for &(column, samples) in [("time", time_s)].iter().chain(columns) {
        if let Some(sample) = samples.iter().position(|x| !x.is_finite()) {
            return Err(HistoryError::NotFinite { sample, column, found: samples[sample] });
        }
    }
    Ok(TimeGrid::through(time_s)?)
}
