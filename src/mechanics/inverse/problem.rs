//! A motion to invert: its periods on any mesh, and the same motion at other samples.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::accuracy::PerQuantity;
use super::analysis::{Analysis, Resources, Unwatched};
use super::error::InversionError;
use super::histories::{Histories, HubMotion};
use super::period::{Padding, Window, check_memory};
use super::periodic_answer::PeriodicAnswer;
use super::spectra::DrivenModel;
use crate::link::Link;
use crate::model::Model;
use crate::motion::{Cutoff, TailTerms, TipMotion, TipPeriod};
use crate::numeric::{TimeGrid, fast_length};

/// A motion and the required accuracy; the first zero of the link determines the padding.
pub(super) struct LinkProblem<'a> {
    pub(super) motion: &'a TipMotion,
    pub(super) analysis: &'a Analysis,
    pub(super) cutoff: Cutoff,
    pub(super) padding: Padding,
    pub(super) resources: Resources<'a>,
}

/// The model of the answer, and its further properties.
pub(super) struct AnsweringModel {
    pub(super) model: Arc<dyn Model>,
    pub(super) first_zero_per_s: Option<f64>,
    /// The hub angle's slow tail, where damping causes one.
    pub(super) hub_tail: Option<TailTerms>,
    /// Peak of each quantity.
    pub(super) peaks: PerQuantity<f64>,
}

impl<'a> LinkProblem<'a> {
    pub(super) fn new(
        motion: &'a TipMotion,
        analysis: &'a Analysis,
        first_zero_per_s: Option<f64>,
        resources: Resources<'a>,
    ) -> Result<Self, InversionError> {
        let padding = Padding::new(motion, analysis, first_zero_per_s);
        // The search of the cut-off takes less memory than the shortest period.
        check_memory(padding.period_len(motion.grid().len)?, 0, resources.memory_bytes)?;
        let tolerance = analysis.tip_tolerance();
        let cutoff = match resources.periods {
            Some(periods) => periods.cutoff(motion, tolerance),
            None => motion.cutoff(tolerance),
        };
        Ok(Self { motion, analysis, cutoff, padding, resources })
    }

    /// The shortest period after which the torque has decayed, as far as the first zero determines it.
    pub(super) fn shortest_period(&self) -> Result<Arc<TipPeriod>, InversionError> {
        self.period(self.padding.period_len(self.motion.grid().len)?)
    }

    pub(super) fn period(&self, len: usize) -> Result<Arc<TipPeriod>, InversionError> {
        let period_s = len as f64 * self.motion.grid().step_s;
        let highest = self.cutoff.end_rad_s() * period_s / TAU;
        check_memory(len, (highest as usize).min(len / 2), self.resources.memory_bytes)?;
        let seam = self.padding.seam(self.motion.grid().len, len);
        Ok(match self.resources.periods {
            Some(periods) => periods.over_period(self.motion, len, seam, self.cutoff),
            None => Arc::new(self.motion.over_period(len, seam, self.cutoff)),
        })
    }

    fn answer(&self, model: &dyn Model, len: usize) -> Result<PeriodicAnswer, InversionError> {
        let (period, watch) = (self.period(len)?, self.resources.watch);
        let driven = DrivenModel { model, period: &period, watch };
        Ok(PeriodicAnswer::of(driven, Arc::clone(&period))?)
    }

    /// Lengthens the period until every quantity has decayed where one period meets the next; returns each remainder
    /// there, over the quantity's peak.
    ///
    /// The zeros determine the exponential decay. Hysteretic damping adds an algebraic tail (∝ t⁻⁴ of the torque), and
    /// a blocked tip rings on, so the decay is measured, too.
    pub(super) fn decayed(
        &self,
        answering: &AnsweringModel,
        shortest: PeriodicAnswer,
    ) -> Result<(PeriodicAnswer, PerQuantity<f64>), InversionError> {
        let AnsweringModel { model, hub_tail, peaks, .. } = answering;
        if self.padding.cycles.is_some() {
            return Ok((shortest, peaks.zip(peaks, |_, _| 0.0)));
        }
        let initial = shortest.torque_n_m.len();
        let mut answer = shortest;
        let tolerance = self.analysis.tolerance();
        loop {
            let left = || answer.left_at_seam(model.link(), hub_tail.as_ref(), peaks);
            let Some(len) = Padding::lengthened(answer.torque_n_m.len(), initial) else {
                let left = left();
                return Ok((answer, left));
            };
            // Until the torque has decayed, the other quantities do not matter.
            if answer.left_of(&answer.torque_n_m) <= tolerance {
                let left = left();
                if left.worst().1 <= tolerance {
                    return Ok((answer, left));
                }
            }
            answer = self.answer(&**model, len)?;
        }
    }

