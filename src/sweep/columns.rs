//! The numbers that a sweep has of each case, and the names of their columns.

use std::f64::consts::TAU;

use crate::inverse::{ArmSolution, Solution};
use crate::modal::torque_zeros;
use crate::response::{ResidualVibration, Simulation};
use crate::result::{ArmMetrics, JointMetrics, Metrics, MotorMetrics, PlayedMetrics, TipError};

/// A case whose torque was computed.
#[derive(Clone, Copy)]
pub struct SolvedCase<'a> {
    /// The solution.
    pub solution: &'a Solution,
    /// Its metrics.
    pub metrics: &'a Metrics,
    /// Its first natural frequency in rad/s; none if nothing vibrates.
    pub first_rad_s: Option<f64>,
}

/// A case on which a torque was played.
#[derive(Debug, Clone, Copy)]
pub struct PlayedCase<'a> {
    /// The simulation.
    pub simulation: &'a Simulation,
    /// Its metrics.
    pub metrics: &'a PlayedMetrics,
    /// The error of the tip against its target.
    pub tip_error: &'a TipError,
}

/// A case of an arm whose torques were computed.
#[derive(Debug, Clone, Copy)]
pub struct ArmCase<'a> {
    /// The solution.
    pub solution: &'a ArmSolution,
    /// Its metrics.
    pub metrics: &'a ArmMetrics,
}

/// A column and the number that it shows of a case, where it has one.
type Solved = (&'static str, fn(&SolvedCase<'_>) -> Option<f64>);
type Played = (&'static str, fn(&PlayedCase<'_>) -> Option<f64>);
type OfArm = (&'static str, fn(&ArmCase<'_>) -> Option<f64>);

/// What stands before and after a joint's number in the name of its column, and the number that it shows.
type OfJoint = ((&'static str, &'static str), fn(&JointMetrics) -> Option<f64>);

const SOLVED: [Solved; 18] = [
    ("period_1_s", |case| case.first_rad_s.map(|omega| TAU / omega)),
    ("zero_1_per_s", |case| case.solution.first_zero_per_s),
    ("peak_torque_n_m", |case| Some(case.metrics.peak_torque_n_m.value)),
    ("rms_torque_n_m", |case| Some(case.metrics.rms_torque_n_m)),
    ("peak_rigid_torque_n_m", |case| Some(case.metrics.peak_rigid_torque_n_m.value)),
    ("torque_ratio", |case| Some(case.metrics.torque_ratio)),
    ("lead_s", |case| case.metrics.lead_s),
    ("lag_s", |case| case.metrics.lag_s),
    ("peak_hub_rate_rad_s", |case| Some(case.metrics.peak_hub_rate_rad_s.value)),
    ("peak_power_w", |case| Some(case.metrics.peak_power_w.value)),
    ("peak_root_moment_n_m", |case| Some(case.metrics.peak_root_moment_n_m.value)),
    ("peak_deflection_m", |case| Some(case.metrics.peak_deflection_m.value)),
    ("band_hz", |case| Some(case.solution.band.cutoff_hz.unwrap_or(case.solution.band.highest_hz))),
    ("tip_error", |case| Some(case.solution.accuracy.tip)),
    ("torque_mesh_error", |case| Some(case.solution.accuracy.errors.torque.mesh)),
    ("torque_window_error", |case| Some(case.solution.accuracy.errors.torque.window)),
    ("torque_model_error", |case| case.solution.accuracy.errors.torque.model),
    ("tip_model_error", |case| case.solution.accuracy.tip_model),
];

const DRIVEN: [Solved; 4] = [
    ("peak_motor_torque_n_m", |case| of_motor(case, |motor| motor.peak_torque_n_m.value)),
    ("rms_motor_torque_n_m", |case| of_motor(case, |motor| motor.rms_torque_n_m)),
    ("peak_motor_rate_rad_s", |case| of_motor(case, |motor| motor.peak_rate_rad_s.value)),
    ("peak_motor_power_w", |case| of_motor(case, |motor| motor.peak_power_w.value)),
];

const PLAYED: [Played; 16] = [
    ("period_1_s", |case| {
        case.simulation.natural_frequencies_rad_s.first().map(|omega| TAU / omega)
    }),
    ("zero_1_per_s", |case| torque_zeros(&case.simulation.mesh, 1).first().copied()),
    ("tip_error_m", |case| Some(case.tip_error.worst_m)),
    ("tip_error_share", |case| Some(case.tip_error.share)),
    ("tip_error_time_s", |case| Some(case.tip_error.time_s)),
    ("rms_tip_error_m", |case| Some(case.tip_error.rms_m)),
    ("final_tip_error_m", |case| Some(case.tip_error.final_m)),
    ("residual_m", |case| residual(case).map(|left| left.amplitude_m)),
    ("residual_share", |case| residual(case).map(|left| left.share)),
    ("residual_frequency_hz", |case| residual(case)?.frequency_hz),
    ("residual_decay_s", |case| residual(case)?.decay_s),
    ("peak_hub_rate_rad_s", |case| Some(case.metrics.peak_hub_rate_rad_s.value)),
    ("peak_power_w", |case| Some(case.metrics.peak_power_w.value)),
    ("peak_deflection_m", |case| Some(case.metrics.peak_deflection_m.value)),
    ("tip_model_error", |case| Some(case.simulation.modes()?.model_error.tip)),
    ("deflection_model_error", |case| Some(case.simulation.modes()?.model_error.deflection)),
];

