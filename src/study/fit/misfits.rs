//! Distance of a fitted link from the measurements, and its credibility.

use faer::Mat;
use serde::Serialize;
use thiserror::Error;

use super::instruments::{Channel, Gain, rms as root_mean_square};
use super::measurement::Measured;
use super::measurements::{Measurements, Prediction};
use super::record::Alignment;
use super::record::Record;
use super::response::{Coordinate, Overlay, ResponseMisfit};
use crate::model::Sensor;
use crate::numeric::{NORMAL_95, student_95};

/// Delay in samples with the weight of a factor of e on a free value: within their bounds both may move about as far.
pub(super) const DELAY_UNIT: f64 = 15.0;

/// Share of a channel's size that may remain as a difference if it is no noise.
const LACKING: f64 = 0.05;

/// Number of uncertainties above which a measurement is an outlier.
const OUTLIER: f64 = 3.0;

/// Root mean square of the relative misfits of frequencies and responses above which no measurement fits.
const LARGEST_MISFIT: f64 = 0.25;

/// Standard deviations of the sum of squares above which it is no chance: one in ten thousand.
const NO_CHANCE: f64 = 3.72;

/// Upper limit of the correlation of neighbours in use: a factor of 45 on standard errors.
const MOST_CORRELATED: f64 = 0.999;

/// Factor on standard errors above which differences are no noise.
const CORRELATED: f64 = 1.5;

/// Ratio to the root mean square above which a difference is too large for many normal ones: one in a billion.
pub(super) const STRAY: f64 = 6.0;

/// A measurement and its prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Residual {
    /// The measurement.
    #[serde(flatten)]
    pub measured: Measured,
    /// Value of the fitted link.
    pub fitted: f64,
    /// Fitted over measured value, minus 1.
    pub relative: f64,
    /// Difference over the measurement's uncertainty, if known.
    pub uncertainties: Option<f64>,
    /// True if it exceeds three uncertainties.
    pub is_outlier: bool,
}

/// Reason to distrust a fitted link.
#[derive(Debug, Clone, PartialEq, Serialize, Error)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Misfit {
    /// The data do not determine all free values.
    #[error("no link file is written: the free values are not all determined")]
    Undetermined,
    /// The sum of squares is larger than the uncertainties explain.
    #[error(
        "no link file is written: no values of the free keys bring all measurements within their uncertainties \
         (chi² = {chi_squared:.3e} with {degrees_of_freedom} degrees of freedom)"
    )]
    Contradiction {
        /// Sum of squared ratios of residuals to uncertainties.
        chi_squared: f64,
        /// Measurements minus free values.
        degrees_of_freedom: usize,
    },
    /// A free value tends to leave its bounds.
    #[error(
        "no link file is written: {path} lies on its bound, {} times the file's value",
        crate::text::significant(*factor, 4)
    )]
    Bound {
        /// Path of the value.
        path: String,
        /// Bound as a factor on the file's value.
        factor: f64,
    },
    /// The delay of a record is the longest of the search.
    #[error(
        "no link file is written: the delay of {name} is the longest that is looked for, {longest} samples"
    )]
    Late {
        /// File of the record.
        name: String,
        /// The longest delay in samples.
        longest: usize,
    },
    /// A record differs by more than noise.
    #[error(
        "no link file is written: {} of {name} differs by {:.0} % of its size, and not as noise does",
        sensor.word(),
        100.0 * rms
    )]
    Lacking {
        /// File of the record.
        name: String,
        /// The sensor.
        sensor: Sensor,
        /// Root mean square of the differences over that of the samples.
        rms: f64,
    },
    /// The iteration did not end.
    #[error("no link file is written: the sum of squares still falls after the last iteration")]
    Unsettled,
    /// The data have several answers, but one was required.
    #[error("no link file is written: {}", as_well(*others))]
    Ambiguous {
        /// Number of other answers.
        others: usize,
    },
    /// The best values make no link with finite differences from the measurements.
    #[error(
        "no link file is written: the differences from the measurements cannot be computed at the best values"
    )]
    Unknown,
    /// The relative misfits are too large for measurements of this link.
    #[error(
        "no link file is written: the best values are still {} % off the measurements (root mean square)",
        crate::text::significant(100.0 * rms, 2)
    )]
    Far {
        /// Root mean square of the misfits.
        rms: f64,
    },
}

/// Distance of a fitted link from the measurements.
pub(super) struct Misfits {
    pub(super) residuals: Vec<Residual>,
    pub(super) responses: Vec<ResponseMisfit>,
    pub(super) records: Vec<RecordMisfit>,
    pub(super) has_uncertainties: bool,
    /// Residuals minus free values, including those of files.
    pub(super) degrees_of_freedom: usize,
    /// Sum of squared residuals; NaN for a link without a measured mode.
    pub(super) sum: f64,
    /// Root mean square of the relative misfits.
    pub(super) rms: f64,
}

