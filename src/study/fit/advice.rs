//! Warnings and remedies of a fit.

use super::decay::Decay;
use super::misfits::{Misfit, RecordMisfit, STRAY, as_well, is_too_small};
use super::outcome::FitOutcome;
use crate::result::Notice;
use crate::text::significant;

/// Remedy for several answers.
const TELL_APART: &str = "measure what separates the answers, such as another mode, the hub held or a mass, or bound \
                          the values with --free PATH=LOW:HIGH";

impl FitOutcome {
    /// All warnings of this fit.
    pub fn warnings(&self) -> Vec<Notice> {
        let outliers = self.residuals.iter().filter(|residual| residual.is_outlier);
        let outliers = outliers.map(|residual| {
            let uncertainties = residual.uncertainties.unwrap_or_default().abs();
            let message = format!(
                "{} is {} uncertainties away from the fitted value",
                residual.measured.observable,
                significant(uncertainties, 2)
            );
            let hint = "measure it again, or give it its true uncertainty";
            Notice::new("outlier", message, hint)
        });
        let others = self.other_answers.len();
        let ambiguous = (others > 0).then(|| {
            let message = format!("{}: the 95 % cover them all", as_well(others));
            Notice::new("ambiguous", message, TELL_APART)
        });
        let unchecked = (self.degrees_of_freedom == 0).then(|| {
            let message = "there are no more measurements than free values: nothing checks the fit";
            Notice::new("unchecked", message, "measure more, or free less")
        });
        let small = self.chi_squared.filter(|sum| is_too_small(*sum, self.degrees_of_freedom));
        let small = small.map(|chi_squared| {
            let message = format!(
                "chi² {} with {} degrees of freedom is far too small: the uncertainties are larger than the \
                 differences",
                significant(chi_squared, 3),
                self.degrees_of_freedom
            );
            let hint = "give uncertainties of one standard deviation, in the unit of their values";
            Notice::new("small_chi_squared", message, hint)
        });
        let of_records = self.records.iter().flat_map(RecordMisfit::warnings);
        let of_decays = self.decays.iter().flat_map(Decay::warnings);
        let of_values = outliers.chain(ambiguous).chain(unchecked).chain(small);
        of_values.chain(of_records).chain(of_decays).collect()
    }
}

/// Remedy for a sample far off.
const LOST: &str = "correct the samples that were lost or cut off, or leave them out";

impl Decay {
    fn warnings(&self) -> Vec<Notice> {
        let name = &self.name;
        let bent = self.modes.iter().filter_map(|mode| {
            let [first, last] = mode.bent?;
            let message = format!(
                "{name}: the logarithm of the amplitude is not straight: {} is {} at the beginning and {} at the \
                 end, as {} makes it",
                mode.ratio.observable,
                significant(first, 2),
                significant(last, 2),
                if first < last { "dry friction" } else { "the drag of air" }
            );
            let hint = "cut the decay to where it is exponential with from and until; it must begin after the \
                        release. No damping ratio describes the rest";
            Some(Notice::new("bent_decay", message, hint))
        });
        let (times, time_s) = self.largest;
        // In a bent decay the differences are no noise.
        let is_bent = self.modes.iter().any(|mode| mode.bent.is_some());
        let stray = (times > STRAY && !is_bent).then(|| {
            let message = format!(
                "{name}: the sample at {} s is off the decay by {} times the root mean square of all differences",
                significant(time_s, 4),
                significant(times, 2)
            );
            Notice::new("stray_sample_of_decay", message, LOST)
        });
        bent.chain(stray).collect()
    }
}

impl RecordMisfit {
    fn warnings(&self) -> Vec<Notice> {
        let (name, channels) = (&self.name, || self.channels.iter());
        let noisy = self.input_noise.map(|share| {
            let message = format!(
                "{name}: the recorded hub angle has noise of about {} % of its motion, which is taken for \
                 motion: stiffness and damping are off by more than their standard errors",
                significant(100.0 * share, 2)
            );
            let hint = "filter the angle without delay before, or fit to the torque or the voltage as input";
            Notice::new("noisy_input", message, hint)
        });
        let strays = channels().filter(|channel| channel.has_stray()).map(|channel| {
            let (times, time_s) = channel.largest;
            let message = format!(
                "{name}: {} differs {} s after the first sample by {} times the root mean square of all \
                 differences",
                channel.sensor.word(),
                significant(time_s, 4),
                significant(times, 2)
            );
            Notice::new("stray_sample", message, LOST)
        });
        let correlated = channels().filter(|channel| channel.is_correlated()).map(|channel| {
            let message = format!(
                "{name}: the differences of {} are not noise, each resembles the one before: the standard errors are \
                 about {} times as large as printed",
                channel.sensor.word(),
                significant(channel.error_factor(), 2)
            );
            let hint = "look at the page of --report for what the link lacks: friction, another damping, a wrong \
                        input, a motion before the first sample; take every n-th sample if it is noise that a \
                        filter has smoothed";
            Notice::new("correlated_differences", message, hint)
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
