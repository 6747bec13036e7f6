//! The hub, and the joint that turns it: friction, gear and elastic joint.

use std::ops::RangeInclusive;

use serde::{Deserialize, Deserializer, Serialize};

use super::error::{ParameterError, not_negative};

/// Stiffnesses of an elastic joint in N m/rad.
const STIFFNESSES_N_M_RAD: RangeInclusive<f64> = 1e-30..=1e30;

/// Rotary inertias of a rotor in kg m².
const INERTIAS_KG_M2: RangeInclusive<f64> = 0.0..=1e30;

/// Ratios of a gear.
const RATIOS: RangeInclusive<f64> = 1e-6..=1e6;

/// The rigid hub that the motor turns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Hub {
    /// Rotary inertia I_H about the axis in kg m².
    pub inertia_kg_m2: f64,
    /// Rigid radius between the axis and the link's root in m.
    pub radius_m: f64,
    /// Viscous friction b of the joint in N m s/rad.
    pub viscous_friction_n_m_s_rad: f64,
}

impl Hub {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`ParameterError`] names the first value out of its range.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        not_negative("hub.inertia", self.inertia_kg_m2, "kg m^2")?;
        not_negative("hub.radius", self.radius_m, "m")?;
        not_negative("hub.viscous_friction", self.viscous_friction_n_m_s_rad, "N m s/rad")
    }
}

/// What the joint at the axis adds to the dynamics of the link itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Viscous friction b in N m s/rad.
    pub friction_n_m_s_rad: f64,
    /// Gear and elastic joint between motor and hub, if there are any.
    pub drive: Option<Drive>,
}

/// What sits between motor and hub: a gear and an elastic joint.
///
/// The rotor turns on the motor side of the gear; the joint's spring on the link's side carries
/// the torque that the hub receives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Torque of the joint per twist in N m/rad, from 1e-30 to 1e30; infinite for a stiff joint.
    #[serde(deserialize_with = "null_is_stiff")]
    pub joint_stiffness_n_m_rad: f64,
    /// Rotary inertia of the rotor about its own axis in kg m², from 0 to 1e30.
    pub rotor_inertia_kg_m2: f64,
    /// Turns of the motor for one turn of the hub, from 1e-6 to 1e6.
    pub gear_ratio: f64,
}

/// Reads a joint stiffness: JSON has no infinity and writes null for it.
fn null_is_stiff<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

impl Drive {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`ParameterError`] names the first value out of its range.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let (stiffness, inertia) = (self.joint_stiffness_n_m_rad, self.rotor_inertia_kg_m2);
        let refuse = |key, value: f64, unit, must: &str| {
            // In the exponent's notation: 1e200 has 200 digits.
            let value = format!("{value:?}");
            Err(ParameterError::new(format!("drive.{key}"), value, unit, must))
        };
        let is_stiff = stiffness.is_infinite() && stiffness > 0.0;
        if !is_stiff && !STIFFNESSES_N_M_RAD.contains(&stiffness) {
            let must = "must lie from 1e-30 to 1e30 N m/rad, or be inf for a stiff joint";
            return refuse("joint_stiffness", stiffness, "N m/rad", must);
        }
        if !INERTIAS_KG_M2.contains(&inertia) {
            return refuse("rotor_inertia", inertia, "kg m^2", "must lie from 0 to 1e30 kg m^2");
        }
        if !RATIOS.contains(&self.gear_ratio) {
            return refuse("gear_ratio", self.gear_ratio, "", "must lie from 1e-6 to 1e6");
        }
        Ok(())
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
            "drive.joint_stiffness = 0.0 N m/rad, but must lie from 1e-30 to 1e30 N m/rad, or be \
             inf for a stiff joint"
        );
        assert!(drive(f64::NAN).check().is_err() && drive(-f64::INFINITY).check().is_err());
    }

    #[test]
    fn what_leaves_double_precision_on_the_way_to_the_motor_is_refused_by_name() {
        let drive =
            Drive { joint_stiffness_n_m_rad: 1e3, rotor_inertia_kg_m2: 1e-4, gear_ratio: 1.0 };
        let refusal = |drive: Drive| drive.check().unwrap_err().to_string();
        assert_eq!(
            refusal(Drive { gear_ratio: 1e200, ..drive }),
            "drive.gear_ratio = 1e200, but must lie from 1e-6 to 1e6"
        );
        assert_eq!(
            refusal(Drive { rotor_inertia_kg_m2: 1.7e308, ..drive }),
            "drive.rotor_inertia = 1.7e308 kg m^2, but must lie from 0 to 1e30 kg m^2"
        );
        let soft = Drive { joint_stiffness_n_m_rad: 5e-324, ..drive };
        assert!(refusal(soft).starts_with("drive.joint_stiffness = 5e-324 N m/rad, but"));
        for gear_ratio in [-2.0, 0.0, f64::NAN, f64::INFINITY] {
            assert!(Drive { gear_ratio, ..drive }.check().is_err(), "{gear_ratio}");
        }
    }
}