/// The first column of an arm, before those of its joints.
const ARM: OfArm = ("zero_1_per_s", |case| case.solution.first_zero_per_s);

const JOINT: [OfJoint; 9] = [
    (("peak_torque", "_n_m"), |joint| Some(joint.peak_torque_n_m)),
    (("rms_torque", "_n_m"), |joint| Some(joint.rms_torque_n_m)),
    (("peak_rigid_torque", "_n_m"), |joint| Some(joint.peak_rigid_torque_n_m)),
    (("lead", "_s"), |joint| Some(joint.lead_s)),
    (("lag", "_s"), |joint| Some(joint.lag_s)),
    (("peak_rate", "_rad_s"), |joint| Some(joint.peak_rate_rad_s)),
    (("peak_power", "_w"), |joint| Some(joint.peak_power_w)),
    (("peak_root_moment", "_n_m"), |joint| Some(joint.peak_root_moment_n_m)),
    (("peak_deflection", "_m"), |joint| Some(joint.peak_deflection_m)),
];

const DRIVEN_JOINT: [OfJoint; 4] = [
    (("peak_motor_torque", "_n_m"), |joint| joint.peak_motor_torque_n_m),
    (("rms_motor_torque", "_n_m"), |joint| joint.rms_motor_torque_n_m),
    (("peak_motor_rate", "_rad_s"), |joint| joint.peak_motor_rate_rad_s),
    (("peak_motor_power", "_w"), |joint| joint.peak_motor_power_w),
];

/// The columns of an arm after those of its joints; errors are the worst of all joints.
const ARM_ERRORS: [OfArm; 5] = [
    ("contraction", |case| case.solution.findings.iteration.contraction),
    ("tip_error", |case| Some(case.solution.tip_error)),
    ("mesh_error", |case| Some(case.solution.worst(|errors| errors.mesh))),
    ("window_error", |case| Some(case.solution.worst(|errors| errors.window))),
    ("iteration_error", |case| {
        let is_iterated = case.solution.findings.iteration.iterations > 0;
        is_iterated.then(|| case.solution.worst(|errors| errors.iteration.unwrap_or(0.0)))
    }),
];

/// The vibration after the torque; none of a link with weight or at large angles.
fn residual<'a>(case: &PlayedCase<'a>) -> Option<&'a ResidualVibration> {
    case.simulation.modes().and_then(|modes| modes.residual.as_ref())
}

fn of_motor(case: &SolvedCase, number: fn(&MotorMetrics) -> f64) -> Option<f64> {
    case.metrics.motor.as_ref().map(number)
}

/// Which numbers a sweep has of its cases: the columns between those of the variations and the last two,
/// `warnings` and `error`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepKind {
    /// Of the torque for the motion.
    Solved,
    /// Of that of a link with a drive, with those of its motor.
    Driven,
    /// Of one torque played on every case.
    Played,
    /// Of the torques of an arm for its path.
    Arm {
        /// How many joints it has.
        joints: usize,
    },
    /// Of those of an arm with a drive, with those of its motors.
    DrivenArm {
        /// How many joints it has.
        joints: usize,
    },
}

/// The numbers of a case, in the order of the columns; none where a case has no such number.
pub type CaseNumbers = Vec<Option<f64>>;

impl SweepKind {
    /// Names of the columns.
    pub fn names(self) -> Vec<String> {
        match self {
            Self::Solved => SOLVED.map(|(name, _)| name.to_owned()).into(),
            Self::Driven => SOLVED.iter().chain(&DRIVEN).map(|(name, _)| (*name).into()).collect(),
            Self::Played => PLAYED.map(|(name, _)| name.to_owned()).into(),
            Self::Arm { joints } | Self::DrivenArm { joints } => {
                let of_joint = |joint: usize| {
                    let columns = self.of_joint();
                    columns.map(move |((quantity, unit), _)| format!("{quantity}{joint}{unit}"))
                };
                let errors = ARM_ERRORS.map(|(name, _)| name.to_owned());
                [ARM.0.to_owned()]
                    .into_iter()
                    .chain((1..=joints).flat_map(of_joint))
                    .chain(errors)
                    .collect()
            }
        }
    }

    /// The columns of each joint of an arm.
    fn of_joint(self) -> impl Iterator<Item = &'static OfJoint> {
        let driven = DRIVEN_JOINT.iter().filter(move |_| matches!(self, Self::DrivenArm { .. }));
        JOINT.iter().chain(driven)
    }

    /// The numbers of a solved case.
    pub fn solved(self, case: &SolvedCase) -> CaseNumbers {
        let driven = DRIVEN.iter().filter(|_| self == Self::Driven);
        SOLVED.iter().chain(driven).map(|(_, of)| of(case)).collect()
    }

    /// The numbers of a case on which a torque was played.
    pub fn played(case: &PlayedCase) -> CaseNumbers {
        PLAYED.iter().map(|(_, of)| of(case)).collect()
    }

    /// The numbers of a case of an arm with as many joints as there are columns for.
    pub fn of_arm(self, case: &ArmCase) -> CaseNumbers {
        let joints = case.metrics.joints.iter();
        let of_joints = joints.flat_map(|joint| self.of_joint().map(move |(_, of)| of(joint)));
        let of_arm = |(_, of): &OfArm| of(case);
        [of_arm(&ARM)].into_iter().chain(of_joints).chain(ARM_ERRORS.iter().map(of_arm)).collect()
    }
}
