//! The shortest motion within limits.

use thiserror::Error;

use super::limits::{Limits, Reached, reached};
use crate::beam::MeshPlan;
use crate::inverse::{Analysis, InversionError, Resources, Solution, invert_motion};
use crate::link::Arm;
use crate::motion::{
    ArmPath, Course, Curve, CurveError, Ends, FEWEST_STEPS, Law, Motion, MotionError, PathError,
    TipMotion,
};
use crate::text::{plain, significant};

/// Most steps of a motion.
const MOST_STEPS: usize = 1 << 18;

/// Most steps of a path. An arm that exceeds its limits in such a slow motion does so by its weight.
const MOST_STEPS_OF_PATH: usize = 1 << 14;

/// Most tried numbers of steps. The search tries every number up to this many steps.
const TRIALS: usize = 1024;

/// Number of coarser meshes, each of half the elements, that may refuse far too fast trials of an automatic mesh.
const HALVINGS: u32 = 3;

/// Ratio of holding torque to `limits.torque` above which the search stops. It exceeds 1 because a sagging link needs
/// less torque than a rigid one.
const HEAVY: f64 = 1.3;

/// Largest relative error of a value that the search compares with its limit.
const TELLING: f64 = 0.25;

/// A motion with an open duration.
#[derive(Debug, Clone, Copy)]
pub struct OpenMotion<'a> {
    /// Its profile, shaped.
    pub law: &'a Law,
    /// Where the tip goes.
    pub along: Along<'a>,
    /// Its step in s.
    pub step_s: f64,
    /// The durations that count, in steps of the profile, ascending; `None`: all.
    pub durations: Option<&'a [usize]>,
}

/// Where a tip goes.
#[derive(Debug, Clone, Copy)]
pub enum Along<'a> {
    /// The tip of one link along its arc.
    Arc(&'a Course),
    /// The tip of an arm along a curve, with the constant directions in rad of its links from the third on.
    Curve(&'a Curve, &'a [f64]),
}

impl Along<'_> {
    /// The ends of the motion.
    pub fn ends(self) -> Ends {
        match self {
            Self::Arc(course) => course.ends(),
            Self::Curve(..) => Ends::AtRest,
        }
    }
}

/// Reason of a failed search for a duration.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// Even slow motions exceed the limits.
    #[error(
        "no duration from {} to {} s keeps the limits ({tried} tried{})",
        plain(*shortest_s),
        plain(*longest_s),
        unsolved(failed.as_ref())
    )]
    TooSlow {
        /// Number of tried durations.
        tried: usize,
        /// The shortest in s.
        shortest_s: f64,
        /// The longest in s.
        longest_s: f64,
        /// Number of unsolved durations, with the error of the longest.
        failed: Option<(usize, Box<FitError>)>,
    },
    /// The motion is invalid.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A weight whose holding torque exceeds the limit.
    #[error(
        "limits.torque = {} N m, but must be at least {} N m, the torque that holds a rigid link against its weight",
        significant(*limit_n_m, 4),
        significant(*held_n_m, 4)
    )]
    TooHeavy {
        /// The limit in N m.
        limit_n_m: f64,
        /// Torque in N m that holds the rigid link at its start or one of its stops.
        held_n_m: f64,
    },
    /// A joint of an arm whose holding torque exceeds its limit.
    #[error(
        "joint {}: limits.torque = {} N m, but must be at least {} N m, the torque that holds the arm at an end of \
         its path",
        joint + 1,
        significant(*limit_n_m, 4),
        significant(*held_n_m, 4)
    )]
    TooHeavyArm {
        /// Number of the joint, from 0.
        joint: usize,
        /// The limit in N m.
        limit_n_m: f64,
        /// Torque in N m that holds the arm.
        held_n_m: f64,
    },
    /// No path has this many steps.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// The arm cannot take the path.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The motion has no torques.
    #[error(transparent)]
    Inversion(#[from] InversionError),
}

fn unsolved(failed: Option<&(usize, Box<FitError>)>) -> String {
    failed.map_or(String::new(), |(count, why)| {
        format!(", {count} of them without a solution, the longest because {why}")
    })
}

