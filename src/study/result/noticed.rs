//! Remarks on a link file, a motion and a solution.

use std::f64::consts::TAU;

use super::metrics::{Acting, JointMetrics, Metrics, timing_errors_s};
use super::peak::Peaks;
use super::remark::{DENSITIES_KG_M3, DURATIONS_S, FIRST_FREQUENCIES_HZ, MODULI_PA, Remark};
use crate::beam::Mesh;
use crate::inverse::{JointMotion, Solution};
use crate::link::{Arm, Link};
use crate::modal::Thickness;
use crate::motion::{Motion, Uncertainty};

/// Least excess of a jumping acceleration over its samples that causes a remark, as a share.
const OVERSHOOT: f64 = 0.05;

/// Usual travel of the tip relative to the length: a full turn.
const MOST_TRAVEL: f64 = TAU;

/// Share of a lead or a lag that its error must exceed to cause a remark.
const SURE: f64 = 0.05;

impl Remark {
    /// A remark on an unusual density above 0.
    pub fn on_density(parameter: &str, kg_m3: f64) -> Option<Self> {
        let is_usual = kg_m3 <= 0.0 || DENSITIES_KG_M3.contains(&kg_m3);
        (!is_usual).then(|| Self::Density { parameter: parameter.to_owned(), kg_m3 })
    }

    /// A remark on a rectangle that is thicker than wide.
    pub fn on_rectangle(parameter: &str, width_m: f64, thickness_m: f64) -> Option<Self> {
        let parameter = parameter.to_owned();
        (thickness_m > width_m).then_some(Self::Rectangle { parameter, width_m, thickness_m })
    }

    /// A remark on a start angle beyond a whole turn.
    pub fn on_start_angle(angle_rad: f64) -> Option<Self> {
        (angle_rad.abs() > TAU).then_some(Self::StartAngle { angle_rad })
    }

    /// A remark on an unusual Young's modulus.
    pub fn on_modulus(parameter: &str, pa: f64) -> Option<Self> {
        let is_usual = MODULI_PA.contains(&pa);
        (!is_usual).then(|| Self::Modulus { parameter: parameter.to_owned(), pa })
    }

    /// Remarks on the first natural frequencies of a link, in rad/s.
    pub fn on_modes(link: &Link, mesh: &Mesh, omegas_rad_s: &[f64]) -> Vec<Self> {
        let first = omegas_rad_s.first().map(|omega| omega / TAU);
        let rare = first.filter(|hertz| !FIRST_FREQUENCIES_HZ.contains(hertz));
        let guessed = Thickness::guessed(link);
        let thick = guessed.and_then(|guess| guess.noticeable(mesh, omegas_rad_s));
        rare.map(|hertz| Self::FirstFrequency { hertz })
            .into_iter()
            .chain(thick.map(|thick| Self::UnknownSection { mode: thick.highest }))
            .collect()
    }

    /// Remarks on a motion that moves the tip by `travel_m`; the tip may stray by the share `tolerance` of it.
    pub fn on_motion(arm: &Arm, motion: &Motion, travel_m: f64, tolerance: f64) -> Vec<Self> {
        let length_m = arm.length_m();
        let duration = Self::on_duration(motion);
        let travel =
            (travel_m > MOST_TRAVEL * length_m).then_some(Self::Travel { travel_m, length_m });
        let of_samples = Self::on_samples(motion, travel_m, tolerance);
        duration.into_iter().chain(travel).chain(of_samples).collect()
    }

    /// A remark on the duration of a motion.
    pub fn on_duration(motion: &Motion) -> Option<Self> {
        let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
        let duration_s = grid.time_s(until) - grid.time_s(from);
        let is_usual = DURATIONS_S.contains(&duration_s);
        (!is_usual).then_some(Self::Duration { duration_s })
    }

    /// A remark on a solution whose tip, followed up to a frequency, accelerates more than its motion.
    pub fn on_jumps(solution: &Solution) -> Option<Self> {
        let motion = solution.motion.tip().filter(|motion| motion.jumps())?;
        let cutoff_hz = solution.band.cutoff_hz?;
        let peak_m_s2 = Peaks::in_solution(solution).of(&solution.tip[0].acceleration_m_s2).value;
        let share = peak_m_s2 / motion.largest_acceleration_m_s2() - 1.0;
        (share > OVERSHOOT).then_some(Self::Jumps { cutoff_hz, peak_m_s2, share })
    }

    /// Remarks on the times of torques that the samples of the motion leave uncertain.
    pub fn on_timing(solution: &Solution) -> Vec<Self> {
        if solution.joints.iter().all(|joint| joint.errors.torque.input.is_none()) {
            return Vec::new();
        }
        let joints = solution.joints.iter().zip(Metrics::of(solution).joints);
        let of = |(joint, metrics): (&JointMotion, JointMetrics)| {
            let share = joint.errors.torque.input?;
            let torque = (&joint.torque_n_m[..], metrics.peak_torque_n_m);
            let [lead_s, lag_s] = timing_errors_s(&solution.grid, share, |level| {
                Acting::in_solution(solution, torque, level)
            });
            // Errors count only above a considerable share of lead or lag.
            let is_noticed =
                lead_s > SURE * metrics.lead_s?.abs() || lag_s > SURE * metrics.lag_s?.abs();
            let joint = metrics.joint.map(|number| number + 1);
            let of_range = solution.arm.has_weight();
            is_noticed.then_some(Self::Timing { joint, share, of_range, lead_s, lag_s })
        };
        joints.filter_map(of).collect()
    }

    /// Remarks on the accuracy of the samples of a motion.
    fn on_samples(motion: &Motion, travel_m: f64, tolerance: f64) -> impl Iterator<Item = Self> {
        let (grid, recording, tip) = (motion.grid(), motion.recording(), motion.tip());
        let jitter = recording.jitter.map(|steps| Self::Jitter { steps, step_s: grid.step_s });
        let moves = tip.filter(|_| recording.moves_by_column).map(|motion| {
            let [before_m_s, after_m_s] = motion.end_velocities_m_s();
            Self::MovingEnds { before_m_s, after_m_s }
        });
        let uncertain = recording.uncertainty.and_then(|uncertainty| {
            let followed_m = match (uncertainty, tip) {
                (Uncertainty::Integrated { .. }, Some(tip)) => {
                    tip.cutoff(tolerance).followed_m()?
                }
                _ => uncertainty.tolerance_m(grid.len),
            };
            let followed = followed_m / travel_m;
            // At 0 the solver uses all frequencies, whatever the accuracy of the samples.
            let is_raised = tolerance > 0.0 && followed > tolerance;
            (is_raised && recording.lowpass_rad_s.is_none()).then_some(match uncertainty {
                Uncertainty::Rounded { decimals, step_m } => {
                    let half_step_m = 0.5 * step_m;
                    match tip {
                        Some(_) => Self::FewDigits { decimals, half_step_m, followed, tolerance },
                        None => Self::PathDigits { decimals, half_step_m, followed, tolerance },
                    }
                }
                Uncertainty::Noisy { deviation_m, moved_m } => {
                    Self::Noise { deviation_m, moved_m, followed, tolerance }
                }
                Uncertainty::Integrated { times, decimals, step } => {
                    let column = if times == 1 { "velocity" } else { "acceleration" }.to_owned();
                    let half_step = 0.5 * step;
                    Self::IntegratedDigits { column, decimals, half_step, followed, tolerance }
                }
            })
        });
        let samples = recording.dropped;
        let dropped = (samples > 0).then_some(Self::DroppedOutliers { samples });
        jitter.into_iter().chain(dropped).chain(moves).chain(uncertain)
    }
}
