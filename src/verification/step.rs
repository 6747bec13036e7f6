//! What half the step of the motion changes.

use super::check::{Check, Question};
use super::report::{Answer, CHOSEN, VerificationError};
use crate::inverse::{invert, torque_over_window};
use crate::numeric::{TimeGrid, largest};

/// The hub's torque, and the motor's where there is a drive, with the motion sampled twice as often.
pub(super) fn with_the_step_halved(answer: &Answer) -> Result<Vec<Check>, VerificationError> {
    let torque = Question {
        name: "step_halving",
        what: "torque with the step halved",
        of: "the torque, rms",
    };
    let motor = Question {
        name: "step_halving_motor",
        what: "motor torque with the step halved",
        of: "its peak",
    };
    let torque = torque.measured(torque_change(answer)?, CHOSEN);
    let motor = motor_change(answer)?.map(|change| motor.measured(change, CHOSEN));
    Ok(std::iter::once(torque).chain(motor).collect())
}

/// Change of the torque, root mean square over root mean square.
///
/// Not at the worst sample: where a motion begins or ends with a kink of its acceleration, the
/// torque has a spike that grows ever narrower with the step and never settles, and moves next to
/// nothing.
fn torque_change(answer: &Answer) -> Result<f64, VerificationError> {
    let Answer { link, motion, analysis, solution, .. } = answer;
    let finer = motion.twice_as_often()?;
    let torque = torque_over_window(solution, link, &finer, analysis)?;
    let pairs = solution.torque_n_m.iter().zip(torque.iter().step_by(2));
    let (difference, whole) = pairs.fold((0.0, 0.0), |(difference, whole), (a, b)| {
        (difference + (a - b).powi(2), whole + b * b)
    });
    Ok((difference / whole).sqrt())
}

/// Largest change of the motor's torque over its peak; none without a drive.
///
/// At the worst sample: the motor must turn its rotor as the spike says.
fn motor_change(answer: &Answer) -> Result<Option<f64>, VerificationError> {
    let Answer { link, plan, motion, analysis, solution, .. } = answer;
    let Some(own) = solution.motor() else { return Ok(None) };
    // Measured by the inversion itself where the step limits the band.
    let measured = solution.accuracy.errors.motor_torque.and_then(|errors| errors.step);
    if measured.is_some() {
        return Ok(measured);
    }
    let finer = invert(link, plan, &motion.twice_as_often()?, analysis)?;
    let Some(motor) = finer.motor() else { return Ok(None) };
    let mut most = 0.0;
    for (k, torque) in own.torque_n_m.iter().enumerate() {
        let Some(row) = row_at(&finer.grid, solution.grid.time_s(k)) else { continue };
        let change = (torque - motor.torque_n_m[row]).abs();
        if change.is_nan() || change > most {
            most = change;
        }
    }
    Ok(Some(most / largest(&motor.torque_n_m)))
}

/// The row of a grid at a time, none outside of it.
fn row_at(grid: &TimeGrid, time_s: f64) -> Option<usize> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of rows, from 0 to the grid's last"
    )]
    let row = |row: f64| row as usize;
    let rows = ((time_s - grid.time_s(0)) / grid.step_s).round();
    (0.0..grid.len as f64).contains(&rows).then(|| row(rows))
}
