use super::check::{Answer, Check, VerificationError};
use super::estimates::{Estimates, tip_deflection, within_limits};
use super::playback::{Played, played, tip_solved};
use super::recomputed::{dense_transfer, with_the_step_halved};

/// The checks of a solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// The checks, in the order in which they are shown.
    pub checks: Vec<Check>,
}

/// Checks a solution by other means:
///
/// - the written torque, played on the link with its own damping law and with viscous damping;
/// - the solved tip against the wanted motion;
/// - the torque with elements halved and with the step halved;
/// - the rest of the torque at the window's edge;
/// - the transfer against the paper's dense system at sample frequencies;
/// - the balance of energy;
/// - the size of the deflections;
/// - the limits of the link file.
///
/// # Errors
/// [`VerificationError`].
pub fn verify(answer: &Answer) -> Result<Verification, VerificationError> {
    let Answer { limits, solution, .. } = answer;
    let wanted = solution.motion.target(solution.grid.time_s(0), solution.grid.end_s());
    let Played { tip: mut checks, energy } = played(answer, &wanted)?;
    checks.extend(tip_solved(answer, &wanted));
    let Estimates { mesh, window, modes } = Estimates::of(answer);
    checks.push(mesh);
    checks.extend(with_the_step_halved(answer)?);
    checks.push(window);
    checks.extend(modes);
    checks.extend([dense_transfer(solution), energy, tip_deflection(solution)]);
    checks.extend(within_limits(limits, solution));
    Ok(Verification { checks })
}

impl Verification {
    /// The checks that are beyond their bounds.
    pub fn failed(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.fails())
    }
}
