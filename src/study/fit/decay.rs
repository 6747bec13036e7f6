//! A free decay: frequency and damping ratio of each mode that one sensor shows after a pluck or a blow, and the
//! vibrations above its noise.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "shares of a number of samples, and numbers of periods"
)]

use std::f64::consts::{LN_2, TAU};

use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::damped::{Damped, Pole};
use super::instruments::{MOST_UNCERTAIN, is_constant, rms};
use super::measurement::{Measured, Observable};
use super::response::{Coordinate, Overlay};
use crate::numeric::FourierPair;
use crate::text::significant;

/// Fewest samples of a decay.
const FEWEST: usize = 24;

/// Fewest periods of a mode in the samples.
const FEWEST_PERIODS: f64 = 2.0;

/// Smallest relative uncertainty: no clock and no mesh is better.
const EXACT: f64 = 1e-6;

/// Change of a damping ratio from the first samples to the last, over the ratio, above which the amplitude is not
/// exponential.
const BENT: f64 = 0.1;

/// Largest uncertainty over the ratio due to such a change.
const MOST_OF_BEND: f64 = 0.45;

/// Standard errors above which such a change is no noise.
const NO_NOISE: f64 = 4.0;

/// A recorded decay.
#[derive(Debug, Clone, PartialEq)]
pub struct DecaySamples {
    /// File of the decay.
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

/// Values of a decay to use in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum DecayValues {
    /// Frequencies and damping ratios.
    #[default]
    #[serde(skip)]
    Both,
    /// Frequencies.
    #[serde(rename = "frequency")]
    Frequencies,
    /// Damping ratios.
    #[serde(rename = "ratio")]
    Ratios,
}

/// Results of a decay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decay {
    /// File of the decay.
    pub name: String,
    /// Quantity of the sensor.
    pub column: String,
    /// Number of samples.
    pub samples: usize,
    /// The requested modes, in their order.
    pub modes: Vec<DecayMode>,
    /// Frequencies in Hz of further vibrations that are no requested modes.
    pub others_hz: Vec<f64>,
    /// Root mean square of the remaining differences, over that of the samples about their offset and drift.
    pub rms: f64,
    /// Largest remaining difference, over their root mean square, and its time in s.
    pub largest: (f64, f64),
    /// The samples with the fitted vibrations.
    #[serde(skip)]
    pub overlay: Overlay,
}

/// A decaying mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecayMode {
    /// Natural frequency.
    pub frequency: Measured,
    /// Damping ratio.
    pub ratio: Measured,
    /// Ratios of the first and of the last samples, if the logarithm of the amplitude is not straight.
    pub bent: Option<[f64; 2]>,
}

