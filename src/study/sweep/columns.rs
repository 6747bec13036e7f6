//! Numbers of each case of a sweep, and the names of their columns.

use std::f64::consts::TAU;

use crate::inverse::Solution;
use crate::link::{Arm, Drive, Hub, Joint, MotorKnown};
use crate::modal::reported_zeros;
use crate::response::{Played, PlayedLink, ResidualVibration};
use crate::result::{JointQuantity, Metrics, PlayedMetrics, QUANTITIES, TipError};

/// A case with a computed torque.
#[derive(Clone, Copy)]
pub struct SolvedCase<'a> {
    /// The solution.
    pub solution: &'a Solution,
    /// Metrics of the solution.
    pub metrics: &'a Metrics,
    /// First natural frequency of one link in rad/s; `None` if nothing vibrates, and for an arm, which has no column for
    /// it.
    pub first_rad_s: Option<f64>,
}

impl<'a> SolvedCase<'a> {
    /// A case with its solution.
    pub fn of(solution: &'a Solution, metrics: &'a Metrics) -> Self {
        let link = solution.motion.tip().map(|_| solution.links[0].natural_frequencies_rad_s(1));
        Self { solution, metrics, first_rad_s: link.and_then(|own| own.first().copied()) }
    }
}

/// A played case.
#[derive(Debug, Clone, Copy)]
pub struct PlayedCase<'a> {
    /// The simulation.
    pub simulation: &'a Played,
    /// Its metrics.
    pub metrics: &'a PlayedMetrics,
    /// Error of the tip relative to its target.
    pub tip_error: &'a TipError,
}

/// A column and the number that it shows of a case, where it has one.
type Solved = (&'static str, fn(&SolvedCase<'_>) -> Option<f64>);
type OfPlayed = (&'static str, fn(&PlayedCase<'_>) -> Option<f64>);

/// The columns of a link before those of its hub; an arm has the last.
const BEFORE: [Solved; 2] = [
    ("period_1_s", |case| case.first_rad_s.map(|omega| TAU / omega)),
    ("zero_1_per_s", |case| {
        let with_weight = case.solution.links.first().filter(|link| link.reports_weight());
        let zero = with_weight.and_then(|link| link.zeros_per_s(1).first().copied());
        zero.or(case.solution.first_zero_per_s)
    }),
];
/// The columns of a link after those of its hub.
const AFTER: [Solved; 6] = [
    ("band_hz", |case| Some(case.solution.band.cutoff_hz.unwrap_or(case.solution.band.highest_hz))),
    ("tip_error", |case| Some(case.solution.expected_tip_error())),
    ("torque_mesh_error", |case| Some(case.solution.hub().errors.torque.mesh)),
    ("torque_window_error", |case| Some(case.solution.hub().errors.torque.window)),
    ("torque_model_error", |case| case.solution.hub().errors.torque.model),
    ("tip_model_error", |case| case.solution.tip_model_error),
];

/// The columns of a played link before those of its hub.
const PLAYED: [OfPlayed; 11] = [
    ("period_1_s", |case| {
        let first = case.simulation.links[0].natural_frequencies_rad_s.first();
        first.map(|omega| TAU / omega).filter(|period_s| period_s.is_finite())
    }),
    ("zero_1_per_s", |case| {
        let first =
            |link: &PlayedLink| reported_zeros(&link.mesh, link.outward_m_s2, 1).first().copied();
        case.simulation.links.iter().filter_map(first).reduce(f64::min)
    }),
    ("tip_error_m", |case| Some(case.tip_error.worst_m)),
    ("tip_error_share", |case| Some(case.tip_error.share)),
    ("tip_error_time_s", |case| Some(case.tip_error.time_s)),
    ("rms_tip_error_m", |case| Some(case.tip_error.rms_m)),
    ("final_tip_error_m", |case| Some(case.tip_error.final_m)),
    ("residual_m", |case| residual(case).map(|left| left.amplitude_m)),
    ("residual_share", |case| residual(case).map(|left| left.share)),
    ("residual_frequency_hz", |case| residual(case)?.frequency_hz),
    ("residual_decay_s", |case| residual(case)?.decay_s),
];
/// The columns of a played link after those of its hub.
const AFTER_PLAYED: [OfPlayed; 2] = [
    ("tip_model_error", |case| Some(case.simulation.modes()?.model_error.tip)),
    ("deflection_model_error", |case| Some(case.simulation.modes()?.model_error.deflection)),
];

/// The columns of a played arm before those of its joints: its zero and its tip.
const OF_TIP: std::ops::Range<usize> = 1..7;

/// The columns of an arm after those of its joints; errors are the worst of all joints.
const AFTER_JOINTS: [Solved; 5] = [
    ("contraction", |case| case.solution.second_order?.iteration.contraction),
    ("tip_error", |case| Some(case.solution.expected_tip_error())),
    ("mesh_error", |case| Some(case.solution.worst(|errors| errors.mesh))),
    ("window_error", |case| Some(case.solution.worst(|errors| errors.window))),
    ("iteration_error", |case| {
        let is_iterated = case.solution.second_order?.iteration.iterations > 0;
        is_iterated.then(|| case.solution.worst(|errors| errors.iteration.unwrap_or(0.0)))
    }),
];

/// Vibration after the torque; `None` for a link with weight or at large angles.
fn residual<'a>(case: &PlayedCase<'a>) -> Option<&'a ResidualVibration> {
    case.simulation.modes().and_then(|modes| modes.residual.as_ref())
}

/// Quantities of a joint with a column, either of a motor or not.
fn swept(is_of_motor: bool) -> impl Iterator<Item = &'static JointQuantity> {
    QUANTITIES.iter().filter(move |own| own.is_swept && own.of_motor.is_some() == is_of_motor)
}

