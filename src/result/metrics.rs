use crate::inverse::{MotorHistories, Solution};
use crate::numeric::{TimeGrid, largest, sum_over};

/// Share of the peak torque that counts as acting: the level of the paper's 0.3 s.
pub const TIMING_LEVEL: f64 = 0.02;

/// Samples that are compared at a time.
const PART: usize = 512;

/// Largest absolute value of a history and when it occurs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// The largest absolute value.
    pub value: f64,
    /// Its time in s; the first one where several are equal.
    pub time_s: f64,
}

/// Numbers of a solution that a person reads first, over the written window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metrics {
    /// Largest |T| in N m.
    pub peak_torque_n_m: Peak,
    /// Root mean square of T in N m while it acts: from the first to the last |T| above 2 % of its
    /// peak, so that the rest around the motion does not count.
    pub rms_torque_n_m: f64,
    /// Largest |T| of the rigid link in N m.
    pub peak_rigid_torque_n_m: Peak,
    /// Peak torque over that of the rigid link.
    pub torque_ratio: f64,
    /// How long before the tip's first motion |T| first exceeds 2 % of its peak, in s; negative
    /// where it does so only afterwards.
    pub lead_s: f64,
    /// How long after the tip's last motion |T| last exceeds 2 % of its peak, in s.
    pub lag_s: f64,
    /// Largest |θ − θ(start)| in rad.
    pub peak_hub_angle_rad: Peak,
    /// Largest hub rate in rad/s.
    pub peak_hub_rate_rad_s: Peak,
    /// Largest mechanical power |T θ̇| in W.
    pub peak_power_w: Peak,
    /// Largest moment of the hub on the link's root in N m.
    pub peak_root_moment_n_m: Peak,
    /// Largest deflection of the tip from the hub's tangent line in m.
    pub peak_deflection_m: Peak,
    /// Largest tip velocity in m/s.
    pub peak_tip_velocity_m_s: Peak,
    /// Largest tip acceleration in m/s².
    pub peak_tip_acceleration_m_s2: Peak,
    /// What the motor does; none for a link without a drive.
    pub motor: Option<MotorMetrics>,
}

/// Numbers of the motor, on its own side of the gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorMetrics {
    /// Largest torque of the motor in N m.
    pub peak_torque_n_m: Peak,
    /// Root mean square of the motor's torque in N m while it acts: from the first to the last one
    /// above 2 % of its peak.
    pub rms_torque_n_m: f64,
    /// Largest rate of the rotor in rad/s.
    pub peak_rate_rad_s: Peak,
    /// Largest mechanical power of the motor in W.
    pub peak_power_w: Peak,
}

impl Metrics {
    /// Reads the numbers off a solution.
    pub fn of(solution: &Solution) -> Self {
        let grid = &solution.grid;
        let torque = &solution.torque_n_m;
        let peak = |samples: &[f64]| peak(samples, grid);
        let peak_torque_n_m = peak(torque);
        let peak_rigid_torque_n_m = peak(&solution.rigid_torque_n_m);
        let start = solution.hub_angle_rad[0];
        let travelled: Vec<f64> = solution.hub_angle_rad.iter().map(|a| a - start).collect();
        let power: Vec<f64> =
            torque.iter().zip(&solution.hub_rate_rad_s).map(|(t, rate)| t * rate).collect();
        let (first, last) = acting(torque, peak_torque_n_m);
        Self {
            peak_torque_n_m,
            rms_torque_n_m: rms(&torque[first..=last]),
            peak_rigid_torque_n_m,
            torque_ratio: peak_torque_n_m.value / peak_rigid_torque_n_m.value,
            lead_s: grid.time_s(solution.moving.0) - grid.time_s(first),
            lag_s: grid.time_s(last) - grid.time_s(solution.moving.1),
            peak_hub_angle_rad: peak(&travelled),
            peak_hub_rate_rad_s: peak(&solution.hub_rate_rad_s),
            peak_power_w: peak(&power),
            peak_root_moment_n_m: peak(&solution.root_moment_n_m),
            peak_deflection_m: peak(&solution.tip_deflection_m()),
            peak_tip_velocity_m_s: peak(&solution.tip.velocity_m_s),
            peak_tip_acceleration_m_s2: peak(&solution.tip.acceleration_m_s2),
            motor: solution.motor().map(|motor| MotorMetrics::of(&motor, grid)),
        }
    }
}

impl MotorMetrics {
    fn of(motor: &MotorHistories, grid: &TimeGrid) -> Self {
        let peak_torque_n_m = peak(&motor.torque_n_m, grid);
        let (first, last) = acting(&motor.torque_n_m, peak_torque_n_m);
        Self {
            peak_torque_n_m,
            rms_torque_n_m: rms(&motor.torque_n_m[first..=last]),
            peak_rate_rad_s: peak(&motor.rate_rad_s, grid),
            peak_power_w: peak(&motor.power_w, grid),
        }
    }
}

/// First and last sample of a torque above 2 % of its peak.
fn acting(torque_n_m: &[f64], peak_n_m: Peak) -> (usize, usize) {
    let acts = |t: &f64| t.abs() > TIMING_LEVEL * peak_n_m.value;
    let first = torque_n_m.iter().position(acts).unwrap_or(0);
    let last = torque_n_m.iter().rposition(acts).unwrap_or(0);
    (first, last)
}

pub(super) fn peak(samples: &[f64], grid: &TimeGrid) -> Peak {
    // By and by, so that only the part with the largest is looked through for it.
    let (mut value, mut first) = (0.0, 0);
    for (part, samples) in samples.chunks(PART).enumerate() {
        let here = largest(samples);
        if here > value {
            (value, first) = (here, part * PART);
        }
    }
    let within = samples[first..].iter().position(|sample| sample.abs() >= value).unwrap_or(0);
    Peak { value, time_s: grid.time_s(first + within) }
}

fn rms(samples: &[f64]) -> f64 {
    let squares = sum_over(samples, |x| x * x);
    (squares / samples.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_the_first_of_equal_magnitudes() {
        let grid = TimeGrid { origin_s: 1.0, step_s: 0.5, first: -1, len: 4 };
        let found = peak(&[0.0, -2.0, 1.0, 2.0], &grid);
        assert_eq!(found, Peak { value: 2.0, time_s: 1.0 });
    }

    #[test]
    fn the_root_mean_square_of_a_sine_is_its_amplitude_over_root_two() {
        let sine: Vec<f64> =
            (0..1000).map(|k| (0.01 * std::f64::consts::TAU * f64::from(k)).sin()).collect();
        assert!((rms(&sine) - 0.5_f64.sqrt()).abs() < 1e-12);
    }
}
