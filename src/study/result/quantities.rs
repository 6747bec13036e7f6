//! The quantities of a joint: the one list that link files, summary.json, sweeps, limits, terminal, page and docs read,
//! and the errors of a joint's numbers. A figure of a limited history needs an entry in `LIMITED` of page/joint.rs, too.

use serde_json::{Map, Value};

use super::metrics::{JointMetrics, PlayedJoint};
use super::peak::Peak;
use crate::inverse::{LinkMotion, MotorHistories, QuantityErrors, Solution};
use crate::link::{Joint, Link, MotorKnown};
use crate::numeric::{Dimension, largest};
use crate::text::{instant, significant};

/// A number of each joint, its link or its motor.
#[derive(Debug, Clone, Copy)]
pub struct JointQuantity {
    /// Its name without the unit; columns of arms insert the joint's number after it: `peak_torque`.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// Its meaning in a sentence, for the schema of link files and for the docs.
    pub what: &'static str,
    /// Constants of the motor that a number of the motor needs; `None` for other numbers.
    pub of_motor: Option<MotorKnown>,
    /// True if sweeps have a column for it.
    pub is_swept: bool,
    /// Its limit in `[limits]`.
    pub(super) limit: Option<Limit>,
    /// Its place on the terminal.
    pub shown: Option<Shown>,
    /// Reads the number of a solution; `None` for a motion without it.
    pub of: fn(&JointMetrics) -> Option<f64>,
    /// Reads the number of a simulation, if simulations have it.
    pub of_played: Option<fn(&PlayedJoint) -> Option<f64>>,
}

/// A limited quantity: its key in the link file, and the error of its value in its unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    pub(super) key: &'static str,
    pub(super) error: fn(&Errors) -> f64,
}

/// The SI unit of a quantity.
#[derive(Debug, Clone, Copy)]
pub struct Unit {
    /// End of names: `_n_m`.
    pub suffix: &'static str,
    /// In text: `N m`.
    pub text: &'static str,
    /// The dimension of values in a link file.
    pub dimension: Dimension,
}

const TORQUE: Unit = Unit { suffix: "_n_m", text: "N m", dimension: Dimension::TORQUE };
const RATE: Unit = Unit { suffix: "_rad_s", text: "rad/s", dimension: Dimension::RATE };
const ACCELERATION: Unit =
    Unit { suffix: "_rad_s2", text: "rad/s²", dimension: Dimension::ANGULAR_ACCELERATION };
const POWER: Unit = Unit { suffix: "_w", text: "W", dimension: Dimension::POWER };
const LENGTH: Unit = Unit { suffix: "_m", text: "m", dimension: Dimension::LENGTH };
const ANGLE: Unit = Unit { suffix: "_rad", text: "rad", dimension: Dimension::NONE };
const TIME: Unit = Unit { suffix: "_s", text: "s", dimension: Dimension::TIME };
const CURRENT: Unit = Unit { suffix: "_a", text: "A", dimension: Dimension::CURRENT };
const VOLTAGE: Unit = Unit { suffix: "_v", text: "V", dimension: Dimension::VOLTAGE };
const RATIO: Unit = Unit { suffix: "", text: "", dimension: Dimension::NONE };

/// Place of a number in a line on the terminal.
#[derive(Debug, Clone, Copy)]
pub struct Shown {
    /// The label of the line.
    pub line: &'static str,
    /// Text with `{}` for the number and `{link}` for the word link or arm. The text that opens a line has no separator.
    pub text: &'static str,
    /// Writes the number.
    pub number: fn(f64) -> String,
}

const THREE: fn(f64) -> String = |number| significant(number, 3);
const FOUR: fn(f64) -> String = |number| significant(number, 4);

