//! What a fit tells its user to do.

use std::fmt;

use super::measurement::Observable;
use super::outcome::{FitOutcome, Misfit};
use crate::text::significant;

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
        }
    }
}

impl FitWarning {
    /// Its kind in fit.json.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Outlier { .. } => "outlier",
            Self::Unchecked => "unchecked",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Outlier { .. } => "measure it again, or give it its true uncertainty",
            Self::Unchecked => "measure more, or free less",
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
        outliers.chain(unchecked).collect()
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
