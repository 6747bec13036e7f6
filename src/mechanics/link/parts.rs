//! Parts at the ends and at the axis of a link, its damping, and the error for a value out of its range.

use std::fmt;
use std::fmt::Debug;

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

/// The carriage that a motor pushes across the link, in place of a hub.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Carriage {
    /// Mass M in kg, without the link.
    pub mass_kg: f64,
    /// Viscous friction b of the guide in N s/m.
    pub viscous_friction_n_s_m: f64,
}

impl Carriage {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        not_negative("carriage.mass", self.mass_kg, "kg")?;
        not_negative("carriage.viscous_friction", self.viscous_friction_n_s_m, "N s/m")
    }
}

/// Motor, gear and elastic joint that drive a hub, or motor, gear, pinion and belt of a carriage.
///
/// The rotor turns on the motor side of the gear. The joint's spring sits on the link's side and carries the hub's
/// torque, or the force on the carriage. Losses and the motor's constants act on the quantities of the motor alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Torque of the joint per twist in N m/rad, from 1e-30 to 1e30; infinite for a rigid joint. Of a carriage's belt in
    /// N/m.
    #[serde(deserialize_with = "null_is_stiff", alias = "joint_stiffness_n_m")]
    pub joint_stiffness_n_m_rad: f64,
    /// Rotary inertia of the rotor about its own axis in kg m², from 0 to 1e30.
    pub rotor_inertia_kg_m2: f64,
    /// Turns of the motor for one turn of the hub, from 1e-6 to 1e6. Of a carriage the motor's angle in rad per m of travel:
    /// the gear ratio over the radius of the pinion.
    #[serde(alias = "gear_ratio_rad_m")]
    pub gear_ratio: f64,
    /// Efficiency η of the gear, from 1e-6 to 1, in both directions of the power.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub efficiency: f64,
    /// Coulomb friction τ of the joint in N m, of a carriage in N, from 0 to 1e30.
    #[serde(default, skip_serializing_if = "is_zero", alias = "coulomb_friction_n")]
    pub coulomb_friction_n_m: f64,
    /// Rate of the joint in rad/s, of a carriage in m/s, at which 76 % of the losses' change of sign is done; `None`:
    /// 1 % of the joint's peak rate.
    #[serde(default, skip_serializing_if = "Option::is_none", alias = "friction_rate_m_s")]
    pub friction_rate_rad_s: Option<f64>,
    /// Torque constant k of the motor in N m/A, from 1e-30 to 1e30.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_constant_n_m_a: Option<f64>,
    /// Resistance R of the motor in Ω, from 1e-30 to 1e30.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resistance_ohm: Option<f64>,
}

fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, clippy::float_cmp, reason = "serde; an exact default")]
fn is_one(value: &f64) -> bool {
    *value == 1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Reads a joint stiffness; null is infinite, because JSON has no infinity.
fn null_is_stiff<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

impl Default for Drive {
    fn default() -> Self {
        Self::DIRECT
    }
}

/// Largest value of a drive's quantities, and the inverse of the least one that must be above 0.
const MOST: f64 = 1e30;

impl Drive {
    /// A stiff joint without gear, rotor, losses and constants of the motor.
    pub const DIRECT: Self = Self {
        joint_stiffness_n_m_rad: f64::INFINITY,
        rotor_inertia_kg_m2: 0.0,
        gear_ratio: 1.0,
        efficiency: 1.0,
        coulomb_friction_n_m: 0.0,
        friction_rate_rad_s: None,
        torque_constant_n_m_a: None,
        resistance_ohm: None,
    };

    pub(super) fn check(&self, slides: bool) -> Result<(), ParameterError> {
        let stiffness = self.joint_stiffness_n_m_rad;
        let most = if stiffness == f64::INFINITY { stiffness } else { MOST };
        let of_stiffness = "must lie from 1e-30 to 1e30 N m/rad, or be inf for a stiff joint";
        let [effort, rate] = if slides { ["N", "m/s"] } else { ["N m", "rad/s"] };
        let above_zero = |unit: &str| format!("must lie from 1e-30 to 1e30 {unit}");
        let positive = MOST.recip()..=MOST;
        let (of_rate, of_constant) = (self.friction_rate_rad_s, self.torque_constant_n_m_a);
        for (key, value, range, unit, must) in [
            ("joint_stiffness", stiffness, MOST.recip()..=most, "N m/rad", of_stiffness.to_owned()),
            (
                "rotor_inertia",
                self.rotor_inertia_kg_m2,
                0.0..=MOST,
                "kg m^2",
                "must lie from 0 to 1e30 kg m^2".to_owned(),
            ),
            ("gear_ratio", self.gear_ratio, 1e-6..=1e6, "", "must lie from 1e-6 to 1e6".to_owned()),
            ("efficiency", self.efficiency, 1e-6..=1.0, "", "must lie from 1e-6 to 1".to_owned()),
            (
                "coulomb_friction",
                self.coulomb_friction_n_m,
                0.0..=MOST,
                effort,
                format!("must lie from 0 to 1e30 {effort}"),
            ),
            ("friction_rate", of_rate.unwrap_or(1.0), positive.clone(), rate, above_zero(rate)),
            (
                "torque_constant",
                of_constant.unwrap_or(1.0),
                positive.clone(),
                "N m/A",
                above_zero("N m/A"),
            ),
            ("resistance", self.resistance_ohm.unwrap_or(1.0), positive, "ohm", above_zero("ohm")),
        ] {
            if !range.contains(&value) {
                // In scientific notation: 1e200 has 200 digits.
                let value = format!("{value:?}");
                return Err(ParameterError::new(format!("drive.{key}"), value, unit, must));
            }
        }
        match (self.resistance_ohm, of_constant) {
            (Some(resistance), None) => {
                let must =
                    "must come with drive.torque_constant, which makes a current of the torque";
                Err(ParameterError::new("drive.resistance", resistance, "ohm", must))
            }
            _ => Ok(()),
        }
    }

    /// The quantities of the motor that its constants give.
    pub fn known(&self) -> MotorKnown {
        match (self.torque_constant_n_m_a, self.resistance_ohm) {
            (Some(_), Some(_)) => MotorKnown::Voltage,
            (Some(_), None) => MotorKnown::Current,
            (None, _) => MotorKnown::Torque,
        }
    }

    /// Inertia n² J of the rotor at the joint: in kg m², at a carriage in kg.
    pub fn rotor_at_joint(&self) -> f64 {
        self.gear_ratio * self.gear_ratio * self.rotor_inertia_kg_m2
    }

    /// Torque at the joint per volt, n k/R; of a carriage in N/V. `None` without the motor's constants.
    pub fn effort_per_volt(&self) -> Option<f64> {
        Some(self.gear_ratio * self.torque_constant_n_m_a? / self.resistance_ohm?)
    }

    /// Viscous friction (n k)²/R of the motor's back voltage at the joint in N m s/rad, at a carriage in N s/m. `None`
    /// without the motor's constants.
    pub fn back_friction(&self) -> Option<f64> {
        Some(self.gear_ratio * self.torque_constant_n_m_a? * self.effort_per_volt()?)
    }

    /// True if friction or gear takes energy.
    pub fn has_losses(&self) -> bool {
        self.coulomb_friction_n_m > 0.0 || self.efficiency < 1.0
    }

    /// Rate of the joint by which the losses change their sign, where it moves at up to `peak_rate`.
    pub fn friction_rate(&self, peak_rate: f64) -> f64 {
        self.friction_rate_rad_s.unwrap_or(FRICTION_SHARE * peak_rate)
    }

    /// Direction x of a joint's rate, from −1 to 1: `tanh(rate/friction rate)`.
    pub fn direction(rate: f64, friction_rate: f64) -> f64 {
        if rate == 0.0 { 0.0 } else { libm::tanh(rate / friction_rate) }
    }

    /// Torque of the motor in N m, from the torque at the input of its gear, in front of the ratio, and the acceleration of
    /// the rotor in rad/s².
    pub(crate) fn motor_n_m(&self, geared_n_m: f64, acceleration_rad_s2: f64) -> f64 {
        geared_n_m / self.gear_ratio + self.rotor_inertia_kg_m2 * acceleration_rad_s2
    }

    /// Torque at the input of the gear, in front of its ratio, for the torque `joint_n_m` at the joint, and its slopes.
    /// `along` is the [`direction`](Self::direction) x of the joint's rate.
    ///
    /// ```text
    /// T' = T + τ x,   f = a T' + b |T'| x,   a = (1/η + η)/2,   b = (1/η − η)/2
    /// ```
    ///
    /// So f is `T'/η` where the motor drives at full rate, and `η T'` where it brakes.
    pub fn with_losses(&self, joint_n_m: f64, along: f64) -> Lossy {
        let inverse = self.efficiency.recip();
        let [mean, half] = [0.5 * (inverse + self.efficiency), 0.5 * (inverse - self.efficiency)];
        let loaded = joint_n_m + self.coulomb_friction_n_m * along;
        let per_torque = mean + half * along.copysign(along * loaded);
        Lossy {
            torque: mean * loaded + half * loaded.abs() * along,
            per_torque,
            per_direction: per_torque * self.coulomb_friction_n_m + half * loaded.abs(),
        }
    }
}

/// Share of a joint's peak rate by which losses change their sign, unless the drive has its rate.
const FRICTION_SHARE: f64 = 0.01;

/// Quantities of a motor by the constants that they need; each includes those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotorKnown {
    /// Torque and rate.
    Torque,
    /// Also the current: the torque constant is known.
    Current,
    /// Also the voltage: the resistance is known, too.
    Voltage,
}