/// Reason why samples are no decay.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DecayError {
    /// There are too few samples.
    #[error("samples = {0}, but must be {FEWEST} or more")]
    Few(usize),
    /// The sensor does not move.
    #[error("{0} is the same in all samples, but must vibrate")]
    Constant(String),
    /// The mode is not in the samples.
    #[error(
        "{observable}: no vibration {} stands out of the noise{}",
        between(*within_hz),
        strongest(*strongest_hz)
    )]
    Missing {
        /// Frequency of the mode.
        observable: Observable,
        /// Range of the search in Hz.
        within_hz: [f64; 2],
        /// Strongest vibration elsewhere.
        strongest_hz: Option<f64>,
    },
    /// The samples contain too few periods.
    #[error("{observable}: periods = {}, but must be {FEWEST_PERIODS} or more", significant(*periods, 2))]
    Short {
        /// Frequency of the mode.
        observable: Observable,
        /// Number of periods in the samples.
        periods: f64,
    },
    /// The samples do not show how fast the mode decays.
    #[error(
        "{observable} = {} ± {}, but its uncertainty must be below half of it",
        significant(*ratio, 2),
        significant(*uncertainty, 2)
    )]
    Uncertain {
        /// Damping ratio of the mode.
        observable: Observable,
        /// Value of the ratio.
        ratio: f64,
        /// Standard uncertainty of the ratio.
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
    /// Suggests a remedy to the user.
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
    /// Identifies modes in a decay; each is the strongest vibration with a natural frequency between two frequencies in
    /// Hz.
    ///
    /// The search adds vibrations in the order of their peaks in the spectrum of the remainder, up to four beyond the
    /// requested modes, and fits all again with each. Each has a frequency and a decay rate, besides an offset and a
    /// drift of the sensor. The uncertainties follow from the remaining differences: from their variance or, if larger,
    /// from their sums over one and over three periods, which include correlation from sample to sample.
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
        // Only an offset and a drift.
        let line = Damped::of(&samples, Vec::new())
            .ok_or_else(|| DecayError::Constant(given.column.clone()))?;
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

    /// The values for a fit, with a relative uncertainty from other causes than the noise of the samples.
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
    /// A mode from a vibration and the variances of σ and ω; `bend` contains σ in the first and in the last samples,
    /// and the standard error of their difference.
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
        // Any ratio between both ends is equally good: the variance of a uniform distribution.
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
        // The warning says more than an uncertainty that no measurement may have.
        let of_both = (of_ratio + of_bend).sqrt().min(MOST_OF_BEND * ratio);
        let uncertainty = least(ratio, of_both.max(of_ratio.sqrt()));
        let ratio = Measured { observable: observable.ratio(), value: ratio, uncertainty };
        Self { frequency, ratio, bent }
    }

    /// Refuses a ratio that the samples do not determine, if the fit uses it.
    fn check(&self, values: DecayValues) -> Result<(), DecayError> {
        let Measured { ref observable, value: ratio, uncertainty } = self.ratio;
        let uncertainty = uncertainty.unwrap_or_default();
        if values == DecayValues::Frequencies || uncertainty < MOST_UNCERTAIN * ratio {
            return Ok(());
        }
        Err(DecayError::Uncertain { observable: observable.clone(), ratio, uncertainty })
    }
}

/// Limit of vibrations besides the requested modes.
const MOST_OTHERS: usize = 4;

/// Smallest relative distance of a vibration besides the modes from all others.
const APART: f64 = 0.2;

/// Ratio to the samples' amplitude below which a vibration does not count.
const LEAST: f64 = 1e-4;

/// Logarithm of one over the chance that a spectrum of noise has a higher peak: for an unrequested vibration, and for a
/// mode.
const CHANCE: f64 = 10.0;
const CHANCE_OF_MODE: f64 = 5.0;

/// Decay rates of the samples' weights in the spectra.
const WEIGHTS: [f64; 4] = [0.0, 3.0, 10.0, 30.0];

/// Factor up and down to the neighbouring frequencies of a peak.
const NEIGHBOURS: f64 = 1.6;

/// Number of peaks tried in each spectrum.
const MOST_TRIED: usize = 30;

/// Decay rates over the time of all samples at which iterations start.
const RATES: [f64; 6] = [0.3, 1.0, 3.0, 10.0, 30.0, 100.0];

/// Search for the vibrations of modes, each with its frequency in a range in Hz.
pub(super) struct Search<'a> {
    pub(super) samples: &'a [f64],
    pub(super) duration_s: f64,
    pub(super) modes: &'a [(Observable, [f64; 2])],
}

