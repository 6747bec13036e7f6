//! An arm and its path: the arm's reach, periods of any length, and the motion over one.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use super::answer::{ArmAnswer, PathPeriod};
use crate::elastica::{
    AngleHistories, ArmMotion, ArmPeriod, Kept, STRETCHED, SecondOrder, follow_arm, follow_arm_at,
    reaching, returning,
};
use crate::inverse::period::{Padding, check_memory};
use crate::inverse::rest::{Rest, Return, left_to_return};
use crate::inverse::{Analysis, InversionError, Resources, Warning};
use crate::link::{Arm, Elbow};
use crate::model::Model;
use crate::motion::{ArmPath, CourseHistories, Cutoff, Prescribed};

/// Sine of the elbow's angle that causes a warning below it.
const NEARLY_STRETCHED: f64 = 0.15;

/// Memory in bytes for each node and sample of the period, as measured of one link.
const BYTES: usize = 300;

/// Largest difference in rad between prescribed directions and directions from the tip's place.
const AGREEMENT: f64 = 1e-3;

/// Share of the iteration's error. Where a warning reports that error, refinement of mesh and period stops once their
/// errors are below this share.
const SMALL: f64 = 0.1;

/// Samples of an arm at rest.
const AT_REST: usize = 8;

pub(super) type Models = [Arc<dyn Model>];

/// An arm, its path, and the required accuracy.
pub(super) struct ArmProblem<'a> {
    pub(super) arm: &'a Arm,
    pub(super) path: &'a ArmPath,
    pub(super) analysis: &'a Analysis,
    pub(super) second_order: SecondOrder,
    pub(super) cutoffs: Vec<Cutoff>,
    pub(super) padding: Padding,
    returns: Return,
    resources: Resources<'a>,
    is_left: bool,
    pub(super) nearly_stretched: Option<Warning>,
}

impl<'a> ArmProblem<'a> {
    /// # Errors
    /// [`InversionError`] if the arm cannot follow the path.
    pub(super) fn of(
        arm: &'a Arm,
        path: &'a ArmPath,
        (analysis, resources): (&'a Analysis, Resources<'a>),
        first_zero_per_s: Option<f64>,
    ) -> Result<Self, InversionError> {
        let nearly_stretched = check_reach(arm, path)?;
        let grid = path.grid();
        let problem = Self {
            arm,
            path,
            analysis,
            second_order: analysis.second_order().unwrap_or(SecondOrder::Full),
            cutoffs: path.cutoffs(analysis.tip_tolerance()),
            padding: Padding::around(path.moving_samples(), grid, analysis, first_zero_per_s),
            returns: Return::of(arm.links().len(), first_zero_per_s, &grid),
            resources,
            is_left: arm.elbow() != Some(Elbow::Right),
            nearly_stretched,
        };
        problem.refuse_beside()?;
        Ok(problem)
    }

