//! Another sampling of a motion on the mesh, and over the window, of a solution.

use std::sync::Arc;

use super::accuracy::{PerQuantity, QuantityErrors};
use super::analysis::Analysis;
use super::error::InversionError;
use super::inversion::Problem;
use super::periodic_answer::PeriodicAnswer;
use super::solution::{HubMotion, Solution, cut};
use super::watch::Unwatched;
use crate::link::Link;
use crate::motion::TipMotion;
use crate::numeric::{TimeGrid, fast_length, largest};

/// Torques over a window.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowTorques {
    /// Torque at the hub in N m.
    pub hub_n_m: Vec<f64>,
    /// Torque of the motor in N m, where there is a drive.
    pub motor_n_m: Option<Vec<f64>>,
}

/// The torques that another sampling of a motion asks of a solution's link, on the same mesh and over
/// the same window; the first sample stands at the window's start.
///
/// # Errors
/// As [`invert`](super::invert).
pub fn torques_over_window(
    solution: &Solution,
    link: &Link,
    motion: &TipMotion,
    analysis: &Analysis,
) -> Result<WindowTorques, InversionError> {
    let problem = Problem::new(link, motion, analysis, solution.first_zero_per_s, &Unwatched)?;
    let answer = problem.answer_on(solution)?;
    let grid = problem.grid_of(solution);
    Ok(WindowTorques {
        hub_n_m: cut(&answer.torque_n_m, &grid),
        motor_n_m: answer.motor_n_m.map(|motor| cut(&motor, &grid)),
    })
}

impl Problem<'_> {
    /// The motion on the mesh of a solution, on a period no shorter than that one's, which holds its
    /// window.
    fn answer_on(&self, solution: &Solution) -> Result<PeriodicAnswer, InversionError> {
        let own = self.padding.period_len(self.motion.grid().len)?;
        let that = (solution.band.period_s / self.motion.grid().step_s).ceil() as usize;
        let period = self.period(own.max(fast_length(that)))?;
        let forcing = self.asked(&period).of(&*solution.model);
        Ok(PeriodicAnswer::of(forcing, Arc::clone(&period))?)
    }

    /// The window of a solution at this motion's own step.
    fn grid_of(&self, solution: &Solution) -> TimeGrid {
        let (window, grid) = (&solution.grid, self.motion.grid());
        let first = ((window.time_s(0) - grid.time_s(0)) / grid.step_s).round() as i64;
        let len = (window.duration_s() / grid.step_s).round() as usize + 1;
        TimeGrid { first, len, ..grid }
    }

    /// Measures what half the step changes of a solution whose band the samples limit.
    pub(super) fn measure_step(&self, solution: &mut Solution) -> Result<(), InversionError> {
        // A motion that cannot be sampled twice as often has no such number.
        let Ok(finer) = self.motion.twice_as_often() else { return Ok(()) };
        let (link, first_zero) = (self.link, solution.first_zero_per_s);
        let problem = Problem::new(link, &finer, self.analysis, first_zero, &Unwatched)?;
        let answer = problem.answer_on(solution)?;
        let grid = problem.grid_of(solution);
        let pair = &answer.period.spectrum.pair;
        let apart = |coarse: &[f64], fine: &[f64]| {
            let pairs = coarse.iter().zip(fine.iter().step_by(2));
            pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
        };
        let off = |coarse: &[f64], period: &[f64]| {
            let fine = cut(period, &grid);
            apart(coarse, &fine) / largest(&fine)
        };
        let torque = off(&solution.torque_n_m, &answer.torque_n_m);
        let tip = answer.period.histories(&finer);
        let tip_m = cut(&tip.displacement_m, &grid);
        let hub = HubMotion {
            period: &answer.period,
            excess_amplitudes_rad: &answer.hub.excess_angle_rad,
            tail: solution.hub_tail,
            per_length: 1.0 / self.link.length_m(),
        };
        let rates = [&tip.velocity_m_s, &tip.acceleration_m_s2].map(|tip| cut(tip, &grid));
        let angle_rad = hub.on(&grid, &tip_m, 0);
        let rate_rad_s = hub.on(&grid, &rates[0], 1);
        let acceleration_rad_s2 = hub.on(&grid, &rates[1], 2);
        let share = |coarse: &[f64], fine: &[f64]| apart(coarse, fine) / largest(fine);
        let turn_rad = apart(&solution.hub_angle_rad, &angle_rad);
        let turned_rad: Vec<f64> = angle_rad.iter().map(|angle| angle - angle_rad[0]).collect();
        let tip_change_m = apart(&solution.tip.displacement_m, &tip_m);
        let root = pair.samples(&answer.hub.root_moment_n_m);
        let forcing = problem.asked(&answer.period).of(&*solution.model);
        let motor = solution.motor().zip(forcing.motor_spectra(&answer.hub));
        let motor = motor.map(|(coarse, fine)| {
            let of = |coarse: &[f64], fine| off(coarse, &pair.samples(fine));
            (of(&coarse.torque_n_m, fine.torque_n_m), of(&coarse.rate_rad_s, fine.rate_rad_s))
        });
        let steps = PerQuantity {
            torque,
            hub_angle: turn_rad / largest(&turned_rad),
            hub_rate: share(&solution.hub_rate_rad_s, &rate_rad_s),
            hub_acceleration: Some(share(solution.hub_acceleration_rad_s2(), &acceleration_rad_s2)),
            displacement: Some(tip_change_m.max(turn_rad * self.link.length_m()) / tip.way_m()),
            bending_moment: Some(off(&solution.root_moment_n_m, &root)),
            motor_torque: motor.map(|(torque, _)| torque),
            motor_rate: motor.map(|(_, rate)| rate),
        };
        let errors = &mut solution.accuracy.errors;
        *errors = errors.zip(&steps, |errors, step| QuantityErrors { step: Some(step), ..errors });
        Ok(())
    }
}
