use super::error::InversionError;
use super::solution::{Solution, cut};
use crate::link::Drive;

/// What the motor does, on its own side of the gear and on the solution's grid.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorHistories {
    /// Torque of the motor in N m.
    pub torque_n_m: Vec<f64>,
    /// Angle of the rotor in rad.
    pub angle_rad: Vec<f64>,
    /// Rate of the rotor in rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Mechanical power of the motor in W.
    pub power_w: Vec<f64>,
}

impl MotorHistories {
    /// Refuses a history that leaves double precision.
    ///
    /// # Errors
    /// [`InversionError::MotorNotFinite`].
    pub(super) fn check(&self) -> Result<(), InversionError> {
        let histories = [
            ("torque", &self.torque_n_m),
            ("angle", &self.angle_rad),
            ("rate", &self.rate_rad_s),
            ("power", &self.power_w),
        ];
        for (history, samples) in histories {
            if samples.iter().any(|sample| !sample.is_finite()) {
                return Err(InversionError::MotorNotFinite { history });
            }
        }
        Ok(())
    }
}

impl Solution {
    /// What the motor must do so that the hub receives the torque T; none for a link without a drive.
    ///
    /// The joint's spring twists by T/k; rotor inertia and gear ratio n follow:
    ///
    /// ```text
    /// φ = n (θ + T/k)      motor angle
    /// T_m = T/n + J φ̈      motor torque
    /// ```
    pub fn motor(&self) -> Option<MotorHistories> {
        let Drive { joint_stiffness_n_m_rad, rotor_inertia_kg_m2, gear_ratio } =
            self.model.link().joint().drive?;
        let hub = [&self.hub_angle_rad, &self.hub_rate_rad_s, self.hub_acceleration_rad_s2()];
        let [angle_rad, rate_rad_s, acceleration] = [0, 1, 2].map(|order| -> Vec<f64> {
            let torque = self.spectrum.derivative(&self.hub.torque_n_m, order);
            let twist = cut(&self.spectrum.pair.samples(torque), &self.grid);
            let motions = hub[order].iter().zip(twist);
            motions.map(|(hub, t)| gear_ratio * (hub + t / joint_stiffness_n_m_rad)).collect()
        });
        let torque_n_m: Vec<f64> = self
            .torque_n_m
            .iter()
            .zip(&acceleration)
            .map(|(t, a)| t / gear_ratio + rotor_inertia_kg_m2 * a)
            .collect();
        let power_w = torque_n_m.iter().zip(&rate_rad_s).map(|(t, rate)| t * rate).collect();
        Some(MotorHistories { torque_n_m, angle_rad, rate_rad_s, power_w })
    }
}
