//! A simulated tip against the wanted motion.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::link::Arm;
use crate::motion::{ArmPath, Prescribed, TipTarget};
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid, rounded};
use crate::response::Played;

/// Wanted places of the tip over time.
#[derive(Debug, Clone, PartialEq)]
pub struct TipPlaces {
    /// Their times.
    pub grid: TimeGrid,
    /// Displacement of a link's tip in m, or x and y of an arm's.
    pub at_m: Vec<Vec<f64>>,
}

impl From<&TipTarget> for TipPlaces {
    fn from(target: &TipTarget) -> Self {
        Self { grid: target.grid(), at_m: vec![target.displacement_m().to_vec()] }
    }
}

impl TipPlaces {
    /// The tip of an arm along its path, with the rests around it, between two times in s.
    pub fn of_path(path: &ArmPath, arm: &Arm, [from_s, until_s]: [f64; 2]) -> Self {
        let (grid, coordinates) = path.between(from_s, until_s);
        let lengths_m = arm.lengths_m();
        let carriage = arm.carriage().filter(|_| path.has_carriage());
        let along = |part: fn(f64) -> f64, axis: usize| {
            let base_m = |k: usize| {
                carriage.map_or(0.0, |own| own.axis[axis] * coordinates[lengths_m.len()][k])
            };
            let at = |k: usize| {
                let links = coordinates.iter().zip(&lengths_m).map(|(own, m)| m * part(own[k]));
                links.sum::<f64>() + base_m(k)
            };
            (0..grid.len).map(at).collect()
        };
        let at_m = match path.prescribed() {
            Prescribed::Tip => coordinates[..2].to_vec(),
            Prescribed::Angles => vec![along(libm::cos, 0), along(libm::sin, 1)],
        };
        Self { grid, at_m }
    }
}

/// Largest travel of the tip before the target's first sample, relative to the target's travel.
const MOVED_BEFORE: f64 = 1e-2;

/// Distance of a simulated tip from the wanted motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TipError {
    /// Largest distance in m.
    pub worst_m: f64,
    /// Largest distance relative to the largest distance of the wanted motion from its start.
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

/// A target that begins after the tip has moved. Its first displacement counts as that of the link at rest.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
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

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        "use a target that begins before the tip moves"
    }
}

/// Reason against a comparison with a target.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TargetError {
    /// The target ends after the simulation.
    #[error(
        "the target ends at {} s, but must not outlast the simulation, which ends at {} s",
        rounded(*end_s, 12),
        rounded(*simulated_s, 12)
    )]
    EndsLate {
        /// Last time of the target in s.
        end_s: f64,
        /// Last time of the simulation in s.
        simulated_s: f64,
    },
    /// The target ends before the simulation begins.
    #[error(
        "the target ends at {} s, but must last beyond the beginning of the simulation at {} s",
        rounded(*end_s, 12),
        rounded(*simulated_s, 12)
    )]
    EndsEarly {
        /// Last time of the target in s.
        end_s: f64,
        /// First time of the simulation in s.
        simulated_s: f64,
    },
    /// The target does not move.
    #[error("the target stands still in all samples, but must move")]
    NoMotion,
}

impl TargetError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::EndsLate { .. } => Some("simulate longer, or cut the target"),
            Self::EndsEarly { .. } => Some("the times of both must count from the same instant"),
            Self::NoMotion => None,
        }
    }
}

/// A wanted tip, and the distance of the simulated one from it, at the target's times.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedTarget {
    /// Times of the target.
    pub grid: TimeGrid,
    /// Wanted place of the tip in m: its displacement, or x and y of an arm's.
    pub wanted_m: Vec<Vec<f64>>,
    /// Simulated less wanted displacement in m; for an arm the distance.
    pub error_m: Vec<f64>,
    /// Numbers of the error.
    pub tip_error: TipError,
}