/// The columns of the carriage of an arm on one, among those of the joint after the last.
fn of_carriage(
    columns: impl Iterator<Item = Column>,
    is_there: bool,
) -> impl Iterator<Item = Column> {
    columns.filter(move |column| match column {
        Column::Joint(_, own) => is_there && !own.is_of_link(),
        _ => false,
    })
}

/// Name of a column of an arm's carriage, from that of a hub.
pub fn column_of_carriage(of_hub: &str) -> String {
    let named = Joint::CARRIAGE.named(of_hub);
    // Times and powers have no word of the carriage in their names.
    if named == of_hub { format!("carriage_{named}") } else { named }
}

/// Kind of a sweep's numbers: the columns between those of the variations and the last two, `warnings` and `error`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepKind {
    /// The torques for the motion.
    Solved {
        /// Number of joints; 1 of one link.
        joints: usize,
        /// Constants of the motors; `None` without motors.
        motor: Option<MotorKnown>,
        /// Of a link or an arm on a carriage.
        slides: bool,
    },
    /// One table of torques, voltages or motions of the joints, played on every case.
    Played {
        /// Number of joints of links; 1 of one link.
        joints: usize,
        /// Of a link or an arm on a carriage.
        slides: bool,
        /// Of torques alone, which are the same in every case.
        is_open: bool,
    },
}

/// Numbers of a case, in the order of the columns; `None` for a missing number.
pub type CaseNumbers = Vec<Option<f64>>;

/// A column of a sweep: of a whole case, or of a joint by its index.
enum Column {
    Solved(Solved),
    Played(OfPlayed),
    Joint(usize, &'static JointQuantity),
}

impl SweepKind {
    /// The kind of sweep that solves this arm.
    pub fn of_arm(arm: &Arm) -> Self {
        let drives = arm.links().iter().filter_map(|own| own.link.drive());
        let motor = drives.map(Drive::known).max();
        let slides = arm.joints().any(|joint| joint.slides());
        Self::Solved { joints: arm.links().len(), motor, slides }
    }

    fn columns(self) -> Vec<Column> {
        let (joints, known, slides) = match self {
            Self::Solved { joints, motor, slides } => (joints, motor, slides),
            Self::Played { joints, slides, is_open } => {
                return Self::played_columns(joints, slides, is_open);
            }
        };
        let of_joint = |joint| swept(false).map(move |own| Column::Joint(joint, own));
        let motor = |joint| {
            swept(true)
                .filter(move |own| own.of_motor <= known)
                .map(move |own| Column::Joint(joint, own))
        };
        if joints == 1 {
            let before = BEFORE.into_iter().map(Column::Solved).chain(of_joint(0));
            return before.chain(AFTER.into_iter().map(Column::Solved)).chain(motor(0)).collect();
        }
        let of_joints = (0..joints).flat_map(|joint| of_joint(joint).chain(motor(joint)));
        let before = BEFORE.into_iter().skip(1).map(Column::Solved).chain(of_joints);
        let carriage = of_carriage(of_joint(joints), slides);
        before.chain(carriage).chain(AFTER_JOINTS.into_iter().map(Column::Solved)).collect()
    }

    /// The torque of a link is no column where all cases play the same; simulations of arms have no deflection.
    fn played_columns(joints: usize, slides: bool, is_open: bool) -> Vec<Column> {
        let (before, after, absent) = match joints {
            1 => (&PLAYED[..], &AFTER_PLAYED[..], is_open.then_some("peak_torque")),
            _ => (&PLAYED[OF_TIP], &[][..], Some("peak_deflection")),
        };
        let is_played = |own: &&JointQuantity| own.of_played.is_some() && Some(own.name) != absent;
        let of_joint =
            |joint| swept(false).filter(is_played).map(move |own| Column::Joint(joint, own));
        let whole = |columns: &'static [OfPlayed]| columns.iter().copied().map(Column::Played);
        let carriage = of_carriage(of_joint(joints), slides && joints > 1);
        let of_joints = (0..joints).flat_map(of_joint).chain(carriage);
        whole(before).chain(of_joints).chain(whole(after)).collect()
    }

    /// Names of the columns.
    pub fn names(self) -> Vec<String> {
        let (Self::Solved { joints, slides, .. } | Self::Played { joints, slides, .. }) = self;
        let of = if slides { Joint::CARRIAGE } else { Joint::Revolute(Hub::default()) };
        let name = |column| match column {
            Column::Solved((name, _)) | Column::Played((name, _)) => of.named(name),
            Column::Joint(_, own) if joints == 1 => of.named(&own.column(None)),
            Column::Joint(joint, own) if joint < joints => own.column(Some(joint + 1)),
            Column::Joint(_, own) => column_of_carriage(&own.column(None)),
        };
        self.columns().into_iter().map(name).collect()
    }

    /// The numbers of a solved case. A sweep that plays has none here.
    pub fn solved(self, case: &SolvedCase) -> CaseNumbers {
        let number = |column| match column {
            Column::Solved((_, of)) => of(case),
            Column::Played(_) => None,
            Column::Joint(joint, own) => case.metrics.joints.get(joint).and_then(own.of),
        };
        self.columns().into_iter().map(number).collect()
    }

    /// Numbers of a played case.
    pub fn played(self, case: &PlayedCase) -> CaseNumbers {
        let number = |column| match column {
            Column::Solved(_) => None,
            Column::Played((_, of)) => of(case),
            Column::Joint(joint, own) => own.played_by(case.metrics.joints.get(joint)?),
        };
        self.columns().into_iter().map(number).collect()
    }
}
