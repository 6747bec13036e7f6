//! Steps bent links in time, finer and finer: each joint under a torque, or moved as prescribed.

use super::balance::Balance;
use super::bent::BentMotion;
use super::driving::Driving;
use super::error::SimulationError;
use super::linkage::Linkage;
use super::modes::HubReaction;
use super::play::PlayProgress;
use super::radau::{Motion, Radau};
use super::state::settle;
use crate::numeric::{TimeGrid, dot};

/// Most steps of a refined motion.
const LONGEST: usize = 1 << 20;

/// Orders that each refinement adds to the polynomials.
const MORE_ORDERS: usize = 2;

/// Largest change of a settled motion by the last refinement, over the motion.
const UNSETTLED: f64 = 1e-4;

/// Largest change of an angle in rad that is round-off.
const STILL_RAD: f64 = 1e-12;

/// Input of one joint: a torque, with a reaction around an angle, or an acceleration.
#[derive(Debug, Clone)]
pub(super) enum Drive {
    Torque(Driving, HubReaction),
    Acceleration(Driving),
}

/// Coordinates and rates at the start.
#[derive(Debug, Clone)]
pub(super) struct Begun {
    pub(super) q: Vec<f64>,
    pub(super) rates: Vec<f64>,
    /// Direction in rad of zero displacement for one link.
    pub(super) from_rad: f64,
}

/// One cycle that repeats.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cycle {
    pub(super) grid: TimeGrid,
    /// Whether the hub is free: it may turn on from cycle to cycle, at one rate.
    pub(super) is_free: bool,
}

/// Links, the input of each joint, and their start.
pub(super) struct Problem<'a> {
    pub(super) linkage: Linkage,
    pub(super) drives: &'a [Drive],
    /// Angle of each joint in rad without a feedback torque.
    pub(super) aims_rad: Vec<f64>,
    pub(super) grid: &'a TimeGrid,
    pub(super) start: Begun,
    pub(super) cycle: Option<Cycle>,
}

/// Refines the motion until tip and joints change by less than `tolerance` of their motion, or to the finest level.
/// `problem` receives the additional orders of the polynomials and the coarser motion, `watch` each sample.
///
/// # Errors
/// [`SimulationError`].
pub(super) fn settled<'a>(
    problem: impl Fn(usize, Option<&BentMotion>) -> Result<Problem<'a>, SimulationError>,
    (samples, tolerance, most_refinements): (usize, f64, usize),
    watch: &dyn Fn(PlayProgress),
) -> Result<BentMotion, SimulationError> {
    let played = |refinement: usize, before: Option<&BentMotion>| {
        let at = |done| watch(PlayProgress { refinement, done, samples });
        problem(refinement * MORE_ORDERS, before)?.played(1 << refinement, at)
    };
    let mut coarse = played(0, None);
    for finer in 1..=most_refinements {
        let is_last = finer == most_refinements || (samples << finer) > LONGEST;
        let before = match coarse {
            Ok(before) => before,
            // Shorter steps may converge where long ones do not.
            Err(SimulationError::NotConverged { .. }) if !is_last => {
                coarse = played(finer, None);
                continue;
            }
            Err(_) => return coarse,
        };
        let mut motion = played(finer, Some(&before))?;
        let (change, moved) = (motion.change_from(&before), motion.moved());
        let least = [STILL_RAD * motion.play.length_m(), STILL_RAD];
        let is_within =
            |share: f64| (0..2).all(|of| change[of] <= (share * moved[of]).max(least[of]));
        (motion.play.change, motion.play.is_unsettled) = (change, !is_within(UNSETTLED));
        let is_settled = is_within(tolerance);
        coarse = Ok(motion);
        if is_settled || is_last {
            break;
        }
    }
    coarse
}

impl Drive {
    fn driving(&self) -> &Driving {
        match self {
            Self::Torque(driving, _) | Self::Acceleration(driving) => driving,
        }
    }