/// All quantities of a joint, in the order of summary.json.
pub const QUANTITIES: [JointQuantity; 22] = [
    of_joint("peak_torque", TORQUE, |own| Some(own.peak_torque_n_m.value))
        .is("Peak torque at the hub, on the link's side of a drive.")
        .limited("torque", |own| own.torque_n_m)
        .shown(("torque", "peak {} N m"), FOUR)
        .played(|own| Some(own.peak_torque_n_m.value)),
    of_joint("peak_torque_time", TIME, |own| Some(own.peak_torque_n_m.time_s))
        .is("Time of the peak torque.")
        .shown(("torque", " at {} s"), |time_s| instant(time_s, 3))
        .not_swept(),
    of_joint("rms_torque", TORQUE, |own| Some(own.rms_torque_n_m))
        .is("Root mean square of the torque at the hub while it acts.")
        .limited("rms_torque", |own| own.torque_n_m)
        .shown(("torque", ", rms {}"), THREE),
    of_joint("peak_rigid_torque", TORQUE, |own| Some(own.peak_rigid_torque_n_m.value))
        .is("Peak torque of the rigid link or arm.")
        .shown(("torque", ", rigid {link} {}"), FOUR),
    of_joint("torque_ratio", RATIO, |own| Some(own.torque_ratio))
        .is("Peak torque over that of the rigid link or arm.")
        .shown(("torque", ", ratio {}"), THREE),
    of_joint("lead", TIME, |own| own.lead_s)
        .is("Time from the torque's first action to the tip's first motion."),
    of_joint("lag", TIME, |own| own.lag_s)
        .is("Time from the tip's last motion to the torque's last action."),
    of_joint("peak_hub_angle", ANGLE, |own| Some(own.peak_hub_angle_rad.value))
        .is("Largest turn of the hub from its start; of a cycle the range of its angle.")
        .limited("hub_angle", |own| own.angle_rad)
        .played(|own| Some(own.peak_hub_angle_rad.value)),
    of_joint("peak_hub_rate", RATE, |own| Some(own.peak_hub_rate_rad_s.value))
        .is("Peak rate of the hub, an angle per time.")
        .limited("hub_rate", |own| own.rate_rad_s)
        .shown(("hub", "; peaks {} rad/s"), FOUR)
        .played(|own| Some(own.peak_hub_rate_rad_s.value)),
    of_joint("peak_hub_acceleration", ACCELERATION, |own| {
        Some(own.peak_hub_acceleration_rad_s2.value)
    })
    .is("Peak acceleration of the hub, an angle per time squared.")
    .limited("hub_acceleration", |own| own.acceleration_rad_s2)
    .played(|own| Some(own.peak_hub_acceleration_rad_s2.value)),
    of_joint("peak_power", POWER, |own| Some(own.peak_power_w.value))
        .is("Peak mechanical power at the hub.")
        .limited("power", |own| own.power_w)
        .shown(("hub", ", {} W"), FOUR)
        .played(|own| Some(own.peak_power_w.value)),
    of_joint("peak_root_moment", TORQUE, |own| Some(own.peak_root_moment_n_m?.value))
        .is("Peak bending moment at the link's root.")
        .limited("bending_moment", |own| own.moment_n_m)
        .shown(("bending", ", root moment up to {} N m"), FOUR),
    of_joint("peak_deflection", LENGTH, |own| Some(own.peak_deflection_m?.value))
        .is("Peak deflection of the tip from the hub's tangent line.")
        .limited("deflection", |own| own.deflection_m)
        .shown(("bending", "tip deflects by up to {} m"), FOUR)
        .played(|own| own.peak_deflection_m.map(|peak| peak.value)),
    of_joint("peak_free_end_from_rigid", LENGTH, |own| Some(own.peak_free_end_from_rigid_m?.value))
        .is("With an output inboard of the tip: largest distance of the tip from its place on a rigid link.")
        .shown(("bending", ", free end strays by up to {} m"), FOUR)
        .not_swept(),
    of_joint("rms_power", POWER, |own| Some(own.rms_power_w))
        .is("Root mean square of the mechanical power at the hub while the torque acts.")
        .limited("rms_power", |own| own.power_w)
        .shown(("hub", ", rms {} W"), THREE),
    of_motor("peak_motor_torque", TORQUE, |own| Some(own.motor?.peaks.peak_torque_n_m.value))
        .is("Peak torque of the motor, on its side of the gear; as all limits of the motor, needs a [drive].")
        .limited("motor_torque", |own| own.motor_torque_n_m)
        .shown(("motor", "peak {} N m"), FOUR)
        .played(|own| Some(own.motor?.peak_torque_n_m.value)),
    of_motor("peak_motor_torque_time", TIME, |own| Some(own.motor?.peaks.peak_torque_n_m.time_s))
        .is("Time of the motor's peak torque.")
        .shown(("motor", " at {} s"), |time_s| instant(time_s, 3))
        .not_swept(),
    of_motor("rms_motor_torque", TORQUE, |own| Some(own.motor?.rms_torque_n_m))
        .is("Root mean square of the motor's torque while it acts.")
        .limited("motor_rms_torque", |own| own.motor_torque_n_m)
        .shown(("motor", ", rms {} N m"), THREE),
    of_motor("peak_motor_rate", RATE, |own| Some(own.motor?.peaks.peak_rate_rad_s.value))
        .is("Peak rate of the rotor, an angle per time.")
        .limited("motor_rate", |own| own.motor_rate_rad_s)
        .shown(("motor", "; {} rad/s"), FOUR)
        .played(|own| Some(own.motor?.peak_rate_rad_s.value)),
    of_motor("peak_motor_power", POWER, |own| Some(own.motor?.peaks.peak_power_w.value))
        .is("Peak mechanical power of the motor.")
        .limited("motor_power", |own| own.motor_power_w)
        .shown(("motor", ", {} W"), FOUR)
        .played(|own| Some(own.motor?.peak_power_w.value)),
    of_motor("peak_motor_current", CURRENT, |own| Some(own.motor?.peaks.peak_current_a?.value))
        .needs(MotorKnown::Current)
        .is("Peak current of the motor; needs drive.torque_constant.")
        .limited("motor_current", |own| own.motor_current_a)
        .shown(("motor", ", {} A"), FOUR)
        .played(|own| Some(own.motor?.peak_current_a?.value)),
    of_motor("peak_motor_voltage", VOLTAGE, |own| Some(own.motor?.peaks.peak_voltage_v?.value))
        .needs(MotorKnown::Voltage)
        .is("Peak voltage of the motor; needs drive.torque_constant and drive.resistance.")
        .limited("motor_voltage", |own| own.motor_voltage_v)
        .shown(("motor", ", {} V"), FOUR)
        .played(|own| Some(own.motor?.peak_voltage_v?.value)),
];

