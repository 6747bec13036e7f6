//! Integrates the motion of bent links in time, with each joint under a torque or moved as prescribed; refines it until
//! it settles.

use nalgebra::{DMatrix, DVector};

use super::balance::Balance;
use super::bent::BentMotion;
use super::driving::{Driving, Jump};
use super::error::SimulationError;
use super::linkage::Linkage;
use super::losses::{Answers, Losses, balanced};
use super::modes::HubReaction;
use super::play::PlayProgress;
use super::radau::{Motion, Radau};
use super::state::{Cycle, settle};
use crate::numeric::{TimeGrid, dot};

/// Number of steps that ends the refinement: the first level with more steps is the last one.
const LAST_STEPS: usize = 1 << 20;

/// Orders that each refinement adds to the polynomials.
pub(super) const MORE_ORDERS: usize = 2;

/// Change by the last refinement, over the motion, above which a motion counts as unsettled.
const UNSETTLED: f64 = 1e-4;

/// An instant: the number of a sample, and the share of the interval after it.
type Instant = (usize, f64);

/// Input of one joint: a torque, with friction and feedback about an aim, or a prescribed acceleration.
#[derive(Debug, Clone)]
pub(super) enum Drive {
    Torque(Driving, HubReaction),
    Acceleration(Driving),
}

/// Coordinates and rates at the start.
#[derive(Debug, Clone)]
pub(super) struct InitialMotion {
    pub(super) q: Vec<f64>,
    pub(super) rates: Vec<f64>,
    /// Direction in rad of zero displacement for one link.
    pub(super) from_rad: f64,
}

/// Links, the input of each joint, and their start.
pub(super) struct DrivenLinks<'a> {
    pub(super) linkage: Linkage,
    pub(super) drives: &'a [Drive],
    /// Joints whose drives have losses under their torques.
    pub(super) lossy: Vec<(usize, Losses)>,
    /// Angle of each joint in rad from which the stiffness of its feedback acts; the input contains the torque for the
    /// motion of the reference.
    pub(super) aims_rad: Vec<f64>,
    pub(super) grid: &'a TimeGrid,
    pub(super) start: InitialMotion,
    pub(super) cycle: Option<Cycle>,
    /// Whether work and losses of an arm are summed over the stages of the steps. `checks` integrates those of one link
    /// from its samples.
    pub(super) has_energies: bool,
}

/// Refines the motion until tip and joints change by less than `tolerance` of their motion, or to the finest level.
/// Each refinement halves the step and adds orders to the polynomials. `links` receives the number of added orders
/// and the coarser motion, `watch` the progress at each sample.
///
/// # Errors
/// [`SimulationError`].
pub(super) fn refine<'a>(
    links: impl Fn(usize, Option<&BentMotion>) -> Result<DrivenLinks<'a>, SimulationError>,
    (samples, tolerance, most_refinements): (usize, f64, usize),
    watch: &dyn Fn(PlayProgress),
) -> Result<BentMotion, SimulationError> {
    let play = |refinement: usize, coarser: Option<&BentMotion>| {
        let report = |done| watch(PlayProgress { refinement, done, samples });
        links(refinement * MORE_ORDERS, coarser)?.play(1 << refinement, report)
    };
    let mut finest = play(0, None);
    for refinement in 1..=most_refinements {
        let is_last = refinement == most_refinements || (samples << refinement) > LAST_STEPS;
        let coarser = match finest {
            Ok(motion) => motion,
            // Shorter steps may converge where long ones do not.
            Err(SimulationError::NotConverged { .. }) if !is_last => {
                finest = play(refinement, None);
                continue;
            }
            Err(_) => return finest,
        };
        let mut motion = match play(refinement, Some(&coarser)) {
            Err(SimulationError::NotConverged { .. }) if !is_last => {
                finest = Ok(coarser);
                continue;
            }
            played => played?,
        };
        motion.play.change = motion.change_from(&coarser);
        let changed = motion.changed();
        motion.play.is_unsettled = changed > UNSETTLED;
        let is_settled = changed <= tolerance;
        finest = Ok(motion);
        if is_settled || is_last {
            break;
        }
    }
    finest
}

impl Drive {
    fn driving(&self) -> &Driving {
        match self {
            Self::Torque(driving, _) | Self::Acceleration(driving) => driving,
        }
    }