    /// The samples to write: until both the torque and that of the motor stay below the tolerance.
    pub(super) fn window(&self, answer: &PeriodicAnswer) -> Window {
        let grid = self.motion.grid();
        if self.padding.cycles.is_some() {
            return Window { start: 0, stop: grid.len as i64 - 1 };
        }
        let window_of = |samples: &[f64]| {
            let torque = answer.periodic(samples);
            torque.window(grid.len, grid.step_s, self.analysis, torque.peak())
        };
        let hub = window_of(&answer.torque_n_m);
        answer.motor_n_m.as_deref().map(window_of).map_or(hub, |motor| Window {
            start: hub.start.min(motor.start),
            stop: hub.stop.max(motor.stop),
        })
    }

    /// The motion on a mesh, on a period at least as long as another one, to cover its samples.
    pub(super) fn answer_over(
        &self,
        model: &dyn Model,
        period_s: f64,
    ) -> Result<PeriodicAnswer, InversionError> {
        let shortest = self.padding.period_len(self.motion.grid().len)?;
        self.answer(model, self.len_over(shortest, period_s))
    }

    /// Samples of a period at least as long as another one and as the shortest; a cycle keeps its period.
    pub(super) fn len_over(&self, shortest: usize, period_s: f64) -> usize {
        if self.padding.cycles.is_some() {
            return shortest;
        }
        shortest.max(fast_length((period_s / self.motion.grid().step_s).ceil() as usize))
    }

    /// Direction of the chord in rad at zero displacement of the tip; 0 for a link without gravity.
    pub(super) fn start_angle_rad(&self, link: &Link) -> Result<f64, InversionError> {
        let Some(gravity) = link.gravity() else { return Ok(0.0) };
        let start_rad = self.motion.recording().start_angle_rad.or(gravity.start_angle_rad);
        if gravity.acts() {
            start_rad.ok_or(InversionError::NoStartAngle)
        } else {
            Ok(start_rad.unwrap_or(0.0))
        }
    }

    /// A window at this motion's step.
    pub(super) fn grid_over(&self, window: &TimeGrid) -> TimeGrid {
        let grid = self.motion.grid();
        let first = ((window.time_s(0) - grid.time_s(0)) / grid.step_s).round() as i64;
        let len = (window.duration_s() / grid.step_s).round() as usize + 1;
        let len = if self.padding.cycles.is_some() { grid.len } else { len };
        TimeGrid { first, len, ..grid }
    }

    /// Change of every quantity by half the step, over its peak. `None` where the motion cannot be sampled twice as
    /// often.
    pub(super) fn step_errors(
        &self,
        answering: &AnsweringModel,
        coarse: &PeriodicAnswer,
        histories: &Histories,
    ) -> Result<Option<PerQuantity<f64>>, InversionError> {
        let Ok(finer) = self.motion.twice_as_often() else { return Ok(None) };
        let resources = Resources { watch: &Unwatched, ..self.resources };
        let problem =
            LinkProblem::new(&finer, self.analysis, answering.first_zero_per_s, resources)?;
        let model = &*answering.model;
        let fine = problem.answer_over(model, coarse.period.spectrum.period_s())?;
        let (window, grid) = (&histories.grid, problem.grid_over(&histories.grid));
        let (tail, rigid_tip) = (answering.hub_tail, model.mesh().rigid_tip());
        let finer = Histories::of(&fine, model, tail, (self.start_angle_rad(model.link())?, grid))?;
        let hub = HubMotion { period: &fine.period, tail, per_rigid_tip: 1.0 / rigid_tip };
        let acceleration = hub.on(&grid, fine.excess(2), &finer.tip.acceleration_m_s2, 2);
        let coarse_hub = HubMotion { period: &coarse.period, ..hub };
        let coarse_tip_m_s2 = &histories.tip.acceleration_m_s2;
        let coarse_acceleration = coarse_hub.on(window, coarse.excess(2), coarse_tip_m_s2, 2);
        let finer = finer.curves(acceleration);
        let apart = histories.curves(coarse_acceleration).apart_from_finer(&finer);
        // A turn of the hub moves a node by at most the turn times the length.
        let turn_m = apart.hub_angle * rigid_tip;
        let displacement = apart.displacement.map(|tip_m| tip_m.max(turn_m));
        let sizes = finer.sizes(false, fine.period.histories.largest_travel_m());
        let apart = PerQuantity { displacement, ..apart };
        Ok(Some(apart.zip(&sizes, |off, size| off / size)))
    }
}
