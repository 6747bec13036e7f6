//! What is left between a record and the histories of a fitted link.

use serde::Serialize;

use super::alignment::Alignment;
use super::record::{Record, RecordFit};
use super::record_parts::{Channel, rms as root_mean_square};
use super::response::Gain;
use super::response::{Coordinate, Overlay};
use crate::model::Sensor;

/// Correlation of neighbours that counts as no larger one: a factor of 45 on standard errors.
const MOST_CORRELATED: f64 = 0.999;

/// Factor on standard errors from which on differences are no noise.
const CORRELATED: f64 = 1.5;

/// Root mean squares beyond which a difference is none of many normal ones: one in a billion.
const STRAY: f64 = 6.0;

/// How far a fitted link's histories are from recorded ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordMisfit {
    /// File of the record.
    pub name: String,
    /// Number of samples that are compared.
    pub samples: usize,
    /// Delay of the sensors in s, if it was free.
    pub delay_s: Option<f64>,
    /// Its standard error in s; none where it is not known.
    pub delay_standard_error_s: Option<f64>,
    /// Step of the samples in s.
    pub step_s: f64,
    /// Noise of a hub angle that drives the link, over its motion, where it counts.
    pub input_noise: Option<f64>,
    /// The channels in their order.
    pub channels: Vec<ChannelMisfit>,
}

/// How far a fitted link's history is from that of a sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelMisfit {
    /// The sensor.
    pub sensor: Sensor,
    /// Factor from SI to the numbers of the column, 1 or −1 of a free sign; none where it was known.
    pub gain: Option<f64>,
    /// What is added to that, in the unit of the column; none where nothing was.
    pub offset: Option<f64>,
    /// Root mean square of the differences over that of the samples.
    pub rms: f64,
    /// Correlation of each difference with the next: about 0 of noise, near 1 where the model lacks something.
    pub autocorrelation: f64,
    /// The largest difference over their root mean square, and its time in s after the first sample.
    pub largest: (f64, f64),
}

impl ChannelMisfit {
    /// Standard errors over those of independent samples, were the differences a process of first order:
    /// `√((1 + ρ)/(1 − ρ))`.
    pub fn error_factor(&self) -> f64 {
        let correlation = self.autocorrelation.clamp(0.0, MOST_CORRELATED);
        ((1.0 + correlation) / (1.0 - correlation)).sqrt()
    }

    /// True if the differences go on from sample to sample, as those of a model that lacks something do.
    pub(super) fn is_correlated(&self) -> bool {
        self.error_factor() > CORRELATED
    }

    /// True if one difference is none of normal noise.
    pub(super) fn has_stray(&self) -> bool {
        self.largest.0 > STRAY
    }
}

impl RecordMisfit {
    pub(super) fn of(record: &Record, RecordFit(alignment): &RecordFit) -> Self {
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
    /// The samples of each channel, and the fitted link's over them.
    pub(super) fn overlays(&self, RecordFit(alignment): &RecordFit) -> Vec<Overlay> {
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
