use crate::inverse::{Accuracy, Solution};
use crate::modal::torque_zeros;
use crate::response::{ResidualVibration, Simulation};
use crate::result::{Metrics, PlayedMetrics, TipError};

/// The numbers of a case whose torque was computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolvedCase {
    /// Period of the first mode in s; none if nothing vibrates.
    pub period_s: Option<f64>,
    /// First zero of torque → tip in 1/s.
    pub zero_per_s: Option<f64>,
    /// Peaks, lead and lag.
    pub metrics: Metrics,
    /// Frequency in Hz up to which the tip's motion is followed.
    pub band_hz: f64,
    /// Its measured errors.
    pub accuracy: Accuracy,
}

impl SolvedCase {
    /// Reads the numbers off a solution.
    pub fn of(solution: &Solution) -> Self {
        Self {
            period_s: first_period_s(&solution.natural_frequencies_rad_s(1)),
            zero_per_s: solution.first_zero_per_s,
            metrics: Metrics::of(solution),
            band_hz: solution.band.cutoff_hz.unwrap_or(solution.band.highest_hz),
            accuracy: solution.accuracy,
        }
    }
}

/// The numbers of a case on which a given torque was played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayedCase {
    /// Period of the first mode in s; none if nothing vibrates.
    pub period_s: Option<f64>,
    /// First zero of torque → tip in 1/s.
    pub zero_per_s: Option<f64>,
    /// Peaks, lead and lag.
    pub metrics: PlayedMetrics,
    /// How far the tip strays from the wanted motion.
    pub tip_error: TipError,
    /// Vibration after the torque.
    pub residual: ResidualVibration,
}

impl PlayedCase {
    /// Reads the numbers off a simulation; `tip_error` is that against its target.
    pub fn of(simulation: &Simulation, tip_error: TipError) -> Self {
        Self {
            period_s: first_period_s(&simulation.natural_frequencies_rad_s),
            zero_per_s: torque_zeros(&simulation.mesh, 1).first().copied(),
            metrics: PlayedMetrics::of(simulation),
            tip_error,
            residual: simulation.residual,
        }
    }
}

fn first_period_s(frequencies_rad_s: &[f64]) -> Option<f64> {
    frequencies_rad_s.first().map(|omega| std::f64::consts::TAU / omega)
}
