//! What half the step of the motion changes.

use super::check::{Check, Question};
use super::report::{Answer, CHOSEN, VerificationError};
use crate::inverse::{Solution, torques_over_window};
use crate::numeric::largest;

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
    let Answer { link, motion, analysis, solution, .. } = answer;
    let finer = torques_over_window(solution, link, &motion.twice_as_often()?, analysis)?;
    let torque = torque.measured(torque_change(&solution.torque_n_m, &finer.hub_n_m), CHOSEN);
    let motor_n_m = finer.motor_n_m.as_deref();
    let motor = motor_change(solution, motor_n_m).map(|change| motor.measured(change, CHOSEN));
    Ok(std::iter::once(torque).chain(motor).collect())
}

/// Change of the torque, root mean square over root mean square.
///
/// Not at the worst sample: where a motion begins or ends with a kink of its acceleration, the
/// torque has a spike that grows ever narrower with the step and never settles, and moves next to
/// nothing.
fn torque_change(own: &[f64], finer: &[f64]) -> f64 {
    let pairs = own.iter().zip(finer.iter().step_by(2));
    let (difference, whole) = pairs.fold((0.0, 0.0), |(difference, whole), (a, b)| {
        (difference + (a - b).powi(2), whole + b * b)
    });
    (difference / whole).sqrt()
}

/// Largest change of the motor's torque over its peak; none without a drive.
///
/// At the worst sample: the motor must turn its rotor as the spike says.
fn motor_change(solution: &Solution, finer: Option<&[f64]>) -> Option<f64> {
    // Measured by the inversion itself where the step limits the band.
    let measured = solution.accuracy.errors.motor_torque.and_then(|errors| errors.step);
    measured.or_else(|| {
        let (own, finer) = (solution.motor()?.torque_n_m, finer?);
        let pairs = own.iter().zip(finer.iter().step_by(2));
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, |most: f64, change| {
            if change.is_nan() || change > most { change } else { most }
        });
        Some(most / largest(finer))
    })
}
