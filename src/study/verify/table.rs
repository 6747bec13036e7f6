//! The error of the tip under a table of set-points.

use std::borrow::Cow;

use super::check::VerificationError;
use super::playback::{initial, simulated, torque_on, under_torque, wanted_tip};
use crate::beam::MeshPlan;
use crate::inverse::Solution;
use crate::link::{Arm, Drive, Link, LinkParts};
use crate::motion::{Ends, Motion, TipMotionHistories, wrapped};
use crate::numeric::{TimeCurve, TimeGrid, largest, rounded};
use crate::response::{
    ArmPose, Feedback, HubReference, Input, Interpolation, Play, Played, SimulationError, Start,
    Torque, simulate, simulate_on,
};
use crate::result::{Held, SetPoint, SetPoints, Side, TipError, for_hold};
use crate::text::significant;

/// Share of the motion within which an arm that plays a table settles: a hundredth of the error that causes a warning.
const SETTLED: f64 = 1e-5;

/// The same where joints are moved in steps, along lines or from count to count, which settle slowly.
const SETTLED_MOVED: f64 = 1e-4;

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

/// Reason why no tip error of a table is known.
#[derive(Debug)]
pub enum Unknown {
    /// Why the table is not played, in words.
    Reason(String),
    /// An error that ends the run.
    Error(VerificationError),
}

impl<E: Into<VerificationError>> From<E> for Unknown {
    fn from(error: E) -> Self {
        Self::Error(error.into())
    }
}

/// Distance of the tip from the wanted motion if drives hold one quantity of a table in place of the solved one; `plans`
/// are those of the links' meshes.
///
/// Direct dynamics play both, and the difference of their tips is added to the solved tip. Hysteretic damping has no
/// equation in time: both are played with the viscous damping that `simulate` takes for it, and what that alone changes
/// cancels.
///
/// Positions and velocities move the joints as prescribed, in steps or along lines where the table is made for them. A
/// motor behind an elastic transmission moves the end of its spring.
///
/// An arm that falls from a pose on its path, or that repeats a cycle, plays its torques under a feedback around the joints
/// as solved, as a robot has it. For a converter that holds its values, the reference of the feedback is corrected as the
/// torques are.
///
/// # Errors
/// [`Unknown`] where a link or an arm cannot be played.
pub fn table_error(
    solution: &Solution,
    plans: &[MeshPlan],
    (table, held): (&SetPoints, Held),
    memory_bytes: Option<usize>,
) -> Result<TableError, Unknown> {
    let grid = table.played_grid();
    let is_cycle = solution.motion.ends() == Ends::Periodic;
    // Torques alone do not hold an arm in its cycle.
    let is_held =
        held == Held::Effort && (falls(solution) || is_cycle && solution.arm.alone().is_none());
    let gains = if is_held { gains(&solution.arm) } else { Vec::new() };
    let (side, is_linear) = (table.side(), false);
    let player = Player { solution, plans, side, gains: &gains, is_linear, memory_bytes };
    // The tip alone is kept: the second play needs the memory of the first.
    let (of_table_m, of_table) = player.tip_m(table, held, &grid)?;
    let (whole, as_solved) = solved(solution, table.side(), held)?;
    let (of_solved_m, of_solved) = player.tip_m(&whole, as_solved, &grid)?;
    let change_m = of_table_m + of_solved_m;
    let tips = solved_and_wanted_m(solution);
    let on_grid = |values: &[f64]| TimeCurve::resampled(values, solution.grid, &grid).into_owned();
    let apart = of_table.iter().zip(&of_solved).zip(&tips).map(|((table, played), tips)| {
        let [tip, wanted] = tips.each_ref().map(|own| on_grid(own));
        let at = |k: usize| table[k] - played[k] + tip[k] - wanted[k];
        (0..grid.len).map(at).collect::<Vec<f64>>()
    });
    let apart: Vec<Vec<f64>> = apart.collect();
    let off = |k: usize| match &apart[..] {
        // The displacement of one link has a sign.
        [along] => along[k],
        axes => axes.iter().map(|own| own[k] * own[k]).sum::<f64>().sqrt(),
    };
    let errors: Vec<f64> = (0..grid.len).map(off).collect();
    let tip = TipError::among(&errors, (&grid, solution.tip_travel_m()), 0.0);
    Ok(TableError { tip, change_m, feedback: gains })
}

