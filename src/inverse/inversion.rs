use std::f64::consts::TAU;
use std::sync::{Arc, OnceLock};

use super::accuracy::{Accuracy, PerQuantity, QuantityErrors};
use super::analysis::Analysis;
use super::error::InversionError;
use super::evidence::{Evidence, warnings};
use super::period::{Padding, Window, check_memory};
use super::periodic_answer::{Costed, PeriodicAnswer};
use super::probes::{Amplitudes, Wanted};
use super::refinement::{Asked, Measured, measured_mesh, shares};
use super::rigid::rigid_torque_n_m;
use super::slow_tail::Series;
use super::solution::{Band, HubMotion, Solution, cut};
use super::watch::{Unwatched, Watch};
use crate::beam::{Mesh, MeshPlan};
use crate::link::Link;
use crate::modal::torque_zeros;
use crate::model::{KeptModes, Model, ModelError, check_size, model_of};
use crate::motion::{Cutoff, TailTerms, TipMotion, TipMotionHistories, TipPeriod};
use crate::numeric::TimeGrid;

/// What is to be solved, the mesh and the period left open.
pub(super) struct Problem<'a> {
    pub(super) link: &'a Link,
    pub(super) motion: &'a TipMotion,
    pub(super) analysis: &'a Analysis,
    cutoff: Cutoff,
    pub(super) padding: Padding,
    watch: &'a dyn Watch,
}

/// What is left of the torque at the ends of a window, over its peak.
struct Edges {
    /// Largest outside the window.
    cut: f64,
    /// Largest where one period meets the next.
    seam: f64,
}

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
/// motor, an automatic mesh that does not converge, or a window too long to transform or for the memory allowed.
pub fn invert(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
) -> Result<Solution, InversionError> {
    invert_watched(link, plan, motion, analysis, &Unwatched)
}

/// The same; `watch` gets the progress.
///
/// # Errors
/// As [`invert`].
pub fn invert_watched(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
    watch: &dyn Watch,
) -> Result<Solution, InversionError> {
    let mesh = Mesh::new(link, plan);
    let elements = mesh.elements().len();
    check_size(link, 2 * elements, 2)?;
    let coarsest = model_of(link, mesh, analysis.kept_modes())?;
    let first_zero = first_zero_of(coarsest.mesh());
    let problem = Problem::new(link, motion, analysis, first_zero, watch)?;
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
    let is_refined = model.mesh().elements().len() > elements;
    let first_zero_per_s = if is_refined { first_zero_of(model.mesh()) } else { first_zero };
    let hub_tail = Series::of(&*model, first_zero_per_s).map(|s| s.hub_tail(&*model));
    let mode_errors = mode_errors.transpose()?;
    let known = Known { first_zero_per_s, hub_tail, peaks, mesh_errors, mode_errors };
    let motor_n_m = amplitudes.motor.map(|motor| motor.torque_n_m);
    let shortest = PeriodicAnswer::new(amplitudes.hub, motor_n_m.as_deref(), Arc::clone(&period));
    let (answer, left) = problem.decayed(&*model, &problem.costed(&known), shortest)?;
    // Only of the mesh that answers: one that is refined, or measured against, may be far too coarse.
    if let Some(frequency_hz) = answer.hub.blocked_hz {
        return Err(InversionError::BlockedTip { frequency_hz });
    }
    let (mut solution, edges) = problem.written(model, &known, answer, left);
    solution.motor().map_or(Ok(()), |motor| motor.check())?;
    if problem.cutoff.keeps_all() {
        problem.measure_step(&mut solution)?;
    }
    solution.warnings =
        warnings(&Evidence { link, motion, analysis, cut: edges.cut, seam: edges.seam }, &solution);
    Ok(solution)
}