impl Misfits {
    pub(super) fn of(
        measurements: &Measurements,
        free: usize,
        predicted: Option<&Prediction>,
    ) -> Self {
        let fitted = |k: usize| predicted.and_then(|predicted| predicted.values[k]);
        let values = measurements.values().iter().enumerate();
        let values =
            values.map(|(k, one)| Residual::of(one.clone(), fitted(k).unwrap_or(f64::NAN)));
        let residuals: Vec<Residual> = values.collect();
        let misfits = predicted.map(|predicted| &predicted.responses[..]).unwrap_or_default();
        let responses = measurements.responses().iter().zip(misfits);
        let responses = responses.map(|(response, fit)| ResponseMisfit::of(response, fit));
        let fits = predicted.map(|predicted| &predicted.records[..]).unwrap_or_default();
        let records = measurements.records().iter().zip(fits);
        let records: Vec<RecordMisfit> =
            records.map(|(record, fit)| RecordMisfit::of(record, fit)).collect();
        let [rows, own] = measurements.rows();
        let scaled = predicted.and_then(|predicted| measurements.residuals(predicted));
        // Damping ratios may differ by more without an error.
        let is_damping = |residual: &&Residual| residual.measured.observable.is_damping();
        let frequencies = residuals.iter().filter(|residual| !is_damping(residual));
        let of_records = records.iter().flat_map(|record: &RecordMisfit| {
            record.channels.iter().map(|channel| channel.rms.powi(2))
        });
        // A channel of a record counts once.
        let squares: Vec<f64> = frequencies
            .map(|residual| residual.relative.powi(2))
            .chain(misfits.iter().flat_map(|fit| &fit.misfits).map(|misfit| misfit * misfit))
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

    /// Sets the standard errors of the delays, whose rows of the covariance follow those of the free values.
    pub(super) fn set_delay_errors(&mut self, spread: Option<(f64, &Mat<f64>)>, free: usize) {
        let Some((scale, covariance)) = spread else { return };
        let late = self.records.iter_mut().filter(|record| record.delay_s.is_some());
        for (k, record) in late.enumerate() {
            let samples = scale * DELAY_UNIT * covariance[(free + k, free + k)].sqrt();
            record.delay_standard_error_s = Some(samples * record.step_s);
        }
    }

    /// Standard deviation of a residual: 1 with uncertainties, else the value from the residuals, if they outnumber the
    /// free values.
    pub(super) fn scale(&self) -> Option<f64> {
        let shown = || (self.sum / self.degrees_of_freedom as f64).sqrt();
        if self.has_uncertainties { Some(1.0) } else { (self.degrees_of_freedom > 0).then(shown) }
    }

    /// Standard errors with 95 % of the true values: more if the scale comes from the residuals.
    pub(super) fn reach_95(&self) -> f64 {
        if self.has_uncertainties { NORMAL_95 } else { student_95(self.degrees_of_freedom) }
    }

    /// Judgement on misfits that are larger than chance, or than any measurement of this link allows.
    pub(super) fn judged(&self) -> Option<Misfit> {
        let Self { rms, sum: chi_squared, degrees_of_freedom, .. } = *self;
        if !(rms.is_finite() && chi_squared.is_finite()) {
            return Some(Misfit::Unknown);
        }
        if rms > LARGEST_MISFIT {
            return Some(Misfit::Far { rms });
        }
        let channels = self
            .records
            .iter()
            .flat_map(|record| record.channels.iter().map(|channel| (&record.name, channel)));
        let mut lacking = channels.filter(|(_, own)| own.rms > LACKING && own.is_correlated());
        if let Some((name, channel)) = lacking.next() {
            let (name, sensor, rms) = (name.clone(), channel.sensor, channel.rms);
            return Some(Misfit::Lacking { name, sensor, rms });
        }
        if !self.has_uncertainties {
            return None;
        }
        let is_chance = chi_squared <= no_chance(degrees_of_freedom, NO_CHANCE);
        (!is_chance).then_some(Misfit::Contradiction { chi_squared, degrees_of_freedom })
    }
}

/// Sum of squares of this number of normal variables that is this number of standard deviations away.
///
/// Wilson and Hilferty: the cube root of χ²/k is nearly normal.
fn no_chance(degrees_of_freedom: usize, deviations: f64) -> f64 {
    let k = degrees_of_freedom.max(1) as f64;
    let variance = 2.0 / (9.0 * k);
    k * (1.0 - variance + deviations * variance.sqrt()).max(0.0).powi(3)
}

/// True if a sum of squares is so small that the uncertainties explain it only once in ten thousand cases.
pub(super) fn is_too_small(chi_squared: f64, degrees_of_freedom: usize) -> bool {
    degrees_of_freedom > 0 && chi_squared < no_chance(degrees_of_freedom, -NO_CHANCE)
}

impl Residual {
    pub(super) fn of(measured: Measured, fitted: f64) -> Self {
        let uncertainties = measured.uncertainty.map(|u| (fitted - measured.value) / u);
        Self {
            relative: fitted / measured.value - 1.0,
            measured,
            fitted,
            uncertainties,
            is_outlier: uncertainties.is_some_and(|u| u.abs() > OUTLIER),
        }
    }
}

/// Distance of a fitted link's histories from recorded ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordMisfit {
    /// File of the record.
    pub name: String,
    /// Number of compared samples.
    pub samples: usize,
    /// Delay of the sensors in s, if free.
    pub delay_s: Option<f64>,
    /// Standard error of the delay in s; `None` if unknown.
    pub delay_standard_error_s: Option<f64>,
    /// Step of the samples in s.
    pub step_s: f64,
    /// Noise of a hub angle that drives the link, over its motion, if it counts.
    pub input_noise: Option<f64>,
    /// Channels in their order.
    pub channels: Vec<ChannelMisfit>,
}

