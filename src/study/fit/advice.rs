//! Warnings and remedies of a fit.

use std::fmt;

use super::decay::Decay;
use super::measurement::Observable;
use super::misfits::{Misfit, RecordMisfit, STRAY, as_well, is_too_small};
use super::outcome::FitOutcome;
use crate::model::Sensor;
use crate::text::significant;

/// Remedy for several answers.
const TELL_APART: &str = "measure what separates the answers, such as another mode, the hub held or a mass, or bound \
                          the values with --free PATH=LOW:HIGH";

/// Warning about a fit, needed to judge it.
#[derive(Debug, Clone, PartialEq)]
pub enum FitWarning {
    /// A measured value is off by more than three uncertainties.
    Outlier {
        /// Measured quantity.
        observable: Observable,
        /// Distance from the fitted link's value, in uncertainties.
        uncertainties: f64,
    },
    /// Other values fit the measurements about as well.
    Ambiguous {
        /// Number of other answers.
        others: usize,
    },
    /// There are only as many measured numbers as free values.
    Unchecked,
    /// Differences of a record are correlated from sample to sample.
    Correlated {
        /// File of the record.
        name: String,
        /// The sensor.
        sensor: Sensor,
        /// Ratio of the true standard errors to the stated ones.
        factor: f64,
    },
    /// A difference of a record is far larger than the others.
    Stray {
        /// File of the record.
        name: String,
        /// The sensor.
        sensor: Sensor,
        /// Ratio of the difference to the root mean square of all.
        times: f64,
        /// Time of the difference in s after the first sample.
        time_s: f64,
    },
    /// The logarithm of a decay is not straight.
    BentDecay {
        /// File of the decay.
        name: String,
        /// Damping ratio of the mode.
        observable: Observable,
        /// Ratios of the first and of the last samples.
        ratios: [f64; 2],
    },
    /// A sample of a decay is far off.
    StrayOfDecay {
        /// File of the decay.
        name: String,
        /// Ratio of the difference to the root mean square of all.
        times: f64,
        /// Time of the sample in s.
        time_s: f64,
    },
    /// Differences are far smaller than the uncertainties.
    TooSmall {
        /// Sum of the squared ratios of differences to uncertainties.
        chi_squared: f64,
        /// Measured numbers minus free values.
        degrees_of_freedom: usize,
    },
    /// A recorded hub angle has noise, which the fit mistakes for motion.
    NoisyInput {
        /// File of the record.
        name: String,
        /// Ratio of the noise to the motion.
        share: f64,
    },
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outlier { observable, uncertainties } => write!(
                f,
                "{observable} is {} uncertainties away from the fitted value",
                significant(*uncertainties, 2)
            ),
            Self::Ambiguous { others } => {
                write!(f, "{}: the 95 % cover them all", as_well(*others))
            }
            Self::Unchecked => f.write_str(
                "there are no more measurements than free values: nothing checks the fit",
            ),
            Self::Correlated { name, sensor, factor } => write!(
                f,
                "{name}: the differences of {} are not noise, each resembles the one before: the standard errors are \
                 about {} times as large as printed",
                sensor.word(),
                significant(*factor, 2)
            ),
            Self::Stray { name, sensor, times, time_s } => write!(
                f,
                "{name}: {} differs {} s after the first sample by {} times the root mean square of all \
                 differences",
                sensor.word(),
                significant(*time_s, 4),
                significant(*times, 2)
            ),
            Self::BentDecay { name, observable, ratios: [first, last] } => write!(
                f,
                "{name}: the logarithm of the amplitude is not straight: {observable} is {} at the beginning and {} at \
                 the end, as {} makes it",
                significant(*first, 2),
                significant(*last, 2),
                if first < last { "dry friction" } else { "the drag of air" }
            ),
            Self::StrayOfDecay { name, times, time_s } => write!(
                f,
                "{name}: the sample at {} s is off the decay by {} times the root mean square of all differences",
                significant(*time_s, 4),
                significant(*times, 2)
            ),
            Self::TooSmall { chi_squared, degrees_of_freedom } => write!(
                f,
                "chi² {} with {degrees_of_freedom} degrees of freedom is far too small: the uncertainties \
                 are larger than the differences",
                significant(*chi_squared, 3)
            ),
            Self::NoisyInput { name, share } => write!(
                f,
                "{name}: the recorded hub angle has noise of about {} % of its motion, which is taken for \
                 motion: stiffness and damping are off by more than their standard errors",
                significant(100.0 * share, 2)
            ),
        }
    }
}

crate::result::notices!(FitWarning);

