//! Torques played on an arm, with feedback at its joints: direct dynamics.

use serde::Serialize;
use thiserror::Error;

use super::arm_chain::ArmChain;
use super::arm_play::{Drive, PlayedArm, Problem, settled};
use super::arm_rest::{ArmStart, at_rest};
use super::chain::play_bytes;
use super::driving::{Driving, Interpolation, pieces};
use super::error::{STEP_SHARE, SimulationError};
use super::history::{APART_RAD, Feedback, Torque};
use super::modes::{HubReaction, torque_band_rad_s};
use super::play::{ArmProgress, continued, refuse_memory};
use super::pose::without_noise;
use super::shape::{refuse_unknown, viscous};
use crate::beam::{Mesh, MeshPlan};
use crate::link::Arm;
use crate::modal::DampingLaw;
use crate::numeric::{TimeGrid, extremes};
use crate::text::significant;

/// Most refinements.
const MOST_REFINEMENTS: usize = 6;

/// Imbalance of energy above which a warning is given.
const IMBALANCE: f64 = 1e-3;

/// Numbers that are kept of a sample beside those of each angle.
const NUMBERS_PER_SAMPLE: usize = 64;

/// What to play on an arm, and how.
#[derive(Debug, Clone, Copy)]
pub struct ArmPlay<'a> {
    /// The torque of each joint, the inner one first, at the same times. It turns its link counterclockwise and the link
    /// before the other way.
    pub torques: &'a [Torque],
    /// The torques between their samples.
    pub interpolation: Interpolation,
    /// Time in s at which to end; `None`: at the last sample. After that no torque acts, or with gravity the last one.
    pub until_s: Option<f64>,
    /// Feedback of each joint, around its angle as an encoder sees it; empty without.
    pub feedback: &'a [Feedback],
    /// Where the arm starts.
    pub start: ArmStart<'a>,
    /// Share of the motion within which tip and joints must settle.
    pub tolerance: f64,
    /// Most memory in bytes that playing may take; `None`: no bound.
    pub memory_bytes: Option<usize>,
}

/// What the user must know to judge the simulation of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ArmPlayWarning {
    /// A torque that does not begin with what holds the arm.
    #[error(
        "torque{joint} begins with {} N m, but {} N m hold the arm where it starts: the difference acts on the \
         resting arm as a jump, {} % of the largest range of a torque",
        significant(*torque_n_m, 4),
        significant(*holding_n_m, 4),
        significant(100.0 * share, 2)
    )]
    BeginsUnheld {
        /// Number of the joint, from 1.
        joint: usize,
        /// First sample in N m.
        torque_n_m: f64,
        /// What holds the arm in N m.
        holding_n_m: f64,
        /// Their difference over the largest range of any torque.
        share: f64,
    },
    /// A torque that drops to zero after its last sample.
    #[error(
        "torque{joint} ends with {} N m, {} % of the largest range of a torque: it drops to zero there",
        significant(*torque_n_m, 4),
        significant(100.0 * share, 2)
    )]
    EndsWithJump {
        /// Number of the joint, from 1.
        joint: usize,
        /// Last sample in N m.
        torque_n_m: f64,
        /// The same over the largest range of any torque.
        share: f64,
    },
    /// A reference that does not begin where the joint stands.
    #[error(
        "the reference of joint {joint} begins at {} rad, but the joint stands at {} rad: the feedback turns it there",
        significant(*reference_rad, 6),
        significant(*joint_rad, 6)
    )]
    ReferenceApart {
        /// Number of the joint, from 1.
        joint: usize,
        /// First angle of the reference in rad.
        reference_rad: f64,
        /// Angle of the joint at the start in rad.
        joint_rad: f64,
    },
    /// Work that is neither held nor lost.
    #[error("work and energy differ by {share:.1e} of the largest of them")]
    Imbalance {
        /// The difference over the largest work or energy.
        share: f64,
    },
    /// A motion that refinement still changes.
    #[error(
        "the last refinement still changes the tip by {tip_m:.1e} m, a joint by {joint_rad:.1e} rad \
         (half the step, more angles)"
    )]
    Unsettled {
        /// Change of the tip in m.
        tip_m: f64,
        /// Largest change of a joint in rad.
        joint_rad: f64,
    },
}