/// Torque at the input of a gear with losses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lossy {
    /// The torque in front of the gear's ratio.
    pub torque: f64,
    /// Its slope by the torque at the joint.
    pub per_torque: f64,
    /// Its slope by the direction of the joint's rate.
    pub per_direction: f64,
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

    /// Component of gravity along a direction, positive if it pulls outward.
    pub fn along_m_s2(&self, angle_rad: f64) -> f64 {
        let [along_x, along_y] = self.acceleration_m_s2;
        along_x * libm::cos(angle_rad) + along_y * libm::sin(angle_rad)
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

/// Damping law of the link, without its joint (Bayo 1987, eqs 12, 15 and 16).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "lowercase", deny_unknown_fields)]
pub enum Damping {
    /// An undamped link.
    #[default]
    #[serde(deserialize_with = "no_more_keys")]
    None,
    /// Complex stiffness K(1 + 2iξ) (eq 16), the paper's law.
    Hysteretic {
        /// Material damping ratio ξ, in [0, 1).
        ratio: f64,
    },
    /// C = αM + βK for every mass and every stiffness.
    Rayleigh {
        /// α in 1/s, at least 0.
        alpha_per_s: f64,
        /// β in s, at least 0.
        beta_s: f64,
    },
    /// C = αM + βK with α and β such that two flexible modes get these ratios.
    #[serde(rename = "rayleigh through modes")]
    RayleighThroughModes {
        /// Numbers of the two flexible modes, from 1, ascending.
        modes: [usize; 2],
        /// Viscous ratio of each, in [0, 1).
        ratios: [f64; 2],
    },
    /// A viscous ratio ζ for each flexible mode, 2ζωq̇ in modal coordinates; rigid motion is free.
    Modal {
        /// ζ of each flexible mode from the first, in [0, 1), at least one; the last holds for all
        /// higher modes.
        ratios: Vec<f64>,
    },
    /// Caughey series through the ratios of these modes (Bayo 1987, eq 12); rigid motion is free:
    ///
    /// ```text
    /// ζ(ω) = ½ Σ_b a_b ω^(2b − 1),  b = 0 … p − 1,  ζ(ω_mode) = ratio for each of the p modes
    /// ```
    Caughey {
        /// Numbers of 1 to 8 flexible modes, from 1, strictly ascending.
        modes: Vec<usize>,
        /// Viscous ratio of each, in [0, 1).
        ratios: Vec<f64>,
    },
}

/// Reads a law without numbers. A plain unit variant would accept any further key.
fn no_more_keys<'de, D: Deserializer<'de>>(deserializer: D) -> Result<(), D::Error> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct NoKeys {}
    NoKeys::deserialize(deserializer).map(|NoKeys {}| ())
}

impl Damping {
    /// Largest number of terms of a Caughey series: the last power, ω¹³, spans twenty decades over the first eight
    /// modes of a beam.
    const MOST_TERMS: usize = 8;

    /// Name of the law in a link file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Hysteretic { .. } => "hysteretic",
            Self::Rayleigh { .. } | Self::RayleighThroughModes { .. } => "rayleigh",
            Self::Modal { .. } => "modal",
            Self::Caughey { .. } => "caughey",
        }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::None => Ok(()),
            Self::Hysteretic { ratio } => in_unit_interval("damping.ratio", *ratio),
            Self::Rayleigh { alpha_per_s, beta_s } => {
                not_negative("damping.alpha", *alpha_per_s, "1/s")?;
                not_negative("damping.beta", *beta_s, "s")
            }
            Self::RayleighThroughModes { modes, ratios } => {
                let must = "must be two flexible modes, numbered from 1, the lower first";
                ascending(modes, must)?;
                all_in_unit_interval(ratios)
            }
            Self::Modal { ratios } if ratios.is_empty() => {
                Err(refused("damping.ratios", ratios, "must hold at least one number"))
            }
            Self::Modal { ratios } => all_in_unit_interval(ratios),
            Self::Caughey { modes, ratios } => check_series(modes, ratios),
        }
    }
}