const fn of_joint(
    name: &'static str,
    unit: Unit,
    of: fn(&JointMetrics) -> Option<f64>,
) -> JointQuantity {
    let (of_motor, is_swept, what, limit, shown, of_played) = (None, true, "", None, None, None);
    JointQuantity { name, unit, what, of_motor, is_swept, limit, shown, of, of_played }
}

const fn of_motor(
    name: &'static str,
    unit: Unit,
    of: fn(&JointMetrics) -> Option<f64>,
) -> JointQuantity {
    of_joint(name, unit, of).needs(MotorKnown::Torque)
}

impl JointQuantity {
    const fn needs(self, known: MotorKnown) -> Self {
        Self { of_motor: Some(known), ..self }
    }

    const fn is(self, what: &'static str) -> Self {
        Self { what, ..self }
    }

    const fn limited(self, key: &'static str, error: fn(&Errors) -> f64) -> Self {
        Self { limit: Some(Limit { key, error }), ..self }
    }

    const fn shown(
        self,
        (line, text): (&'static str, &'static str),
        number: fn(f64) -> String,
    ) -> Self {
        Self { shown: Some(Shown { line, text, number }), ..self }
    }

    const fn played(self, of_played: fn(&PlayedJoint) -> Option<f64>) -> Self {
        Self { of_played: Some(of_played), ..self }
    }

    const fn not_swept(self) -> Self {
        Self { is_swept: false, ..self }
    }

    /// Key of its limit in `[limits]`; `None` for a quantity without a limit.
    pub fn limit_key(&self) -> Option<&'static str> {
        self.limit.map(|limit| limit.key)
    }

    /// The quantities that may have a limit, with its key.
    pub fn with_limit() -> impl Iterator<Item = (&'static str, &'static Self)> {
        QUANTITIES.iter().filter_map(|own| Some((own.limit_key()?, own)))
    }

    /// The quantity with this limit.
    pub fn of_limit(key: &str) -> Option<&'static Self> {
        QUANTITIES.iter().find(|own| own.limit_key() == Some(key))
    }

    /// The number of a joint in a simulation; `None` for a simulation without it.
    pub fn played_by(&self, joint: &PlayedJoint) -> Option<f64> {
        self.of_played.and_then(|of| of(joint))
    }

    /// True for a number whose text is the same for a hub and for a carriage.
    pub fn keeps_words(&self) -> bool {
        self.of_motor.is_some() || self.name == "peak_root_moment"
    }

    /// True for a number of the link beyond the joint, which the carriage of an arm does not have.
    pub fn is_of_link(&self) -> bool {
        ["peak_root_moment", "peak_deflection", "peak_free_end_from_rigid"].contains(&self.name)
    }

    /// Its column in a sweep, for a joint with its number from 1: `peak_torque2_n_m`.
    pub fn column(&self, joint: Option<usize>) -> String {
        let number = joint.map(|joint| joint.to_string()).unwrap_or_default();
        format!("{}{number}{}", self.name, self.unit.suffix)
    }
}

/// The numbers of a joint by the keys of summary.json; `of` reads each number that there is, which may be null.
pub(crate) fn by_name(
    joint: &Joint,
    of: impl Fn(&JointQuantity) -> Option<Value>,
) -> Map<String, Value> {
    let named = |own: &JointQuantity| joint.named(&own.column(None));
    QUANTITIES.iter().filter_map(|own| Some((named(own), of(own)?))).collect()
}

