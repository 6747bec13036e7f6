use thiserror::Error;

use crate::motion::TipTarget;
use crate::numeric::{CubicSpline, SplineEnds, rounded};
use crate::response::Simulation;

/// Largest travel of the tip before the target's first sample, relative to the target's travel.
const MOVED_BEFORE: f64 = 1e-2;

/// Distance of a simulated tip from the wanted motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipError {
    /// Largest distance in m.
    pub worst_m: f64,
    /// The same, relative to the largest distance of the wanted motion from its start.
    pub share: f64,
    /// Time of the largest distance in s.
    pub time_s: f64,
    /// Root mean square of the distance over the target's samples in m.
    pub rms_m: f64,
    /// Distance at the target's last sample in m, simulated less wanted.
    pub final_m: f64,
    /// Set if the tip moves before the target begins.
    pub late: Option<LateTarget>,
}

/// A target that begins after the tip has moved: its first displacement is taken as that of the link at
/// rest.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "the target begins at {} s, when the tip has moved by {:?} m: its first displacement is taken as \
     that of the link at rest",
    rounded(*start_s, 12),
    rounded(*moved_m, 4)
)]
pub struct LateTarget {
    /// First time of the target in s.
    pub start_s: f64,
    /// Travel of the simulated tip until then in m.
    pub moved_m: f64,
}

impl LateTarget {
    /// Name of the warning, for machines.
    pub fn kind(&self) -> &'static str {
        "late_target"
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "a target that begins before the tip moves"
    }
}

/// Why a simulation is not compared with a target.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TargetError {
    /// The target ends after the simulation.
    #[error(
        "the target ends at {} s, but must not go on after the simulation, which ends at {} s",
        rounded(*end_s, 12),
        rounded(*simulated_s, 12)
    )]
    EndsLate {
        /// Last time of the target in s.
        end_s: f64,
        /// Last time of the simulation in s.
        simulated_s: f64,
    },
    /// The target does not move.
    #[error("the target stands still in all samples, but must move")]
    NoMotion,
}

impl TargetError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::EndsLate { .. } => Some("simulate longer, or cut the target"),
            Self::NoMotion => None,
        }
    }
}

impl TipError {
    /// Compares a simulation with a wanted displacement at the target's own times.
    ///
    /// The tip rests before the simulation's first sample; between samples a cubic spline interpolates.
    ///
    /// # Errors
    /// [`TargetError`].
    pub fn of(simulation: &Simulation, target: &TipTarget) -> Result<Self, TargetError> {
        let (own, grid, wanted_m) = (&simulation.grid, target.grid(), target.displacement_m());
        let spline = CubicSpline::uniform(&simulation.tip.displacement_m, SplineEnds::NotAKnot);
        let travel_m = target.largest_travel_m();
        if travel_m == 0.0 {
            return Err(TargetError::NoMotion);
        }
        let last = (own.len - 1) as f64;
        let at = |k: usize| (grid.time_s(k) - own.time_s(0)) / own.step_s;
        if at(grid.len - 1) > last + 1e-6 {
            let (end_s, simulated_s) = (target.grid().end_s(), own.time_s(own.len - 1));
            return Err(TargetError::EndsLate { end_s, simulated_s });
        }
        let tip_m = |k: usize| spline.value(at(k).clamp(0.0, last));
        let strays = |(k, wanted): (usize, &f64)| tip_m(k) - wanted;
        let errors: Vec<f64> = wanted_m.iter().enumerate().map(strays).collect();
        let larger = |a: &usize, b: &usize| errors[*a].abs().total_cmp(&errors[*b].abs());
        let worst = (0..errors.len()).max_by(larger).unwrap_or(0);
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let moved_m = (tip_m(0) - simulation.tip.displacement_m[0]).abs();
        let late = LateTarget { start_s: grid.time_s(0), moved_m };
        Ok(Self {
            worst_m: errors[worst].abs(),
            share: errors[worst].abs() / travel_m,
            time_s: grid.time_s(worst),
            rms_m: (squares / errors.len() as f64).sqrt(),
            final_m: errors[errors.len() - 1],
            late: (moved_m > MOVED_BEFORE * travel_m).then_some(late),
        })
    }
}
