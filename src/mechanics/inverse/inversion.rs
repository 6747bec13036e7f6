//! The inversion: period, mesh, window, histories, errors and warnings, up to the solution.

use std::f64::consts::TAU;
use std::sync::Arc;

use num_complex::Complex64;

use super::accuracy::{PerQuantity, QuantityErrors};
use super::analysis::{Analysis, Resources};
use super::arm::{ArmProblem, Solver, diverged, invert_arm};
use super::diagnostics::{Diagnostics, Edge, thick_share};
use super::error::{BUCKLED, InversionError, RefusedEnds};
use super::histories::{Histories, SlowTails};
use super::mesh_error::MeshAnswer;
use super::period::Window;
use super::periodic_answer::PeriodicAnswer;
use super::problem::{AnsweringModel, LinkProblem};
use super::solution::{
    Band, JointMotion, LinkMotion, LinkSpectra, SecondOrderFindings, Shape, Solution,
};
use super::warning::{SolutionWarning, Warning};
use crate::beam::{Mesh, MeshPlan};
use crate::elastica::{ElasticaError, SecondOrder};
use crate::link::{Arm, Link};
use crate::modal::{buckling_share, real_frequency_zeros, torque_zeros};
use crate::model::{Model, check_size, model_of};
use crate::motion::{Ends, Motion, TipMotion, TipPeriod};
use crate::numeric::TimeGrid;

/// Largest distance from whole turns, in turns, of a cycle under gravity that ends in its first direction.
const WHOLE_TURNS: f64 = 1e-6;

/// Finds the hub torque that makes the tip of `link` follow `motion` (Bayo 1987, eqs 13-21).
///
/// Divides each frequency of the tip by the link's transfer from torque to tip. The period is long enough for the
/// torque to decay before and after the motion. A mesh of half the element length measures the mesh error and, for an
/// automatic plan, refines the mesh.
///
/// # Errors
/// [`InversionError`]: impossible damping, a torque at hub or motor that is not finite, an automatic mesh that does not
/// converge, or a window too long to transform.
pub fn invert(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
) -> Result<Solution, InversionError> {
    invert_link(link, plan, motion, analysis, &Resources::default())
}

/// Finds the torques of all joints for the motion of an arm, or of one link; `plans` has one for each link.
///
/// # Errors
/// [`InversionError`]: impossible damping, an arm that cannot follow its path, or a torque that is not finite. An automatic
/// mesh or second-order terms may not converge. A window may be too long to transform, or need more memory than
/// `resources` allow.
pub fn invert_motion(
    arm: &Arm,
    plans: &[MeshPlan],
    motion: &Motion,
    analysis: &Analysis,
    resources: &Resources<'_>,
) -> Result<Solution, InversionError> {
    match (motion, arm.links(), plans) {
        (Motion::Tip(motion), [own], [plan]) => {
            invert_link(&own.link, plan, motion, analysis, resources)
        }
        (Motion::Tip(_), [_], _) => Err(InversionError::Plans { plans: plans.len(), links: 1 }),
        (Motion::Tip(_), links, _) => Err(InversionError::OtherMotion { links: links.len() }),
        (Motion::Path(path), ..) => invert_arm(arm, plans, path, analysis, resources),
    }
}

