//! Checks that compute the torque again: at half the step, and by the paper's dense system.

use std::f64::consts::TAU;

use super::check::{Answer, CHOSEN, Check, Label, VerificationError};
use crate::inverse::{Resources, Solution, torques_over_window};
use crate::modal::REPORTED_MODES;
use crate::model::{Dense, KeptModes, MOST_ELEMENTS_OF_DENSE_SOLVE, Model};
use crate::numeric::{largest, magnitude};

/// Number of frequencies at which the dense system is solved.
const FREQUENCIES: usize = 9;

/// Largest relative difference where round-off does not spoil the dense solve.
const AGREEMENT: f64 = 1e-9;

/// Round-off of the dense solve above which the comparison says nothing.
const SPOILT: f64 = 1e-3;

/// Change of the hub's torque, and of the motor's where there is a drive, with the motion sampled
/// twice as often.
pub(super) fn with_the_step_halved(answer: &Answer) -> Result<Vec<Check>, VerificationError> {
    let torque =
        Label { name: "step_halving", what: "torque with the step halved", of: "the torque, rms" };
    let motor = Label {
        name: "step_halving_motor",
        what: "motor torque with the step halved",
        of: "its peak",
    };
    let Answer { solution, memory_bytes, .. } = *answer;
    let resources = Resources { memory_bytes, ..Resources::default() };
    let finer = torques_over_window(solution, &solution.motion.twice_as_often()?, &resources)?;
    let torque = torque.measured(torque_change(&solution.torque_n_m, &finer.hub_n_m), CHOSEN);
    let motor_n_m = finer.motor_n_m.as_deref();
    let motor = motor_change(solution, motor_n_m).map(|change| motor.measured(change, CHOSEN));
    Ok(std::iter::once(torque).chain(motor).collect())
}

/// Change of the torque, root mean square over root mean square.
///
/// The worst sample would not do: where the acceleration of a motion has a kink at its begin or end,
/// the torque has a spike that becomes narrower with every shorter step, never converges, and hardly
/// moves the link.
fn torque_change(own: &[f64], finer: &[f64]) -> f64 {
    let pairs = own.iter().zip(finer.iter().step_by(2));
    let (difference, whole) = pairs.fold((0.0, 0.0), |(difference, whole), (a, b)| {
        (difference + (a - b).powi(2), whole + b * b)
    });
    (difference / whole).sqrt()
}

/// Largest change of the motor's torque over its peak; none without a drive.
///
/// Taken at the worst sample, since the motor must turn its rotor through that spike too.
fn motor_change(solution: &Solution, finer: Option<&[f64]>) -> Option<f64> {
    // The inversion has measured it where the step limits the band.
    let measured = solution.accuracy.errors.motor_torque.and_then(|errors| errors.step);
    measured.or_else(|| {
        let (own, finer) = (&solution.motor.as_ref()?.torque_n_m, finer?);
        let pairs = own.iter().zip(finer.iter().step_by(2));
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, |most: f64, change| {
            if change.is_nan() || change > most { change } else { most }
        });
        Some(most / largest(finer))
    })
}

/// The transfer from tip to torque against the paper's dense system, at frequencies around the first
/// modes.
pub(super) fn dense_transfer(solution: &Solution) -> Check {
    let label =
        Label { name: "dense_transfer", what: "T/a_tip of the paper's dense H", of: "T/a_tip" };
    if solution.model.kept_modes() != KeptModes::All {
        return label.not_measured("the link is reduced to few modes".into());
    }
    let elements = solution.mesh().elements().len();
    if elements > MOST_ELEMENTS_OF_DENSE_SOLVE {
        return label.not_measured(format!(
            "{elements} elements, more than the {MOST_ELEMENTS_OF_DENSE_SOLVE} that are factorised"
        ));
    }
    let Some(dense) = Dense::assemble(solution.model.on_mesh().clone()) else {
        return label.not_measured("its modes are no finite numbers".into());
    };
    let modes = solution.natural_frequencies_rad_s(REPORTED_MODES);
    let first = modes.first().copied().unwrap_or(TAU / solution.band.period_s);
    let (low, high) = (0.3 * first, 3.0 * modes.last().copied().unwrap_or(first));
    let (mut worst, mut bound) = (0.0_f64, AGREEMENT);
    for k in 0..FREQUENCIES {
        // The odd offset keeps these off the poles and zeros of an undamped link.
        let omega = low * libm::pow(high / low, (k as f64 + 0.37) / FREQUENCIES as f64);
        let exact = solution.model.tip_transfer(omega).inertia_kg_m;
        let found = dense.tip_transfer(omega).inertia_kg_m;
        worst = worst.max(magnitude(found - exact) / magnitude(exact));
        bound = bound.max(dense.round_off(omega));
    }
    if bound > SPOILT {
        return label.not_measured(format!("its round-off may be {bound:.1e}"));
    }
    // Round-off has other digits on every processor: a difference within the bound counts as the bound.
    label.measured(if worst <= bound { bound } else { worst }, bound)
}
