//! The error of the tip under a table of torques.

use super::check::VerificationError;
use super::playback::{simulated, wanted_tip};
use crate::beam::MeshPlan;
use crate::inverse::Solution;
use crate::link::{Arm, Link};
use crate::motion::{Ends, Motion};
use crate::numeric::rounded;
use crate::response::{
    ArmPose, Feedback, HubReference, Input, Interpolation, Play, Played, SimulationError, Start,
    Torque, simulate,
};
use crate::result::{TipError, TorqueTable, for_hold};

/// Share of the motion within which an arm that plays a table settles: a hundredth of the error that causes a warning.
const SETTLED: f64 = 1e-5;

/// Poses of an arm, spread over the window, that the search for a fall examines.
const POSES: usize = 16;

/// Damping ratio of the joints of a rigid arm under the feedback that holds it.
const DAMPING_RATIO: f64 = 0.7;

/// The tip under a table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableError {
    /// Distance of the tip from the wanted motion; times are those of the solution.
    pub tip: TipError,
    /// Distance in m that the last refinements of the simulations moved the tip, the uncertainty of the error. 0 for
    /// modes, whose equations are integrated exactly.
    pub change_m: f64,
    /// Gains in N m/rad and N m s/rad of a feedback around each joint as solved, for an arm that falls from a pose;
    /// empty if torques alone act.
    pub feedback: Vec<[f64; 2]>,
}

/// Distance of the tip from the wanted motion if a table is played in place of the solved torques; `plans` are those of the
/// links' meshes.
///
/// Direct dynamics play both, and the difference of their tips is added to the solved tip. Hysteretic damping has no
/// equation in time: both are played with the viscous damping that `simulate` takes for it, and what that alone changes
/// cancels.
///
/// An arm that falls from a pose on its path, or that repeats a cycle, is played under a feedback around the joints as solved,
/// as a robot has it. For a converter that holds its values, the reference of the feedback is corrected as the torques are.
///
/// # Errors
/// [`VerificationError`] where a link or an arm cannot be played.
pub fn table_error(
    solution: &Solution,
    plans: &[MeshPlan],
    table: &TorqueTable,
    memory_bytes: Option<usize>,
) -> Result<TableError, VerificationError> {
    let grid = solution.grid;
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let is_cycle = solution.motion.ends() == Ends::Periodic;
    // Torques alone do not hold an arm in its cycle.
    let is_held = falls(solution) || is_cycle && solution.arm.alone().is_none();
    let gains = if is_held { gains(&solution.arm) } else { Vec::new() };
    let played = |table: &TorqueTable| -> Result<Played, VerificationError> {
        let (torques_n_m, interpolation) = (table.whole_n_m(), table.interpolation());
        match &solution.motion {
            Motion::Tip(motion) => {
                let (followed, torque_n_m) = ((solution, motion), &torques_n_m[0]);
                Ok(simulated(followed, torque_n_m, interpolation, memory_bytes)?)
            }
            Motion::Path(_) => {
                let torques = torques_n_m.iter().map(|own| Torque::new(&time_s, own.clone()));
                let torques = torques.collect::<Result<Vec<_>, _>>()?;
                let start_rad = solution.joints.iter().map(|joint| joint.angle_rad[0]);
                let play = Play {
                    interpolation,
                    feedback: &feedback(solution, &gains, &time_s, interpolation)?,
                    start: Some(Start::Joints(&start_rad.collect::<Vec<_>>())),
                    tolerance: Some(SETTLED),
                    memory_bytes,
                    cycle_turn_rad: is_cycle.then_some(0.0),
                    ..Play::with(Input::Torques(&torques))
                };
                Ok(simulate(&solution.arm, plans, &play, &|_| {})?)
            }
        }
    };
    // The tip alone is kept: the second play needs the memory of the first.
    let tip = |table| played(table).map(|played| (played.change()[0], played.tip));
    let [(of_table_m, of_table), (of_solved_m, of_solved)] =
        [tip(table)?, tip(&TorqueTable::of(solution))?];
    let change_m = of_table_m + of_solved_m;
    let tips = solved_and_wanted_m(solution);
    let off = |k: usize| {
        let axes = of_table.iter().zip(&of_solved).zip(&tips);
        let axes = axes.map(|((table, solved), [tip, wanted])| {
            table.displacement_m[k] - solved.displacement_m[k] + tip[k] - wanted[k]
        });
        // The displacement of one link has a sign.
        match axes.collect::<Vec<_>>()[..] {
            [along] => along,
            ref axes => axes.iter().map(|own| own * own).sum::<f64>().sqrt(),
        }
    };
    let errors: Vec<f64> = (0..grid.len).map(off).collect();
    let tip = TipError::among(&errors, (&grid, solution.tip_travel_m()), 0.0);
    Ok(TableError { tip, change_m, feedback: gains })
}

/// Each coordinate of the tip in m, as solved and as wanted: the displacement of a link's, x and y of an arm's.
fn solved_and_wanted_m(solution: &Solution) -> Vec<[Vec<f64>; 2]> {
    let wanted = |axis: usize| match &solution.motion {
        Motion::Tip(motion) => wanted_tip(solution, motion).displacement_m().to_vec(),
        Motion::Path(path) => {
            (0..solution.grid.len).map(|k| solution.wanted_tip_m(path, k)[axis]).collect()
        }
    };
    let axes = solution.tip.iter().enumerate();
    axes.map(|(axis, tip)| [tip.displacement_m.clone(), wanted(axis)]).collect()
}

/// A feedback around each joint as solved; empty without gains.
fn feedback(
    solution: &Solution,
    gains: &[[f64; 2]],
    time_s: &[f64],
    interpolation: Interpolation,
) -> Result<Vec<Feedback>, VerificationError> {
    let reference = |samples: &[f64]| match interpolation {
        Interpolation::Zero => for_hold(samples, false),
        _ => samples.to_vec(),
    };
    let joints = gains.iter().zip(&solution.joints).map(|([kp, kd], joint)| {
        let [angle, rate] = [&joint.angle_rad, &joint.rate_rad_s].map(|own| reference(own));
        let reference = HubReference::new(time_s, angle, Some(rate))?;
        Ok(Feedback::new(*kp, *kd, reference).map_err(SimulationError::from)?)
    });
    joints.collect()
}

/// True if an arm with free joints leaves a pose of its path, held there by its torques, or if that is not known.
fn falls(solution: &Solution) -> bool {
    let leaves = |row: usize| {
        let directions_rad: Vec<f64> = solution.shapes().map(|link| link.chord[0][row]).collect();
        let pose = ArmPose::of(&solution.arm, &directions_rad, (0.0, 0));
        let modes = pose.and_then(|pose| pose.modes(None, 1));
        modes.map_or(true, |modes| modes.iter().any(|mode| mode.square_per_s2 < 0.0))
    };
    let last = solution.grid.len - 1;
    solution.shapes().next().is_some()
        && solution.arm.has_weight()
        && (0..=POSES).any(|k| leaves(k * last / POSES))
}

/// Gains in N m/rad and N m s/rad, of two digits, that hold an arm in any pose. The stiffness of each joint exceeds
/// the loss from the weight of all links outward, stretched.
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