/// [`invert`] within a memory limit, with a watcher of its progress.
fn invert_link(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
    resources: &Resources<'_>,
) -> Result<Solution, InversionError> {
    let mesh = Mesh::new(link, plan)?;
    let elements = mesh.elements().len();
    check_size(link, 2 * elements, 2)?;
    let coarsest = model_of(link, mesh, analysis.kept_modes())?;
    let order = analysis.second_order_of(link);
    let is_bent = link.has_weight() || order != SecondOrder::None;
    let has_drag = coarsest.law().mass_rate_per_s() > 0.0;
    analysis.refuse_ends(motion.ends(), (is_bent, has_drag))?;
    let turns = motion.travel_m() / (TAU * link.rigid_tip());
    let is_turned = motion.ends() == Ends::Periodic && (turns - turns.round()).abs() > WHOLE_TURNS;
    if is_turned && link.has_weight() && !link.joint().slides() {
        return Err(InversionError::Ends(RefusedEnds::Turned));
    }
    if is_bent {
        return invert_bent(coarsest, plan, motion, analysis, resources);
    }
    let mut first_zero_per_s = first_zero(coarsest.mesh());
    let problem = LinkProblem::new(motion, analysis, first_zero_per_s, *resources)?;
    let (mut coarsest, mut period) = (coarsest, problem.shortest_period()?);
    let (answering, answer, left, mesh_errors, mode_errors, input_errors, moments) = loop {
        let MeshAnswer { model, amplitudes, peaks, mesh_errors, mode_errors, input_errors } =
            MeshAnswer::of(coarsest, plan, &period, analysis, resources.watch)?;
        if model.mesh().elements().len() > elements {
            first_zero_per_s = first_zero(model.mesh());
        }
        // The images of a cycle are its neighbours.
        let tails = SlowTails::of(&*model, first_zero_per_s).filter(|_| motion.cycles().is_none());
        let hub_tail = tails.map(|tails| tails.hub_tail(&*model));
        let answering = AnsweringModel { model, first_zero_per_s, hub_tail, peaks };
        let (motor, moments) = (amplitudes.motor.as_ref(), amplitudes.moment_n_m);
        let shortest = PeriodicAnswer::new(amplitudes.hub, motor, Arc::clone(&period));
        let (answer, left) = problem.decayed(&answering, shortest)?;
        // A link that rings on gathers its errors over the whole period.
        let is_whole = Arc::ptr_eq(&answer.period, &period);
        if is_whole || !rings(answering.model.mesh(), &period) {
            let moments = moments.filter(|_| is_whole).unwrap_or_default();
            break (answering, answer, left, mesh_errors, mode_errors, input_errors, moments);
        }
        (coarsest, period) = (answering.model, answer.period);
    };
    // Only the mesh of the answer counts: other meshes may be far too coarse.
    if let Some(frequency_hz) = answer.hub.blocked_hz {
        return Err(InversionError::BlockedTip { frequency_hz });
    }
    let window = problem.window(&answer);
    let torque = answer.periodic(&answer.torque_n_m);
    let edge = match motion.cycles() {
        Some(_) => Edge { cut: 0.0, seam: 0.0 },
        None => Edge {
            cut: torque.outside(&window) / torque.peak(),
            seam: torque.at_seam() / torque.peak(),
        },
    };
    let errors = mesh_errors
        .zip(
            &window_errors((motion, link.has_station()), &answer, (left, &moments), &window),
            |mesh, window| QuantityErrors { mesh, window, ..QuantityErrors::default() },
        )
        .with(mode_errors, |errors, modes| QuantityErrors { modes: Some(modes), ..errors })
        .with(input_errors, |errors, input| QuantityErrors { input: Some(input), ..errors });
    problem.solution(answering, answer, (&window, edge), &errors, None)
}

/// Share of the buckling weight above which a warning tells it.
const NEAR_BUCKLING: f64 = 0.7;

/// Results of a bent link beside its histories.
struct Bent {
    findings: SecondOrderFindings,
    /// Largest slope |w'| of the link from its chord.
    largest_slope: f64,
    /// Places of the nodes over the period.
    shape: Shape,
}

/// [`invert_link`] for a link under gravity, or with second-order terms: an arm of one link.
fn invert_bent(
    coarsest: Arc<dyn Model>,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
    resources: &Resources<'_>,
) -> Result<Solution, InversionError> {
    let near_buckling = buckling(coarsest.link())?;
    let first_zero_per_s = first_zero(coarsest.mesh());
    let link = LinkProblem::new(motion, analysis, first_zero_per_s, *resources)?;
    let arm = coarsest.link().clone().into();
    let problem = ArmProblem::of_link(&link, &arm, first_zero_per_s)?;
    let solver = Solver { problem, plans: std::slice::from_ref(plan), falls_back: false };
    let models = vec![coarsest];
    let measured = solver.measured(models.clone(), first_zero_per_s).map_err(|error| {
        let InversionError::Elastica(ElasticaError::Diverges { .. }) = error else { return error };
        let refused = diverged(error, &models, &solver.problem);
        match solver.problem.second_order {
            SecondOrder::First => InversionError::NorFirst(Box::new(refused)),
            _ => refused,
        }
    })?;
    let (window, edge, errors) = (measured.window, measured.edge, measured.errors[0]);
    let (answer, peaks, model) = measured.of_link();
    let bent = &answer.motion.links[0].bent;
    let bent = Bent {
        findings: solver.findings(&answer),
        largest_slope: bent.largest_slope,
        shape: Shape::of(bent, answer.motion.second_order, model.mesh()),
    };
    let answering = AnsweringModel { model, first_zero_per_s, hub_tail: None, peaks };
    let mut solution =
        link.solution(answering, answer.periodic(), (&window, edge), &errors, Some(bent))?;
    solution.warnings.extend(near_buckling.map(SolutionWarning::from));
    Ok(solution)
}