    pub(super) fn resources(&self) -> Resources<'a> {
        self.resources
    }

    /// Refuses directions that contradict the tip's places.
    fn refuse_beside(&self) -> Result<(), InversionError> {
        if self.path.beside().is_empty() {
            return Ok(());
        }
        let at_rest = |given: Vec<f64>| {
            let none = vec![0.0; given.len()];
            [given, none.clone(), none]
        };
        let courses: Vec<_> = self.path.given().into_iter().map(at_rest).collect();
        let chords = self.chords(&courses, 0)?;
        for (link, angles) in self.path.beside() {
            let pairs = angles.iter().zip(&chords[*link][0]);
            let off =
                |(found, expected): (&f64, &f64)| libm::remainder(found - expected, TAU).abs();
            if let Some(sample) = pairs.clone().position(|pair| off(pair) > AGREEMENT) {
                let (found, expected) = (angles[sample], chords[*link][0][sample]);
                return Err(InversionError::Disagree { sample, link: *link, found, expected });
            }
        }
        Ok(())
    }

    /// Directions of the rigid arm's links at these coordinates of the path. They begin with sample `seam`, and
    /// continue over whole turns from there.
    fn chords(
        &self,
        courses: &[CourseHistories],
        seam: usize,
    ) -> Result<Vec<AngleHistories>, InversionError> {
        if self.path.prescribed() == Prescribed::Angles {
            return Ok(courses.to_vec());
        }
        let len = courses[0][0].len();
        let rotated = |course: &CourseHistories, by: usize| -> CourseHistories {
            course.each_ref().map(|part| {
                let mut part = part.clone();
                part.rotate_left(by);
                part
            })
        };
        let in_time: Vec<_> = courses.iter().map(|course| rotated(course, seam % len)).collect();
        let [x, y] = [&in_time[0], &in_time[1]];
        let tip: Vec<[[f64; 2]; 3]> =
            (0..len).map(|k| [0, 1, 2].map(|part: usize| [x[part][k], y[part][k]])).collect();
        let mut chords = reaching(&tip, &self.arm.lengths_m(), &in_time[2..], self.is_left)?;
        if let [first, second, third, ..] = &mut chords[..] {
            // The whole turns of the prescribed links count.
            let turns = ((third[0][0] - second[0][0]) / TAU).round();
            for angle in first[0].iter_mut().chain(&mut second[0]) {
                *angle += TAU * turns;
            }
        }
        Ok(chords.iter().map(|chord| rotated(chord, len - seam % len)).collect())
    }

    fn kept(&self) -> Kept {
        match self.path.prescribed() {
            Prescribed::Tip => Kept::Tip,
            Prescribed::Angles => Kept::Angles,
        }
    }

    /// Samples of the shortest period.
    pub(super) fn shortest_len(&self) -> Result<usize, InversionError> {
        self.returns.shortest_len(self.padding, self.path.grid().len)
    }

    /// The path over a period of `len` samples.
    pub(super) fn period(&self, len: usize) -> Result<Arc<PathPeriod>, InversionError> {
        self.straying(len, None)
    }

    /// The path over a period; with `stray` it has possible errors of its samples, different for each number.
    pub(super) fn straying(
        &self,
        len: usize,
        stray: Option<u64>,
    ) -> Result<Arc<PathPeriod>, InversionError> {
        check_memory(len, 0, self.resources.memory_bytes)?;
        let (given, step_s) = (self.path.grid().len, self.path.grid().step_s);
        let seam = self.padding.seam(given, len);
        let found = self.path.over_period((len, seam), &self.cutoffs, stray);
        let rigid = self.chords(&found.courses, seam)?;
        let returning = self.returns.samples(self.padding, given, len);
        let returned = self.returned(rigid.clone(), &returning, seam);
        let arm = ArmPeriod::new(step_s, returned, self.kept(), self.arm.gravity_m_s2())?;
        // A path that has passed its checks moves at least one coordinate.
        let tip = found.period.ok_or(InversionError::OutOfRange { peak_n_m: 0.0 })?;
        let rests = [returning.end, returning.start - 1];
        let rest = Rest::of(&tip.spectrum, found.seam_reach, returning);
        Ok(Arc::new(PathPeriod { arm, rest, rests, rigid, tip, errors_m: found.errors_m }))
    }

    /// Refuses answers on all these meshes at once if they exceed the memory limit.
    pub(super) fn refuse_memory(
        &self,
        models: &[&Models],
        path: &PathPeriod,
    ) -> Result<(), InversionError> {
        let nodes = models.iter().copied().flatten().map(|model| model.mesh().nodes_m().len());
        let bytes = path.len().saturating_mul(nodes.sum()).saturating_mul(BYTES);
        match self.resources.memory_bytes.filter(|most| bytes > *most) {
            Some(allowed) => Err(InversionError::TooMuchMemory { bytes, allowed }),
            None => Ok(()),
        }
    }

    /// Sufficient error of mesh and period, whatever their tolerances: a share of the iteration's error if that exceeds
    /// the tolerance, else 0.
    pub(super) fn small(&self, answer: &ArmAnswer) -> f64 {
        let open = answer.motion.iteration.error;
        if open > self.analysis.tolerance() { SMALL * open } else { 0.0 }
    }

    /// The motion on meshes; with `nodes`, only at these nodes of each link.
    pub(super) fn answer(
        &self,
        models: &Models,
        path: &Arc<PathPeriod>,
        nodes: Option<&[Vec<usize>]>,
    ) -> Result<ArmAnswer, InversionError> {
        self.refuse_memory(&[models], path)?;
        let how = (self.second_order, self.analysis.iterated_to());
        let motion = follow_arm_at(models, &path.arm, how, nodes)?;
        Ok(ArmAnswer { motion, path: Arc::clone(path) })
    }

    /// Chords with a return around the seam; whole turns need no return. The first two chords return over the same
    /// turns, so that the elbow stays on its side.
    ///
    /// After a cut-off the motion rings on at rest. The tip's place determines the angles of this ringing, so that it
    /// fades out and in again while the chords return.
    fn returned(
        &self,
        mut chords: Vec<AngleHistories>,
        samples: &Range<usize>,
        seam: usize,
    ) -> Vec<AngleHistories> {
        let half = samples.len() / 2;
        let fades = returning(1.0, 0.0, half);
        let back = returning(0.0, 1.0, samples.len() - half);
        let fading: Vec<f64> = fades.into_iter().chain(back).collect();
        let mut turns = 0.0;
        for (link, [angle, rate, acceleration]) in chords.iter_mut().enumerate() {
            let rests = [angle[samples.start - 1], angle[samples.end]];
            let travel = rests[0] - rests[1];
            if link != 1 || self.kept() == Kept::Angles {
                turns = (travel / TAU).round();
            }
            let left = left_to_return(travel - TAU * turns, samples, seam);
            for ((k, left), share) in left.zip(&fading) {
                let rest = if k < seam { rests[0] } else { rests[1] };
                angle[k] = rest + left + share * (angle[k] - rest);
                rate[k] *= share;
                acceleration[k] *= share;
            }
        }
        chords
    }

    /// The arm at rest with its chords before and after the motion.
    pub(super) fn at_rest(
        &self,
        models: &Models,
        path: &PathPeriod,
    ) -> Result<[ArmMotion; 2], InversionError> {
        let pose = |sample: usize| -> Result<ArmMotion, InversionError> {
            let held = |chord: &AngleHistories| {
                [vec![chord[0][sample]; AT_REST], vec![0.0; AT_REST], vec![0.0; AT_REST]]
            };
            let chords = path.rigid.iter().map(held).collect();
            let period = ArmPeriod::new(1.0, chords, self.kept(), self.arm.gravity_m_s2())?;
            Ok(follow_arm(models, &period, self.second_order, self.analysis.iterated_to())?)
        };
        Ok([pose(path.rests[0])?, pose(path.rests[1])?])
    }

    /// The same problem with other cut-offs or terms.
    pub(super) fn with(&self, second_order: SecondOrder, cutoffs: Vec<Cutoff>) -> Self {
        Self { second_order, cutoffs, ..*self }
    }
}

