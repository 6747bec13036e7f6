//! Joints of an arm moved as given: where its tip goes then, and which torques that takes.
//!
//! The arm is one chain of elasticas, each turned by its joint against the tip of the one before; nothing of the inversion
//! is used. Joints that are moved let no pose fall.

use super::arm_chain::ArmChain;
use super::arm_play::{Drive, PlayedArm, Problem, settled};
use super::arm_rest::{ArmStart, at_rest};
use super::driving::{Driving, Interpolation, pieces};
use super::error::SimulationError;
use crate::link::{Arm, Damping};
use crate::numeric::TimeGrid;

/// Most refinements.
const MOST_REFINEMENTS: usize = 4;

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

/// Moves the joints of an arm over a grid, finer and finer until that changes tip and joints by less than `tolerance` of
/// what they move by or the finest is reached ([`PlayedArm::change`] tells);
/// `highest_rad_s` is the highest frequency of the motion.
///
/// # Errors
/// [`SimulationError`]; among them damping that no equation in time has.
pub fn move_arm(
    arm: &Arm,
    joints: &[MovedJoint<'_>],
    grid: &TimeGrid,
    (highest_rad_s, tolerance): (f64, f64),
) -> Result<PlayedArm, SimulationError> {
    let drive = |joint: &MovedJoint<'_>| {
        let samples = joint.accelerations_rad_s2.to_vec();
        let pieces = pieces(&samples, Interpolation::Cubic);
        Drive::Acceleration(Driving { samples, pieces, hold: 0.0, repeats: false, turning: None })
    };
    let drives: Vec<Drive> = joints.iter().map(drive).collect();
    let angles_rad: Vec<f64> = joints.iter().map(|joint| joint.angle_rad).collect();
    let problem = |more: usize| {
        let chain = rayleigh(arm, ArmChain::of(arm, highest_rad_s, more, None))?;
        let q =
            at_rest(arm, &chain, ArmStart::Joints(&angles_rad)).ok_or(SimulationError::NoRest)?;
        let mut rates = vec![0.0; chain.count];
        for (joint, moved) in chain.joints.iter().zip(joints) {
            rates[*joint] = moved.rate_rad_s;
        }
        Ok(Problem { chain, drives: &drives, grid, start: (q, rates) })
    };
    settled(problem, (tolerance, MOST_REFINEMENTS), &|_| {})
}

/// The same with the damping of its links, which must be proportional to stiffness.
fn rayleigh(arm: &Arm, chain: ArmChain) -> Result<ArmChain, SimulationError> {
    let refused = SimulationError::NotDerived {
        what: "the damping of a link is neither rayleigh with alpha = 0 nor none",
        known: "with these",
    };
    let betas_s = arm.links().iter().map(|own| match own.link.damping() {
        Damping::Rayleigh { alpha_per_s: 0.0, beta_s } => Ok(*beta_s),
        Damping::None | Damping::Hysteretic { ratio: 0.0 } => Ok(0.0),
        _ => Err(refused.clone()),
    });
    let betas_s: Vec<f64> = betas_s.collect::<Result<_, _>>()?;
    let damping = chain.scaled_stiffness(&betas_s);
    Ok(ArmChain { damping, ..chain })
}
