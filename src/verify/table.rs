//! What a torque table does to the tip.

use super::check::VerificationError;
use super::playback::turn_of_cycle_rad;
use crate::beam::MeshPlan;
use crate::inverse::{ArmSolution, Solution};
use crate::link::{Arm, Link};
use crate::motion::Ends;
use crate::numeric::rounded;
use crate::response::{
    ArmPlay, ArmPose, ArmStart, Feedback, HubReference, Interpolation, Play, Played,
    SimulationError, State, Torque, simulate_arm, simulate_on,
};
use crate::result::{TipError, TorqueTable, for_hold};

/// Share of the motion within which an arm that plays a table settles: a hundredth of the error that is warned of.
const SETTLED: f64 = 1e-5;

/// Poses of an arm, spread over the window, that are looked at.
const POSES: usize = 16;

/// Damping ratio of the joints of a rigid arm under the feedback that holds it.
const DAMPING_RATIO: f64 = 0.7;

/// What playing a table finds.
#[derive(Debug, Clone, PartialEq)]
pub struct TableError {
    /// Distance of the tip from the wanted motion; times are those of the solution.
    pub tip: TipError,
    /// How far the last refinements of the simulations moved the tip in m: the error is known no better. 0 where modes are
    /// played, whose equations are integrated exactly.
    pub change_m: f64,
    /// Gains in N m/rad and N m s/rad of a feedback around each joint as solved, with which an arm was played that falls from
    /// a pose; empty where torques alone were played.
    pub feedback: Vec<[f64; 2]>,
}

/// Distance of the tip from the wanted motion if a table is played in place of the solved torque.
///
/// Direct dynamics play both, and the difference of their tips is added to the solved tip. Hysteretic damping has no
/// equation in time: both are played with the viscous damping that `simulate` takes for it, and what that alone changes
/// cancels.
///
/// # Errors
/// [`VerificationError`] of a link that cannot be played.
pub fn table_error(
    solution: &Solution,
    table: &TorqueTable,
    memory_bytes: Option<usize>,
) -> Result<TableError, VerificationError> {
    let (grid, tip) = (solution.grid, &solution.tip);
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let initial_tip_m = tip.displacement_m[0];
    let moving =
        State::turning(solution.link(), grid.time_s(0), [initial_tip_m, tip.velocity_m_s[0]]);
    let played = |torque_n_m: &[f64], interpolation: Interpolation| {
        let torque = Torque::new(&time_s, torque_n_m.to_vec())?;
        let play = Play {
            interpolation,
            initial_tip_m,
            memory_bytes,
            is_large: solution.second_order().is_some(),
            state: (solution.motion.ends() == Ends::Moving).then_some(&moving),
            cycle_turn_rad: turn_of_cycle_rad(solution),
            ..Play::of(&torque)
        };
        let simulation = simulate_on(solution.link(), solution.mesh().clone(), &play)?;
        let change_m = match &simulation.played {
            Played::Modes(_) => 0.0,
            Played::Elastica(bent) => bent.tip_change_m,
        };
        Ok::<_, VerificationError>((simulation.tip.displacement_m, change_m))
    };
    let (of_table, change_m) = played(&table.whole_n_m()[0], table.interpolation())?;
    let (of_solved, solved_change_m) = played(&solution.torque_n_m, Interpolation::Cubic)?;
    let wanted = solution.motion.target(grid.time_s(0), grid.end_s());
    let solved = tip.displacement_m.iter().zip(wanted.displacement_m());
    let errors = of_table.iter().zip(&of_solved).zip(solved);
    let errors: Vec<f64> = errors.map(|((t, s), (tip, wanted))| t - s + tip - wanted).collect();
    let tip = TipError::among(&errors, (&grid, solution.tip_travel_m()), 0.0);
    Ok(TableError { tip, change_m: change_m + solved_change_m, feedback: Vec::new() })
}

