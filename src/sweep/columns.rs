//! The numbers that a sweep has of each case, and the names of their columns.

use std::f64::consts::TAU;

use crate::inverse::{ArmSolution, Solution};
use crate::modal::torque_zeros;
use crate::response::{Played, ResidualVibration};
use crate::result::{JointQuantity, Metrics, PlayedMetrics, QUANTITIES, TipError};

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
    pub simulation: &'a Played,
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
    pub metrics: &'a Metrics,
}

/// A column and the number that it shows of a case, where it has one.
type Solved = (&'static str, fn(&SolvedCase<'_>) -> Option<f64>);
type OfPlayed = (&'static str, fn(&PlayedCase<'_>) -> Option<f64>);
type OfArm = (&'static str, fn(&ArmCase<'_>) -> Option<f64>);

/// The columns of a link before and after those of its hub.
const BEFORE: [Solved; 2] = [
    ("period_1_s", |case| case.first_rad_s.map(|omega| TAU / omega)),
    ("zero_1_per_s", |case| case.solution.first_zero_per_s),
];
const AFTER: [Solved; 6] = [
    ("band_hz", |case| Some(case.solution.band.cutoff_hz.unwrap_or(case.solution.band.highest_hz))),
    ("tip_error", |case| Some(case.solution.accuracy.tip)),
    ("torque_mesh_error", |case| Some(case.solution.accuracy.errors.torque.mesh)),
    ("torque_window_error", |case| Some(case.solution.accuracy.errors.torque.window)),
    ("torque_model_error", |case| case.solution.accuracy.errors.torque.model),
    ("tip_model_error", |case| case.solution.accuracy.tip_model),
];

const PLAYED: [OfPlayed; 16] = [
    ("period_1_s", |case| {
        case.simulation.links[0].natural_frequencies_rad_s.first().map(|omega| TAU / omega)
    }),
    ("zero_1_per_s", |case| torque_zeros(case.simulation.mesh(), 1).first().copied()),
    ("tip_error_m", |case| Some(case.tip_error.worst_m)),
    ("tip_error_share", |case| Some(case.tip_error.share)),
    ("tip_error_time_s", |case| Some(case.tip_error.time_s)),
    ("rms_tip_error_m", |case| Some(case.tip_error.rms_m)),
    ("final_tip_error_m", |case| Some(case.tip_error.final_m)),
    ("residual_m", |case| residual(case).map(|left| left.amplitude_m)),
    ("residual_share", |case| residual(case).map(|left| left.share)),
    ("residual_frequency_hz", |case| residual(case)?.frequency_hz),
    ("residual_decay_s", |case| residual(case)?.decay_s),
    ("peak_hub_rate_rad_s", |case| Some(case.metrics.hub().peak_hub_rate_rad_s.value)),
    ("peak_power_w", |case| Some(case.metrics.hub().peak_power_w.value)),
    ("peak_deflection_m", |case| case.metrics.hub().peak_deflection_m.map(|peak| peak.value)),
    ("tip_model_error", |case| Some(case.simulation.modes()?.model_error.tip)),
    ("deflection_model_error", |case| Some(case.simulation.modes()?.model_error.deflection)),
];

/// The first column of an arm, before those of its joints.
const ARM: OfArm = ("zero_1_per_s", |case| case.solution.first_zero_per_s);

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

/// The quantities of a joint that have a column: of a motor or not.
fn swept(is_of_motor: bool) -> impl Iterator<Item = &'static JointQuantity> {
    QUANTITIES.iter().filter(move |own| own.is_swept && own.is_of_motor == is_of_motor)
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
        let hub = |is_of_motor| swept(is_of_motor).map(|own| own.column(None));
        let of_link =
            |columns: &[Solved]| columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        let of_arm =
            |columns: &[OfArm]| columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        let parts: [Vec<String>; 4] = match self {
            Self::Played => return PLAYED.map(|(name, _)| name.to_owned()).into(),
            Self::Solved | Self::Driven => {
                let motor = hub(true).filter(|_| self == Self::Driven).collect();
                [of_link(&BEFORE), hub(false).collect(), of_link(&AFTER), motor]
            }
            Self::Arm { joints } | Self::DrivenArm { joints } => {
                let of_joint = |joint| self.of_joint().map(move |own| own.column(Some(joint)));
                let joints = (1..=joints).flat_map(of_joint).collect();
                [of_arm(&[ARM]), joints, of_arm(&ARM_ERRORS), vec![]]
            }
        };
        parts.concat()
    }

    /// The columns of each joint of an arm.
    fn of_joint(self) -> impl Iterator<Item = &'static JointQuantity> {
        let driven = swept(true).filter(move |_| matches!(self, Self::DrivenArm { .. }));
        swept(false).chain(driven)
    }

    /// The numbers of a solved case.
    pub fn solved(self, case: &SolvedCase) -> CaseNumbers {
        let hub = |is_of_motor| swept(is_of_motor).map(|own| (own.of)(case.metrics.hub()));
        let driven = hub(true).filter(|_| self == Self::Driven);
        let of = |(_, of): &Solved| of(case);
        BEFORE.iter().map(of).chain(hub(false)).chain(AFTER.iter().map(of)).chain(driven).collect()
    }

    /// The numbers of a case on which a torque was played.
    pub fn played(case: &PlayedCase) -> CaseNumbers {
        PLAYED.iter().map(|(_, of)| of(case)).collect()
    }

    /// The numbers of a case of an arm with as many joints as there are columns for.
    pub fn of_arm(self, case: &ArmCase) -> CaseNumbers {
        let joints = case.metrics.joints.iter();
        let of_joints = joints.flat_map(|joint| self.of_joint().map(move |own| (own.of)(joint)));
        let of_arm = |(_, of): &OfArm| of(case);
        [of_arm(&ARM)].into_iter().chain(of_joints).chain(ARM_ERRORS.iter().map(of_arm)).collect()
    }
}
