//! The answer to another sampling of a motion, on the mesh and over the window of one that is known.

use std::sync::Arc;

use super::accuracy::PerQuantity;
use super::error::InversionError;
use super::histories::{Histories, HubMotion, cut};
use super::periodic_answer::PeriodicAnswer;
use super::problem::Problem;
use super::solution::Solution;
use super::watch::{Resources, Unwatched};
use crate::model::Model;
use crate::motion::{TailTerms, TipMotion};
use crate::numeric::{TimeGrid, fast_length, largest};

/// Torques over a window.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowTorques {
    /// Torque at the hub in N m.
    pub hub_n_m: Vec<f64>,
    /// Torque of the motor in N m, where there is a drive.
    pub motor_n_m: Option<Vec<f64>>,
}

/// The torques that another sampling of the motion asks of a solution's link, on the same mesh and over
/// the same window; the first sample stands at the window's start.
///
/// # Errors
/// As [`invert_with`](super::invert_with).
pub fn torques_over_window(
    solution: &Solution,
    motion: &TipMotion,
    resources: &Resources<'_>,
) -> Result<WindowTorques, InversionError> {
    let first_zero = solution.first_zero_per_s;
    let problem = Problem::new(motion, &solution.analysis, first_zero, *resources)?;
    let answer = problem.answer_on(&*solution.model, solution.band.period_s)?;
    let grid = problem.grid_over(&solution.grid);
    Ok(WindowTorques {
        hub_n_m: cut(&answer.torque_n_m, &grid),
        motor_n_m: answer.motor_n_m.map(|motor| cut(&motor, &grid)),
    })
}

/// An answer whose band the samples limit.
pub(super) struct Sampled<'a> {
    pub(super) model: &'a dyn Model,
    pub(super) first_zero_per_s: Option<f64>,
    /// The hub angle's slow tail, where damping leaves one.
    pub(super) tail: Option<TailTerms>,
    pub(super) answer: &'a PeriodicAnswer,
    pub(super) histories: &'a Histories,
}

impl Problem<'_> {
    /// The motion on a mesh, on a period no shorter than one given, so that it holds what that one does.
    fn answer_on(
        &self,
        model: &dyn Model,
        period_s: f64,
    ) -> Result<PeriodicAnswer, InversionError> {
        let own = self.padding.period_len(self.motion.grid().len)?;
        let that = (period_s / self.motion.grid().step_s).ceil() as usize;
        let period = self.period(own.max(fast_length(that)))?;
        Ok(PeriodicAnswer::of(self.asked(&period).of(model), Arc::clone(&period))?)
    }

    /// A window at this motion's own step.
    fn grid_over(&self, window: &TimeGrid) -> TimeGrid {
        let grid = self.motion.grid();
        let first = ((window.time_s(0) - grid.time_s(0)) / grid.step_s).round() as i64;
        let len = (window.duration_s() / grid.step_s).round() as usize + 1;
        TimeGrid { first, len, ..grid }
    }

    /// What half the step changes of every quantity, over its peak; none where the motion cannot be
    /// sampled twice as often.
    pub(super) fn step_errors(
        &self,
        sampled: &Sampled<'_>,
    ) -> Result<Option<PerQuantity<f64>>, InversionError> {
        let Ok(finer) = self.motion.twice_as_often() else { return Ok(None) };
        let Sampled { model, first_zero_per_s, tail, answer: coarse_answer, histories } = *sampled;
        let resources = Resources { watch: &Unwatched, ..self.resources };
        let problem = Problem::new(&finer, self.analysis, first_zero_per_s, resources)?;
        let period_s = coarse_answer.period.spectrum.period_s();
        let answer = problem.answer_on(model, period_s)?;
        let (window, grid) = (&histories.grid, problem.grid_over(&histories.grid));
        let (pair, length_m) = (&answer.period.spectrum.pair, model.mesh().length_m());
        let apart = |coarse: &[f64], fine: &[f64]| {
            let pairs = coarse.iter().zip(fine.iter().step_by(2));
            pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
        };
        let share = |coarse: &[f64], fine: &[f64]| apart(coarse, fine) / largest(fine);
        let off = |coarse: &[f64], period: &[f64]| share(coarse, &cut(period, &grid));
        let tip = &answer.period.histories;
        let fine_tip = [&tip.displacement_m, &tip.velocity_m_s, &tip.acceleration_m_s2]
            .map(|tip| cut(tip, &grid));
        let hub = HubMotion::of(&answer.period, &answer.hub, tail, 1.0 / length_m);
        let [angle_rad, rate_rad_s, acceleration_rad_s2] =
            [0, 1, 2].map(|order| hub.on(&grid, &fine_tip[order], order));
        let coarse_hub =
            HubMotion::of(&coarse_answer.period, &coarse_answer.hub, tail, 1.0 / length_m);
        let coarse_acceleration = coarse_hub.on(window, &histories.tip.acceleration_m_s2, 2);
        let turn_rad = apart(&histories.hub_angle_rad, &angle_rad);
        let turned_rad: Vec<f64> = angle_rad.iter().map(|angle| angle - angle_rad[0]).collect();
        let tip_change_m = apart(&histories.tip.displacement_m, &fine_tip[0]);
        let root = pair.samples(&answer.hub.root_moment_n_m);
        let forcing = problem.asked(&answer.period).of(model);
        let motor = histories.motor.as_ref().zip(forcing.motor_spectra(&answer.hub));
        let motor = motor.map(|(coarse, fine)| {
            let of = |coarse: &[f64], fine| off(coarse, &pair.samples(fine));
            (of(&coarse.torque_n_m, &fine.torque_n_m), of(&coarse.rate_rad_s, &fine.rate_rad_s))
        });
        Ok(Some(PerQuantity {
            torque: off(&histories.torque_n_m, &answer.torque_n_m),
            hub_angle: turn_rad / largest(&turned_rad),
            hub_rate: share(&histories.hub_rate_rad_s, &rate_rad_s),
            hub_acceleration: Some(share(&coarse_acceleration, &acceleration_rad_s2)),
            displacement: Some(tip_change_m.max(turn_rad * length_m) / tip.largest_travel_m()),
            bending_moment: Some(off(&histories.root_moment_n_m, &root)),
            motor_torque: motor.map(|(torque, _)| torque),
            motor_rate: motor.map(|(_, rate)| rate),
        }))
    }
}