fn first_zero_of(mesh: &Mesh) -> Option<f64> {
    torque_zeros(mesh, 1).first().copied()
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        link: &'a Link,
        motion: &'a TipMotion,
        analysis: &'a Analysis,
        first_zero_per_s: Option<f64>,
        watch: &'a dyn Watch,
    ) -> Result<Self, InversionError> {
        let padding = Padding::new(motion, analysis, first_zero_per_s);
        // The search of the cut-off takes less memory than the shortest period.
        check_memory(padding.period_len(motion.grid().len)?, 0, analysis)?;
        let cutoff = motion.cutoff(analysis.tip_tolerance());
        Ok(Self { link, motion, analysis, cutoff, padding, watch })
    }

    fn shortest_period(&self) -> Result<Arc<TipPeriod>, InversionError> {
        self.period(self.padding.period_len(self.motion.grid().len)?)
    }

    pub(super) fn period(&self, len: usize) -> Result<Arc<TipPeriod>, InversionError> {
        let period_s = len as f64 * self.motion.grid().step_s;
        let highest = self.cutoff.end_rad_s() * period_s / TAU;
        check_memory(len, (highest as usize).min(len / 2), self.analysis)?;
        let seam = self.padding.seam(self.motion.grid().len, len);
        Ok(self.motion.over_period(len, seam, self.cutoff))
    }

    pub(super) fn asked<'b>(&self, period: &'b TipPeriod) -> Asked<'b>
    where
        'a: 'b,
    {
        Asked {
            spectrum: &period.spectrum,
            histories: period.histories(self.motion),
            wanted: Wanted {
                tables: self.analysis.measures_tables(),
                moments: self.analysis.measures_moments(),
            },
            watch: self.watch,
        }
    }

    fn costed<'b>(&'b self, known: &'b Known) -> Costed<'b> {
        Costed {
            link: self.link,
            moments: self.analysis.measures_moments(),
            tail: known.hub_tail.as_ref(),
            peaks: &known.peaks,
        }
    }

    /// Lengthens the period until every quantity has decayed where one period meets the next; returns
    /// what is left there, over the peak of each.
    ///
    /// The zeros tell the exponential decay; hysteretic damping adds an algebraic tail (∝ t⁻⁴ of the
    /// torque), and a blocked tip rings on, so the decay is measured, too.
    fn decayed(
        &self,
        model: &dyn Model,
        costed: &Costed<'_>,
        shortest: PeriodicAnswer,
    ) -> Result<(PeriodicAnswer, PerQuantity<f64>), InversionError> {
        let initial = shortest.torque_n_m.len();
        let mut answer = shortest;
        loop {
            let left = answer.left_at_seam(costed);
            let (_, most) = left.worst();
            let has_decayed = most <= self.analysis.tolerance();
            let next = Padding::lengthened(answer.torque_n_m.len(), initial);
            match next.filter(|_| !has_decayed) {
                Some(len) => {
                    let period = self.period(len)?;
                    let forcing = self.asked(&period).of(model);
                    answer = PeriodicAnswer::of(forcing, Arc::clone(&period))?;
                }
                None => return Ok((answer, left)),
            }
        }
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

    /// The samples to write: until both the torque and that of the motor stay below the tolerance.
    fn window(&self, answer: &PeriodicAnswer) -> Window {
        let given = self.motion.grid();
        let of = |samples: &[f64]| {
            let torque = answer.periodic(samples);
            torque.window(given.len, given.step_s, self.analysis, torque.peak())
        };
        let hub = of(&answer.torque_n_m);
        answer.motor_n_m.as_deref().map(of).map_or(hub, |motor| Window {
            start: hub.start.min(motor.start),
            stop: hub.stop.max(motor.stop),
        })
    }

    /// Cuts the window to write out of the period and gathers what is known of the answer.
    fn written(
        &self,
        model: Arc<dyn Model>,
        known: &Known,
        answer: PeriodicAnswer,
        left: PerQuantity<f64>,
    ) -> (Solution, Edges) {
        let given = self.motion.grid();
        let torque = answer.periodic(&answer.torque_n_m);
        let window = self.window(&answer);
        let edges = Edges {
            cut: torque.outside(&window) / torque.peak(),
            seam: torque.at_seam() / torque.peak(),
        };
        let grid = TimeGrid { first: window.start, len: window.len(), ..given };
        let moving = self.motion.moving_samples();
        let on_grid = |k: usize| (k as i64 - window.start).max(0) as usize;
        let spectrum = Arc::clone(&answer.period.spectrum);
        let (histories, root_moment_n_m) = rayon::join(
            || answer.period.histories(self.motion),
            || cut(&spectrum.pair.samples(&answer.hub.root_moment_n_m), &grid),
        );
        let tip = TipMotionHistories {
            displacement_m: cut(&histories.displacement_m, &grid),
            velocity_m_s: cut(&histories.velocity_m_s, &grid),
            acceleration_m_s2: cut(&histories.acceleration_m_s2, &grid),
        };
        let rigid = rigid_torque_n_m(self.link, model.law(), &tip);
        let window_errors = Self::window_errors(&answer, left, &window);
        let errors = known.mesh_errors.zip(&window_errors, |mesh, window| QuantityErrors {
            mesh,
            window,
            ..QuantityErrors::default()
        });
        let errors = match &known.mode_errors {
            Some(modes) => {
                errors.zip(modes, |errors, modes| QuantityErrors { modes: Some(modes), ..errors })
            }
            None => errors,
        };
        let ringing_m = if self.cutoff.keeps_all() { histories.ringing_m() } else { 0.0 };
        let tip_m = self.cutoff.tip_error_m + ringing_m;
        let accuracy = Accuracy { tip: tip_m / histories.way_m(), errors };
        let per_length = 1.0 / model.mesh().length_m();
        let hub = HubMotion {
            period: &answer.period,
            excess_amplitudes_rad: &answer.hub.excess_angle_rad,
            tail: known.hub_tail,
            per_length,
        };
        let (hub_angle_rad, hub_rate_rad_s) = rayon::join(
            || hub.of_period(&answer.excess_rad, &grid, &tip.displacement_m, 0),
            || hub.on(&grid, &tip.velocity_m_s, 1),
        );
        let mut torque_n_m = cut(&answer.torque_n_m, &grid);
        hub.take_images_off(&grid, 1, self.link.joint().friction_n_m_s_rad, &mut torque_n_m);
        let solution = Solution {
            torque_n_m,
            rigid_torque_n_m: rigid,
            hub_angle_rad,
            hub_rate_rad_s,
            rigid_hub_angle_rad: tip.displacement_m.iter().map(|v| v * per_length).collect(),
            root_moment_n_m,
            tip,
            moving: (on_grid(moving.0), on_grid(moving.1)),
            first_zero_per_s: known.first_zero_per_s,
            accuracy,
            band: Band::of(&spectrum),
            warnings: Vec::new(),
            grid,
            model,
            hub: answer.hub,
            hub_acceleration_rad_s2: OnceLock::new(),
            hub_tail: known.hub_tail,
            period: answer.period,
            spectrum,
        };
        (solution, edges)
    }
}
