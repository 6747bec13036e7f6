use serde::{Deserialize, Serialize};

use super::driving::{Cubic, Step};
use super::error::SimulationWarning;
use super::modes::Equations;
use super::stepper::Stepper;
use crate::numeric::{FourierPair, angular_frequency, fast_length, largest, magnitude};

/// A vibration has decayed when it stays below this share of its amplitude.
const DECAYED: f64 = 0.01;

/// Vibration below this share of the tip's travel is round-off.
const ROUND_OFF: f64 = 1e-12;

/// Periods of the first mode between two tests for decay, and the most tests.
const PERIODS: usize = 4;
const WATCHES: usize = 100;

/// Steps in a period of the first mode, enough for vibrating higher modes; the torque's step does not matter.
const STEPS: usize = 256;

/// Warning thresholds of the linear model's errors: of the tip over its travel, and of deflections over their peak.
const INEXACT_TIP: f64 = 1e-2;
const INEXACT_DEFLECTION: f64 = 0.2;

/// Zeros appended to the vibration, in lengths of it: they interpolate between the bins of its spectrum.
const ZEROS: usize = 3;

/// Motion of the tip after the last sample of the input, less the rotation of the rigid link; with feedback,
/// less the final position of the reference.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ResidualVibration {
    /// Largest excursion in m.
    pub amplitude_m: f64,
    /// Amplitude over the tip's travel, its largest displacement from its start.
    pub share: f64,
    /// Frequency of its strongest part in Hz; `None` without a vibration.
    pub frequency_hz: Option<f64>,
    /// Time in s from the input's last sample until the vibration stays below 1 % of its amplitude; `None` if it takes
    /// more than 400 periods of the first mode.
    pub decay_s: Option<f64>,
}

/// Errors of a simulation by the linear model, estimated from deflection, rate and vibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayedModelError {
    /// Error of the tip over its travel.
    pub tip: f64,
    /// Error of deflections over the largest.
    pub deflection: f64,
}

impl PlayedModelError {
    /// A warning of noticeable errors.
    pub(super) fn warning(self) -> Option<SimulationWarning> {
        let Self { tip, deflection } = self;
        let counts = tip > INEXACT_TIP || deflection > INEXACT_DEFLECTION;
        counts.then_some(SimulationWarning::InexactModel { tip, deflection })
    }

    /// Estimates the errors from the relative changes of the largest deflection and of the vibration's ω². Further
    /// needs deflection and travel in m, the vibration with its angular frequency in rad/s, and the simulated time in
    /// s.
    pub(super) fn of(
        [deflection, of_vibration]: [f64; 2],
        (deflection_m, travel_m): (f64, f64),
        vibration: Option<&ResidualVibration>,
        (omega_rad_s, played_s): (f64, f64),
    ) -> Self {
        let out_of_step_m = vibration.map_or(0.0, |vibration| {
            // Time times a vibration that decays to 1 % in t is largest at t/ln 100, with 1/e of its amplitude.
            let most_s = vibration.decay_s.map_or(played_s, |decay_s| played_s.min(decay_s / 12.5));
            // The relative change of ω is half that of ω².
            let phase_rad = 0.5 * of_vibration * omega_rad_s * most_s;
            phase_rad.min(2.0) * vibration.amplitude_m
        });
        let moved_m = deflection * deflection_m + out_of_step_m;
        let tip = if moved_m > 0.0 && travel_m > 0.0 { moved_m / travel_m } else { 0.0 };
        Self { tip, deflection }
    }
}

impl ResidualVibration {
    /// Continues from the coordinates and rates at the torque's last sample, under the input `held`, until
    /// the vibration has decayed; the tip's largest displacement from its start is `travel_m`.
    pub(super) fn of(
        equations: &Equations,
        (coordinates, rates): (&[f64], &[f64]),
        held: Cubic,
        reading: &Reading,
        travel_m: f64,
    ) -> Self {
        let Some(period_s) = equations.first_period_s() else {
            return Self { decay_s: Some(0.0), ..Self::default() };
        };
        let step_s = period_s / STEPS as f64;
        let mut stepper = Stepper::new(equations, step_s).starting_at(coordinates, rates);
        let read = |q: &[f64], rate: &[f64]| reading.of(equations, q, rate);
        let mut vibration = vec![read(coordinates, rates)];
        let (watch, held) = (PERIODS * STEPS, Step::from(held));
        for _ in 0..WATCHES {
            for _ in 0..watch {
                stepper.advance(&held);
                vibration.push(read(&stepper.coordinates(), &stepper.rates()));
            }
            let recent = &vibration[vibration.len() - watch..];
            if largest(recent) <= DECAYED * largest(&vibration) {
                break;
            }
        }
        Self::measured(&vibration, step_s, travel_m, watch)
    }