    /// Puts an input into the equation of a joint, whose angle is coordinate number `joint`. A torque, less the
    /// reaction that opposes the motion, joins the forces. An acceleration replaces the equation by `q̈ = input`.
    fn apply(
        &self,
        (input, aim_rad): (f64, f64),
        joint: usize,
        (q, rates): (&[f64], &[f64]),
        balance: &mut Balance,
    ) {
        let (count, Balance { mass, force, .. }) = (q.len(), balance);
        match self {
            Self::Torque(_, reaction) => {
                force[joint] += input - reaction.torque_n_m(q[joint] - aim_rad, rates[joint]);
            }
            Self::Acceleration(_) => {
                mass[joint * count..][..count].fill(0.0);
                mass[joint * count + joint] = 1.0;
                force[joint] = input;
            }
        }
    }
}

impl DrivenLinks<'_> {
    /// Integrates with `steps` steps from one sample to the next; `report` receives the number of finished samples.
    pub(super) fn play(
        self,
        steps: usize,
        report: impl Fn(usize),
    ) -> Result<BentMotion, SimulationError> {
        let (grid, count) = (*self.grid, self.linkage.count);
        // Linear parts of all forces, for the matrix of Radau's iteration.
        let (mut stiffness, mut damping) =
            (self.linkage.stiffness.clone(), self.linkage.damping.clone());
        for (joint, drive) in self.linkage.joints.iter().zip(self.drives) {
            if let Drive::Torque(_, reaction) = drive {
                stiffness[joint * count + joint] += reaction.stiffness_n_m_rad;
                damping[joint * count + joint] += reaction.damping_n_m_s_rad;
            }
        }
        let place = |(number, own): &(usize, Losses)| (self.linkage.joints[*number], *own);
        let lossy: Vec<(usize, Losses)> = self.lossy.iter().map(place).collect();
        let step_s = grid.step_s / steps as f64;
        let mut radau = Radau::new(step_s, [&stiffness, &damping], &lossy);
        let mut balance = Balance::default();
        let InitialMotion { q, rates, from_rad } = self.start.clone();
        let mut motion = Motion { q, rates, accelerations: vec![0.0; count] };
        let rest = vec![0.0; count];
        let is_arm = self.linkage.links.len() > 1;
        // The holding torques balance all other forces: of an arm those of its shape at rest, of one link also those of
        // its rates at the start. A cycle has no rest.
        self.linkage.balance(&motion.q, if is_arm { &rest } else { &motion.rates }, &mut balance);
        let holds = |joint: &usize| self.cycle.is_none().then(|| -balance.force[*joint]);
        let holding_n_m = self.linkage.joints.iter().map(holds);
        let mut played = BentMotion::empty(&self.linkage, from_rad, (steps, grid.len), holding_n_m);
        if self.cycle.is_none() {
            self.jump(0, &mut motion)?;
        }
        self.accelerate(0, &mut motion, &mut balance)?;
        if let Some(cycle) = &self.cycle {
            let joints = (&self.linkage.joints[..], self.linkage.links[0].position_size());
            settle(&mut motion, cycle, joints, |motion, sample| {
                (0..steps).try_for_each(|step| self.step(&mut radau, motion, (sample, step, steps)))
            })?;
            self.accelerate_under_torques(0, &mut motion, &mut balance)?;
        }
        self.observe(0, &motion, &mut balance, &mut played);
        for sample in 1..grid.len {
            let [mut work_j, mut lost_j] = [&played.play.work_j, &played.play.lost_j]
                .map(|sum| sum.last().copied().unwrap_or_default());
            for step in 0..steps {
                self.step(&mut radau, &mut motion, (sample - 1, step, steps))?;
                if self.has_energies {
                    let stages = radau.reached();
                    // In an arm the damping turns with no reference.
                    let losses = stages.iter().map(|stage| self.linkage.lost_w(&stage.rates, 0.0));
                    lost_j += radau.integral(losses);
                    let powers = stages.iter().enumerate().map(|(number, stage)| {
                        let share = interval_share(number, step, steps);
                        self.power_w((sample - 1, share), stage, &mut balance)
                    });
                    work_j += radau.integral(powers);
                }
            }
            if self.has_energies {
                played.play.work_j.push(work_j);
                played.play.lost_j.push(lost_j);
            }
            self.accelerate_under_torques(sample, &mut motion, &mut balance)?;
            self.observe(sample, &motion, &mut balance, &mut played);
            report(sample + 1);
        }
        Ok(played)
    }

    /// Adds the motion at a sample, with its torques, to the histories of `played`.
    fn observe(
        &self,
        sample: usize,
        motion: &Motion,
        balance: &mut Balance,
        played: &mut BentMotion,
    ) {
        let torques_n_m = self.torques_n_m((sample, 0.0), motion, balance);
        played.observe(motion, torques_n_m, self.turning_rad_s((sample, 0.0)));
    }

    /// Makes step number `step` of the `steps` after a sample.
    fn step(
        &self,
        radau: &mut Radau<'_>,
        motion: &mut Motion,
        (sample, step, steps): (usize, usize, usize),
    ) -> Result<(), SimulationError> {
        let is_done = radau.advance(motion, |stage, q, rates, balance| {
            self.linkage.balance(q, rates, balance);
            self.apply((sample, interval_share(stage, step, steps)), (q, rates), balance);
        });
        if !is_done {
            return Err(SimulationError::NotConverged { time_s: self.grid.time_s(sample + 1) });
        }
        if step + 1 == steps { self.jump(sample + 1, motion) } else { Ok(()) }
    }

    /// Lets prescribed joints jump at a sample. The masses determine the motion of the other coordinates, and the damping of
    /// a jump of position changes their rates.
    fn jump(&self, sample: usize, motion: &mut Motion) -> Result<(), SimulationError> {
        let jumps = self.drives.iter().map(|own| own.driving().jump_at(sample));
        let jumps: Vec<Jump> = jumps.collect();
        if jumps.iter().flatten().all(|own| *own == 0.0) {
            return Ok(());
        }
        let (count, mut balance) = (motion.q.len(), Balance::default());
        self.linkage.balance(&motion.q, &motion.rates, &mut balance);
        for joint in &self.linkage.joints {
            balance.mass[joint * count..][..count].fill(0.0);
            balance.mass[joint * count + joint] = 1.0;
        }
        let lost = || SimulationError::NotFinite { time_s: self.grid.time_s(sample) };
        let mut by = |part: usize, force: Vec<f64>| {
            balance.force = force;
            for (joint, jump) in self.linkage.joints.iter().zip(&jumps) {
                balance.force[*joint] = jump[part];
            }
            let changes = balance.accelerations(std::iter::empty()).ok_or_else(lost)?.0;
            Ok::<_, SimulationError>(changes.as_slice().to_vec())
        };
        let moved = by(0, vec![0.0; count])?;
        let damping = self.linkage.damping.chunks_exact(count);
        let quicker = by(1, damping.map(|row| -dot(row, &moved)).collect())?;
        let pairs = motion.q.iter_mut().zip(moved).chain(motion.rates.iter_mut().zip(quicker));
        pairs.for_each(|(own, change)| *own += change);
        let mut balance = Balance::default();
        self.accelerate(sample, motion, &mut balance)
    }

    /// Applies the inputs of all joints at an instant.
    fn apply(&self, time: Instant, (q, rates): (&[f64], &[f64]), balance: &mut Balance) {
        self.linkage.turn(self.turning_rad_s(time), balance);
        let joints = self.linkage.joints.iter().zip(self.drives).zip(&self.aims_rad);
        for ((joint, drive), aim_rad) in joints {
            drive.apply((drive.driving().within(time), *aim_rad), *joint, (q, rates), balance);
        }
        let efforts = self.lossy.iter().map(|(number, _)| self.effort(*number, time, (q, rates)));
        balance.efforts.clear();
        balance.efforts.extend(efforts);
    }

    /// Torque in N m of the motor of a joint in front of its losses: `input − k (q − q₀) − d q̇`, with the feedback's stiffness
    /// k and damping d about the aim q₀.
    fn effort(&self, number: usize, time: Instant, (q, rates): (&[f64], &[f64])) -> f64 {
        let (drive, joint) = (&self.drives[number], self.linkage.joints[number]);
        let input = drive.driving().within(time);
        let Drive::Torque(_, reaction) = drive else { return input };
        // The reaction includes the friction, which is no torque of the motor.
        let friction_n_m = self.linkage.friction_n_m_s_rad[number] * rates[joint];
        let own_rad = q[joint] - self.aims_rad[number];
        input - (reaction.torque_n_m(own_rad, rates[joint]) - friction_n_m)
    }

    /// Rate in rad/s of the first joint's reference at an instant; the damping of a loop turns with it.
    fn turning_rad_s(&self, time: Instant) -> f64 {
        let turning = self.drives[0].driving().turning.as_ref();
        turning.map_or(0.0, |turning| turning.within(time))
    }

    /// Computes the accelerations at a sample. Where the mass matrix is singular, the accelerations of the last step's
    /// end stay.
    fn accelerate(
        &self,
        sample: usize,
        motion: &mut Motion,
        balance: &mut Balance,
    ) -> Result<(), SimulationError> {
        self.linkage.balance(&motion.q, &motion.rates, balance);
        self.apply((sample, 0.0), (&motion.q, &motion.rates), balance);
        let joints = self.lossy.iter().map(|(number, _)| self.linkage.joints[*number]);
        if let Some((free, answers)) = balance.accelerations(joints.clone()) {
            let joints: Vec<usize> = joints.collect();
            let each = joints.len();
            let of = |rates: &dyn Fn(usize) -> f64| DVector::from_fn(each, |k, _| rates(joints[k]));
            // An instant changes no rate.
            let rates =
                Answers { free: of(&|k| motion.rates[k]), per_loss: DMatrix::zeros(each, each) };
            let accelerations =
                Answers { free: of(&|k| free[k]), per_loss: answers.select_rows(&joints) };
            let own = self.lossy.iter().map(|(_, own)| *own).zip(balance.efforts.iter().copied());
            let own: Vec<(Losses, f64)> = own.collect();
            let losses = balanced(&own, [&rates, &accelerations], DVector::zeros(each));
            motion.accelerations = (free - answers * losses).as_slice().to_vec();
        }
        if motion.q.iter().chain(&motion.rates).all(|value| value.is_finite()) {
            return Ok(());
        }
        Err(SimulationError::NotFinite { time_s: self.grid.time_s(sample) })
    }

    /// Computes the accelerations at a sample again if a joint is under a torque. The torque may jump at the sample,
    /// and the last step ended with the torque before the jump.
    fn accelerate_under_torques(
        &self,
        sample: usize,
        motion: &mut Motion,
        balance: &mut Balance,
    ) -> Result<(), SimulationError> {
        if self.drives.iter().any(|drive| matches!(drive, Drive::Torque(..))) {
            self.accelerate(sample, motion, balance)?;
        }
        Ok(())
    }

    /// Torque of the motor of each joint in N m at an instant. With friction b and all other forces f it is
    /// `(M q̈)_joint − f + b q̇` for a prescribed acceleration, else its [`effort`](Self::effort) less its loss.
    fn torques_n_m(&self, time: Instant, motion: &Motion, balance: &mut Balance) -> Vec<f64> {
        let Motion { q, rates, accelerations } = motion;
        // M and f without the equations that `apply` replaces.
        if self.drives.iter().any(|drive| matches!(drive, Drive::Acceleration(_))) {
            self.linkage.balance(q, rates, balance);
        }
        let frictions = &self.linkage.friction_n_m_s_rad;
        let joints = self.linkage.joints.iter().zip(frictions).enumerate();
        let torque =
            |(drive, (number, (joint, friction))): (&Drive, (usize, (&usize, &f64)))| match drive {
                Drive::Acceleration(_) => {
                    let row = &balance.mass[joint * q.len()..][..q.len()];
                    dot(row, accelerations) - balance.force[*joint] + friction * rates[*joint]
                }
                Drive::Torque(..) => {
                    let effort_n_m = self.effort(number, time, (q, rates));
                    let own = self.lossy.iter().find(|(lossy, _)| *lossy == number);
                    let [rate, acceleration] = [rates, accelerations].map(|own| [own[*joint], 0.0]);
                    let loss = own.map(|(_, own)| own.solve(effort_n_m, rate, acceleration));
                    effort_n_m - loss.unwrap_or_default()
                }
            };
        self.drives.iter().zip(joints).map(torque).collect()
    }

    /// Power of all motors in W at an instant.
    fn power_w(&self, time: Instant, motion: &Motion, balance: &mut Balance) -> f64 {
        let torques = self.torques_n_m(time, motion, balance);
        let joints = self.linkage.joints.iter().zip(torques);
        joints.map(|(joint, torque)| torque * motion.rates[*joint]).sum()
    }
}

/// Time of a stage of a step after a sample, as a share of the interval to the next sample.
fn interval_share(stage: usize, step: usize, steps: usize) -> f64 {
    (step as f64 + Radau::places()[stage]) / steps as f64
}
