//! What a fit tells its user to do.

use std::fmt;

use super::measurement::Observable;
use super::outcome::{FitOutcome, Misfit};
use crate::model::Sensor;
use crate::text::significant;

/// Factor on standard errors beyond which a user must know it.
const CORRELATED: f64 = 1.5;

/// What the user of a fit must know to judge it.
#[derive(Debug, Clone, PartialEq)]
pub enum FitWarning {
    /// A measured value that lies beyond three uncertainties.
    Outlier {
        /// What was measured.
        observable: Observable,
        /// Distance from the fitted link's value, in uncertainties.
        uncertainties: f64,
    },
    /// As many measured numbers as free values.
    Unchecked,
    /// Differences of a record that go on from sample to sample.
    Correlated {
        /// File of the record.
        name: String,
        /// The sensor.
        sensor: Sensor,
        /// Standard errors over those that are given.
        factor: f64,
    },
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outlier { observable, uncertainties } => write!(
                f,
                "{observable} is {} uncertainties away from the fitted link's",
                significant(*uncertainties, 2)
            ),
            Self::Unchecked => f.write_str(
                "there are no more measurements than free values: nothing checks the fit",
            ),
            Self::Correlated { name, sensor, factor } => write!(
                f,
                "{name}: the differences of {} are no noise, each is like the one before: the standard \
                 errors are about {} times those given",
                sensor.word(),
                significant(*factor, 2)
            ),
        }
    }
}

impl FitWarning {
    /// Its kind in fit.json.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Outlier { .. } => "outlier",
            Self::Unchecked => "unchecked",
            Self::Correlated { .. } => "correlated_differences",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Outlier { .. } => "measure it again, or give it its true uncertainty",
            Self::Unchecked => "measure more, or free less",
            Self::Correlated { .. } => {
                "look at the page of --report for what the link lacks: friction, another damping, a wrong \
                 input; record with a longer step if it is noise that a filter has smoothed"
            }
        }
    }
}

impl FitOutcome {
    /// All warnings of this fit.
    pub fn warnings(&self) -> Vec<FitWarning> {
        let outliers = self.residuals.iter().filter(|residual| residual.is_outlier);
        let outliers = outliers.map(|residual| FitWarning::Outlier {
            observable: residual.measured.observable,
            uncertainties: residual.uncertainties.unwrap_or_default().abs(),
        });
        let unchecked = (self.degrees_of_freedom == 0).then_some(FitWarning::Unchecked);
        let channels = self
            .records
            .iter()
            .flat_map(|record| record.channels.iter().map(|channel| (&record.name, channel)));
        let correlated = channels.filter(|(_, channel)| channel.error_factor() > CORRELATED);
        let correlated = correlated.map(|(name, channel)| FitWarning::Correlated {
            name: name.clone(),
            sensor: channel.sensor,
            factor: channel.error_factor(),
        });
        outliers.chain(unchecked).chain(correlated).collect()
    }
}

impl Misfit {
    /// What the user can do about it.
    pub fn hint(&self) -> String {
        match self {
            Self::Undetermined => {
                "fix one of the values, or measure more: a mass or a stiffness".to_owned()
            }
            Self::Bound { path, .. } => format!(
                "widen its bounds, --free {path}=LOW:HIGH, if the value may lie beyond; else fix it, or \
                 look for what else differs from the link file"
            ),
            Self::Late { .. } => "shift its columns over each other by hand, to within 100 samples; a \
                                  record that does not fit at all has no delay, either"
                .to_owned(),
            Self::Unsettled => "start nearer the fitted values with --set, bound them with \
                                --free PATH=LOW:HIGH, or free fewer"
                .to_owned(),
            Self::Contradiction { .. } => {
                "one measurement far off has another mode or hub than it says; if all are off, enlarge the \
                 uncertainties to what the measurements are worth, or free the value that differs from the \
                 link file"
                    .to_owned()
            }
            Self::Far { .. } => {
                "check each unit, mode and hub, and of a response its transfer and gain; modes are \
                 numbered from 1, the rigid rotation left out"
                    .to_owned()
            }
        }
    }
}