/// Refuses a path beyond the arm's reach, or within reach only stretched or folded, as [`invert_motion`] does; returns the
/// warning of a nearly stretched or folded elbow. Accepts every path of directions.
///
/// [`invert_motion`]: super::invert_motion
///
/// # Errors
/// [`InversionError`] with the sample.
pub fn check_reach(arm: &Arm, path: &ArmPath) -> Result<Option<Warning>, InversionError> {
    if path.prescribed() == Prescribed::Angles {
        return Ok(None);
    }
    if arm.elbow().is_none() {
        return Err(InversionError::NoElbow);
    }
    let lengths_m = arm.lengths_m();
    let [l1, l2] = [lengths_m[0], lengths_m[1]];
    let (least_m, most_m) = ((l1 - l2).abs(), l1 + l2);
    let mut least = (0, 1.0);
    for (sample, (distance_m, cosine)) in elbows(path, &lengths_m).enumerate() {
        if !(-1.0..=1.0).contains(&cosine) {
            return Err(InversionError::OutOfReach { sample, distance_m, least_m, most_m });
        }
        let sine = (1.0 - cosine * cosine).sqrt();
        if sine < STRETCHED {
            return Err(InversionError::Stretched { sample, sine, least: STRETCHED });
        }
        if sine < least.1 {
            least = (sample, sine);
        }
    }
    let (sample, sine) = least;
    let time_s = path.grid().time_s(sample);
    Ok((sine < NEARLY_STRETCHED).then_some(Warning::NearlyStretched { sine, time_s }))
}

/// Distance in m of the second link's end from the first joint, and cosine of the elbow's angle, at each sample.
fn elbows(path: &ArmPath, lengths_m: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    let given = path.given();
    (0..path.grid().len).map(move |k| {
        let outer = given[2..].iter().zip(&lengths_m[2..]);
        let [x, y] = outer.fold([given[0][k], given[1][k]], |[x, y], (angle, length_m)| {
            [x - length_m * libm::cos(angle[k]), y - length_m * libm::sin(angle[k])]
        });
        let [l1, l2] = [lengths_m[0], lengths_m[1]];
        let squared = x * x + y * y;
        (squared.sqrt(), (squared - l1 * l1 - l2 * l2) / (2.0 * l1 * l2))
    })
}