impl FollowedTarget {
    /// Compares the tip of a simulation with a wanted one at the target's own times.
    ///
    /// The tip rests before the simulation's first sample; between samples a cubic spline interpolates.
    ///
    /// # Errors
    /// [`TargetError`].
    pub fn of(played: &Played, target: &TipPlaces) -> Result<Self, TargetError> {
        let splines = played.tip.iter().map(|axis| &axis.displacement_m);
        let splines = splines.map(|own| CubicSpline::uniform(own, SplineEnds::NotAKnot));
        let splines: Vec<CubicSpline> = splines.collect();
        let (grid, wanted) = (target.grid, &target.at_m);
        let apart = |from: &dyn Fn(usize) -> f64, to: &dyn Fn(usize) -> f64| {
            let parts: Vec<f64> = (0..wanted.len()).map(|axis| from(axis) - to(axis)).collect();
            match parts[..] {
                // The displacement of one link has a sign.
                [along_m] => along_m,
                ref parts => parts.iter().map(|part| part * part).sum::<f64>().sqrt(),
            }
        };
        let wanted_m = |k: usize| move |axis: usize| wanted[axis][k];
        let from_start = |k: usize| apart(&wanted_m(k), &wanted_m(0)).abs();
        let travel_m = (0..grid.len).map(from_start).fold(0.0, f64::max);
        let at = Sampling::of(played.grid, grid, travel_m)?;
        let (splines, at) = (&splines, &at);
        let tip_m = |k: usize| move |axis: usize| splines[axis].value(at.place(k));
        let error_m: Vec<f64> = (0..grid.len).map(|k| apart(&tip_m(k), &wanted_m(k))).collect();
        let start_m = |axis: usize| played.tip[axis].displacement_m[0];
        let moved_m = apart(&tip_m(0), &start_m).abs();
        let tip_error = TipError::among(&error_m, (&grid, travel_m), moved_m);
        Ok(Self { grid, wanted_m: wanted.clone(), error_m, tip_error })
    }
}

/// A [`FollowedTarget`] as read back from a folder.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredTarget {
    /// Times of the target in s.
    pub times_s: Vec<f64>,
    /// Wanted place of the tip in m: its displacement, or x and y of an arm's.
    pub wanted_m: Vec<Vec<f64>>,
    /// Distance of the tip from its wanted place in m.
    pub error_m: Vec<f64>,
}

impl TipError {
    /// Numbers of the errors in m at the target's times, for a tip that moved by `moved_m` before them.
    pub(crate) fn among(errors: &[f64], (grid, travel_m): (&TimeGrid, f64), moved_m: f64) -> Self {
        let larger = |a: &usize, b: &usize| errors[*a].abs().total_cmp(&errors[*b].abs());
        let worst = (0..errors.len()).max_by(larger).unwrap_or(0);
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let late = LateTarget { start_s: grid.time_s(0), moved_m };
        Self {
            worst_m: errors[worst].abs(),
            share: errors[worst].abs() / travel_m,
            time_s: grid.time_s(worst),
            rms_m: (squares / errors.len() as f64).sqrt(),
            final_m: errors[errors.len() - 1],
            late: (moved_m > MOVED_BEFORE * travel_m).then_some(late),
        }
    }
}

/// The samples of a simulation at times of a target.
struct Sampling {
    own: TimeGrid,
    target: TimeGrid,
}

impl Sampling {
    fn of(own: TimeGrid, target: TimeGrid, travel_m: f64) -> Result<Self, TargetError> {
        if travel_m == 0.0 {
            return Err(TargetError::NoMotion);
        }
        let sampling = Self { own, target };
        if sampling.at(target.len - 1) > (own.len - 1) as f64 + 1e-6 {
            let (end_s, simulated_s) = (target.end_s(), own.time_s(own.len - 1));
            return Err(TargetError::EndsLate { end_s, simulated_s });
        }
        if sampling.at(target.len - 1) <= 0.0 {
            let (end_s, simulated_s) = (target.end_s(), own.time_s(0));
            return Err(TargetError::EndsEarly { end_s, simulated_s });
        }
        Ok(sampling)
    }

    fn at(&self, sample: usize) -> f64 {
        (self.target.time_s(sample) - self.own.time_s(0)) / self.own.step_s
    }

    /// Position of a time of the target among the samples.
    fn place(&self, sample: usize) -> f64 {
        self.at(sample).clamp(0.0, (self.own.len - 1) as f64)
    }
}
