//! Joints of an arm moved as given: where its tip goes then, and which torques that takes.
//!
//! The arm is one chain of elasticas, each turned by its joint against the tip of the one before; nothing of the inversion
//! is used. Joints that are moved let no pose fall.

use nalgebra::DVector;
use thiserror::Error;

use super::arm_chain::ArmChain;
use super::balance::{Balance, Met};
use super::driving::{Interpolation, pieces};
use super::radau::{Motion, Radau};
use super::shape::newton_change;
use crate::link::Arm;
use crate::numeric::{Size, TimeGrid, dot};

/// What each refinement adds to every order, and most of them.
const MORE_ORDERS: usize = 2;
const MOST_REFINEMENTS: usize = 4;

/// A shape is at rest where an iteration changes it by less, in rad; and the most iterations.
const SETTLED_RAD: f64 = 1e-12;
const MOST_ITERATIONS: usize = 60;

/// How a joint is moved: angle and rate in rad and rad/s at first, and accelerations in rad/s² at each sample.
#[derive(Debug, Clone, Copy)]
pub struct MovedJoint<'a> {
    /// Angle against the tip of the link before, of the first joint against x.
    pub angle_rad: f64,
    /// Its rate.
    pub rate_rad_s: f64,
    /// Its accelerations.
    pub accelerations_rad_s2: &'a [f64],
}

/// What an arm does when its joints are moved.
#[derive(Debug, Clone)]
pub struct MovedArm {
    /// x and y of the tip in m at each sample.
    pub tip_m: [Vec<f64>; 2],
    /// Torque of each joint in N m, its friction included.
    pub torques_n_m: Vec<Vec<f64>>,
    /// Kinetic energy, and that of strain and weight, in J at each sample.
    pub energy_j: Vec<f64>,
    /// Work in J that the torques have done until each sample.
    pub work_j: Vec<f64>,
    /// What damping and friction have dissipated in J until each sample.
    pub lost_j: Vec<f64>,
    /// Largest change of the tip in m by the last refinement: longer polynomials, half the step.
    pub change_m: f64,
}

/// Why an arm is not moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum MovedArmError {
    /// Damping that no equation in time has.
    #[error("the damping of a link is neither rayleigh with alpha = 0 nor none")]
    Damping,
    /// No shape at rest, or a step that does not converge.
    #[error("the motion of its joints does not converge")]
    NotConverged,
}