fn check_series(modes: &[usize], ratios: &[f64]) -> Result<(), ParameterError> {
    let most = Damping::MOST_TERMS;
    if !(1..=most).contains(&ratios.len()) {
        let must = format!("must hold 1 to {most} numbers for a Caughey series");
        return Err(refused("damping.ratios", ratios, must));
    }
    if modes.len() != ratios.len() {
        let must = format!("must be as many as damping.ratios, {}", ratios.len());
        return Err(refused("damping.modes", modes, must));
    }
    ascending(modes, "must be flexible modes, numbered from 1, in ascending order")?;
    all_in_unit_interval(ratios)
}

/// Refuses mode numbers that do not ascend from 1 or above.
fn ascending(modes: &[usize], must: &str) -> Result<(), ParameterError> {
    if modes.first() != Some(&0) && modes.is_sorted_by(|lower, higher| lower < higher) {
        Ok(())
    } else {
        Err(refused("damping.modes", modes, must))
    }
}

fn all_in_unit_interval(ratios: &[f64]) -> Result<(), ParameterError> {
    ratios.iter().try_for_each(|&ratio| in_unit_interval("damping.ratios", ratio))
}

/// Refuses a damping ratio outside [0, 1).
pub(crate) fn in_unit_interval(parameter: &str, ratio: f64) -> Result<(), ParameterError> {
    if (0.0..1.0).contains(&ratio) {
        Ok(())
    } else {
        Err(ParameterError::new(parameter, ratio, "", "must lie in [0, 1)"))
    }
}