impl ArmPlayWarning {
    /// Name of the kind in summary.json.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::BeginsUnheld { .. } => "begins_unheld",
            Self::EndsWithJump { .. } => "ends_with_jump",
            Self::ReferenceApart { .. } => "reference_apart",
            Self::Imbalance { .. } => "imbalance",
            Self::Unsettled { .. } => "unsettled",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::BeginsUnheld { .. } => {
                "torques.csv of solve begins with it: the arm must start where that path does"
            }
            Self::EndsWithJump { .. } => "torques of solve end at zero, unless the window is cut",
            Self::ReferenceApart { .. } => {
                "joint_angles.csv of solve begins there: the arm must start where that path does"
            }
            Self::Imbalance { .. } => "a shorter step of the torques, or smaller gains",
            Self::Unsettled { .. } => {
                "feedback, where the arm falls from its pose; torques without jumps, or damping and hub.inertia where they jump"
            }
        }
    }
}

/// Computes the motion of an arm under torques of its joints: direct dynamics; `watch` gets the progress.
///
/// The arm is a chain of inextensible elasticas with angles as coordinates, integrated by Radau's method with more
/// angles and shorter steps until tip and joints settle; nothing of the inversion is used. Hysteretic damping has no
/// equation in time: its ratio is taken as the viscous ratio of every mode of the link alone, clamped at its joint.
///
/// # Errors
/// [`SimulationError`].
///
/// # Panics
/// If there is not one torque for each link, or feedback for some joints alone.
pub fn simulate_arm(
    arm: &Arm,
    plans: &[MeshPlan],
    play: &ArmPlay<'_>,
    watch: &dyn Fn(ArmProgress),
) -> Result<(PlayedArm, Vec<ArmPlayWarning>), SimulationError> {
    let links = arm.links().len();
    assert!(play.torques.len() == links, "one torque for each link");
    assert!([0, links].contains(&play.feedback.len()), "feedback for all joints or none");
    let driven = play.torques[0].grid();
    let grid = continued(driven, play.until_s)?;
    let drives = drives(arm, play)?;
    let laws = laws(arm, plans)?;
    let highest_rad_s = band_rad_s(play, &driven);
    let state = match play.start {
        ArmStart::State(state) => Some(state),
        _ => None,
    };
    state.map_or(Ok(()), |state| state.check(arm))?;
    let problem = |more: usize| {
        let modes = ArmChain::coordinates(arm, highest_rad_s, more, state);
        let bytes = play_bytes(modes, grid.len, 2 * (2 * modes + NUMBERS_PER_SAMPLE));
        refuse_memory((grid.len, modes), bytes, play.memory_bytes)?;
        let chain = ArmChain::of(arm, highest_rad_s, more, state);
        let damping = chain.links.iter().zip(&laws).map(|(link, law)| viscous(link, law, None));
        let lost = SimulationError::NotFinite { time_s: grid.time_s(0) };
        let damping: Vec<Vec<f64>> = damping.collect::<Option<_>>().ok_or(lost)?;
        let chain = chain.damped(&damping);
        let start = if let Some(state) = state {
            chain.of_state(state)?
        } else {
            let q = at_rest(arm, &chain, play.start).ok_or(SimulationError::NoRest)?;
            (q, vec![0.0; chain.count])
        };
        Ok(Problem { chain, drives: &drives, grid: &grid, start })
    };
    let mut found = settled(problem, (play.tolerance, MOST_REFINEMENTS), watch)?;
    let weight_n_m = arm.weight_moment_n_m();
    for torque_n_m in &mut found.holding_n_m {
        *torque_n_m = without_noise(*torque_n_m, weight_n_m);
    }
    let warnings = warnings(arm, play, &found);
    Ok((found, warnings))
}

/// The damping law of each link.
fn laws(arm: &Arm, plans: &[MeshPlan]) -> Result<Vec<DampingLaw>, SimulationError> {
    let law = |(own, plan): (&crate::link::ArmLink, &MeshPlan)| {
        let law = DampingLaw::of(&own.link, &Mesh::new(&own.link, plan)?)?;
        refuse_unknown(&own.link, &law)?;
        Ok(law)
    };
    arm.links().iter().zip(plans).map(law).collect()
}