/// Measured errors of the values of a joint that have limits, in the units of the values.
///
/// A root mean square has the error of the peak. Power has the errors of torque and rate, deflection that of the hub angle,
/// the root's moment that of the torque. A motor's current has that of its torque, its voltage those of current and rate.
pub(super) struct Errors {
    pub(super) torque_n_m: f64,
    pub(super) angle_rad: f64,
    pub(super) rate_rad_s: f64,
    /// Without tables, which lack this error, it is that of the torque.
    pub(super) acceleration_rad_s2: f64,
    pub(super) power_w: f64,
    /// Error of the joint's position times the rigid tip's displacement for a unit of it.
    pub(super) deflection_m: f64,
    pub(super) moment_n_m: f64,
    pub(super) motor_torque_n_m: f64,
    pub(super) motor_rate_rad_s: f64,
    pub(super) motor_power_w: f64,
    pub(super) motor_current_a: f64,
    pub(super) motor_voltage_v: f64,
}

impl Errors {
    pub(super) fn of(solution: &Solution, number: usize, metrics: &JointMetrics) -> Self {
        let (joint, has_weight) = (&solution.joints[number], solution.arm.has_weight());
        let errors = joint.errors.of_kind(all_kinds);
        // With gravity errors are shares of ranges.
        let per_peak = |error: f64, history: &[f64]| {
            if has_weight { error * solution.size_of(history) / largest(history) } else { error }
        };
        let of_motor = |error: Option<f64>, history: fn(&MotorHistories) -> &Vec<f64>| {
            let history = joint.motor.as_ref().map(history);
            error.zip(history).map_or(0.0, |(error, history)| per_peak(error, history))
        };
        let turned_rad = if has_weight {
            solution.size_of(solution.followed_rad(number))
        } else {
            metrics.peak_hub_angle_rad.value
        };
        let (torque, rate) = (
            per_peak(errors.torque, &joint.torque_n_m),
            per_peak(errors.hub_rate, &joint.rate_rad_s),
        );
        let acceleration = errors
            .hub_acceleration
            .map_or(torque, |error| per_peak(error, &solution.acceleration_rad_s2(number)));
        let motor_torque = of_motor(errors.motor_torque, |motor| &motor.torque_n_m);
        let motor_rate = of_motor(errors.motor_rate, |motor| &motor.rate_rad_s);
        let peaks = |peak: [Peak; 2]| peak.map(|peak| peak.value);
        let [peak_n_m, peak_rad_s] = peaks([metrics.peak_torque_n_m, metrics.peak_hub_rate_rad_s]);
        let motor =
            metrics.motor.map(|own| peaks([own.peaks.peak_torque_n_m, own.peaks.peak_rate_rad_s]));
        let [motor_n_m, motor_rad_s] = motor.unwrap_or_default();
        let drive = solution.arm.links().get(number).and_then(|own| own.link.drive());
        let constant = drive.and_then(|drive| drive.torque_constant_n_m_a).unwrap_or(0.0);
        let resistance = drive.and_then(|drive| drive.resistance_ohm).unwrap_or(0.0);
        let current_a = if constant > 0.0 { motor_torque * motor_n_m / constant } else { 0.0 };
        // The moment at the root of a hub and its torque have one size.
        let root_n_m = metrics.peak_root_moment_n_m.map_or(0.0, |peak| peak.value);
        let link = solution.links.get(number).map(LinkMotion::link);
        let turns = link.is_some_and(|link| !link.joint().slides());
        let moment_n_m = if turns { peak_n_m.max(root_n_m) } else { root_n_m };
        Self {
            torque_n_m: torque * peak_n_m,
            angle_rad: errors.hub_angle * turned_rad,
            rate_rad_s: rate * peak_rad_s,
            acceleration_rad_s2: acceleration * metrics.peak_hub_acceleration_rad_s2.value,
            power_w: (torque + rate) * (peak_n_m * peak_rad_s),
            deflection_m: errors.hub_angle * (link.map_or(0.0, Link::rigid_tip) * turned_rad),
            moment_n_m: torque * moment_n_m,
            motor_torque_n_m: motor_torque * motor_n_m,
            motor_rate_rad_s: motor_rate * motor_rad_s,
            motor_power_w: (motor_torque + motor_rate) * (motor_n_m * motor_rad_s),
            motor_current_a: current_a,
            motor_voltage_v: resistance * current_a + constant * (motor_rate * motor_rad_s),
        }
    }
}

/// Sum of all errors of a quantity except that of the model, which is shown beside it.
fn all_kinds(errors: QuantityErrors) -> f64 {
    let QuantityErrors { mesh, window, step, iteration, modes, input, model: _ } = errors;
    [step, iteration, modes, input]
        .into_iter()
        .flatten()
        .fold(mesh + window, |sum, error| sum + error)
}
