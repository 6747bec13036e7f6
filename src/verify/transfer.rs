use std::f64::consts::TAU;

use super::check::{Check, Question};
use crate::inverse::Solution;
use crate::modal::REPORTED_MODES;
use crate::model::{Dense, KeptModes, MOST_ELEMENTS_OF_DENSE_SOLVE, Model};
use crate::numeric::magnitude;

/// Frequencies at which the dense system is solved.
const FREQUENCIES: usize = 9;

/// How well both agree where round-off does not spoil the dense solve.
const AGREEMENT: f64 = 1e-9;

/// Round-off of the dense solve from which on it tells nothing.
const SPOILT: f64 = 1e-3;

/// The transfer from tip to torque against the paper's dense system at frequencies around the first
/// modes, where the torque is.
pub(super) fn dense_transfer(solution: &Solution) -> Check {
    let question =
        Question { name: "dense_transfer", what: "T/a_tip of the paper's dense H", of: "T/a_tip" };
    if solution.model.kept_modes() != KeptModes::All {
        return question.not_measured("the link is reduced to few modes".into());
    }
    let elements = solution.mesh().elements().len();
    if elements > MOST_ELEMENTS_OF_DENSE_SOLVE {
        return question.not_measured(format!(
            "{elements} elements, more than the {MOST_ELEMENTS_OF_DENSE_SOLVE} that are factorised"
        ));
    }
    let Some(dense) = Dense::assemble(solution.model.on_mesh().clone()) else {
        return question.not_measured("its modes are no finite numbers".into());
    };
    let modes = solution.natural_frequencies_rad_s(REPORTED_MODES);
    let first = modes.first().copied().unwrap_or(TAU / solution.band.period_s);
    let (low, high) = (0.3 * first, 3.0 * modes.last().copied().unwrap_or(first));
    let (mut worst, mut bound) = (0.0_f64, AGREEMENT);
    for k in 0..FREQUENCIES {
        // Between poles and zeros of an undamped link none of these is likely to fall on one.
        let omega = low * libm::pow(high / low, (k as f64 + 0.37) / FREQUENCIES as f64);
        let exact = solution.model.tip_transfer(omega).inertia_kg_m;
        let found = dense.tip_transfer(omega).inertia_kg_m;
        worst = worst.max(magnitude(found - exact) / magnitude(exact));
        bound = bound.max(dense.round_off(omega));
    }
    if bound > SPOILT {
        return question.not_measured(format!("its round-off may be {bound:.1e}"));
    }
    question.measured(worst, bound)
}