/// What acts on each joint.
fn drives(arm: &Arm, play: &ArmPlay<'_>) -> Result<Vec<Drive>, SimulationError> {
    let drive = |(number, torque): (usize, &Torque)| {
        let friction_n_m_s_rad = arm.links()[number].link.joint().friction_n_m_s_rad;
        let own = torque.torque_n_m();
        let kept_n_m = if arm.has_weight() { own[own.len() - 1] } else { 0.0 };
        let mut reaction = HubReaction {
            damping_n_m_s_rad: friction_n_m_s_rad,
            friction_n_m_s_rad,
            ..HubReaction::default()
        };
        let (samples, hold) = match play.feedback.get(number) {
            None => (own.to_vec(), kept_n_m),
            Some(feedback) => {
                reaction.stiffness_n_m_rad = feedback.stiffness_n_m_rad();
                reaction.damping_n_m_s_rad += feedback.damping_n_m_s_rad();
                let wanted = feedback.wanted_torque_n_m(torque, Some(0.0), false)?;
                let samples = own.iter().zip(wanted).map(|(own, wanted)| own + wanted).collect();
                let turn_rad = feedback.reference().turn_rad(Some(0.0));
                (samples, kept_n_m + feedback.stiffness_n_m_rad() * turn_rad)
            }
        };
        let pieces = pieces(&samples, play.interpolation);
        Ok(Drive::Torque(
            Driving { samples, pieces, hold, repeats: false, turning: None },
            reaction,
        ))
    };
    play.torques.iter().enumerate().map(drive).collect()
}

/// Frequency in rad/s up to which torques and references drive the arm. What holds it at the ends has no part in that: the
/// samples count from the first one, and there and back.
fn band_rad_s(play: &ArmPlay<'_>, grid: &TimeGrid) -> f64 {
    let twice = TimeGrid { len: 2 * grid.len, ..*grid };
    let moving = |samples: &[f64]| {
        let there_and_back = samples.iter().chain(samples.iter().rev());
        let moving: Vec<f64> = there_and_back.map(|own| own - samples[0]).collect();
        torque_band_rad_s(&twice, &moving)
    };
    let torques = play.torques.iter().filter_map(|torque| moving(torque.torque_n_m()));
    let wanted = play.feedback.iter().filter_map(|own| moving(&own.rate_rad_s(false)));
    torques.chain(wanted).fold(0.0, f64::max)
}

fn warnings(arm: &Arm, play: &ArmPlay<'_>, found: &PlayedArm) -> Vec<ArmPlayWarning> {
    let ranges = play.torques.iter().map(|torque| {
        let [low, high] = extremes(torque.torque_n_m());
        high - low
    });
    let range = ranges.fold(0.0, f64::max);
    let most = found.holding_n_m.iter().fold(range, |most, own| most.max(own.abs()));
    let size = if range > 0.0 { range } else { most };
    let starts_at_rest = !matches!(play.start, ArmStart::State(_));
    let mut warnings = Vec::new();
    for (number, torque) in play.torques.iter().enumerate() {
        let (own, joint) = (torque.torque_n_m(), number + 1);
        let (torque_n_m, holding_n_m) = (own[0], found.holding_n_m[number]);
        let share = (torque_n_m - holding_n_m).abs() / size;
        if starts_at_rest && share > STEP_SHARE {
            let begins = ArmPlayWarning::BeginsUnheld { joint, torque_n_m, holding_n_m, share };
            warnings.push(begins);
        }
        let torque_n_m = own[own.len() - 1];
        let share = torque_n_m.abs() / size;
        if !arm.has_weight() && share > STEP_SHARE {
            warnings.push(ArmPlayWarning::EndsWithJump { joint, torque_n_m, share });
        }
        let (joint_rad, feedback) = (found.joints[number][0][0], play.feedback.get(number));
        let reference_rad = feedback.map(|own| own.reference().angle_rad()[0]);
        let apart = reference_rad.filter(|own| (own - joint_rad).abs() > APART_RAD);
        if let Some(reference_rad) = apart.filter(|_| starts_at_rest) {
            warnings.push(ArmPlayWarning::ReferenceApart { joint, reference_rad, joint_rad });
        }
    }
    let [tip_m, joint_rad] = found.change;
    if found.is_unsettled {
        warnings.push(ArmPlayWarning::Unsettled { tip_m, joint_rad });
    }
    let share = found.imbalance();
    if share > IMBALANCE {
        warnings.push(ArmPlayWarning::Imbalance { share });
    }
    warnings
}
