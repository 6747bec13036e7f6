//! Samples of a tip motion, and their checks.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::error::MotionError;
use crate::numeric::{TimeGrid, largest};

/// Share of the peak acceleration below which the tip counts as at rest.
const MOTION_THRESHOLD: f64 = 1e-6;

/// Longest period, in lengths of the motion, for which the transform must not overflow.
const PERIODS: f64 = 64.0;

/// Smallest peak acceleration in m/s²: the squares of its amplitudes do not underflow.
const LEAST_M_S2: f64 = 1e-120;

/// End velocity over peak velocity up to which displacement samples count as at rest.
const REST_TOLERANCE: f64 = 1e-2;

/// End velocity over peak velocity up to which it counts as an effect of few digits, and is corrected.
pub(super) const FEW_DIGITS: f64 = 1e-3;

/// Sampled columns of a tip motion, in SI, of equal length.
///
/// At least one of `acceleration_m_s2` and `displacement_m` is present.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MotionColumns {
    /// Time in s.
    pub time_s: Vec<f64>,
    /// Tip acceleration in m/s².
    pub acceleration_m_s2: Option<Vec<f64>>,
    /// Tip velocity in m/s.
    pub velocity_m_s: Option<Vec<f64>>,
    /// Tip displacement along the arc in m.
    pub displacement_m: Option<Vec<f64>>,
}

/// Tip motion before the first sample and after the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// The tip is at rest.
    #[default]
    AtRest,
    /// The tip has a constant velocity before, and another one after.
    Moving,
    /// The tip repeats the samples: the first follows the last, one step later.
    Periodic,
}

/// Checked samples of a tip motion. A clone shares them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Samples {
    pub(super) grid: TimeGrid,
    pub(super) source: Arc<Source>,
    /// Displacement before the motion in m.
    pub(super) initial_displacement_m: f64,
    /// Displacement after the motion minus displacement before it, in m; for a tip that moves at its ends, last sample
    /// minus first; for a periodic motion, the travel of one cycle.
    pub(super) travel_m: f64,
    pub(super) ends: Ends,
    /// Velocities in m/s before the motion and after it; for a periodic motion, the mean velocity.
    pub(super) velocities_m_s: [f64; 2],
}

/// Column that defines a motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Source {
    /// Accelerations in m/s².
    Acceleration(Vec<f64>),
    /// Displacements in m, and their second differences over the squared step in m/s².
    Displacement { samples: Vec<f64>, second_differences: Vec<f64> },
}

impl Samples {
    /// The input displacements in m; empty for accelerations.
    pub(super) fn displacements_m(&self) -> &[f64] {
        match &*self.source {
            Source::Displacement { samples, .. } => samples,
            Source::Acceleration(_) => &[],
        }
    }

    /// Accelerations in m/s², or second differences of displacements over the squared step.
    pub(super) fn forcing_m_s2(&self) -> &[f64] {
        match &*self.source {
            Source::Acceleration(samples) => samples,
            Source::Displacement { second_differences, .. } => second_differences,
        }
    }

    /// Smallest even number of samples that contains whole cycles of a periodic motion.
    pub(super) fn cycles(&self) -> Option<usize> {
        let given = self.grid.len;
        let len = if given.is_multiple_of(2) { given } else { 2 * given };
        (self.ends == Ends::Periodic).then_some(len)
    }

    /// The forcing over a period of `len` samples: several cycles of a periodic motion, otherwise padded with zeros.
    pub(super) fn forcing_over_m_s2(&self, len: usize) -> Vec<f64> {
        let own = self.forcing_m_s2();
        if self.ends == Ends::Periodic {
            return own.iter().copied().cycle().take(len).collect();
        }
        let mut samples = own.to_vec();
        samples.resize(len, 0.0);
        samples
    }

    /// Displacements in m over a period of `len` samples, for samples that are displacements; those from `seam` on
    /// precede the motion.
    pub(super) fn displacement_over_m(&self, own: &[f64], len: usize, seam: usize) -> Vec<f64> {
        let (given, step_s) = (own.len(), self.grid.step_s);
        let [before, after] = self.velocities_m_s;
        let at = |k: usize| match self.ends {
            Ends::Periodic => own[k % given] + self.travel_m * (k / given) as f64,
            _ if k < given => own[k],
            _ if k < seam => own[given - 1] + after * step_s * (k + 1 - given) as f64,
            _ => own[0] - before * step_s * (len - k) as f64,
        };
        (0..len).map(at).collect()
    }
}

