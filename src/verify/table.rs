//! What a torque table does to the tip.

use super::check::VerificationError;
use super::playback::turn_of_cycle_rad;
use crate::inverse::Solution;
use crate::motion::Ends;
use crate::response::{Interpolation, Play, State, Torque, simulate_on};
use crate::result::{TipError, TorqueTable};

/// Distance of the tip from the wanted motion if a table is played in place of the solved torque.
///
/// Direct dynamics play both, and the difference of their tips is added to the solved tip. Hysteretic damping has no
/// equation in time: both are played with the viscous damping that `simulate` takes for it, and what that alone changes
/// cancels.
///
/// # Errors
/// [`VerificationError`] of a link that cannot be played.
pub fn table_error(
    solution: &Solution,
    table: &TorqueTable,
    memory_bytes: Option<usize>,
) -> Result<TipError, VerificationError> {
    let (grid, tip) = (solution.grid, &solution.tip);
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let initial_tip_m = tip.displacement_m[0];
    let moving =
        State::turning(solution.link(), grid.time_s(0), [initial_tip_m, tip.velocity_m_s[0]]);
    let played = |torque_n_m: &[f64], interpolation: Interpolation| {
        let torque = Torque::new(&time_s, torque_n_m.to_vec())?;
        let play = Play {
            interpolation,
            initial_tip_m,
            memory_bytes,
            is_large: solution.second_order().is_some(),
            state: (solution.motion.ends() == Ends::Moving).then_some(&moving),
            cycle_turn_rad: turn_of_cycle_rad(solution),
            ..Play::of(&torque)
        };
        let simulation = simulate_on(solution.link(), solution.mesh().clone(), &play)?;
        Ok::<_, VerificationError>(simulation.tip.displacement_m)
    };
    let of_table = played(table.whole_n_m(), table.interpolation())?;
    let of_solved = played(&solution.torque_n_m, Interpolation::Cubic)?;
    let wanted = solution.motion.target(grid.time_s(0), grid.end_s());
    let solved = tip.displacement_m.iter().zip(wanted.displacement_m());
    let errors = of_table.iter().zip(&of_solved).zip(solved);
    let errors: Vec<f64> = errors.map(|((t, s), (tip, wanted))| t - s + tip - wanted).collect();
    Ok(TipError::among(&errors, (&grid, solution.tip_travel_m()), 0.0))
}