/// The shortest motion within the limits.
#[derive(Clone)]
pub struct Fit {
    /// Steps of the motion.
    pub steps: usize,
    /// Its solution.
    pub solution: Solution,
    /// The limit closest to its value; absent without limits.
    pub binding: Option<Reached>,
    /// Error of the motion that is one step shorter; absent if this motion exceeds a limit.
    pub unsolved: Option<Box<FitError>>,
    /// Number of tried motions with fewer steps; every one exceeds a limit or fails.
    pub shorter_tried: usize,
}

impl Fit {
    /// The motion of this many steps, if its values keep their limits.
    fn within(steps: usize, solution: Solution, reached: Vec<Reached>) -> Option<Self> {
        let binding = reached.into_iter().max_by(|a, b| a.share().total_cmp(&b.share()));
        // A value with a larger error is not known to be within any limit.
        let fits = |reached: Reached| reached.share() <= 1.0 && reached.error <= TELLING;
        let fit = || Self { steps, solution, binding, unsolved: None, shorter_tried: 0 };
        binding.is_none_or(fits).then(fit)
    }

    /// True if every motion of fewer steps was tried.
    pub fn is_shortest(&self) -> bool {
        self.shorter_tried == self.shorter()
    }

    /// True if no profile has fewer steps.
    pub fn has_fewest_steps(&self) -> bool {
        self.shorter() == 0
    }

    /// Number of motions with fewer steps.
    pub fn shorter(&self) -> usize {
        self.steps.saturating_sub(FEWEST_STEPS)
    }
}

/// A motion of open duration, with the link or the arm and the limits.
#[derive(Debug, Clone, Copy)]
pub struct FitProblem<'a> {
    /// The arm; one link is an arm of one.
    pub arm: &'a Arm,
    /// Mesh plan of each link.
    pub plans: &'a [MeshPlan],
    /// Required accuracy of the answers.
    pub analysis: &'a Analysis,
    /// Memory in bytes that each trial may take; `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// Largest values that each joint, its link and its motor may reach.
    pub limits: &'a [Limits],
    /// The motion.
    pub motion: OpenMotion<'a>,
}

/// The solution of a motion of this many steps of its profile, without regard to limits.
///
/// # Errors
/// [`FitError`].
pub fn solved(problem: &FitProblem, steps: usize) -> Result<Solution, FitError> {
    Ok(problem.inverted(problem.plans, &problem.motion_of(steps)?, false)?)
}

/// The fewest steps of a motion within limits: the answer to how fast a link may move its tip.
///
/// The torque does not simply fall as the duration grows: it jumps with the number of steps, and rises again where
/// the link resonates. So one duration says nothing about another. The search doubles the duration until one fits;
/// then it tries all shorter ones upward. Of more than a thousand it tries a thousand, evenly among the doublings,
/// and then all between the first fit and the duration before it. A motion fits if every value with its measured
/// error is within its limit, and the error of the value nearest to its limit is below a quarter. A motion that
/// cannot be solved does not fit.
///
/// # Errors
/// [`FitError`] where no duration fits.
pub fn shortest_fit(problem: &FitProblem) -> Result<Fit, FitError> {
    problem.check_weight()?;
    let fit = problem.shortest()?;
    match problem.motion_of(fit.steps)? {
        // A trial omits the parts for warnings alone.
        motion @ Motion::Tip(_) => {
            Ok(Fit { solution: problem.inverted(problem.plans, &motion, false)?, ..fit })
        }
        Motion::Path(_) => Ok(fit),
    }
}