    fn measured(vibration: &[f64], step_s: f64, travel_m: f64, watch: usize) -> Self {
        let amplitude_m = peak_between(vibration);
        let share = if travel_m > 0.0 { amplitude_m / travel_m } else { 0.0 };
        if share <= ROUND_OFF {
            return Self { amplitude_m, share, frequency_hz: None, decay_s: Some(0.0) };
        }
        let stays = |x: &f64| x.abs() > DECAYED * amplitude_m;
        let last = vibration.iter().rposition(stays).unwrap_or(0);
        let has_decayed = last + watch <= vibration.len();
        Self {
            amplitude_m,
            share,
            frequency_hz: strongest_hz(&vibration[..=last], step_s),
            decay_s: has_decayed.then_some((last + 1) as f64 * step_s),
        }
    }
}

/// Part of the tip's displacement that is no vibration.
pub(super) enum Reading {
    /// A reference holds the hub: the tip's final displacement in m.
    Held(f64),
    /// The hub turns freely, or as prescribed: the tip's deflection by friction in m per rate of the rigid
    /// rotation. The rotation itself is no vibration either.
    Free(f64),
}

impl Reading {
    /// The reading of a link with its tip held at a goal, or with a free hub.
    pub(super) fn new(equations: &Equations, goal_m: Option<f64>) -> Self {
        if let Some(goal_m) = goal_m {
            return Self::Held(goal_m);
        }
        let modes = &equations.coordinates[1..];
        let per_torque: f64 =
            modes.iter().map(|mode| mode.tip * mode.hub_angle / mode.square).sum();
        let drag = equations.reaction.damping_n_m_s_rad * equations.coordinates[0].hub_angle;
        Self::Free(-drag * per_torque)
    }

    /// Displacement of the tip by vibration in m.
    fn of(&self, equations: &Equations, coordinates: &[f64], rates: &[f64]) -> f64 {
        match self {
            Self::Held(goal_m) => equations.tip(coordinates) - goal_m,
            Self::Free(dragged_m_s) => {
                let modes = coordinates.iter().zip(&equations.coordinates).skip(1);
                let bent_m: f64 = modes.map(|(q, mode)| q * mode.tip).sum();
                bent_m - dragged_m_s * rates[0]
            }
        }
    }
}

/// Largest excursion, also between samples: the top of the quartic through the largest sample and two on
/// each side.
fn peak_between(samples: &[f64]) -> f64 {
    let sizes = |a: &usize, b: &usize| samples[*a].abs().total_cmp(&samples[*b].abs());
    let Some(top) = (0..samples.len()).max_by(sizes) else { return 0.0 };
    if top < 2 || top + 2 >= samples.len() {
        return samples[top].abs();
    }
    let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|k| samples[top + k - 2]);
    // Derivatives at the top in steps, by central differences of fourth order.
    let slope = (a - 8.0 * b + 8.0 * d - e) / 12.0;
    let curvature = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 12.0;
    let third = 0.5 * (e - a) + b - d;
    let fourth = a - 4.0 * b + 6.0 * c - 4.0 * d + e;
    let derivative = |s: f64| slope + s * (curvature + s * (third / 2.0 + s * fourth / 6.0));
    let bend = |s: f64| curvature + s * (third + s * fourth / 2.0);
    // From half a step away a few of Newton's steps converge to the last bit.
    let at = (0..4).fold(0.0, |s, _| s - derivative(s) / bend(s));
    if at.abs() < 1.0 {
        let series = [c, slope, curvature / 2.0, third / 6.0, fourth / 24.0];
        let crest = series.iter().rev().fold(0.0, |sum, term| sum * at + term);
        c.abs().max(crest.abs())
    } else {
        // Next to a kink the quartic is useless.
        c.abs()
    }
}

