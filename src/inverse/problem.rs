//! What is to be solved, the mesh and the period left open.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::accuracy::PerQuantity;
use super::analysis::Analysis;
use super::error::InversionError;
use super::period::{Padding, Window, check_memory};
use super::periodic_answer::{Costed, PeriodicAnswer};
use super::probes::Wanted;
use super::refinement::Asked;
use super::watch::Resources;
use crate::model::Model;
use crate::motion::{Cutoff, TipMotion, TipPeriod};

/// A motion and how exactly it is to be followed, over a band and with a padding that the first zero of
/// the link asks for.
pub(super) struct Problem<'a> {
    pub(super) motion: &'a TipMotion,
    pub(super) analysis: &'a Analysis,
    pub(super) cutoff: Cutoff,
    pub(super) padding: Padding,
    pub(super) resources: Resources<'a>,
}

impl<'a> Problem<'a> {
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

    pub(super) fn asked<'b>(&self, period: &'b TipPeriod) -> Asked<'b>
    where
        'a: 'b,
    {
        Asked {
            spectrum: &period.spectrum,
            histories: &period.histories,
            wanted: Wanted {
                tables: self.analysis.measures_tables(),
                moments: self.analysis.measures_moments(),
            },
            watch: self.resources.watch,
        }
    }

    /// Lengthens the period until every quantity has decayed where one period meets the next; returns
    /// what is left there, over the peak of each.
    ///
    /// The zeros tell the exponential decay; hysteretic damping adds an algebraic tail (∝ t⁻⁴ of the
    /// torque), and a blocked tip rings on, so the decay is measured, too.
    pub(super) fn decayed(
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

    /// The samples to write: until both the torque and that of the motor stay below the tolerance.
    pub(super) fn window(&self, answer: &PeriodicAnswer) -> Window {
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
}
