//! A motor at the hub, for responses and records in volts.

use crate::link::{Hub, Link, LinkParts, ParameterError, positive};

/// A direct-current motor at the hub, with neglected inductance.
///
/// ```text
/// T = N k_t/R (V − N k_t θ̇)
/// ```
///
/// The back voltage acts as viscous friction `(N k_t)²/R` on the hub.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    torque_constant_n_m_a: f64,
    resistance_ohm: f64,
    gear_ratio: f64,
}

impl Motor {
    /// Torque constant `k_t` in N m/A, resistance R in Ω, and N turns of the motor for one of the hub.
    ///
    /// # Errors
    /// [`ParameterError`] names the first value that is not above 0.
    pub fn new(
        torque_constant_n_m_a: f64,
        resistance_ohm: f64,
        gear_ratio: f64,
    ) -> Result<Self, ParameterError> {
        positive("motor.torque_constant", torque_constant_n_m_a, "N m/A")?;
        positive("motor.resistance", resistance_ohm, "ohm")?;
        positive("motor.gear_ratio", gear_ratio, "")?;
        Ok(Self { torque_constant_n_m_a, resistance_ohm, gear_ratio })
    }

    /// Torque of the held hub per volt in N m/V.
    pub(super) fn torque_per_volt_n_m_v(&self) -> f64 {
        self.gear_ratio * self.torque_constant_n_m_a / self.resistance_ohm
    }

    /// Viscous friction of the shorted motor at the hub in N m s/rad.
    pub(super) fn friction_n_m_s_rad(&self) -> f64 {
        self.gear_ratio * self.torque_constant_n_m_a * self.torque_per_volt_n_m_v()
    }
}

/// The link with the friction due to a motor's back voltage on its hub; `None` if it is out of range.
pub(super) fn with_motor_friction(link: &Link, friction_n_m_s_rad: f64) -> Option<Link> {
    let parts = LinkParts::from(link.clone());
    let viscous_friction_n_m_s_rad = parts.hub.viscous_friction_n_m_s_rad + friction_n_m_s_rad;
    let hub = Hub { viscous_friction_n_m_s_rad, ..parts.hub };
    Link::new(LinkParts { hub, ..parts }).ok()
}
