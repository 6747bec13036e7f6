//! The numbers that a sweep has of each case, and the names of their columns.

use std::f64::consts::TAU;

use crate::inverse::Solution;
use crate::modal::torque_zeros;
use crate::response::{ResidualVibration, Simulation};
use crate::result::{Metrics, MotorMetrics, PlayedMetrics, TipError};

/// A case whose torque was computed.
#[derive(Clone, Copy)]
pub struct SolvedCase<'a> {
    /// The solution.
    pub solution: &'a Solution,
    /// Its metrics.
    pub metrics: &'a Metrics,
    /// Its first natural frequency in rad/s; none if nothing vibrates.
    pub first_rad_s: Option<f64>,
}

/// A case on which a torque was played.
#[derive(Debug, Clone, Copy)]
pub struct PlayedCase<'a> {
    /// The simulation.
    pub simulation: &'a Simulation,
    /// Its metrics.
    pub metrics: &'a PlayedMetrics,
    /// The error of the tip against its target.
    pub tip_error: &'a TipError,
}

/// A column and the number that it shows of a case, where it has one.
type Solved = (&'static str, fn(&SolvedCase<'_>) -> Option<f64>);
type Played = (&'static str, fn(&PlayedCase<'_>) -> Option<f64>);

const SOLVED: [Solved; 16] = [
    ("period_1_s", |case| case.first_rad_s.map(|omega| TAU / omega)),
    ("zero_1_per_s", |case| case.solution.first_zero_per_s),
    ("peak_torque_n_m", |case| Some(case.metrics.peak_torque_n_m.value)),
    ("rms_torque_n_m", |case| Some(case.metrics.rms_torque_n_m)),
    ("peak_rigid_torque_n_m", |case| Some(case.metrics.peak_rigid_torque_n_m.value)),
    ("torque_ratio", |case| Some(case.metrics.torque_ratio)),
    ("lead_s", |case| case.metrics.lead_s),
    ("lag_s", |case| case.metrics.lag_s),
    ("peak_hub_rate_rad_s", |case| Some(case.metrics.peak_hub_rate_rad_s.value)),
    ("peak_power_w", |case| Some(case.metrics.peak_power_w.value)),
    ("peak_root_moment_n_m", |case| Some(case.metrics.peak_root_moment_n_m.value)),
    ("peak_deflection_m", |case| Some(case.metrics.peak_deflection_m.value)),
    ("band_hz", |case| Some(case.solution.band.cutoff_hz.unwrap_or(case.solution.band.highest_hz))),
    ("tip_error", |case| Some(case.solution.accuracy.tip)),
    ("torque_mesh_error", |case| Some(case.solution.accuracy.errors.torque.mesh)),
    ("torque_window_error", |case| Some(case.solution.accuracy.errors.torque.window)),
];

const DRIVEN: [Solved; 4] = [
    ("peak_motor_torque_n_m", |case| of_motor(case, |motor| motor.peak_torque_n_m.value)),
    ("rms_motor_torque_n_m", |case| of_motor(case, |motor| motor.rms_torque_n_m)),
    ("peak_motor_rate_rad_s", |case| of_motor(case, |motor| motor.peak_rate_rad_s.value)),
    ("peak_motor_power_w", |case| of_motor(case, |motor| motor.peak_power_w.value)),
];

const PLAYED: [Played; 14] = [
    ("period_1_s", |case| {
        case.simulation.natural_frequencies_rad_s.first().map(|omega| TAU / omega)
    }),
    ("zero_1_per_s", |case| torque_zeros(&case.simulation.mesh, 1).first().copied()),
    ("tip_error_m", |case| Some(case.tip_error.worst_m)),
    ("tip_error_share", |case| Some(case.tip_error.share)),
    ("tip_error_time_s", |case| Some(case.tip_error.time_s)),
    ("rms_tip_error_m", |case| Some(case.tip_error.rms_m)),
    ("final_tip_error_m", |case| Some(case.tip_error.final_m)),
    ("residual_m", |case| residual(case).map(|left| left.amplitude_m)),
    ("residual_share", |case| residual(case).map(|left| left.share)),
    ("residual_frequency_hz", |case| residual(case)?.frequency_hz),
    ("residual_decay_s", |case| residual(case)?.decay_s),
    ("peak_hub_rate_rad_s", |case| Some(case.metrics.peak_hub_rate_rad_s.value)),
    ("peak_power_w", |case| Some(case.metrics.peak_power_w.value)),
    ("peak_deflection_m", |case| Some(case.metrics.peak_deflection_m.value)),
];

/// The vibration after the torque; none of a link with weight or at large angles.
fn residual<'a>(case: &PlayedCase<'a>) -> Option<&'a ResidualVibration> {
    case.simulation.modes().and_then(|modes| modes.residual.as_ref())
}

fn of_motor(case: &SolvedCase, number: fn(&MotorMetrics) -> f64) -> Option<f64> {
    case.metrics.motor.as_ref().map(number)
}

/// Which numbers a sweep has of its cases: the columns between those of the variations and the last two,
/// `warnings` and `error`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepKind {
    /// Of the torque for the motion.
    Solved,
    /// Of that of a link with a drive, with those of its motor.
    Driven,
    /// Of one torque played on every case.
    Played,
}

/// The numbers of a case, in the order of the columns; none where a case has no such number.
pub type CaseNumbers = Vec<Option<f64>>;

impl SweepKind {
    /// Names of the columns.
    pub fn names(self) -> Vec<&'static str> {
        match self {
            Self::Solved => SOLVED.map(|(name, _)| name).into(),
            Self::Driven => [&SOLVED[..], &DRIVEN].concat().iter().map(|(name, _)| *name).collect(),
            Self::Played => PLAYED.map(|(name, _)| name).into(),
        }
    }

    /// The numbers of a solved case.
    pub fn solved(self, case: &SolvedCase) -> CaseNumbers {
        let driven = DRIVEN.iter().filter(|_| self == Self::Driven);
        SOLVED.iter().chain(driven).map(|(_, of)| of(case)).collect()
    }

    /// The numbers of a case on which a torque was played.
    pub fn played(case: &PlayedCase) -> CaseNumbers {
        PLAYED.iter().map(|(_, of)| of(case)).collect()
    }
}
