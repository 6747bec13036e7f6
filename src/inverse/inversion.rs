use std::sync::Arc;

use super::accuracy::{Accuracy, PerQuantity, QuantityErrors};
use super::analysis::Analysis;
use super::diagnostics::Diagnostics;
use super::error::InversionError;
use super::histories::Histories;
use super::period::Window;
use super::periodic_answer::{Costed, PeriodicAnswer};
use super::probes::Amplitudes;
use super::problem::Problem;
use super::refinement::{Measured, measured_mesh, shares};
use super::resampled::Sampled;
use super::slow_tail::Series;
use super::solution::{Band, Solution};
use super::watch::Resources;
use crate::beam::{Mesh, MeshPlan};
use crate::link::Link;
use crate::modal::torque_zeros;
use crate::model::{KeptModes, Model, ModelError, check_size, model_of};
use crate::motion::{TailTerms, TipMotion};
use crate::numeric::TimeGrid;

/// What is known of a mesh besides the answer on it.
struct Known {
    first_zero_per_s: Option<f64>,
    hub_tail: Option<TailTerms>,
    peaks: PerQuantity<f64>,
    mesh_errors: PerQuantity<f64>,
    mode_errors: Option<PerQuantity<f64>>,
}

/// Finds the hub torque that makes the tip of `link` follow `motion` (Bayo 1987, eqs 13-21).
///
/// Each frequency that the tip needs is divided by the link's transfer from torque to tip, on a period
/// long enough for the torque to decay before and after the motion; the mesh is measured against
/// one of half the element length, and refined where the plan says so.
///
/// # Errors
/// [`InversionError`]: damping that cannot be, a torque that is not finite, at the hub or at the
/// motor, an automatic mesh that does not converge, or a window too long to transform.
pub fn invert(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
) -> Result<Solution, InversionError> {
    invert_with(link, plan, motion, analysis, &Resources::default())
}

/// [`invert`] within so much memory, its progress watched.
///
/// # Errors
/// As [`invert`], and [`InversionError::TooMuchMemory`].
pub fn invert_with(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
    resources: &Resources<'_>,
) -> Result<Solution, InversionError> {
    let mesh = Mesh::new(link, plan);
    let elements = mesh.elements().len();
    check_size(link, 2 * elements, 2)?;
    let coarsest = model_of(link, mesh, analysis.kept_modes())?;
    let first_zero = first_zero_of(coarsest.mesh());
    let problem = Problem::new(motion, analysis, first_zero, *resources)?;
    let period = problem.shortest_period()?;
    let asked = problem.asked(&period);
    let Measured { model, probes, amplitudes, peaks, mesh_errors } =
        measured_mesh(coarsest, plan, &asked)?;
    let mode_errors = (model.kept_modes() != KeptModes::All).then(|| {
        let all = model.unreduced()?;
        let exact = Amplitudes::of(asked.of(&*all), &probes)?;
        let peaks = asked.peaks(all.mesh().length_m(), &exact);
        Ok::<_, ModelError>(shares(&amplitudes.change_to(&exact), &peaks))
    });
    let mode_errors = mode_errors.transpose()?;
    let is_refined = model.mesh().elements().len() > elements;
    let first_zero_per_s = if is_refined { first_zero_of(model.mesh()) } else { first_zero };
    let hub_tail = Series::of(&*model, first_zero_per_s).map(|s| s.hub_tail(&*model));
    let known = Known { first_zero_per_s, hub_tail, peaks, mesh_errors, mode_errors };
    let motor_n_m = amplitudes.motor.map(|motor| motor.torque_n_m);
    let shortest = PeriodicAnswer::new(amplitudes.hub, motor_n_m.as_deref(), Arc::clone(&period));
    problem.solution(model, &known, shortest)
}

fn first_zero_of(mesh: &Mesh) -> Option<f64> {
    torque_zeros(mesh, 1).first().copied()
}