impl MotionColumns {
    /// Refuses columns of different lengths, too few samples, and samples that are not finite.
    pub(super) fn check(&self) -> Result<(), MotionError> {
        let columns = [
            ("time", Some(&self.time_s)),
            ("acceleration", self.acceleration_m_s2.as_ref()),
            ("velocity", self.velocity_m_s.as_ref()),
            ("displacement", self.displacement_m.as_ref()),
        ];
        let samples = self.time_s.len();
        let is_ragged = columns.iter().any(|(_, own)| own.is_some_and(|own| own.len() != samples));
        let has_motion = self.acceleration_m_s2.is_some() || self.displacement_m.is_some();
        if is_ragged || samples < 4 || !has_motion {
            return Err(MotionError::Shape { samples });
        }
        for (column, samples) in columns {
            let bad = samples.and_then(|own| Some((own, own.iter().position(|x| !x.is_finite())?)));
            if let Some((own, sample)) = bad {
                return Err(MotionError::NotFinite { sample, column, found: own[sample] });
            }
        }
        Ok(())
    }
}

/// Refuses displacement samples that begin or end with a velocity.
///
/// The velocity at the end is extrapolated from the two outermost differences, which is exact for a constant
/// acceleration. A smoother start gives a velocity of the opposite sign, and also counts as rest.
pub(super) fn at_rest(displacement_m: &[f64], step_s: f64) -> Result<(), MotionError> {
    let differences: Vec<f64> = displacement_m.windows(2).map(|d| d[1] - d[0]).collect();
    let peak = largest(&differences);
    let last = differences.len() - 1;
    let ends =
        [(0, differences[0], differences[1]), (last + 1, differences[last], differences[last - 1])];
    for (sample, outer, inner) in ends {
        let velocity = 1.5 * outer - 0.5 * inner;
        if velocity * outer > 0.0 && velocity.abs() > REST_TOLERANCE * peak {
            return Err(MotionError::MovingAtEnd {
                sample,
                velocity_m_s: velocity / step_s,
                share: velocity.abs() / peak,
            });
        }
    }
    Ok(())
}

/// True if a Fourier transform over [`PERIODS`] times the motion does not overflow.
pub(super) fn can_be_transformed(forcing: &[f64]) -> bool {
    let sum: f64 = forcing.iter().map(|a| a.abs()).sum();
    (sum * PERIODS * forcing.len() as f64).is_finite()
}

/// Numbers of the last sample before the samples that move the tip and of the first one after them.
pub(super) fn moving_samples(forcing: &[f64]) -> Result<(usize, usize), MotionError> {
    let peak_m_s2 = largest(forcing);
    let moves = |a: &f64| a.abs() > MOTION_THRESHOLD * peak_m_s2;
    let ends = forcing.iter().position(moves).zip(forcing.iter().rposition(moves));
    let (first, last) = ends.filter(|_| peak_m_s2 > 0.0).ok_or(MotionError::NoMotion)?;
    if peak_m_s2 < LEAST_M_S2 {
        return Err(MotionError::TooSmall { peak_m_s2, least_m_s2: LEAST_M_S2 });
    }
    Ok((first.saturating_sub(1), (last + 1).min(forcing.len() - 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gentle_starts_are_at_rest_and_ramps_are_not() {
        let sampled =
            |f: fn(f64) -> f64| (0..=10).map(|k| f(f64::from(k) / 10.0)).collect::<Vec<_>>();
        // Minimum jerk and bang-bang, both with coarse steps.
        let gentle = [
            sampled(|t| t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t)),
            sampled(|t| if t < 0.5 { 2.0 * t * t } else { 1.0 - 2.0 * (1.0 - t) * (1.0 - t) }),
        ];
        for motion in gentle {
            assert_eq!(at_rest(&motion, 0.1), Ok(()));
        }
        let error = at_rest(&sampled(|t| t), 0.1).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the motion starts with a velocity of 1.000e0 m/s, 100.00 % of its peak, but must be \
             at rest there"
        );
        let half = at_rest(&sampled(|t| t * t), 0.1).unwrap_err();
        assert_eq!(half.sample(), Some(10));
    }
}
