//! A free decay: the frequency and the damping ratio of each mode that one sensor shows after a pluck or a blow.

use std::f64::consts::TAU;

use serde::Serialize;
use thiserror::Error;

use super::damped::{Damped, Pole};
use super::measurement::{Measured, Observable};
use super::record_parts::{is_constant, rms};
use super::response::{Coordinate, MOST_UNCERTAIN, Overlay};
use super::vibrations::Search;
use crate::text::significant;

/// Fewest samples of a decay.
const FEWEST: usize = 24;

/// Fewest periods of a mode in the samples.
const FEWEST_PERIODS: f64 = 2.0;

/// Relative uncertainty that no clock and no mesh is below.
const EXACT: f64 = 1e-6;

/// Change of a damping ratio from the first samples to the last, over the ratio, from which on the amplitude is not
/// exponential.
const BENT: f64 = 0.1;

/// Largest uncertainty over the ratio that such a change makes.
const MOST_OF_BEND: f64 = 0.45;

/// Standard errors beyond which such a change is no noise.
const NO_NOISE: f64 = 4.0;

/// A recorded decay.
#[derive(Debug, Clone, PartialEq)]
pub struct DecaySamples {
    /// Its file.
    pub name: String,
    /// Quantity of the sensor: `tip_deflection`.
    pub column: String,
    /// Time of the first sample in s.
    pub start_s: f64,
    /// Step of the times in s.
    pub step_s: f64,
    /// The samples in any unit.
    pub samples: Vec<f64>,
}

/// The values of a decay that a link is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecayValues {
    /// Frequencies and damping ratios.
    Both,
    /// Frequencies.
    Frequencies,
    /// Damping ratios.
    Ratios,
}

/// What a decay shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decay {
    /// Its file.
    pub name: String,
    /// Quantity of the sensor.
    pub column: String,
    /// How many samples it has.
    pub samples: usize,
    /// The modes that were asked for, in their order.
    pub modes: Vec<DecayMode>,
    /// Frequencies in Hz of further vibrations, which are no modes that were asked for.
    pub others_hz: Vec<f64>,
    /// Root mean square of what remains, over that of the samples about their offset and drift.
    pub rms: f64,
    /// The largest of the differences that remain, over their root mean square, and its time in s.
    pub largest: (f64, f64),
    /// The samples, and the vibrations in their place.
    #[serde(skip)]
    pub overlay: Overlay,
}

/// A mode that decays.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecayMode {
    /// Its natural frequency.
    pub frequency: Measured,
    /// Its damping ratio.
    pub ratio: Measured,
    /// The ratio of the first samples and that of the last, where the logarithm of the amplitude is not straight.
    pub bent: Option<[f64; 2]>,
}

/// Why samples are no decay.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DecayError {
    /// Too few samples.
    #[error("samples = {0}, but must be {FEWEST} or more")]
    Few(usize),
    /// A sensor that does not move.
    #[error("{0} = the same value in all samples, but must vibrate")]
    Constant(String),
    /// The mode is not in the samples.
    #[error(
        "{observable}: no vibration {} stands out of the noise{}",
        between(*within_hz),
        strongest(*strongest_hz)
    )]
    Missing {
        /// Its frequency.
        observable: Observable,
        /// Where it was looked for.
        within_hz: [f64; 2],
        /// The strongest vibration elsewhere.
        strongest_hz: Option<f64>,
    },
    /// Too few periods.
    #[error("{observable}: periods = {}, but must be {FEWEST_PERIODS} or more", significant(*periods, 2))]
    Short {
        /// Its frequency.
        observable: Observable,
        /// Periods in the samples.
        periods: f64,
    },
    /// The samples do not tell how fast it decays.
    #[error(
        "{observable} = {} ± {}, but its uncertainty must be below half of it",
        significant(*ratio, 2),
        significant(*uncertainty, 2)
    )]
    Uncertain {
        /// Its damping ratio.
        observable: Observable,
        /// What was found.
        ratio: f64,
        /// Its standard uncertainty.
        uncertainty: f64,
    },
}