fn refused<T: Debug>(parameter: &str, list: &[T], must: impl Into<String>) -> ParameterError {
    ParameterError::new(parameter, format!("{list:?}"), "", must)
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
        let check = |joint_stiffness_n_m_rad| {
            Drive { joint_stiffness_n_m_rad, ..Drive::default() }.check(false)
        };
        assert!(check(f64::INFINITY).is_ok());
        assert_eq!(
            check(0.0).unwrap_err().to_string(),
            "drive.joint_stiffness = 0.0 N m/rad, but must lie from 1e-30 to 1e30 N m/rad, or be \
             inf for a stiff joint"
        );
        assert!(check(f64::NAN).is_err() && check(-f64::INFINITY).is_err());
    }

    #[test]
    fn what_leaves_double_precision_on_the_way_to_the_motor_is_refused_by_name() {
        let drive =
            Drive { joint_stiffness_n_m_rad: 1e3, rotor_inertia_kg_m2: 1e-4, ..Drive::default() };
        let refusal = |drive: Drive| drive.check(false).unwrap_err().to_string();
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
            assert!(Drive { gear_ratio, ..drive }.check(false).is_err(), "{gear_ratio}");
        }
    }

    #[test]
    fn losses_and_constants_out_of_range_are_refused_in_the_joints_units() {
        let refusal = |drive: Drive, slides| drive.check(slides).map_err(|error| error.to_string());
        let friction = Drive { coulomb_friction_n_m: -1.0, ..Drive::DIRECT };
        let message = |unit: &str| {
            format!("drive.coulomb_friction = -1.0 {unit}, but must lie from 0 to 1e30 {unit}")
        };
        assert_eq!(refusal(friction, false), Err(message("N m")));
        assert_eq!(refusal(friction, true), Err(message("N")));
        for efficiency in [0.0, -0.5, 1.01, f64::NAN] {
            assert!(Drive { efficiency, ..Drive::DIRECT }.check(false).is_err(), "{efficiency}");
        }
        let alone = Drive { resistance_ohm: Some(2.0), ..Drive::DIRECT };
        let must = "must come with drive.torque_constant, which makes a current of the torque";
        assert_eq!(refusal(alone, false), Err(format!("drive.resistance = 2 ohm, but {must}")));
        assert!(refusal(Drive { torque_constant_n_m_a: Some(0.1), ..alone }, false).is_ok());
    }

    /// Slopes against differences, on both sides of a change of direction and of load.
    #[test]
    fn the_slopes_of_losses_are_those_of_their_torque() {
        let drive = Drive { efficiency: 0.7, coulomb_friction_n_m: 0.4, ..Drive::DIRECT };
        let torque = |joint_n_m: f64, along: f64| drive.with_losses(joint_n_m, along).torque;
        let step = 1e-6;
        for (joint_n_m, along) in [(1.0, 0.6), (1.0, -0.9), (-2.0, 0.3), (-0.1, -0.7)] {
            let found = drive.with_losses(joint_n_m, along);
            let slope = |up: f64, down: f64| (up - down) / (2.0 * step);
            let per_torque =
                slope(torque(joint_n_m + step, along), torque(joint_n_m - step, along));
            let per_direction =
                slope(torque(joint_n_m, along + step), torque(joint_n_m, along - step));
            assert!((found.per_torque - per_torque).abs() < 1e-8, "{found:?}");
            assert!((found.per_direction - per_direction).abs() < 1e-8, "{found:?}");
        }
        assert!((torque(1.0, 1.0) - 1.4 / 0.7).abs() < 1e-15);
        assert!((torque(1.0, -1.0) - 0.6 * 0.7).abs() < 1e-15);
        assert_eq!(Drive::direction(0.0, 0.0).to_bits(), 0);
    }

    fn refusal(law: &Damping) -> String {
        law.check().unwrap_err().to_string()
    }

    #[test]
    fn a_stored_law_is_read_back_and_another_key_is_refused() {
        let modal = Damping::Modal { ratios: vec![0.1] };
        let series = Damping::Caughey { modes: vec![2], ratios: vec![0.1] };
        let two = Damping::RayleighThroughModes { modes: [1, 2], ratios: [0.1; 2] };
        let rayleigh = Damping::Rayleigh { alpha_per_s: 0.1, beta_s: 0.0 };
        let hysteretic = Damping::Hysteretic { ratio: 0.1 };
        for law in [Damping::None, hysteretic, rayleigh, two, modal, series] {
            let stored = serde_json::to_string(&law).unwrap();
            assert_eq!(serde_json::from_str::<Damping>(&stored).unwrap(), law);
            let further = stored.replace('}', r#","more":1}"#);
            assert!(serde_json::from_str::<Damping>(&further).is_err(), "{further}");
        }
    }

    #[test]
    fn a_ratio_outside_zero_to_one_is_refused_with_its_value() {
        let error = Damping::Hysteretic { ratio: -0.02 }.check().unwrap_err();
        assert_eq!(error.to_string(), "damping.ratio = -0.02, but must lie in [0, 1)");
        assert!(Damping::Hysteretic { ratio: 1.0 }.check().is_err());
        assert!(Damping::Hysteretic { ratio: f64::NAN }.check().is_err());
        assert!(Damping::Hysteretic { ratio: 0.0 }.check().is_ok());
    }

    #[test]
    fn rayleigh_modes_must_ascend_from_one() {
        for modes in [[0, 1], [2, 2], [3, 1]] {
            let law = Damping::RayleighThroughModes { modes, ratios: [0.01, 0.02] };
            assert_eq!(law.check().unwrap_err().parameter, "damping.modes");
        }
    }

    #[test]
    fn modal_damping_needs_a_ratio_and_each_in_its_range() {
        let modal = |ratios: &[f64]| Damping::Modal { ratios: ratios.to_vec() };
        assert_eq!(modal(&[0.0, 0.02]).check(), Ok(()));
        assert_eq!(refusal(&modal(&[])), "damping.ratios = [], but must hold at least one number");
        for ratio in [-0.01, 1.0, f64::NAN] {
            assert_eq!(
                refusal(&modal(&[0.02, ratio])),
                format!("damping.ratios = {ratio}, but must lie in [0, 1)")
            );
        }
    }

    #[test]
    fn a_caughey_series_goes_through_one_to_eight_ascending_modes() {
        let caughey = |modes: &[usize], ratios: &[f64]| Damping::Caughey {
            modes: modes.to_vec(),
            ratios: ratios.to_vec(),
        };
        assert_eq!(caughey(&[3], &[0.02]).check(), Ok(()));
        assert_eq!(caughey(&[1, 2, 3, 4, 5, 6, 7, 9], &[0.02; 8]).check(), Ok(()));
        let ascending = "must be flexible modes, numbered from 1, in ascending order";
        for (modes, ratios, expected) in [
            (&[][..], &[][..], "ratios = [], but must hold 1 to 8 numbers for a Caughey series"),
            (&[1, 2], &[0.1], "modes = [1, 2], but must be as many as damping.ratios, 1"),
            (&[0, 1], &[0.1; 2], &format!("modes = [0, 1], but {ascending}")),
            (&[1, 3, 3], &[0.1; 3], &format!("modes = [1, 3, 3], but {ascending}")),
            (&[1, 2], &[0.1, 1.5], "ratios = 1.5, but must lie in [0, 1)"),
        ] {
            assert_eq!(refusal(&caughey(modes, ratios)), format!("damping.{expected}"));
        }
        assert!(caughey(&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[0.02; 9]).check().is_err());
    }
}