    /// Puts an input into the equation of a joint, the coordinate of this number.
    fn apply(
        &self,
        (input, aim_rad): (f64, f64),
        joint: usize,
        (q, rates): (&[f64], &[f64]),
        into: &mut Balance,
    ) {
        let count = q.len();
        match self {
            Self::Torque(_, reaction) => {
                into.force[joint] += input - reaction.torque_n_m(q[joint] - aim_rad, rates[joint]);
            }
            Self::Acceleration(_) => {
                into.mass[joint * count..][..count].fill(0.0);
                into.mass[joint * count + joint] = 1.0;
                into.force[joint] = input;
            }
        }
    }
}

impl Problem<'_> {
    /// Plays with `steps` steps from one sample to the next; `at` receives the number of finished samples.
    fn played(self, steps: usize, at: impl Fn(usize)) -> Result<BentMotion, SimulationError> {
        let (grid, count) = (*self.grid, self.linkage.count);
        let (mut stiffness, mut damping) =
            (self.linkage.stiffness.clone(), self.linkage.damping.clone());
        for (joint, drive) in self.linkage.joints.iter().zip(self.drives) {
            if let Drive::Torque(_, reaction) = drive {
                stiffness[joint * count + joint] += reaction.stiffness_n_m_rad;
                damping[joint * count + joint] += reaction.damping_n_m_s_rad;
            }
        }
        let mut radau = Radau::new(grid.step_s / steps as f64, &stiffness, &damping);
        let mut balance = Balance::default();
        let Begun { q, rates, from_rad } = self.start.clone();
        let mut motion = Motion { q, rates, accelerations: vec![0.0; count] };
        let rest = vec![0.0; count];
        let is_arm = self.linkage.links.len() > 1;
        self.linkage.balance(&motion.q, if is_arm { &rest } else { &motion.rates }, &mut balance);
        let holding_n_m = self.linkage.joints.iter().map(|joint| -balance.force[*joint]);
        let mut played = BentMotion::begun(&self.linkage, from_rad, (steps, grid.len), holding_n_m);
        self.accelerate(0, &mut motion, &mut balance)?;
        if let Some(Cycle { grid: cycle, is_free }) = self.cycle {
            settle(&mut motion, cycle, is_free, |motion, sample| {
                (0..steps).try_for_each(|step| self.step(&mut radau, motion, (sample, step, steps)))
            })?;
            self.accelerate_torques(0, &mut motion, &mut balance)?;
        }
        self.observe(0, &motion, &mut balance, &mut played);
        for sample in 1..grid.len {
            let [mut work_j, mut lost_j] = [&played.play.work_j, &played.play.lost_j]
                .map(|sum| sum.last().copied().unwrap_or_default());
            for step in 0..steps {
                self.step(&mut radau, &mut motion, (sample - 1, step, steps))?;
                if is_arm {
                    let reached = radau.reached();
                    lost_j += radau
                        .integral(reached.iter().map(|own| self.linkage.lost_w(&own.rates, 0.0)));
                    let powers = reached.iter().enumerate().map(|(stage, own)| {
                        let s = place(stage, step, steps);
                        self.power_w((sample - 1, s), own, &mut balance)
                    });
                    work_j += radau.integral(powers);
                }
            }
            if is_arm {
                played.play.work_j.push(work_j);
                played.play.lost_j.push(lost_j);
            }
            self.accelerate_torques(sample, &mut motion, &mut balance)?;
            self.observe(sample, &motion, &mut balance, &mut played);
            at(sample + 1);
        }
        Ok(played)
    }

    /// Adds the motion at a sample.
    fn observe(
        &self,
        sample: usize,
        motion: &Motion,
        balance: &mut Balance,
        into: &mut BentMotion,
    ) {
        let torques_n_m = self.torques_n_m((sample, 0.0), motion, balance);
        into.observe(motion, torques_n_m, self.turning_rad_s((sample, 0.0)));
    }

    /// Makes one step of several after a sample.
    fn step(
        &self,
        radau: &mut Radau<'_>,
        motion: &mut Motion,
        (sample, step, steps): (usize, usize, usize),
    ) -> Result<(), SimulationError> {
        let is_done = radau.advance(motion, |stage, q, rates, balance| {
            self.linkage.balance(q, rates, balance);
            self.apply((sample, place(stage, step, steps)), (q, rates), balance);
        });
        let time_s = self.grid.time_s(sample + 1);
        if is_done { Ok(()) } else { Err(SimulationError::NotConverged { time_s }) }
    }

    /// Applies the inputs of all joints a part s of a step after a sample.
    fn apply(&self, at: (usize, f64), motion: (&[f64], &[f64]), balance: &mut Balance) {
        self.linkage.turn(self.turning_rad_s(at), balance);
        let joints = self.linkage.joints.iter().zip(self.drives).zip(&self.aims_rad);
        for ((joint, drive), aim_rad) in joints {
            drive.apply((drive.driving().within(at), *aim_rad), *joint, motion, balance);
        }
    }

    /// Rate of the first joint's reference in rad/s, a part s of a step after a sample; the damping of a loop turns
    /// with it.
    fn turning_rad_s(&self, at: (usize, f64)) -> f64 {
        let turning = self.drives[0].driving().turning.as_ref();
        turning.map_or(0.0, |turning| turning.within(at))
    }

    /// Computes the accelerations at a sample. Where the masses are singular, those of the last step stay.
    fn accelerate(
        &self,
        sample: usize,
        motion: &mut Motion,
        balance: &mut Balance,
    ) -> Result<(), SimulationError> {
        self.linkage.balance(&motion.q, &motion.rates, balance);
        self.apply((sample, 0.0), (&motion.q, &motion.rates), balance);
        if let Some(now) = balance.accelerations() {
            motion.accelerations = now;
        }
        if motion.q.iter().chain(&motion.rates).all(|own| own.is_finite()) {
            return Ok(());
        }
        Err(SimulationError::NotFinite { time_s: self.grid.time_s(sample) })
    }

    /// The accelerations under torques, which may jump at a sample: the last step's end has those of the torque before.
    fn accelerate_torques(
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

    /// Torque of each joint in N m, a part s of a step after a sample: the torque of its motor, or the torque for its
    /// prescribed motion.
    fn torques_n_m(&self, at: (usize, f64), motion: &Motion, balance: &mut Balance) -> Vec<f64> {
        let Motion { q, rates, accelerations } = motion;
        if self.drives.iter().any(|drive| matches!(drive, Drive::Acceleration(_))) {
            self.linkage.balance(q, rates, balance);
        }
        let frictions = &self.linkage.friction_n_m_s_rad;
        let joints = self.linkage.joints.iter().zip(frictions).zip(&self.aims_rad);
        let torque = |(drive, ((joint, friction), aim_rad)): (&Drive, ((&usize, &f64), &f64))| {
            let rubbed = friction * rates[*joint];
            match drive {
                Drive::Acceleration(_) => {
                    let row = &balance.mass[joint * q.len()..][..q.len()];
                    dot(row, accelerations) - balance.force[*joint] + rubbed
                }
                // Friction acts on the joint; the rest of the reaction is the motor's.
                Drive::Torque(driving, reaction) => {
                    let opposed = reaction.torque_n_m(q[*joint] - aim_rad, rates[*joint]);
                    driving.within(at) - (opposed - rubbed)
                }
            }
        };
        self.drives.iter().zip(joints).map(torque).collect()
    }

    /// Power of all torques in W.
    fn power_w(&self, at: (usize, f64), motion: &Motion, balance: &mut Balance) -> f64 {
        let torques = self.torques_n_m(at, motion, balance);
        let joints = self.linkage.joints.iter().zip(torques);
        joints.map(|(joint, torque)| torque * motion.rates[*joint]).sum()
    }
}

/// Place of a stage of one step, as a part of the interval between two samples.
fn place(stage: usize, step: usize, steps: usize) -> f64 {
    (step as f64 + Radau::places()[stage]) / steps as f64
}