fn between([low, high]: [f64; 2]) -> String {
    let [low, high] = [low, high].map(|hertz| (hertz, significant(hertz, 3)));
    match (low, high) {
        ((0.0, _), (f64::INFINITY, _)) => String::new(),
        ((0.0, _), (_, high)) => format!("below {high} Hz"),
        ((_, low), (f64::INFINITY, _)) => format!("above {low} Hz"),
        ((_, low), (_, high)) => format!("between {low} and {high} Hz"),
    }
}

fn strongest(hertz: Option<f64>) -> String {
    hertz.map_or(String::new(), |hertz| {
        format!("; the strongest is at {} Hz", significant(hertz, 4))
    })
}

impl DecayError {
    /// Advice to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Few(_) | Self::Short { .. } => "record longer, or leave more of the file in",
            Self::Constant(_) => "sensor = \"tip_acceleration\" names the column of another sensor",
            Self::Missing { .. } => {
                "the mode is looked for about where the link file has it: name the mode that vibrates, or bring the \
                 link file nearer with --set"
            }
            Self::Uncertain { .. } => {
                "record longer or with less noise, begin after the release with from, or take only = \"frequency\" from \
                 this decay"
            }
        }
    }
}

impl Decay {
    /// Identifies modes in a decay, the natural frequency of each between two frequencies in Hz: the strongest there.
    ///
    /// Vibrations are added in the order of their peaks in the spectrum of what remains, and all are fitted anew with
    /// each; up to four that are no modes asked for. Each has a frequency and a decay rate, beside an offset and a drift
    /// of the sensor. The uncertainties follow from the differences that remain: from their variance, or from their sums
    /// over one and over three periods, if these are larger, as of differences that go on from sample to sample.
    ///
    /// # Errors
    /// [`DecayError`]: too few samples or periods, a mode that does not stand out, or does not decay.
    pub fn of(
        given: DecaySamples,
        modes: &[(Observable, [f64; 2])],
        values: DecayValues,
    ) -> Result<Self, DecayError> {
        let len = given.samples.len();
        if len < FEWEST {
            return Err(DecayError::Few(len));
        }
        let mean = given.samples.iter().sum::<f64>() / len as f64;
        let about: Vec<f64> = given.samples.iter().map(|sample| sample - mean).collect();
        let size = rms(&about);
        if is_constant(&given.samples) || size == 0.0 {
            return Err(DecayError::Constant(given.column));
        }
        let samples: Vec<f64> = about.iter().map(|sample| sample / size).collect();
        let duration_s = len as f64 * given.step_s;
        let search = Search { samples: &samples, duration_s, modes };
        let line =
            Damped::line(&samples).ok_or_else(|| DecayError::Constant(given.column.clone()))?;
        let total = line.cost;
        let fit = search.all(line);
        let differences = fit.differences(&samples);
        let variances = fit.variances(&differences);
        let places = search.assigned(&fit);
        let mut found = Vec::new();
        for ((observable, within_hz), place) in modes.iter().zip(&places) {
            let pair = place.zip(variances.as_ref());
            let Some((place, variances)) = pair else {
                return Err(DecayError::Missing {
                    observable: observable.clone(),
                    within_hz: *within_hz,
                    strongest_hz: fit.strongest().map(|pole| search.hertz(pole)),
                });
            };
            let periods = fit.poles[place].omega / TAU;
            if periods < FEWEST_PERIODS {
                return Err(DecayError::Short { observable: observable.clone(), periods });
            }
            let bend = fit.bend(place, &differences);
            let mode =
                DecayMode::of(observable, &fit.poles[place], variances[place], bend, duration_s);
            mode.check(values)?;
            found.push(mode);
        }
        let others = (0..fit.poles.len()).filter(|k| !places.contains(&Some(*k)));
        let square: f64 = differences.iter().map(|r| r * r).sum();
        let largest = differences.iter().enumerate().map(|(k, r)| (r.abs(), k));
        let largest = largest.fold((0.0, 0), |most, own| if own.0 > most.0 { own } else { most });
        let time_s = |k: usize| given.start_s + k as f64 * given.step_s;
        let in_place = differences.iter().zip(&given.samples).map(|(r, sample)| sample - r * size);
        let overlay = Overlay {
            name: format!("{}: {}, decay", given.name, given.column),
            x: Coordinate::linear("time", "s"),
            y: Coordinate::linear("sensor", ""),
            places: (0..len).map(time_s).collect(),
            fitted: in_place.collect(),
            measured: given.samples.clone(),
        };
        Ok(Self {
            samples: len,
            modes: found,
            others_hz: others.map(|k| search.hertz(&fit.poles[k])).collect(),
            rms: (square / total).sqrt(),
            largest: (largest.0 / (square / len as f64).sqrt(), time_s(largest.1)),
            overlay,
            name: given.name,
            column: given.column,
        })
    }