impl FitProblem<'_> {
    fn most_steps(&self) -> usize {
        match self.motion.along {
            Along::Arc(_) => MOST_STEPS,
            Along::Curve(..) => MOST_STEPS_OF_PATH,
        }
    }

    /// The fewest steps within the limits, see [`shortest_fit`].
    fn shortest(&self) -> Result<Fit, FitError> {
        if let Some(durations) = self.motion.durations {
            return self.first_of(durations.iter().copied()).map(|(_, fit)| fit);
        }
        let (mut refused, upper) = self.doubled()?;
        let mut last = FEWEST_STEPS - 1;
        let mut found = upper;
        for steps in grid(found.steps) {
            if let Some(fit) = self.tried_once(steps, &mut refused) {
                found = fit;
                break;
            }
            last = steps;
        }
        let between = last + 1..found.steps;
        let earlier = { between }.find_map(|steps| self.tried_once(steps, &mut refused));
        let fit = earlier.unwrap_or(found);
        let shorter_tried = refused.iter().filter(|steps| **steps < fit.steps).count();
        let before = fit.steps - 1;
        let unsolved = refused.contains(&before).then(|| self.tried(before).err()).flatten();
        Ok(Fit { shorter_tried, unsolved: unsolved.map(Box::new), ..fit })
    }

    /// The first of doubled durations that fits, and the shorter ones.
    fn doubled(&self) -> Result<(Vec<usize>, Fit), FitError> {
        let doubled = std::iter::successors(Some(FEWEST_STEPS), |steps| Some(2 * steps));
        self.first_of(doubled.take_while(|steps| *steps <= self.most_steps()))
    }

    /// The first of these durations that fits, and those before it.
    fn first_of(
        &self,
        durations: impl Iterator<Item = usize>,
    ) -> Result<(Vec<usize>, Fit), FitError> {
        let (mut refused, mut failed) = (Vec::new(), None);
        for steps in durations {
            match self.tried(steps) {
                Ok(Some(fit)) => return Ok((refused, fit)),
                Ok(None) => {}
                Err(error @ FitError::TooHeavyArm { .. }) => return Err(error),
                Err(error) => {
                    let count = failed.map_or(0, |(count, _)| count);
                    failed = Some((count + 1, Box::new(error)));
                }
            }
            refused.push(steps);
        }
        let tried = refused.len();
        match failed {
            Some((count, error)) if count == tried => Err(*error),
            failed => {
                let step_s = self.motion.step_s;
                let [shortest_s, longest_s] = [refused.first(), refused.last()]
                    .map(|steps| rounded(steps.copied().unwrap_or_default() as f64 * step_s));
                Err(FitError::TooSlow { tried, shortest_s, longest_s, failed })
            }
        }
    }

    /// Tries a number of steps, unless it was refused before; adds it to `refused` if it does not fit.
    fn tried_once(&self, steps: usize, refused: &mut Vec<usize>) -> Option<Fit> {
        if refused.contains(&steps) {
            return None;
        }
        let fit = self.tried(steps).ok().flatten();
        if fit.is_none() {
            refused.push(steps);
        }
        fit
    }

    /// The motion of this many steps with its torques. `None` if it exceeds a limit.
    fn tried(&self, steps: usize) -> Result<Option<Fit>, FitError> {
        let motion = self.motion_of(steps)?;
        if self.exceeds_on_a_coarse_mesh(&motion) {
            return Ok(None);
        }
        let solution = self.inverted(self.plans, &motion, true)?;
        self.refuse_heavy(&solution)?;
        let reached = reached(&solution, self.limits);
        Ok(Fit::within(steps, solution, reached))
    }

    /// Refuses a limit far below the holding torque of a link before or after the motion: no duration keeps it.
    fn check_weight(&self) -> Result<(), FitError> {
        let (Along::Arc(course), [own], [limits]) =
            (self.motion.along, self.arm.links(), self.limits)
        else {
            return Ok(());
        };
        let link = &own.link;
        let start_rad = link.gravity().and_then(|own| own.start_angle_rad);
        let Some((start_rad, limit_n_m)) = start_rad.zip(limits.of("torque")) else {
            return Ok(());
        };
        let held_n_m = |stop_m: &f64| {
            let turned_rad = stop_m / link.length_m();
            let turned_rad = if link.joint().slides() { 0.0 } else { turned_rad };
            link.holding_effort(start_rad + turned_rad).abs()
        };
        let held_n_m = [0.0].iter().chain(course.stops_m()).map(held_n_m).fold(0.0, f64::max);
        if held_n_m > HEAVY * limit_n_m {
            return Err(FitError::TooHeavy { limit_n_m, held_n_m });
        }
        Ok(())
    }

    /// Refuses a limit below the holding torque of an arm at the ends of its path.
    fn refuse_heavy(&self, solution: &Solution) -> Result<(), FitError> {
        if let Along::Arc(_) = self.motion.along {
            return Ok(());
        }
        for (joint, (own, limits)) in solution.joints.iter().zip(self.limits).enumerate() {
            let ends = own.torque_n_m.first().into_iter().chain(own.torque_n_m.last());
            let held_n_m = ends.fold(0.0, |most: f64, torque| most.max(torque.abs()));
            if let Some(limit_n_m) = limits.of("torque").filter(|limit| held_n_m > *limit) {
                return Err(FitError::TooHeavyArm { joint, limit_n_m, held_n_m });
            }
        }
        Ok(())
    }

    /// True if a value of a link with an automatic mesh exceeds its limit by more than four times its error on a
    /// coarser mesh. Then the trial does not need the plan's mesh.
    fn exceeds_on_a_coarse_mesh(&self, motion: &Motion) -> bool {
        let exceeds = |Reached { value, error }: &Reached| {
            *error <= TELLING && value.found > value.limit * (1.0 + 4.0 * error)
        };
        let [plan] = self.plans else { return false };
        plan.is_automatic()
            && (0..HALVINGS).any(|halvings| {
                let solution = self.inverted(&[plan.halved(halvings)], motion, true);
                solution.is_ok_and(|solution| reached(&solution, self.limits).iter().any(exceeds))
            })
    }

    fn motion_of(&self, steps: usize) -> Result<Motion, FitError> {
        let OpenMotion { law, along, step_s, .. } = self.motion;
        Ok(match along {
            Along::Arc(course) => {
                let columns = course.sampled(law, step_s, steps, [0, 0])?;
                Motion::Tip(TipMotion::with_ends(columns, course.ends())?)
            }
            Along::Curve(curve, outer_rad) => {
                let columns = curve.columns(law, (step_s, steps), [0, 0], outer_rad)?;
                Motion::Path(ArmPath::new(columns, &self.arm.lengths_m())?)
            }
        })
    }

    fn inverted(
        &self,
        plans: &[MeshPlan],
        motion: &Motion,
        is_trial: bool,
    ) -> Result<Solution, InversionError> {
        let memory_bytes = self.memory_bytes;
        let resources = Resources { memory_bytes, is_trial, ..Resources::default() };
        invert_motion(self.arm, plans, motion, self.analysis, &resources)
    }
}