/// Distance of a fitted link's history from a sensor's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelMisfit {
    /// The sensor.
    pub sensor: Sensor,
    /// Factor from SI to the numbers of the column, 1 or −1 for a free sign; `None` if it was known.
    pub gain: Option<f64>,
    /// Offset in the unit of the column; `None` without a free offset.
    pub offset: Option<f64>,
    /// Root mean square of the differences over that of the samples.
    pub rms: f64,
    /// Correlation of each difference with the next: about 0 for noise, near 1 for a deficient model.
    pub autocorrelation: f64,
    /// Largest difference over their root mean square, and its time in s after the first sample.
    pub largest: (f64, f64),
}

impl ChannelMisfit {
    /// Ratio of standard errors to those of independent samples, for differences as a process of first order:
    /// `√((1 + ρ)/(1 − ρ))`.
    pub fn error_factor(&self) -> f64 {
        let correlation = self.autocorrelation.clamp(0.0, MOST_CORRELATED);
        ((1.0 + correlation) / (1.0 - correlation)).sqrt()
    }

    /// True if the differences are correlated from sample to sample, as those of a deficient model are.
    pub(super) fn is_correlated(&self) -> bool {
        self.error_factor() > CORRELATED
    }

    /// True if one difference is too large for normal noise.
    pub(super) fn has_stray(&self) -> bool {
        self.largest.0 > STRAY
    }
}

impl RecordMisfit {
    pub(super) fn of(record: &Record, alignment: &Alignment) -> Self {
        let Alignment { delay, lines, differences } = alignment;
        let channels = record.channels.iter().zip(lines).zip(differences).enumerate();
        let channels = channels.map(|(k, ((channel, line), differences))| {
            let root = root_mean_square(differences);
            let sum = root * root * differences.len() as f64;
            let rms = root / record.sizes[k];
            let products: f64 = differences.windows(2).map(|pair| pair[0] * pair[1]).sum();
            let autocorrelation = if sum > 0.0 { products / sum } else { 0.0 };
            let sizes = differences.iter().map(|difference| difference.abs()).enumerate();
            let (at, size) = sizes.fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
            let largest = (if sum > 0.0 { size / root } else { 0.0 }, record.step_s * at as f64);
            let gain = (channel.gain != Gain::Known).then_some(line.gain);
            let offset = channel.has_offset.then_some(line.offset / channel.unit);
            ChannelMisfit { sensor: channel.sensor, gain, offset, rms, autocorrelation, largest }
        });
        Self {
            name: record.name.clone(),
            samples: record.compared(),
            delay_s: record.is_delay_free.then_some(delay * record.step_s),
            delay_standard_error_s: None,
            step_s: record.step_s,
            input_noise: record.input_noise(),
            channels: channels.collect(),
        }
    }
}

impl Record {
    /// Samples of each channel, with those of the fitted link.
    pub(super) fn overlays(&self, alignment: &Alignment) -> Vec<Overlay> {
        let channels = self.channels.iter().zip(&alignment.differences);
        let overlay = |(channel, differences): (&Channel, &Vec<f64>)| {
            let (quantity, unit) = (channel.sensor.quantity(), channel.sensor.unit());
            let measured = &channel.samples[..differences.len()];
            let pairs = measured.iter().zip(differences);
            Overlay {
                name: format!("{}: {quantity}", self.name),
                x: Coordinate::linear("time", "s"),
                y: Coordinate::linear(quantity, if channel.gain == Gain::Free { "" } else { unit }),
                places: (0..differences.len()).map(|k| self.step_s * k as f64).collect(),
                measured: measured.to_vec(),
                fitted: pairs.map(|(recorded, difference)| recorded - difference).collect(),
            }
        };
        channels.map(overlay).collect()
    }
}

/// Text about several answers.
pub(super) fn as_well(others: usize) -> String {
    let fit = if others == 1 {
        "one other answer fits".to_owned()
    } else {
        format!("{others} other answers fit")
    };
    format!("{fit} the measurements about as well")
}