/// Moves the joints of an arm over a grid, finer and finer until that changes the tip by less than `settled_m` or the
/// finest is reached ([`MovedArm::change_m`] tells);
/// `highest_rad_s` is the highest frequency of the motion.
///
/// # Errors
/// [`MovedArmError`].
pub fn move_arm(
    arm: &Arm,
    joints: &[MovedJoint<'_>],
    grid: &TimeGrid,
    (highest_rad_s, settled_m): (f64, f64),
) -> Result<MovedArm, MovedArmError> {
    let played = |finer: usize| {
        let chain = ArmChain::of(arm, highest_rad_s, finer * MORE_ORDERS)?;
        chain.played(joints, grid, 1 << finer)
    };
    let mut coarse = played(0)?;
    for finer in 1..=MOST_REFINEMENTS {
        let mut found = played(finer)?;
        let [x, y] = [0, 1].map(|axis: usize| found.tip_m[axis].iter().zip(&coarse.tip_m[axis]));
        let apart = x.zip(y).map(|((x, was_x), (y, was_y))| {
            ((x - was_x) * (x - was_x) + (y - was_y) * (y - was_y)).sqrt()
        });
        found.change_m = apart.fold(0.0, Size::larger);
        coarse = found;
        if coarse.change_m <= settled_m {
            break;
        }
    }
    Ok(coarse)
}

impl ArmChain {
    /// The equations with the joints' accelerations given.
    fn moved(&self, accelerations: impl Iterator<Item = f64>, balance: &mut Balance) {
        for (joint, acceleration) in self.joints.iter().zip(accelerations) {
            balance.mass[joint * self.count..][..self.count].fill(0.0);
            balance.mass[joint * self.count + joint] = 1.0;
            balance.force[*joint] = acceleration;
        }
    }

    /// The shape at rest with the joints at their angles, by Newton's iteration.
    fn at_rest(&self, joints: &[MovedJoint<'_>]) -> Result<Vec<f64>, MovedArmError> {
        let (count, mut balance) = (self.count, Balance::default());
        let rest = vec![0.0; count];
        let mut q = rest.clone();
        for (joint, moved) in self.joints.iter().zip(joints) {
            q[*joint] = moved.angle_rad;
        }
        let held = q.clone();
        let mut left = |q: &[f64]| {
            self.balance(q, &rest, &mut balance);
            let mut left = DVector::from_column_slice(&balance.force);
            for joint in &self.joints {
                left[*joint] = held[*joint] - q[*joint];
            }
            left
        };
        for _ in 0..MOST_ITERATIONS {
            let now = left(&q);
            let change =
                newton_change(&mut q, &now, &mut left).ok_or(MovedArmError::NotConverged)?;
            q.iter_mut().zip(change.iter()).for_each(|(own, change)| *own -= change);
            if change.amax() < SETTLED_RAD {
                return Ok(q);
            }
        }
        Err(MovedArmError::NotConverged)
    }

    fn played(
        &self,
        joints: &[MovedJoint<'_>],
        grid: &TimeGrid,
        steps: usize,
    ) -> Result<MovedArm, MovedArmError> {
        let count = self.count;
        let cubics: Vec<_> = joints
            .iter()
            .map(|joint| pieces(joint.accelerations_rad_s2, Interpolation::Cubic))
            .collect();
        let at = |sample: usize, s: f64| {
            cubics.iter().map(move |pieces| match pieces.get(sample) {
                Some(cubic) => cubic.iter().rev().fold(0.0, |sum, term| sum * s + term),
                None => 0.0,
            })
        };
        let mut motion = Motion {
            q: self.at_rest(joints)?,
            rates: vec![0.0; count],
            accelerations: vec![0.0; count],
        };
        for (joint, moved) in self.joints.iter().zip(joints) {
            motion.rates[*joint] = moved.rate_rad_s;
        }
        let mut balance = Balance::default();
        let mut found = MovedArm {
            tip_m: [Vec::new(), Vec::new()],
            torques_n_m: vec![Vec::new(); self.links.len()],
            energy_j: Vec::new(),
            work_j: Vec::new(),
            lost_j: Vec::new(),
            change_m: f64::INFINITY,
        };
        let mut radau = Radau::new(grid.step_s / steps as f64, &self.stiffness, &self.damping);
        let places = Radau::places();
        // The joints' accelerations are given, and those of what bends follow.
        self.balance(&motion.q, &motion.rates, &mut balance);
        self.moved(at(0, 0.0), &mut balance);
        motion.accelerations = balance.accelerations().ok_or(MovedArmError::NotConverged)?;
        for sample in 0..grid.len {
            self.observe(&motion, &mut balance, &mut found);
            if sample + 1 == grid.len {
                break;
            }
            for step in 0..steps {
                let is_done = radau.advance(&mut motion, |stage, q, rates, balance| {
                    let s = (step as f64 + places[stage]) / steps as f64;
                    self.balance(q, rates, balance);
                    self.moved(at(sample, s), balance);
                });
                if !is_done {
                    return Err(MovedArmError::NotConverged);
                }
            }
        }
        found.add_up(grid.step_s);
        Ok(found)
    }

    /// Adds what a motion is like: tip, torques, energy, and powers in place of work and loss.
    fn observe(&self, motion: &Motion, balance: &mut Balance, found: &mut MovedArm) {
        let Motion { q, rates, accelerations } = motion;
        self.balance(q, rates, balance);
        let mut energy_j = 0.5
            * self
                .stiffness
                .chunks_exact(self.count)
                .zip(q)
                .map(|(row, own)| own * dot(row, q))
                .sum::<f64>();
        let tip = self.walk(q, rates, |place, met| match met {
            Met::Mass(mass_kg) => {
                energy_j += mass_kg
                    * (0.5 * dot(&place.rate_m_s, &place.rate_m_s)
                        - dot(&self.gravity_m_s2, &place.at_m));
            }
            Met::Inertia(inertia_kg_m2, turned) => {
                let rate: f64 = turned.iter().map(|i| rates[*i]).sum();
                energy_j += 0.5 * inertia_kg_m2 * rate * rate;
            }
            Met::End(_) => {}
        });
        let damped = self
            .damping
            .chunks_exact(self.count)
            .zip(rates)
            .map(|(row, own)| own * dot(row, rates));
        let (mut lost_w, mut power_w) = (damped.sum::<f64>(), 0.0);
        for (number, joint) in self.joints.iter().enumerate() {
            let rate = rates[*joint];
            let rubbed_n_m = self.friction_n_m_s_rad[number] * rate;
            let row = &balance.mass[joint * self.count..][..self.count];
            let torque_n_m = dot(row, accelerations) - balance.force[*joint] + rubbed_n_m;
            found.torques_n_m[number].push(torque_n_m);
            power_w += torque_n_m * rate;
            lost_w += rubbed_n_m * rate;
        }
        for (column, at_m) in found.tip_m.iter_mut().zip(tip.at_m) {
            column.push(at_m);
        }
        found.energy_j.push(energy_j);
        found.work_j.push(power_w);
        found.lost_j.push(lost_w);
    }
}

impl MovedArm {
    /// Integrates the powers over the samples, which lie `step_s` apart, by cubic splines.
    fn add_up(&mut self, step_s: f64) {
        for powers in [&mut self.work_j, &mut self.lost_j] {
            let mut sum = 0.0;
            let parts = pieces(powers, Interpolation::Cubic);
            let whole = parts.iter().map(|cubic| {
                let over = cubic.iter().zip(1..).map(|(term, n)| term / f64::from(n));
                step_s * over.sum::<f64>()
            });
            let sums = std::iter::once(0.0).chain(whole).map(|part| {
                sum += part;
                sum
            });
            *powers = sums.take(powers.len()).collect();
        }
    }
}
