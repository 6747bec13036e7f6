//! Parts at the ends and at the axis of a link, and the error for a value out of its range.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize};
use thiserror::Error;

use crate::text::plain;

/// Positions closer than this share of the link's length coincide: a sum of segment lengths can differ in its last
/// digits from a user's decimal for `at`.
pub(crate) const POSITION_TOLERANCE: f64 = 1e-9;

/// Longest text of a number that is shown with all its digits.
const LONGEST_NUMBER: usize = 12;

/// A physical parameter outside its range.
///
/// The text has the form of all errors of this program: `parameter = found unit, but must …`.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{parameter} = {found}, but {must}")]
pub struct ParameterError {
    /// Dotted path of the parameter, as in the link file: `segments.1.length`.
    pub parameter: String,
    /// The wrong value, with its unit.
    pub found: String,
    /// Condition that the value breaks.
    pub must: String,
}

impl ParameterError {
    /// Error for `parameter` with `value` in `unit` (empty for a pure number).
    pub(crate) fn new(
        parameter: impl Into<String>,
        value: impl fmt::Display,
        unit: &str,
        must: impl Into<String>,
    ) -> Self {
        let space = if unit.is_empty() { "" } else { " " };
        let text = value.to_string();
        // A number far from 1 has up to three hundred digits.
        let is_long = text.len() > LONGEST_NUMBER;
        let value = if is_long { text.parse().map_or(text, plain) } else { text };
        Self {
            parameter: parameter.into(),
            found: format!("{value}{space}{unit}"),
            must: must.into(),
        }
    }
}

/// Refuses a value unless it is finite and above zero.
pub(crate) fn positive(parameter: &str, value: f64, unit: &str) -> Result<(), ParameterError> {
    let is_positive = value.is_finite() && value > 0.0;
    let refused = || ParameterError::new(parameter, value, unit, "must be finite and above 0");
    if is_positive { Ok(()) } else { Err(refused()) }
}

/// Refuses a value unless it is finite and at least zero.
pub(crate) fn not_negative(parameter: &str, value: f64, unit: &str) -> Result<(), ParameterError> {
    let is_possible = value.is_finite() && value >= 0.0;
    let refused = || ParameterError::new(parameter, value, unit, "must be finite and at least 0");
    if is_possible { Ok(()) } else { Err(refused()) }
}

/// The rigid hub that the motor turns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hub {
    /// Rotary inertia I_H about the axis in kg m².
    pub inertia_kg_m2: f64,
    /// Rigid radius between the axis and the link's root in m.
    pub radius_m: f64,
    /// Viscous friction b of the joint in N m s/rad.
    pub viscous_friction_n_m_s_rad: f64,
}

impl Hub {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        not_negative("hub.inertia", self.inertia_kg_m2, "kg m^2")?;
        not_negative("hub.radius", self.radius_m, "m")?;
        not_negative("hub.viscous_friction", self.viscous_friction_n_m_s_rad, "N m s/rad")
    }
}

/// Friction and drive at the axis, added to the dynamics of the link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Viscous friction b in N m s/rad.
    pub friction_n_m_s_rad: f64,
    /// Gear and elastic joint between motor and hub, if there is a drive.
    pub drive: Option<Drive>,
}

/// Gear and elastic joint between motor and hub.
///
/// The rotor turns on the motor side of the gear. The joint's spring sits on the link's side and carries the hub's
/// torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Torque of the joint per twist in N m/rad, from 1e-30 to 1e30; infinite for a rigid joint.
    #[serde(deserialize_with = "null_is_stiff")]
    pub joint_stiffness_n_m_rad: f64,
    /// Rotary inertia of the rotor about its own axis in kg m², from 0 to 1e30.
    pub rotor_inertia_kg_m2: f64,
    /// Turns of the motor for one turn of the hub, from 1e-6 to 1e6.
    pub gear_ratio: f64,
}

/// Reads a joint stiffness; null is infinite, because JSON has no infinity.
fn null_is_stiff<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

