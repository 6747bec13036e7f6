//! An arm of one link or several and its wanted motion: the arm's reach, periods of any length, and the motion over one.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::answer::{ArmAnswer, Carried, Models, PathPeriod};
use crate::elastica::{
    AngleHistories, ArmMotion, ArmPeriod, Kept, STRETCHED, SecondOrder, estimate, follow_arm,
    follow_arm_at, reaching, returning,
};
use crate::inverse::accuracy::Curves;
use crate::inverse::period::{Padding, Rest, Return, check_memory, left_to_return};
use crate::inverse::problem::LinkProblem;
use crate::inverse::{Analysis, InversionError, Resources, Stage, Unwatched, Warning};
use crate::link::{Arm, Elbow};
use crate::model::Model;
use crate::motion::{
    ArmPath, CourseHistories, Cutoff, Motion, MotionError, Prescribed, TipPeriod, Uncertainty,
};
use crate::numeric::TimeGrid;

/// Sine of the elbow's angle that causes a warning below it.
const NEARLY_STRETCHED: f64 = 0.15;

/// Memory in bytes for each node and sample of the period, as measured of one link.
pub(in super::super) const BYTES: usize = 300;

/// Largest difference in rad between prescribed directions and directions from the tip's place.
const AGREEMENT: f64 = 1e-3;

/// Standard deviations of noise that directions may differ by, too.
const DEVIATIONS: f64 = 6.0;

/// Share of the iteration's error. Where a warning reports that error, refinement of mesh and period stops once their
/// errors are below this share.
const SMALL: f64 = 0.1;

/// Samples of an arm at rest.
const AT_REST: usize = 8;

/// The wanted motion.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a> {
    /// Tip of one link along its arc.
    Tip(&'a LinkProblem<'a>),
    /// Path of several links.
    Path(&'a ArmPath),
}

impl<'a> Wanted<'a> {
    /// Path of several links.
    pub(super) fn path(self) -> Option<&'a ArmPath> {
        match self {
            Self::Tip(_) => None,
            Self::Path(path) => Some(path),
        }
    }

    /// Grid of its samples.
    pub(super) fn grid(self) -> TimeGrid {
        match self {
            Self::Tip(problem) => problem.motion.grid(),
            Self::Path(path) => path.grid(),
        }
    }

    /// The motion sampled twice as often.
    pub(super) fn twice_as_often(self) -> Result<Motion, MotionError> {
        match self {
            Self::Tip(problem) => problem.motion.twice_as_often().map(Motion::Tip),
            Self::Path(path) => path.twice_as_often().map(Motion::Path),
        }
    }
}

/// An arm, its wanted motion, and the required accuracy.
pub(in super::super) struct ArmProblem<'a> {
    pub(super) arm: &'a Arm,
    pub(super) wanted: Wanted<'a>,
    /// Direction in rad of one link at zero displacement of its tip.
    start_angle_rad: f64,
    pub(super) analysis: &'a Analysis,
    pub(in super::super) second_order: SecondOrder,
    pub(super) cutoffs: Vec<Cutoff>,
    pub(super) padding: Padding,
    returns: Return,
    pub(super) resources: Resources<'a>,
    is_left: bool,
    pub(super) nearly_stretched: Option<Warning>,
}

impl<'a> ArmProblem<'a> {
    /// The problem of several links.
    ///
    /// # Errors
    /// [`InversionError`] if the arm cannot follow the path.
    pub(super) fn of(
        arm: &'a Arm,
        path: &'a ArmPath,
        (analysis, resources): (&'a Analysis, Resources<'a>),
        first_zero_per_s: Option<f64>,
    ) -> Result<Self, InversionError> {
        analysis.refuse_ends(path.ends(), (true, false))?;
        let nearly_stretched = check_reach(arm, path)?;
        let (grid, links) = (path.grid(), arm.links().len());
        let moving = (path.cycles(), path.moving_samples());
        let problem = Self {
            arm,
            wanted: Wanted::Path(path),
            start_angle_rad: 0.0,
            analysis,
            second_order: analysis.second_order().unwrap_or(SecondOrder::Full),
            cutoffs: path.cutoffs(analysis.tip_tolerance()),
            padding: Padding::around(moving, grid, analysis, first_zero_per_s),
            returns: match path.cycles() {
                Some(_) => Return::NONE,
                None => Return::of(links, first_zero_per_s, &grid),
            },
            resources,
            is_left: arm.elbow() != Some(Elbow::Right),
            nearly_stretched,
        };
        problem.refuse_beside(path)?;
        Ok(problem)
    }

