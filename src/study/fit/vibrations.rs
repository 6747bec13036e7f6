//! Vibrations above the noise of a decay.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "shares of a number of samples, and numbers of periods"
)]

use std::f64::consts::{LN_2, TAU};

use num_complex::Complex64;

use super::damped::{Damped, Pole};
use super::measurement::Observable;
use crate::numeric::FourierPair;

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