    /// The values that a link is fitted to, with a relative uncertainty from other causes than the noise of the samples.
    pub fn values(&self, values: DecayValues, other: f64) -> Vec<Measured> {
        let with_other = |own: &Measured| {
            let square = own.uncertainty.unwrap_or(0.0).powi(2) + (other * own.value).powi(2);
            Measured { uncertainty: Some(square.sqrt()), ..own.clone() }
        };
        let frequencies = self.modes.iter().map(|mode| with_other(&mode.frequency));
        let ratios = self.modes.iter().map(|mode| with_other(&mode.ratio));
        match values {
            DecayValues::Both => frequencies.chain(ratios).collect(),
            DecayValues::Frequencies => frequencies.collect(),
            DecayValues::Ratios => ratios.collect(),
        }
    }
}

impl DecayMode {
    /// A vibration with the variances of σ and ω; `bend` holds σ in the first and in the last samples, and the standard
    /// error of their difference.
    fn of(
        observable: &Observable,
        pole: &Pole,
        [of_sigma, of_omega]: [f64; 2],
        bend: Option<([f64; 2], f64)>,
        duration_s: f64,
    ) -> Self {
        let Pole { sigma, omega } = *pole;
        let natural = (sigma * sigma + omega * omega).sqrt();
        let ratio = sigma / natural;
        let is_bent = |([first, last], error): &([f64; 2], f64)| {
            let change = (last - first).abs();
            change > NO_NOISE * error && change > BENT * sigma.abs()
        };
        let bent = bend.filter(is_bent).map(|(rates, _)| rates.map(|rate| rate / natural));
        // Any ratio between both ends is as good as another: the variance of a uniform distribution.
        let of_bend = bent.map_or(0.0, |[first, last]| (last - first).powi(2) / 12.0);
        let [x, y] = [sigma / natural, omega / natural];
        let of_natural = x * x * of_sigma + y * y * of_omega;
        let of_ratio = y * y * (y * y * of_sigma + x * x * of_omega) / (natural * natural);
        let hertz = natural / TAU / duration_s;
        let least = |value: f64, uncertainty: f64| Some(uncertainty.max(EXACT * value.abs()));
        let frequency = Measured {
            observable: observable.clone(),
            value: hertz,
            uncertainty: least(hertz, of_natural.sqrt() / TAU / duration_s),
        };
        // Its warning says more than an uncertainty that no measurement may have.
        let of_both = (of_ratio + of_bend).sqrt().min(MOST_OF_BEND * ratio);
        let uncertainty = least(ratio, of_both.max(of_ratio.sqrt()));
        let ratio = Measured { observable: observable.ratio(), value: ratio, uncertainty };
        Self { frequency, ratio, bent }
    }

    /// Refuses a ratio that the samples do not tell, if it is to be fitted to.
    fn check(&self, values: DecayValues) -> Result<(), DecayError> {
        let Measured { ref observable, value: ratio, uncertainty } = self.ratio;
        let uncertainty = uncertainty.unwrap_or_default();
        if values == DecayValues::Frequencies || uncertainty < MOST_UNCERTAIN * ratio {
            return Ok(());
        }
        Err(DecayError::Uncertain { observable: observable.clone(), ratio, uncertainty })
    }
}
