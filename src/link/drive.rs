use super::error::{ParameterError, not_negative, positive};

/// What sits between motor and hub: a gear and an elastic joint.
///
/// The rotor turns on the motor side of the gear; the joint's spring on the link's side carries
/// the torque that the hub receives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Torque of the joint per twist in N m/rad, above 0; infinite for a stiff joint.
    pub joint_stiffness_n_m_rad: f64,
    /// Rotary inertia of the rotor about its own axis in kg m², at least 0.
    pub rotor_inertia_kg_m2: f64,
    /// Turns of the motor for one turn of the hub, above 0.
    pub gear_ratio: f64,
}

impl Drive {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`ParameterError`] names the first value out of its range.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let stiffness = self.joint_stiffness_n_m_rad;
        if stiffness.is_nan() || stiffness <= 0.0 {
            let must = "must be above 0; inf for a stiff joint";
            let parameter = "drive.joint_stiffness";
            return Err(ParameterError::new(parameter, stiffness, "N m/rad", must));
        }
        not_negative("drive.rotor_inertia", self.rotor_inertia_kg_m2, "kg m^2")?;
        positive("drive.gear_ratio", self.gear_ratio, "")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiff_joint_is_a_joint_and_none_is_not() {
        let drive = |joint_stiffness_n_m_rad| Drive {
            joint_stiffness_n_m_rad,
            rotor_inertia_kg_m2: 0.0,
            gear_ratio: 1.0,
        };
        assert!(drive(f64::INFINITY).check().is_ok());
        assert_eq!(
            drive(0.0).check().unwrap_err().to_string(),
            "drive.joint_stiffness = 0 N m/rad, but must be above 0; inf for a stiff joint"
        );
        assert!(Drive { gear_ratio: -2.0, ..drive(1.0) }.check().is_err());
    }
}