/// The same of an arm, as the distance of its tip from its path.
///
/// An arm that falls from a pose on its way is played under a feedback around the joints as solved, as a robot has it. For a
/// converter that holds its values, the reference of the feedback is corrected as the torques are.
///
/// # Errors
/// [`VerificationError`] of an arm that cannot be played.
pub fn arm_table_error(
    solution: &ArmSolution,
    plans: &[MeshPlan],
    table: &TorqueTable,
    memory_bytes: Option<usize>,
) -> Result<TableError, VerificationError> {
    let grid = solution.grid;
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let gains = if falls(solution) { gains(&solution.arm) } else { Vec::new() };
    let start_rad: Vec<f64> = solution.joints.iter().map(|joint| joint.angle[0][0]).collect();
    let played = |torques_n_m: Vec<&Vec<f64>>, interpolation: Interpolation| {
        let torques = torques_n_m.into_iter().map(|own| Torque::new(&time_s, own.clone()));
        let torques = torques.collect::<Result<Vec<_>, _>>()?;
        let reference = |samples: &[f64]| match interpolation {
            Interpolation::Zero => for_hold(samples, false),
            _ => samples.to_vec(),
        };
        let feedback = gains.iter().zip(&solution.joints).map(|([kp, kd], joint)| {
            let [angle, rate, _] = &joint.angle;
            let reference = HubReference::new(&time_s, reference(angle), Some(reference(rate)))?;
            let feedback = Feedback::new(*kp, *kd, reference);
            Ok::<_, VerificationError>(feedback.map_err(SimulationError::from)?)
        });
        let play = ArmPlay {
            torques: &torques,
            interpolation,
            until_s: None,
            feedback: &feedback.collect::<Result<Vec<_>, _>>()?,
            start: ArmStart::Joints(&start_rad),
            tolerance: SETTLED,
            memory_bytes,
        };
        let (played, _) = simulate_arm(&solution.arm, plans, &play, &|_| {})?;
        let [x, y] = played.tip.map(|[places_m, ..]| places_m);
        Ok::<_, VerificationError>(([x, y], played.change[0]))
    };
    let (of_table, change_m) = played(table.whole_n_m().iter().collect(), table.interpolation())?;
    let solved = solution.joints.iter().map(|joint| &joint.torque_n_m).collect();
    let (of_solved, solved_change_m) = played(solved, Interpolation::Cubic)?;
    let off = |k: usize| {
        let wanted_m = solution.wanted_tip_m(k);
        let [x, y] = [0, 1].map(|axis: usize| {
            of_table[axis][k] - of_solved[axis][k] + solution.tip[axis][0][k] - wanted_m[axis]
        });
        (x * x + y * y).sqrt()
    };
    let errors: Vec<f64> = (0..grid.len).map(off).collect();
    let tip = TipError::among(&errors, (&grid, solution.way_m), 0.0);
    Ok(TableError { tip, change_m: change_m + solved_change_m, feedback: gains })
}

/// True if an arm with free joints leaves a pose of its way, held there by its torques, or if that is not known.
fn falls(solution: &ArmSolution) -> bool {
    let leaves = |row: usize| {
        let directions_rad: Vec<f64> =
            solution.links.iter().map(|link| link.chord[0][row]).collect();
        let pose = ArmPose::of(&solution.arm, &directions_rad, (0.0, 0));
        let modes = pose.and_then(|pose| pose.modes(None, 1));
        modes.map_or(true, |modes| modes.iter().any(|mode| mode.square_per_s2 < 0.0))
    };
    let last = solution.grid.len - 1;
    solution.arm.has_weight() && (0..=POSES).any(|k| leaves(k * last / POSES))
}

/// Gains in N m/rad and N m s/rad, of two digits, that hold an arm in any pose: the stiffness of each joint exceeds what the weight of all links
/// outward, stretched, takes away.
fn gains(arm: &Arm) -> Vec<[f64; 2]> {
    let [x, y] = arm.gravity_m_s2();
    let (gravity_m_s2, links) = ((x * x + y * y).sqrt(), arm.links());
    // Of all links outward of a joint: mass, its moment and its inertia about the joint.
    let (mut mass_kg, mut moment_kg_m, mut inertia_kg_m2) = (0.0, 0.0, 0.0);
    let of_joint = |link: &Link| {
        let length_m = link.length_m();
        inertia_kg_m2 += length_m * (2.0 * moment_kg_m + length_m * mass_kg);
        inertia_kg_m2 += link.rigid_inertia_kg_m2();
        moment_kg_m += length_m * mass_kg + link.mass_moment_kg_m();
        mass_kg += link.mass_kg();
        let stiffness = 2.0 * links.len() as f64 * gravity_m_s2 * moment_kg_m;
        [stiffness, 2.0 * DAMPING_RATIO * (stiffness * inertia_kg_m2).sqrt()]
    };
    let mut gains: Vec<[f64; 2]> = links.iter().rev().map(|own| &own.link).map(of_joint).collect();
    gains.reverse();
    gains.into_iter().map(|both| both.map(|gain| rounded(gain, 2))).collect()
}