impl Search<'_> {
    /// All vibrations above the noise.
    pub(super) fn all(&self, line: Damped) -> Damped {
        let mut fit = line;
        let pair = FourierPair::fast(2 * self.samples.len());
        while fit.poles.len() < self.modes.len() + MOST_OTHERS {
            let Some(omega) = self.peak(&pair, &fit) else { break };
            let starts = RATES.into_iter().filter(|sigma| *sigma < 0.3 * omega);
            let starts = starts.filter_map(|sigma| {
                let poles = fit.poles.iter().copied().chain([Pole { sigma, omega }]);
                Damped::of(self.samples, poles.collect())
            });
            let Some(start) = starts.min_by(|a, b| a.cost.total_cmp(&b.cost)) else { break };
            fit = start.settled(self.samples);
        }
        fit
    }

    /// Frequency of the next vibration: the highest peak over the noise in any of several spectra of the remainder.
    /// Each spectrum weights the samples by another decay, so that short vibrations stand out in long records.
    fn peak(&self, pair: &FourierPair, fit: &Damped) -> Option<f64> {
        let differences = fit.differences(self.samples);
        let len = self.samples.len() as f64;
        let looked_for = self.looked_for(fit);
        let weighed = |rate: &f64| {
            let weight = |k: usize| libm::exp(-rate * k as f64 / len);
            let weighed = differences.iter().enumerate().map(|(k, r)| r * weight(k));
            let found = pair.amplitudes(weighed.collect::<Vec<f64>>());
            let power: Vec<f64> = found.iter().map(Complex64::norm_sqr).collect();
            self.highest(&power, pair.len() as f64 / len, fit, &looked_for)
        };
        let peaks = WEIGHTS.iter().filter_map(weighed);
        peaks.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, omega)| omega)
    }

    /// Ranges in Hz of the modes without a vibration so far.
    fn looked_for(&self, fit: &Damped) -> Vec<[f64; 2]> {
        let modes = self.modes.iter().zip(self.assigned(fit));
        modes.filter(|(_, place)| place.is_none()).map(|((_, within), _)| *within).collect()
    }

    /// Peak of a spectrum that is highest over the noise: its height over the noise, and its frequency.
    fn highest(
        &self,
        power: &[f64],
        scale: f64,
        fit: &Damped,
        looked_for: &[[f64; 2]],
    ) -> Option<(f64, f64)> {
        let bins = libm::log(self.samples.len() as f64);
        let least_power = (0.5 * LEAST / scale).powi(2);
        // The powers of noise are exponential: their mean is their median over ln 2.
        let noise =
            |among: &[f64], chance: f64| (median(among) / LN_2 * (bins + chance)).max(least_power);
        let omega = |k: usize| TAU * k as f64 / scale;
        let is_looked_for = |omega: f64| {
            let hertz = omega / TAU / self.duration_s;
            looked_for.iter().any(|[low, high]| hertz > *low && hertz < *high)
        };
        let is_apart = |omega: f64| {
            let near = if is_looked_for(omega) { 0.0 } else { APART };
            fit.poles.iter().all(|pole| {
                let least = (near * pole.omega).max(1.5 * TAU).max(2.0 * pole.sigma.abs());
                (omega - pole.omega).abs() > least
            })
        };
        let of_all = noise(power, CHANCE_OF_MODE);
        let is_peak = |k: &usize| {
            let (own, omega) = (power[*k], omega(*k));
            let is_highest = own >= power[k - 1] && own > power[k + 1];
            own > of_all && is_highest && omega > TAU && is_apart(omega)
        };
        let mut peaks: Vec<usize> = (1..power.len() - 1).filter(is_peak).collect();
        peaks.sort_by(|a, b| power[*b].total_cmp(&power[*a]));
        // Around a vibration that is not exponential the remainder has peaks on both sides, which are no vibrations.
        let beside = (1..power.len()).filter(|k| !is_apart(omega(*k)));
        let beside = beside.map(|k| power[k]).fold(0.0, f64::max);
        // In noise that is not white a vibration must exceed its neighbours.
        let over_noise = |k: usize| {
            let around = [k as f64 / NEIGHBOURS, k as f64 * NEIGHBOURS].map(|k| k as usize);
            let neighbours = &power[around[0]..=around[1].min(power.len() - 1)];
            let of_others = || noise(neighbours, CHANCE).max(beside);
            let least = if is_looked_for(omega(k)) { of_all } else { of_others() };
            (power[k] / least, omega(k))
        };
        peaks.into_iter().take(MOST_TRIED).map(over_noise).find(|(over, _)| *over > 1.0)
    }

    /// The strongest vibration of each mode.
    pub(super) fn assigned(&self, fit: &Damped) -> Vec<Option<usize>> {
        let strongest = |[low, high]: [f64; 2]| {
            let is_within = |k: &usize| {
                let hertz = self.hertz(&fit.poles[*k]);
                hertz > low && hertz < high
            };
            let within = (0..fit.poles.len()).filter(is_within);
            within.max_by(|a, b| fit.energy(*a).total_cmp(&fit.energy(*b)))
        };
        self.modes.iter().map(|(_, within_hz)| strongest(*within_hz)).collect()
    }

    /// Natural frequency in Hz.
    pub(super) fn hertz(&self, Pole { sigma, omega }: &Pole) -> f64 {
        (sigma * sigma + omega * omega).sqrt() / TAU / self.duration_s
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