impl Problem<'_> {
    /// The solution on a mesh, from the answer on the shortest period.
    fn solution(
        &self,
        model: Arc<dyn Model>,
        known: &Known,
        shortest: PeriodicAnswer,
    ) -> Result<Solution, InversionError> {
        let Known { first_zero_per_s, hub_tail, ref peaks, .. } = *known;
        let moments = self.analysis.measures_moments();
        let costed = Costed { link: model.link(), moments, tail: hub_tail.as_ref(), peaks };
        let (answer, left) = self.decayed(&*model, &costed, shortest)?;
        // Only of the mesh that answers: one that is refined, or measured against, may be far too coarse.
        if let Some(frequency_hz) = answer.hub.blocked_hz {
            return Err(InversionError::BlockedTip { frequency_hz });
        }
        let window = self.window(&answer);
        let grid = TimeGrid { first: window.start, len: window.len(), ..self.motion.grid() };
        let histories = Histories::of(&answer, &*model, hub_tail, grid)?;
        let spectrum = &answer.period.spectrum;
        let sampled = Sampled {
            model: &*model,
            first_zero_per_s,
            tail: hub_tail,
            answer: &answer,
            histories: &histories,
        };
        let keeps_all = self.cutoff.keeps_all();
        let step_errors = if keeps_all { self.step_errors(&sampled)? } else { None };
        let accuracy = Accuracy {
            tip: answer.period.tip_error_m() / answer.period.histories.largest_travel_m(),
            errors: errors(known, &window_errors(&answer, left, &window), step_errors),
        };
        let torque = answer.periodic(&answer.torque_n_m);
        let warnings = Diagnostics {
            model: &*model,
            motion: self.motion,
            analysis: self.analysis,
            spectrum,
            hub: &answer.hub,
            histories: &histories,
            accuracy: &accuracy,
            cut: torque.outside(&window) / torque.peak(),
            seam: torque.at_seam() / torque.peak(),
        }
        .warnings();
        let (first, last) = self.motion.moving_samples();
        let on_grid = |k: usize| (k as i64 - window.start).max(0) as usize;
        let Histories { torque_n_m, rigid_torque_n_m, hub_angle_rad, hub_rate_rad_s, .. } =
            histories;
        Ok(Solution {
            motion: self.motion.clone(),
            analysis: *self.analysis,
            grid,
            torque_n_m,
            rigid_torque_n_m,
            hub_angle_rad,
            hub_rate_rad_s,
            rigid_hub_angle_rad: histories.rigid_hub_angle_rad,
            root_moment_n_m: histories.root_moment_n_m,
            tip: histories.tip,
            motor: histories.motor,
            moving: (on_grid(first), on_grid(last)),
            first_zero_per_s,
            accuracy,
            band: Band::of(spectrum),
            warnings,
            model,
            hub: answer.hub,
            hub_tail,
            period: answer.period,
        })
    }
}

/// What mesh, window, modes and step cost each quantity.
fn errors(
    known: &Known,
    window: &PerQuantity<f64>,
    step: Option<PerQuantity<f64>>,
) -> PerQuantity<QuantityErrors> {
    let mut errors = known.mesh_errors.zip(window, |mesh, window| QuantityErrors {
        mesh,
        window,
        ..QuantityErrors::default()
    });
    if let Some(modes) = &known.mode_errors {
        errors = errors.zip(modes, |errors, modes| QuantityErrors { modes: Some(modes), ..errors });
    }
    if let Some(step) = &step {
        errors = errors.zip(step, |errors, step| QuantityErrors { step: Some(step), ..errors });
    }
    errors
}

/// What the finite period and the window that is cut out of it cost each quantity, over its peak;
/// `left` is the period's part.
fn window_errors(
    answer: &PeriodicAnswer,
    left: PerQuantity<f64>,
    window: &Window,
) -> PerQuantity<f64> {
    let cut_off = |samples: &[f64]| {
        let periodic = answer.periodic(samples);
        periodic.outside(window) / periodic.peak()
    };
    let root = || answer.period.spectrum.pair.samples(&answer.hub.root_moment_n_m);
    PerQuantity {
        torque: left.torque.max(cut_off(&answer.torque_n_m)),
        bending_moment: left.bending_moment.map(|left| left.max(cut_off(&root()))),
        motor_torque: left
            .motor_torque
            .zip(answer.motor_n_m.as_deref())
            .map(|(left, motor)| left.max(cut_off(motor))),
        ..left
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::beam::ElementCount;
    use crate::link::{Damping, LinkParts, uniform};
    use crate::motion::MotionColumns;

    /// A motion of this many steps, smooth, so that its band is narrow where they are many.
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