/// Frequency of the strongest part: the highest point of the spectrum under a Hann window, by a
/// parabola through the logarithms around it.
fn strongest_hz(vibration: &[f64], step_s: f64) -> Option<f64> {
    let len = vibration.len();
    if len < 8 {
        return None;
    }
    let padded = fast_length((1 + ZEROS) * len);
    let window = |k: usize| {
        let sine = libm::sin(std::f64::consts::PI * (k as f64 + 0.5) / len as f64);
        sine * sine
    };
    // Removes the mean under the window: a remainder could exceed a decaying vibration.
    let weights: f64 = (0..len).map(window).sum();
    let mean = vibration.iter().enumerate().map(|(k, x)| window(k) * x).sum::<f64>() / weights;
    let mut samples: Vec<f64> =
        vibration.iter().enumerate().map(|(k, x)| window(k) * (x - mean)).collect();
    samples.resize(padded, 0.0);
    let sizes: Vec<f64> =
        FourierPair::new(padded).amplitudes(samples).into_iter().map(magnitude).collect();
    let peak = (1..sizes.len() - 1).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]))?;
    if sizes[peak - 1..=peak + 1].contains(&0.0) {
        return None;
    }
    let [before, at, after] =
        [-1_isize, 0, 1].map(|k| libm::log(sizes[peak.saturating_add_signed(k)]));
    let offset = 0.5 * (before - after) / (before - 2.0 * at + after);
    let spacing = angular_frequency(1, padded, step_s) / std::f64::consts::TAU;
    Some((peak as f64 + offset) * spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vibration_that_decays_within_few_periods_has_its_own_frequency() {
        for (rate_per_s, hertz) in [(0.25, 0.37), (0.5, 0.8), (0.02, 0.1)] {
            let decaying = |k: i32| {
                let t = 0.5 * f64::from(k);
                (-rate_per_s * t).exp() * (std::f64::consts::TAU * hertz * t).cos()
            };
            let vibration: Vec<f64> = (0..40).map(decaying).collect();
            let found = strongest_hz(&vibration, 0.5).unwrap();
            assert!((found / hertz - 1.0).abs() < 0.03, "{found} Hz is not {hertz} Hz");
        }
    }

    #[test]
    fn the_crest_between_samples_is_that_of_the_quartic_through_them() {
        for place in [-0.45, -0.1, 0.3, 0.45] {
            let quartic = |k: i32| {
                let s = f64::from(k) - place;
                3.0 - 0.5 * s * s + 0.05 * s.powi(3) - 0.02 * s.powi(4)
            };
            for sign in [1.0, -1.0] {
                let samples = [-2, -1, 0, 1, 2].map(|k| sign * quartic(k));
                let found = peak_between(&samples);
                assert!((found - 3.0).abs() < 1e-14, "{found} at {place}");
                for long in [[&[0.0; 9], &samples[..]].concat(), [&samples[..], &[0.0; 9]].concat()]
                {
                    assert_eq!(peak_between(&long).to_bits(), found.to_bits(), "wherever it is");
                }
                // Next to an end the largest sample replaces the quartic.
                for cut in [&samples[1..], &samples[..4]] {
                    assert_eq!(peak_between(cut).to_bits(), quartic(0).to_bits());
                }
            }
        }
        assert_eq!(peak_between(&[]).to_bits(), 0);
    }

    #[test]
    fn no_excursion_is_smaller_than_the_largest_sample_nor_far_above_it() {
        for kinked in [[0.0, 0.99, 1.0, 0.9999, -0.9], [0.9, 0.95, 1.0, 0.99999, 0.1]] {
            assert_eq!(peak_between(&kinked).to_bits(), 1.0_f64.to_bits());
        }
    }

    #[test]
    fn a_lasting_vibration_has_its_frequency_beside_any_offset_and_up_to_nyquists() {
        for offset in [0.0, 50.0] {
            let turns = 7.3 / 200.0;
            let swinging = |k: i32| offset + (std::f64::consts::TAU * turns * f64::from(k)).sin();
            let vibration: Vec<f64> = (0..200).map(swinging).collect();
            let found = strongest_hz(&vibration, 0.5).unwrap();
            assert!((found / (2.0 * turns) - 1.0).abs() < 1e-4, "{found} Hz beside {offset}");
        }
        let alternating: Vec<f64> = (0..64).map(|k| f64::from(1 - 2 * (k % 2))).collect();
        let found = strongest_hz(&alternating, 0.5).unwrap();
        assert!((found - 1.0).abs() < 1e-3, "{found} Hz is not 1 Hz");
        assert!(strongest_hz(&alternating[..8], 0.5).is_some());
        assert_eq!(strongest_hz(&alternating[..7], 0.5), None, "too short to tell");
        assert_eq!(strongest_hz(&[0.0; 64], 0.5), None, "at rest");
    }

    #[test]
    fn a_decay_lasts_until_the_vibration_stays_below_a_hundredth() {
        // The tenth sample is the last above a hundredth of the first.
        let vibration: Vec<f64> = (0..30).map(|k| 2.0 * 0.6_f64.powi(k)).collect();
        let measured = |watch| ResidualVibration::measured(&vibration, 0.5, 4.0, watch);
        assert_eq!(measured(20).decay_s, Some(5.0));
        assert_eq!(measured(21).decay_s, Some(5.0));
        assert_eq!(measured(22).decay_s, None, "not watched for so long");
        assert!((measured(20).share - 0.5).abs() < 1e-15, "{:?}", measured(20));
        let still = ResidualVibration { decay_s: Some(0.0), ..ResidualVibration::default() };
        assert_eq!(ResidualVibration::measured(&[0.0; 9], 0.5, 0.0, 4), still);
    }
}