/// A time in s without the last digits of a product.
fn rounded(time_s: f64) -> f64 {
    format!("{time_s:.14e}").parse().unwrap_or(time_s)
}

/// Steps to try below `end`, a power of two, upward: all, or at most [`TRIALS`], evenly among the doublings.
fn grid(end: usize) -> impl Iterator<Item = usize> {
    let doublings = (end / FEWEST_STEPS).ilog2() as usize;
    let next = move |steps: &usize| {
        let doubled_from = 1 << steps.ilog2();
        let stride = if end <= TRIALS { 1 } else { doubled_from * doublings / TRIALS };
        Some(steps + stride.max(1)).filter(|next| *next < end)
    };
    std::iter::successors(Some(FEWEST_STEPS).filter(|first| *first < end), next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_to_a_thousand_steps_are_all_tried_and_of_more_as_many_in_each_doubling() {
        assert_eq!(grid(4).count(), 0);
        assert!(grid(1024).eq(4..1024));
        for end in [2048, 1 << 14, MOST_STEPS] {
            let tried: Vec<usize> = grid(end).collect();
            assert!(tried.len() <= TRIALS && tried.len() > TRIALS / 3, "{end}: {}", tried.len());
            assert!(tried.windows(2).all(|pair| pair[0] < pair[1]));
            let last = tried[tried.len() - 1];
            assert!(last < end && end - last <= end / 50, "{end}: {last}");
        }
    }
}