impl FitWarning {
    /// Name of the kind in the record of a run.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Outlier { .. } => "outlier",
            Self::Ambiguous { .. } => "ambiguous",
            Self::Unchecked => "unchecked",
            Self::Correlated { .. } => "correlated_differences",
            Self::Stray { .. } => "stray_sample",
            Self::BentDecay { .. } => "bent_decay",
            Self::StrayOfDecay { .. } => "stray_sample_of_decay",
            Self::TooSmall { .. } => "small_chi_squared",
            Self::NoisyInput { .. } => "noisy_input",
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Outlier { .. } => "measure it again, or give it its true uncertainty",
            Self::Ambiguous { .. } => TELL_APART,
            Self::Unchecked => "measure more, or free less",
            Self::BentDecay { .. } => {
                "cut the decay to where it is exponential with from and until; it must begin after the release. No \
                 damping ratio describes the rest"
            }
            Self::Stray { .. } | Self::StrayOfDecay { .. } => {
                "correct the samples that were lost or cut off, or leave them out"
            }
            Self::TooSmall { .. } => {
                "give uncertainties of one standard deviation, in the unit of their values"
            }
            Self::NoisyInput { .. } => {
                "filter the angle without delay before, or fit to the torque or the voltage as input"
            }
            Self::Correlated { .. } => {
                "look at the page of --report for what the link lacks: friction, another damping, a wrong \
                 input, a motion before the first sample; take every n-th sample if it is noise that a \
                 filter has smoothed"
            }
        }
    }
}

impl FitOutcome {
    /// All warnings of this fit.
    pub fn warnings(&self) -> Vec<FitWarning> {
        let outliers = self.residuals.iter().filter(|residual| residual.is_outlier);
        let outliers = outliers.map(|residual| FitWarning::Outlier {
            observable: residual.measured.observable.clone(),
            uncertainties: residual.uncertainties.unwrap_or_default().abs(),
        });
        let others = self.other_answers.len();
        let ambiguous = (others > 0).then_some(FitWarning::Ambiguous { others });
        let unchecked = (self.degrees_of_freedom == 0).then_some(FitWarning::Unchecked);
        let small = self.chi_squared.filter(|found| is_too_small(*found, self.degrees_of_freedom));
        let small = small.map(|chi_squared| FitWarning::TooSmall {
            chi_squared,
            degrees_of_freedom: self.degrees_of_freedom,
        });
        let of_records = self.records.iter().flat_map(RecordMisfit::warnings);
        let of_decays = self.decays.iter().flat_map(Decay::warnings);
        let of_values = outliers.chain(ambiguous).chain(unchecked).chain(small);
        of_values.chain(of_records).chain(of_decays).collect()
    }
}

impl Decay {
    fn warnings(&self) -> Vec<FitWarning> {
        let name = || self.name.clone();
        let bent = self.modes.iter().filter_map(|mode| {
            let observable = mode.ratio.observable.clone();
            Some(FitWarning::BentDecay { name: name(), observable, ratios: mode.bent? })
        });
        let (times, time_s) = self.largest;
        // In a bent decay the differences are no noise.
        let is_bent = self.modes.iter().any(|mode| mode.bent.is_some());
        let is_stray = times > STRAY && !is_bent;
        let stray = is_stray.then(|| FitWarning::StrayOfDecay { name: name(), times, time_s });
        bent.chain(stray).collect()
    }
}

impl RecordMisfit {
    fn warnings(&self) -> Vec<FitWarning> {
        let name = || self.name.clone();
        let channels = || self.channels.iter();
        let noisy = self.input_noise.map(|share| FitWarning::NoisyInput { name: name(), share });
        let strays = channels().filter(|channel| channel.has_stray()).map(|channel| {
            let (sensor, (times, time_s)) = (channel.sensor, channel.largest);
            FitWarning::Stray { name: name(), sensor, times, time_s }
        });
        let correlated = channels().filter(|channel| channel.is_correlated()).map(|channel| {
            let (sensor, factor) = (channel.sensor, channel.error_factor());
            FitWarning::Correlated { name: name(), sensor, factor }
        });
        noisy.into_iter().chain(strays).chain(correlated).collect()
    }
}

impl Misfit {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> String {
        match self {
            Self::Undetermined => {
                "fix one of the values, or measure more: a mass or a stiffness".to_owned()
            }
            Self::Bound { path, .. } => format!(
                "widen its bounds, --free {path}=LOW:HIGH, if the value may lie beyond; else fix it, or \
                 look for what else differs from the link file"
            ),
            Self::Late { longest, .. } => format!(
                "check that input and sensors share one clock, or cut the file so that they are less than \
                 {longest} samples apart"
            ),
            Self::Unsettled => "start nearer the fitted values with --set, bound them with \
                                --free PATH=LOW:HIGH, or free fewer"
                .to_owned(),
            Self::Contradiction { .. } => {
                "if one measurement is far off, check its mode, hub and pose; if all are off, enlarge the \
                 uncertainties to what the measurements are worth (uncertainty = 0.01 in a [[decay]]), or free the \
                 value that differs from the link file"
                    .to_owned()
            }
            Self::Lacking { .. } => "look at the page of --report for when it differs: the sign, gain, offset or \
                                     delay of the channel, the input and its hold, a motion before the first \
                                     sample, a sensor at its end, or what the link file lacks"
                .to_owned(),
            Self::Ambiguous { .. } => TELL_APART.to_owned(),
            Self::Unknown => "bound the free values with --free PATH=LOW:HIGH, or start nearer the \
                              measurements with --set"
                .to_owned(),
            Self::Far { .. } => {
                "check each unit, mode, hub and pose, of a response its transfer and gain, of a record its input \
                 and hold, the sensor, sign and gain of each channel, and that it begins at rest; modes \
                 are numbered from 1, the rigid rotation of a link left out"
                    .to_owned()
            }
        }
    }
}