/// Warns of a weight near the one that buckles a link which keeps its direction.
///
/// # Errors
/// [`InversionError::Buckled`].
fn buckling(link: &Link) -> Result<Option<Warning>, InversionError> {
    let Some((direction_rad, gravity)) = link.direction_rad().zip(link.gravity()) else {
        return Ok(None);
    };
    let mesh = Mesh::new(link, &MeshPlan::automatic(link))?;
    let share = buckling_share(&mesh, gravity.along_m_s2(direction_rad));
    if share >= BUCKLED {
        return Err(InversionError::Buckled { share });
    }
    Ok((share > NEAR_BUCKLING).then_some(Warning::NearBuckling { share }))
}

/// Torques over a window.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowTorques {
    /// Torque at the hub in N m.
    pub hub_n_m: Vec<f64>,
    /// Torque of the motor in N m, where there is a drive.
    pub motor_n_m: Option<Vec<f64>>,
}

impl Solution {
    /// The torques of one link for another sampling of its motion, on the same mesh and over the same window; the first
    /// sample is at the window's start. `None` for an arm.
    ///
    /// # Errors
    /// As [`invert_motion`].
    pub fn torques_over_window(
        &self,
        motion: &TipMotion,
        resources: &Resources<'_>,
    ) -> Result<Option<WindowTorques>, InversionError> {
        let Some(LinkSpectra { hub_tail, shape, .. }) = &self.spectra else { return Ok(None) };
        let (first_zero, model) = (self.first_zero_per_s, &self.links[0].model);
        let problem = LinkProblem::new(motion, &self.analysis, first_zero, *resources)?;
        let answer = if shape.is_some() {
            let bent = ArmProblem::of_link(&problem, &self.arm, first_zero)?;
            let len = problem.len_over(bent.shortest_len()?, self.band.period_s);
            bent.answer(&[Arc::clone(model)], &bent.period(len)?, None)?.periodic()
        } else {
            problem.answer_over(&**model, self.band.period_s)?
        };
        let grid = problem.grid_over(&self.grid);
        let histories = Histories::of(&answer, &**model, *hub_tail, (0.0, grid))?;
        Ok(Some(WindowTorques {
            hub_n_m: histories.torque_n_m,
            motor_n_m: histories.motor.map(|motor| motor.torque_n_m),
        }))
    }
}

/// True if no torque moves the output at a frequency of a period: the torque rings on there.
fn rings(mesh: &Mesh, period: &TipPeriod) -> bool {
    let highest_rad_s = period.spectrum.omegas_rad_s.last();
    highest_rad_s.is_some_and(|highest| !real_frequency_zeros(mesh, *highest).is_empty())
}

fn first_zero(mesh: &Mesh) -> Option<f64> {
    torque_zeros(mesh, 1).first().copied()
}

impl LinkProblem<'_> {
    /// The solution over a window of the answer; `errors` are the errors of mesh, modes and window.
    fn solution(
        &self,
        answering: AnsweringModel,
        answer: PeriodicAnswer,
        (window, edge): (&Window, Edge),
        errors: &PerQuantity<QuantityErrors>,
        bent: Option<Bent>,
    ) -> Result<Solution, InversionError> {
        let grid = TimeGrid { first: window.start, len: window.len(), ..self.motion.grid() };
        let start_angle_rad = self.start_angle_rad(answering.model.link())?;
        let place = (start_angle_rad, grid);
        let histories = Histories::of(&answer, &*answering.model, answering.hub_tail, place)?;
        // A bent link has step errors where its loads exceed the samples' resolution.
        let keeps_all = self.cutoff.keeps_all() && bent.is_none();
        let step_errors =
            if keeps_all { self.step_errors(&answering, &answer, &histories)? } else { None };
        let model = bent.is_none().then(|| self.model_error(&answering, &answer, &histories));
        let thick = {
            let (link, model) = (answering.model.link(), &*answering.model);
            let spectrum = &answer.period.spectrum;
            let omegas_rad_s = &spectrum.omegas_rad_s[..spectrum.band_len()];
            thick_share(model, omegas_rad_s, &answer.moving_torque_n_m(link))
        };
        let tip_error = answer.period.tip_error_m() / answer.period.histories.largest_travel_m();
        let tip_model_error = model.map(|model| model.tip);
        let errors = errors
            .with(step_errors, |errors, step| QuantityErrors { step: Some(step), ..errors })
            .with(model.map(|model| model.with_thickness(thick)), |errors, model| QuantityErrors {
                model: Some(model),
                ..errors
            });
        let warnings = Diagnostics {
            model: &*answering.model,
            motion: self.motion,
            analysis: self.analysis,
            answer: &answer,
            edge,
            second_order: bent.as_ref().map(|bent| bent.findings),
            histories: &histories,
            tip_error,
            tip_model_error,
            errors: &errors,
            thick,
        };
        let warnings = warnings.warnings().into_iter().map(SolutionWarning::from).collect();
        let (first, last) = self.motion.moving_samples();
        let on_grid = |k: usize| (k as i64 - window.start).max(0) as usize;
        let hub = JointMotion {
            torque_n_m: histories.torque_n_m,
            rigid_torque_n_m: histories.rigid_torque_n_m,
            angle_rad: histories.hub_angle_rad,
            rate_rad_s: histories.hub_rate_rad_s,
            acceleration_rad_s2: None,
            rigid_angle_rad: histories.rigid_hub_angle_rad,
            force_n: None,
            motor: histories.motor,
            errors,
        };
        let link = LinkMotion {
            root_moment_n_m: histories.root_moment_n_m,
            largest_slope: bent.as_ref().map(|bent| bent.largest_slope),
            shape: None,
            model: answering.model,
        };
        let solution = Solution {
            arm: link.link().clone().into(),
            motion: Motion::Tip(self.motion.clone()),
            analysis: *self.analysis,
            grid,
            joints: vec![hub],
            links: vec![link],
            tip: vec![histories.tip],
            tip_error,
            tip_model_error,
            moving: (on_grid(first), on_grid(last)),
            first_zero_per_s: answering.first_zero_per_s,
            band: Band::of(&answer.period.spectrum, answer.hub.torque_n_m.len()),
            second_order: bent.as_ref().map(|bent| bent.findings),
            warnings,
            spectra: Some(LinkSpectra {
                hub: answer.hub,
                period: answer.period,
                hub_tail: answering.hub_tail,
                shape: bent.map(|bent| Arc::new(bent.shape)),
            }),
        };
        Ok(solution.with_losses())
    }
}