impl Drive {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let stiffness = self.joint_stiffness_n_m_rad;
        let most = if stiffness == f64::INFINITY { stiffness } else { 1e30 };
        let of_stiffness = "must lie from 1e-30 to 1e30 N m/rad, or be inf for a stiff joint";
        for (key, value, range, unit, must) in [
            ("joint_stiffness", stiffness, 1e-30..=most, "N m/rad", of_stiffness),
            (
                "rotor_inertia",
                self.rotor_inertia_kg_m2,
                0.0..=1e30,
                "kg m^2",
                "must lie from 0 to 1e30 kg m^2",
            ),
            ("gear_ratio", self.gear_ratio, 1e-6..=1e6, "", "must lie from 1e-6 to 1e6"),
        ] {
            if !range.contains(&value) {
                // In scientific notation: 1e200 has 200 digits.
                let value = format!("{value:?}");
                return Err(ParameterError::new(format!("drive.{key}"), value, unit, must));
            }
        }
        Ok(())
    }
}

/// Gravity in the plane of motion, and the pose where displacements start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Acceleration of gravity along the plane's x and y axes in m/s².
    pub acceleration_m_s2: [f64; 2],
    /// Direction in rad of the chord, from the axis to the tip, at tip displacement 0: counterclockwise from x. `None`
    /// if motions contain angles.
    pub start_angle_rad: Option<f64>,
}

impl Gravity {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let axes = ["gravity.0", "gravity.1"].into_iter().zip(self.acceleration_m_s2);
        let numbers = axes.map(|(key, value)| (key, value, "m/s^2"));
        let angle = self.start_angle_rad.map(|angle| ("start_angle", angle, "rad"));
        let lost = numbers.chain(angle).find(|(_, value, _)| !value.is_finite());
        lost.map_or(Ok(()), |(parameter, value, unit)| {
            Err(ParameterError::new(parameter, value, unit, "must be finite"))
        })
    }

    /// True if gravity has a component in the plane.
    pub fn acts(&self) -> bool {
        self.acceleration_m_s2.iter().any(|part| *part != 0.0)
    }

    /// Component of gravity across a direction, positive if it turns the link clockwise: `g_x sin θ − g_y cos θ`.
    pub fn across_m_s2(&self, angle_rad: f64) -> f64 {
        let [along_x, along_y] = self.acceleration_m_s2;
        along_x * libm::sin(angle_rad) - along_y * libm::cos(angle_rad)
    }
}

/// A point mass fixed to the link.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LumpedMass {
    /// Distance from the axis in m, hub radius included.
    pub at_m: f64,
    /// Mass in kg.
    pub mass_kg: f64,
    /// Rotary inertia about its centre in kg m².
    pub inertia_kg_m2: f64,
}

/// Payload at the tip.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    /// Mass m_t in kg.
    pub mass_kg: f64,
    /// Rotary inertia J_t about its centre of mass in kg m².
    pub inertia_kg_m2: f64,
    /// Offset c of its centre of mass beyond the tip in m; negative towards the hub.
    pub offset_m: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::uniform;

    #[test]
    fn gravity_across_a_level_link_is_all_of_it_and_across_a_hanging_one_none() {
        let link = uniform().gravity([0.0, -9.81], 0.0).build().unwrap();
        let gravity = link.gravity().unwrap();
        assert!(link.has_weight() && (gravity.across_m_s2(0.0) - 9.81).abs() < 1e-12);
        assert!(gravity.across_m_s2(-0.5 * std::f64::consts::PI).abs() < 1e-12);
        assert!((gravity.across_m_s2(std::f64::consts::PI) + 9.81).abs() < 1e-12);
        assert!(!uniform().gravity([0.0; 2], 0.0).build().unwrap().has_weight());
        let lost = uniform().gravity([f64::NAN, 0.0], 0.0).build().unwrap_err();
        assert_eq!(lost.to_string(), "gravity.0 = NaN m/s^2, but must be finite");
    }

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