/// The solved quantity that a table replaces; positions in place of velocities.
fn solved(solution: &Solution, side: Side, held: Held) -> Result<(SetPoints, Held), Unknown> {
    let (set_point, held) = match held {
        Held::Effort => (SetPoint::Effort, Held::Effort),
        Held::Position | Held::Velocity => (SetPoint::Position, Held::Position),
    };
    let whole = SetPoints::of(solution, &[set_point], side);
    Ok((whole.map_err(|error| Unknown::Reason(error.to_string()))?, held))
}

/// Plays what drives hold.
struct Player<'a> {
    solution: &'a Solution,
    plans: &'a [MeshPlan],
    side: Side,
    /// Gains of a feedback around the joints under efforts; empty without.
    gains: &'a [[f64; 2]],
    /// Whether a link plays without its weight, at small angles.
    is_linear: bool,
    memory_bytes: Option<usize>,
}

impl Player<'_> {
    /// Each coordinate of the tip on a grid in m while the drives hold one quantity of a table, and how far the last refinement
    /// moved it.
    ///
    /// Steps excite all shapes of a bent link, which its integrator resolves slowly. It plays the smooth curve that the drive
    /// follows up to the Nyquist frequency. The images of the steps above it move the linear link, whose modes are integrated
    /// exactly. So high above the first mode the weight hardly changes them.
    fn tip_m(
        &self,
        table: &SetPoints,
        held: Held,
        grid: &TimeGrid,
    ) -> Result<(f64, Vec<Vec<f64>>), Unknown> {
        if held == Held::Velocity
            && let Some(drift) = table.drift(self.solution)
        {
            let drift = significant(drift, 3);
            let slides = self.side == Side::Joint && self.solution.arm.joint().slides();
            let unit = if slides { "m" } else { "rad" };
            return Err(Unknown::Reason(format!(
                "the velocities of a cycle add up to {drift} {unit} more than the motion, and the position drifts by this in \
                 each cycle"
            )));
        }
        let ends = self.solution.motion.ends();
        let is_stiff = |own: &Drive| own.joint_stiffness_n_m_rad.is_infinite();
        let is_split = !self.is_linear
            && held != Held::Effort
            && table.interpolation() != Interpolation::Cubic
            && self.solution.second_order.is_some()
            && self.solution.arm.alone().is_some()
            && self.drives().iter().all(is_stiff);
        if is_split {
            let (smooth, linear) =
                (table.clone().smoothed(ends), Self { is_linear: true, ..*self });
            let (change_m, mut tip_m) = self.tip_m(&smooth, held, grid)?;
            let [stepped, curved] = [table, &smooth].map(|own| linear.tip_m(own, held, grid));
            let ((_, stepped), (_, curved)) = (stepped?, curved?);
            let images = stepped[0].iter().zip(&curved[0]).map(|(step, curve)| step - curve);
            let images: Vec<f64> = images.collect();
            tip_m[0].iter_mut().zip(&images).for_each(|(own, image)| *own += image);
            // How much the weight changes the images is not measured: at most they are all wrong.
            return Ok((change_m + largest(&images), tip_m));
        }
        let own = table.played_grid();
        let played = self.played(&own, table.played(held), held)?;
        let on_grid = |tip: &TipMotionHistories| match &self.solution.motion {
            // A finer grid goes on beyond the last row of a cycle.
            Motion::Tip(motion) if motion.ends() == Ends::Periodic && own != *grid => {
                let tip_m = wrapped(&tip.displacement_m, motion.travel_m(), 1);
                let around = TimeGrid { first: own.first - 1, len: tip_m.len(), ..own };
                TimeCurve::resampled(&tip_m, around, grid).into_owned()
            }
            _ => TimeCurve::resampled(&tip.displacement_m, own, grid).into_owned(),
        };
        Ok((played.change()[0], played.tip.iter().map(on_grid).collect()))
    }

    /// The motion of link or arm while its drives hold `values`, one list for each joint.
    fn played(
        &self,
        grid: &TimeGrid,
        (mut values, interpolation): (Vec<Vec<f64>>, Interpolation),
        held: Held,
    ) -> Result<Played, Unknown> {
        if held == Held::Effort {
            return self.under_efforts(grid, &values, interpolation);
        }
        let (first, drives) = (self.first_positions(), self.drives());
        for ((values, drive), first) in values.iter_mut().zip(&drives).zip(first) {
            let start = if held == Held::Velocity { first } else { 0.0 };
            for value in values {
                *value = (*value + start) / drive.gear_ratio;
            }
        }
        let time_s = times_s(grid);
        let references = values.into_iter().map(|own| HubReference::new(&time_s, own, None));
        let references = references.collect::<Result<Vec<_>, _>>()?;
        let stiff = drives.iter().filter(|own| own.joint_stiffness_n_m_rad.is_infinite()).count();
        let result = if stiff == drives.len() {
            self.moved(&references, interpolation)
        } else if stiff == 0 {
            self.sprung(grid, (references, &drives), interpolation)
        } else {
            let reason = "joints with and without elastic transmissions are not played together";
            return Err(Unknown::Reason(reason.to_owned()));
        };
        // A motion that jumps may not be played where a torque is.
        result.map_err(|error| match error {
            Unknown::Error(VerificationError::Simulation(error)) => {
                Unknown::Reason(self.solution.arm.worded(&error.to_string()))
            }
            other => other,
        })
    }

    /// Positions on the table's side at the start of the solution.
    fn first_positions(&self) -> Vec<f64> {
        let of_motor = |joint: &crate::inverse::JointMotion| {
            joint.motor.as_ref().filter(|_| self.side == Side::Motor).map(|own| own.angle_rad[0])
        };
        let joints = self.solution.joints.iter();
        joints.map(|own| of_motor(own).unwrap_or(own.angle_rad[0])).collect()
    }

    /// The drives between the table and the joints.
    fn drives(&self) -> Vec<Drive> {
        let of_link = |link: &Link| link.drive().copied().filter(|_| self.side == Side::Motor);
        let links = self.solution.arm.links().iter().map(|own| of_link(&own.link));
        let carriage = self.solution.arm.carriage().map(|_| None);
        links.chain(carriage).map(Option::unwrap_or_default).collect()
    }

    /// Play under the efforts of joints or motors.
    fn under_efforts(
        &self,
        grid: &TimeGrid,
        values: &[Vec<f64>],
        interpolation: Interpolation,
    ) -> Result<Played, Unknown> {
        let (solution, memory_bytes) = (self.solution, self.memory_bytes);
        let of_motors = self.side == Side::Motor;
        let is_elastic = |own: &Drive| own.joint_stiffness_n_m_rad.is_finite();
        if self.drives().iter().any(is_elastic) {
            return Err(Unknown::Reason("a transmission is elastic".to_owned()));
        }
        let arm = if of_motors {
            let arm = solution.arm.with_rotors();
            Cow::Owned(arm.map_err(|error| Unknown::Reason(error.to_string()))?)
        } else {
            Cow::Borrowed(&solution.arm)
        };
        let torques = values
            .iter()
            .zip(self.drives())
            .map(|(own, drive)| Ok(torque_on(grid, own)?.scaled(drive.gear_ratio)));
        let torques = torques.collect::<Result<Vec<Torque>, VerificationError>>()?;
        match &solution.motion {
            Motion::Tip(motion) => {
                let play =
                    under_torque((solution, motion), &torques[0], interpolation, memory_bytes);
                if !of_motors {
                    return Ok(simulated(solution, &play)?);
                }
                let initial = initial(solution);
                let play = Play { is_under_voltage: true, state: initial.as_ref(), ..play };
                Ok(simulate(&arm, self.plans, &play, &|_| {})?)
            }
            Motion::Path(_) => {
                let start_rad = solution.joints.iter().map(|joint| joint.angle_rad[0]);
                let play = Play {
                    interpolation,
                    feedback: &feedback(solution, self.gains, grid, interpolation)?,
                    start: Some(Start::Joints(&start_rad.collect::<Vec<_>>())),
                    is_under_voltage: of_motors,
                    ..self.of_arm(Input::Torques(&torques))
                };
                Ok(simulate(&arm, self.plans, &play, &|_| {})?)
            }
        }
    }

    /// Play with the joints moved as prescribed.
    fn moved(
        &self,
        references: &[HubReference],
        interpolation: Interpolation,
    ) -> Result<Played, Unknown> {
        let solution = self.solution;
        let Motion::Tip(motion) = &solution.motion else {
            let play = self.of_arm(Input::Angles(references));
            let play = Play { interpolation, tolerance: Some(SETTLED_MOVED), ..play };
            return Ok(simulate(&solution.arm, self.plans, &play, &|_| {})?);
        };
        let (own, hub) = (&solution.links[0], &solution.joints[0]);
        let link = if self.is_linear {
            let parts = LinkParts { gravity: None, ..own.link().clone().into() };
            &Link::new(parts).map_err(|error| Unknown::Reason(error.to_string()))?
        } else {
            own.link()
        };
        let reference = match motion.ends() {
            Ends::Moving => references[0].clone().arriving(hub.angle_rad[0], hub.rate_rad_s[0]),
            _ => references[0].clone(),
        };
        let play = Play {
            interpolation,
            tolerance: Some(SETTLED_MOVED),
            memory_bytes: self.memory_bytes,
            is_large: solution.second_order.is_some() && !self.is_linear,
            cycle_turn_rad: motion.turn_of_cycle_rad(link.rigid_tip()),
            start_angle_rad: wanted_tip(solution, motion).start_angle_rad(),
            ..Play::turning(&reference)
        };
        Ok(simulate_on(link, own.mesh().clone(), &play)?)
    }

    /// Play with the motors' ends of elastic transmissions moved as prescribed: the springs act like a feedback.
    fn sprung(
        &self,
        grid: &TimeGrid,
        (references, drives): (Vec<HubReference>, &[Drive]),
        interpolation: Interpolation,
    ) -> Result<Played, Unknown> {
        let solution = self.solution;
        let torques = references.iter().map(|_| torque_on(grid, &vec![0.0; grid.len]));
        let torques = torques.collect::<Result<Vec<Torque>, _>>()?;
        let springs = references.into_iter().zip(drives).map(|(reference, drive)| {
            Feedback::new(drive.joint_stiffness_n_m_rad, 0.0, reference)
                .map_err(SimulationError::from)
        });
        let feedback = &springs.collect::<Result<Vec<_>, _>>()?;
        if let Motion::Tip(motion) = &solution.motion {
            let play =
                under_torque((solution, motion), &torques[0], interpolation, self.memory_bytes);
            let tolerance = Some(SETTLED_MOVED);
            return Ok(simulated(solution, &Play { feedback, tolerance, ..play })?);
        }
        let start_rad: Vec<f64> = solution.joints.iter().map(|own| own.angle_rad[0]).collect();
        let play = Play {
            interpolation,
            feedback,
            start: Some(Start::Joints(&start_rad)),
            tolerance: Some(SETTLED_MOVED),
            ..self.of_arm(Input::Torques(&torques))
        };
        Ok(simulate(&solution.arm, self.plans, &play, &|_| {})?)
    }

    /// A play of an arm.
    fn of_arm<'b>(&self, input: Input<'b>) -> Play<'b> {
        let is_cycle = self.solution.motion.ends() == Ends::Periodic;
        Play {
            tolerance: Some(SETTLED),
            memory_bytes: self.memory_bytes,
            cycle_turn_rad: is_cycle.then_some(0.0),
            ..Play::with(input)
        }
    }
}

fn times_s(grid: &TimeGrid) -> Vec<f64> {
    (0..grid.len).map(|k| grid.time_s(k)).collect()
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
    grid: &TimeGrid,
    interpolation: Interpolation,
) -> Result<Vec<Feedback>, VerificationError> {
    let (time_s, ends) = (times_s(grid), solution.motion.ends());
    let reference = |samples: &[f64]| {
        for_hold(&TimeCurve::resampled(samples, solution.grid, grid), interpolation, ends)
    };
    let joints = gains.iter().zip(&solution.joints).map(|([kp, kd], joint)| {
        let [angle, rate] = [&joint.angle_rad, &joint.rate_rad_s].map(|own| reference(own));
        let reference = HubReference::new(&time_s, angle, Some(rate))?;
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