/// Error of each quantity from the finite period and the written window, over its peak; `left` is the period's part.
/// `moments` are amplitudes of the bending moment at places of the link, if they are known over the period.
fn window_errors(
    (motion, has_station): (&TipMotion, bool),
    answer: &PeriodicAnswer,
    (left, moments): (PerQuantity<f64>, &[Vec<Complex64>]),
    window: &Window,
) -> PerQuantity<f64> {
    if motion.cycles().is_some() {
        return left;
    }
    let cut_off = |samples: &[f64]| {
        let periodic = answer.periodic(samples);
        periodic.outside(window) / periodic.peak()
    };
    let pair = &answer.period.spectrum.pair;
    let root = || pair.samples(&answer.hub.root_moment_n_m);
    let torque = left.torque.max(cut_off(&answer.torque_n_m));
    // Beyond a station the link rings on with the torque, and the moment at the root does not show it.
    let beyond = if has_station { torque.max(moment_left(answer, moments, window)) } else { 0.0 };
    PerQuantity {
        torque,
        bending_moment: left.bending_moment.map(|left| left.max(cut_off(&root())).max(beyond)),
        motor_torque: left
            .motor_torque
            .zip(answer.motor_n_m.as_deref())
            .map(|(left, motor)| left.max(cut_off(motor))),
        ..left
    }
}

/// Moment at all places outside a window, or where one period meets the next, over its peak.
fn moment_left(answer: &PeriodicAnswer, moments: &[Vec<Complex64>], window: &Window) -> f64 {
    let of_place = moments.iter().map(|amplitudes| {
        let samples = answer.period.spectrum.pair.samples(amplitudes);
        let periodic = answer.periodic(&samples);
        [periodic.outside(window).max(answer.left_of(&samples) * periodic.peak()), periodic.peak()]
    });
    let [left, peak] =
        of_place.fold([0.0_f64; 2], |[left, peak], own| [left.max(own[0]), peak.max(own[1])]);
    if left == 0.0 { 0.0 } else { left / peak }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::beam::ElementCount;
    use crate::link::{Damping, LinkParts, uniform};
    use crate::motion::MotionColumns;

    /// A smooth motion of this many steps; more steps narrow its band.
    pub(crate) fn solution(steps: u32) -> Solution {
        let damping = Damping::Hysteretic { ratio: 0.02 };
        let link = Link::new(LinkParts { damping, ..uniform() }).unwrap();
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(40)), 1e-4).unwrap();
        let share = |k: u32| (2.0 * f64::from(k) / f64::from(steps) - 1.0) * 6.0;
        let time_s = (0..=steps).map(|k| 1.2 * f64::from(k) / f64::from(steps)).collect();
        let bell = (0..=steps).map(|k| -share(k) * libm::exp(-share(k).powi(2))).collect();
        let columns = MotionColumns { time_s, acceleration_m_s2: Some(bell), ..Default::default() };
        let motion = TipMotion::new(columns).unwrap();
        invert(&link, &plan, &motion, &Analysis::default()).unwrap()
    }
}
