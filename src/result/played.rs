use super::peak::{Between, Peak, peak};
use crate::response::Simulation;

/// The numbers of a simulation that a person reads first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayedMetrics {
    /// Largest torque of the motor in N m.
    pub peak_torque_n_m: Peak,
    /// Largest distance of the tip from its start in m.
    pub farthest_m: f64,
    /// Displacement of the tip at the last sample less that at the first, in m.
    pub travel_m: f64,
    /// Velocity of the tip at the last sample in m/s.
    pub final_tip_velocity_m_s: f64,
    /// Largest |θ − θ(start)| in rad.
    pub peak_hub_angle_rad: Peak,
    /// Largest hub rate in rad/s.
    pub peak_hub_rate_rad_s: Peak,
    /// Largest mechanical power |T θ̇| of the motor in W.
    pub peak_power_w: Peak,
    /// Largest deflection of the tip from the hub's tangent line in m.
    pub peak_deflection_m: Peak,
}

impl PlayedMetrics {
    /// Reads the numbers off a simulation.
    pub fn of(simulation: &Simulation) -> Self {
        let Simulation { tip, torque_n_m, hub_angle_rad, hub_rate_rad_s, .. } = simulation;
        let peak = |samples: &[f64]| peak(samples, &simulation.grid, Between::Unknown);
        let displacement = &tip.displacement_m;
        let last = displacement.len() - 1;
        let turned: Vec<f64> = hub_angle_rad.iter().map(|a| a - hub_angle_rad[0]).collect();
        let power: Vec<f64> = torque_n_m.iter().zip(hub_rate_rad_s).map(|(t, w)| t * w).collect();
        Self {
            peak_torque_n_m: peak(torque_n_m),
            farthest_m: tip.largest_travel_m(),
            travel_m: displacement[last] - displacement[0],
            final_tip_velocity_m_s: tip.velocity_m_s[last],
            peak_hub_angle_rad: peak(&turned),
            peak_hub_rate_rad_s: peak(hub_rate_rad_s),
            peak_power_w: peak(&power),
            peak_deflection_m: peak(&simulation.tip_deflection_m()),
        }
    }
}