    /// The problem of one link with weight or second-order terms. Without weight, or on a carriage, its chord need not
    /// return.
    ///
    /// # Errors
    /// [`InversionError::NoStartAngle`].
    pub(in super::super) fn of_link(
        problem: &'a LinkProblem<'a>,
        arm: &'a Arm,
        first_zero_per_s: Option<f64>,
    ) -> Result<Self, InversionError> {
        let link = &arm.links()[0].link;
        let turns = link.has_weight() && !link.joint().slides();
        let returns = turns && problem.motion.cycles().is_none();
        Ok(Self {
            arm,
            wanted: Wanted::Tip(problem),
            start_angle_rad: problem.start_angle_rad(link)?,
            analysis: problem.analysis,
            second_order: problem.analysis.second_order_of(link),
            cutoffs: vec![problem.cutoff],
            padding: problem.padding,
            returns: if returns {
                Return::of(1, first_zero_per_s, &problem.motion.grid())
            } else {
                Return::NONE
            },
            resources: problem.resources,
            is_left: true,
            nearly_stretched: None,
        })
    }

    /// True for one link along its arc.
    pub(super) fn is_link(&self) -> bool {
        self.wanted.path().is_none()
    }

    /// Refuses directions that contradict the tip's places.
    fn refuse_beside(&self, path: &ArmPath) -> Result<(), InversionError> {
        if path.beside().is_empty() {
            return Ok(());
        }
        let at_rest = |given: Vec<f64>| {
            let none = vec![0.0; given.len()];
            [given, none.clone(), none]
        };
        let mut courses: Vec<_> = path.given().into_iter().map(at_rest).collect();
        take_carriage(self.arm, path, &mut courses);
        let chords = self.chords(&courses, 0)?;
        let noise_m = match path.recording().uncertainty {
            Some(Uncertainty::Noisy { deviation_m, .. }) => DEVIATIONS * deviation_m,
            _ => 0.0,
        };
        let shortest_m = self.arm.lengths_m()[..2].iter().copied().fold(f64::INFINITY, f64::min);
        let noise_rad = noise_m / shortest_m;
        for (link, angles) in path.beside() {
            let pairs = angles.iter().zip(&chords[*link][0]);
            let off =
                |(found, expected): (&f64, &f64)| libm::remainder(found - expected, TAU).abs();
            // Noise turns a direction, and that from the place the more, the straighter the elbow.
            let allowed = |sample: usize| {
                let elbow_rad = chords[1][0][sample] - chords[0][0][sample];
                AGREEMENT + noise_rad * (1.0 + libm::sin(elbow_rad).abs().recip())
            };
            let mut numbered = pairs.enumerate();
            if let Some((sample, _)) = numbered.find(|(sample, pair)| off(*pair) > allowed(*sample))
            {
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
        if self.kept() == Kept::Angles {
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

    /// True if the path moves a carriage.
    fn moves_carriage(&self) -> bool {
        self.wanted.path().is_some_and(ArmPath::has_carriage)
    }

    fn kept(&self) -> Kept {
        match self.wanted.path().map(ArmPath::prescribed) {
            Some(Prescribed::Tip) => Kept::Tip,
            _ => Kept::Angles,
        }
    }

    /// Samples of the shortest period.
    pub(in super::super) fn shortest_len(&self) -> Result<usize, InversionError> {
        self.returns.shortest_len(self.padding, self.wanted.grid().len)
    }

    /// The motion over a period of `len` samples.
    pub(in super::super) fn period(&self, len: usize) -> Result<Arc<PathPeriod>, InversionError> {
        match self.wanted {
            Wanted::Tip(problem) => self.along_arc(problem.period(len)?).map(Arc::new),
            Wanted::Path(path) => self.straying((path, len), None),
        }
    }

    /// The chord of one link over a period of its tip.
    fn along_arc(&self, tip: Arc<TipPeriod>) -> Result<PathPeriod, InversionError> {
        let (histories, spectrum) = (&tip.histories, &tip.spectrum);
        // A link that slides has displacements, and keeps its direction.
        let joint = self.arm.joint();
        let (length_m, start) = (self.arm.links()[0].link.rigid_tip(), self.start_angle_rad);
        let start = if joint.slides() { 0.0 } else { start };
        let angle = |m: f64| start + m / length_m;
        let per_length = |values: &[f64]| values.iter().map(|m| m / length_m).collect();
        let rigid = [
            histories.displacement_m.iter().map(|m| angle(*m)).collect(),
            per_length(&histories.velocity_m_s),
            per_length(&histories.acceleration_m_s2),
        ];
        // The tip rings around its places at rest.
        let ends_m = [0.0, spectrum.travel_m()].map(|travel_m| histories.start_m() + travel_m);
        let rests = vec![ends_m.map(angle)];
        let (seam_reach, errors_m) = (spectrum.seam_reach(), vec![tip.tip_error_m()]);
        self.returned((tip, vec![rigid], None), Some(rests), seam_reach, errors_m)
    }

    /// The path over a period; with `stray` it has possible errors of its samples, different for each number.
    pub(super) fn straying(
        &self,
        (path, len): (&ArmPath, usize),
        stray: Option<u64>,
    ) -> Result<Arc<PathPeriod>, InversionError> {
        check_memory(len, 0, self.resources.memory_bytes)?;
        let seam = self.padding.seam(path.grid().len, len);
        let mut sampled = path.over_period((len, seam), &self.cutoffs, stray);
        let carriage = take_carriage(self.arm, path, &mut sampled.courses);
        let rigid = self.chords(&sampled.courses, seam)?;
        // A path that has passed its checks moves at least one coordinate.
        let tip = sampled.period.ok_or(InversionError::OutOfRange { peak_n_m: 0.0 })?;
        let courses = (tip, rigid, carriage);
        self.returned(courses, None, sampled.seam_reach, sampled.errors_m).map(Arc::new)
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

    /// Reports the start of answers on these meshes, each of which advances by the bins of the period.
    pub(super) fn begin(&self, models: &[&Models], path: &PathPeriod) {
        let finest = models.last().copied().into_iter().flatten();
        let elements = finest.map(|model| model.mesh().elements().len()).sum();
        let stage = Stage::Solve { elements };
        self.resources.watch.begin(stage, models.len() * path.bins());
    }

    /// The motion on meshes, with progress; with `nodes`, only at these nodes of each link.
    pub(in super::super) fn answer(
        &self,
        models: &Models,
        path: &Arc<PathPeriod>,
        nodes: Option<&[Vec<usize>]>,
    ) -> Result<ArmAnswer, InversionError> {
        self.begin(&[models], path);
        self.answer_in_stage(models, path, nodes)
    }

    /// [`Self::answer`] in a stage that has [begun](Self::begin).
    pub(super) fn answer_in_stage(
        &self,
        models: &Models,
        path: &Arc<PathPeriod>,
        nodes: Option<&[Vec<usize>]>,
    ) -> Result<ArmAnswer, InversionError> {
        self.refuse_memory(&[models], path)?;
        let how = (self.second_order, self.analysis.iterated_to());
        let motion = follow_arm_at(models, &path.arm, how, nodes)?;
        self.resources.watch.advance(path.bins());
        Ok(ArmAnswer { models: models.to_vec(), motion, path: Arc::clone(path) })
    }

    /// Histories of one linear link over a period of its motion at some nodes, further histories, and the change by all
    /// second-order terms over the difference of both.
    ///
    /// # Errors
    /// [`InversionError`].
    pub(in super::super) fn estimated(
        &self,
        model: Arc<dyn Model>,
        period: &Arc<TipPeriod>,
        probes: &[Vec<usize>; 1],
    ) -> Result<([Curves; 2], f64), InversionError> {
        let path = Arc::new(self.along_arc(Arc::clone(period))?);
        let models = vec![model];
        let (both, share) = estimate(&models, &path.arm, probes)?;
        let curves = both.map(|motion| {
            let (models, path) = (models.clone(), Arc::clone(&path));
            ArmAnswer { models, motion, path }.curves(probes).remove(0)
        });
        Ok((curves, share))
    }

    /// Chords with a return around the seam; whole turns and cycles need no return. The first two chords return over the same
    /// turns, so that the elbow stays on its side.
    ///
    /// After a cut-off the motion rings on at rest. The place of an arm's tip determines the angles of this ringing, so
    /// that it fades out and in again while the chords return. One link rings on around its `rests`.
    fn returned(
        &self,
        (tip, rigid, mut carriage): (Arc<TipPeriod>, Vec<AngleHistories>, Option<CourseHistories>),
        rests: Option<Vec<[f64; 2]>>,
        seam_reach: usize,
        errors_m: Vec<f64>,
    ) -> Result<PathPeriod, InversionError> {
        let (len, seam) = (tip.spectrum.pair.len(), tip.spectrum.seam);
        let samples = self.returns.samples(self.padding, self.wanted.grid().len, len);
        let half = samples.len() / 2;
        let fades = returning(1.0, 0.0, half);
        let back = returning(0.0, 1.0, samples.len() - half);
        let is_fading = rests.is_none();
        let fading = fades.into_iter().chain(back).map(|share| if is_fading { share } else { 1.0 });
        let fading: Vec<f64> = fading.collect();
        let at_ends =
            |[angle, ..]: &AngleHistories| [angle[samples.end % len], angle[samples.start - 1]];
        let rests = rests.unwrap_or_else(|| rigid.iter().chain(&carriage).map(at_ends).collect());
        let (mut chords, mut turns) = (rigid.clone(), 0.0);
        for (link, [angle, rate, acceleration]) in chords.iter_mut().enumerate() {
            let [before, after] = rests[link];
            let travel = after - before;
            if link != 1 || self.kept() == Kept::Angles {
                turns = (travel / TAU).round();
            }
            let left = left_to_return(travel - TAU * turns, &samples, seam);
            for ((k, left), share) in left.zip(&fading) {
                let rest = if k < seam { after } else { before };
                angle[k] = rest + left + share * (angle[k] - rest);
                rate[k] *= share;
                acceleration[k] *= share;
            }
        }
        let (step_s, gravity_m_s2) = (tip.spectrum.step_s, self.arm.gravity_m_s2());
        let mut arm = self.sliding(ArmPeriod::new(step_s, chords, self.kept(), gravity_m_s2)?);
        if let Some([_, rate, acceleration]) = &mut carriage {
            for (k, share) in samples.clone().zip(&fading) {
                rate[k] *= share;
                acceleration[k] *= share;
            }
        }
        let carried = self.arm.carriage().copied().zip(carriage);
        let carried = carried.map(|(own, course)| Carried { own, gravity_m_s2, course });
        if let Some(carried) = carried.as_ref().filter(|_| self.moves_carriage()) {
            arm = arm.carried_by(carried.accelerations_m_s2());
        }
        let rest = Rest::of(&tip.spectrum, seam_reach, samples);
        Ok(PathPeriod { arm, rest, rests, rigid, carried, tip, errors_m })
    }

    /// The period, of a link that slides in its direction.
    fn sliding(&self, period: ArmPeriod) -> ArmPeriod {
        if self.arm.joint().slides() { period.sliding(self.start_angle_rad) } else { period }
    }

    /// The arm at rest with its chords before and after the motion.
    pub(super) fn at_rest(
        &self,
        models: &Models,
        path: &PathPeriod,
    ) -> Result<[ArmMotion; 2], InversionError> {
        let pose = |end: usize| -> Result<ArmMotion, InversionError> {
            let held = |rests: &[f64; 2]| {
                [vec![rests[end]; AT_REST], vec![0.0; AT_REST], vec![0.0; AT_REST]]
            };
            let chords = path.rests.iter().take(path.rigid.len()).map(held).collect();
            let period = ArmPeriod::new(1.0, chords, self.kept(), self.arm.gravity_m_s2())?;
            Ok(follow_arm(
                models,
                &self.sliding(period),
                self.second_order,
                self.analysis.iterated_to(),
            )?)
        };
        Ok([pose(0)?, pose(1)?])
    }

    /// The same problem with other cut-offs or terms, without progress.
    pub(in super::super) fn with(&self, second_order: SecondOrder, cutoffs: Vec<Cutoff>) -> Self {
        let resources = Resources { watch: &Unwatched, ..self.resources };
        Self { second_order, cutoffs, resources, ..*self }
    }
}

/// Refuses a path beyond the arm's reach, or within reach only stretched or folded, as [`invert_motion`] does; returns the
/// warning of a nearly stretched or folded elbow. Accepts every path of directions.
///
/// [`invert_motion`]: crate::inverse::invert_motion
///
/// # Errors
/// [`InversionError`] with the sample.
pub fn check_reach(arm: &Arm, path: &ArmPath) -> Result<Option<Warning>, InversionError> {
    if path.has_carriage() && arm.carriage().is_none() {
        return Err(InversionError::NoCarriage);
    }
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
    for (sample, (distance_m, cosine)) in elbows(arm, path, &lengths_m).enumerate() {
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

/// Takes the carriage out of the courses of a path, which become those of an arm with a fixed first axis. Without a
/// course the carriage stays at 0. `None` for an arm without a carriage.
fn take_carriage(
    arm: &Arm,
    path: &ArmPath,
    courses: &mut Vec<CourseHistories>,
) -> Option<CourseHistories> {
    let axis = arm.carriage()?.axis;
    if !path.has_carriage() {
        return courses.first().map(|course| course.each_ref().map(|own| vec![0.0; own.len()]));
    }
    let carriage = courses.pop()?;
    if path.prescribed() == Prescribed::Tip {
        for (place, part) in courses.iter_mut().zip(axis) {
            for (own, moved) in place.iter_mut().flatten().zip(carriage.iter().flatten()) {
                *own -= part * moved;
            }
        }
    }
    Some(carriage)
}

/// Distance in m of the second link's end from the first joint, and cosine of the elbow's angle, at each sample.
fn elbows(arm: &Arm, path: &ArmPath, lengths_m: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    let mut courses: Vec<CourseHistories> =
        path.given().into_iter().map(|own| [own, Vec::new(), Vec::new()]).collect();
    take_carriage(arm, path, &mut courses);
    let places: Vec<Vec<f64>> = courses.into_iter().map(|[own, ..]| own).collect();
    (0..path.grid().len).map(move |k| {
        let outer = places[2..].iter().zip(&lengths_m[2..]);
        let [x, y] = outer.fold([places[0][k], places[1][k]], |[x, y], (angle, length_m)| {
            [x - length_m * libm::cos(angle[k]), y - length_m * libm::sin(angle[k])]
        });
        let [l1, l2] = [lengths_m[0], lengths_m[1]];
        let squared = x * x + y * y;
        (squared.sqrt(), (squared - l1 * l1 - l2 * l2) / (2.0 * l1 * l2))
    })
}
