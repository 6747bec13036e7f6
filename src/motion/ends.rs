//! What the tip does before the first sample of a motion and after its last.

use super::samples::{Ends, FEW_DIGITS, MotionColumns, MotionError, moving_samples};
use crate::numeric::{extremes, largest};

/// Velocity at an end over the peak velocity from which on a velocity column says that the tip moves there.
const MOVES: f64 = 1e-2;

/// Difference of the first and the last sample over the range of all below which they are the same.
const SAME: f64 = 1e-6;

/// Second differences, over the range of the samples, that are round-off.
const ROUND_OFF: f64 = 1e-13;

impl Ends {
    /// The same, but moving where a velocity column says so of a tip that was taken to be at rest.
    #[must_use]
    pub fn said_by(self, velocity_m_s: Option<&[f64]>) -> Self {
        let Some(velocity) = velocity_m_s.filter(|_| self == Self::AtRest) else { return self };
        let [first, last] = [velocity[0], velocity[velocity.len() - 1]];
        let moves = first.abs().max(last.abs()) > MOVES * largest(velocity);
        if moves { Self::Moving } else { self }
    }

    /// Velocities in m/s before the first sample and after the last one, as far as they are known; of a periodic
    /// motion both are its mean. The second is `None` where it follows from the acceleration.
    ///
    /// # Errors
    /// [`MotionError::UnknownVelocity`] for a moving tip of which the acceleration alone is given.
    pub(super) fn velocities_m_s(
        self,
        columns: &MotionColumns,
        step_s: f64,
    ) -> Result<(f64, Option<f64>), MotionError> {
        let velocity = columns.velocity_m_s.as_deref();
        match (self, velocity) {
            (Self::AtRest, _) => Ok((0.0, Some(0.0))),
            (Self::Periodic, velocity) => {
                let mean = velocity.map_or(0.0, |v| v.iter().sum::<f64>() / v.len() as f64);
                // Of a velocity with few digits the mean is none.
                let moves = mean.abs() > FEW_DIGITS * velocity.map_or(0.0, largest);
                let mean = if moves { mean } else { 0.0 };
                Ok((mean, Some(mean)))
            }
            (Self::Moving, Some(velocity)) => Ok((velocity[0], Some(velocity[velocity.len() - 1]))),
            (Self::Moving, None) => {
                let displacement =
                    columns.displacement_m.as_deref().ok_or(MotionError::UnknownVelocity)?;
                match &columns.acceleration_m_s2 {
                    None => {
                        let reversed: Vec<f64> = displacement.iter().rev().copied().collect();
                        let (first, last) = (slope(displacement), -slope(&reversed));
                        Ok((first / step_s, Some(last / step_s)))
                    }
                    Some(acceleration) => {
                        Ok((start_velocity(displacement, acceleration, step_s), None))
                    }
                }
            }
        }
    }
}

/// True if the second differences of displacements over the squared step are round-off.
pub(super) fn is_steady(displacement_m: &[f64], second_differences: &[f64], step_s: f64) -> bool {
    let [low, high] = extremes(displacement_m);
    largest(second_differences) * step_s.powi(2) <= ROUND_OFF * (high - low)
}

/// Numbers of the samples between which the tip moves, or changes its velocity.
pub(super) fn moves(forcing_m_s2: &[f64], ends: Ends) -> Result<(usize, usize), MotionError> {
    let moving = moving_samples(forcing_m_s2).map_err(|error| match error {
        MotionError::NoMotion if ends != Ends::AtRest => MotionError::Steady,
        error => error,
    })?;
    Ok(if ends == Ends::Periodic { (0, forcing_m_s2.len() - 1) } else { moving })
}

/// Slope at the first of some samples in units per step, exact for a cubic.
fn slope(samples: &[f64]) -> f64 {
    let [a, b, c, d] = [samples[0], samples[1], samples[2], samples[3]];
    (18.0 * b - 11.0 * a - 9.0 * c + 2.0 * d) / 6.0
}

/// Velocity before the first sample with which the acceleration leads from the first displacement to the last one.
fn start_velocity(displacement_m: &[f64], acceleration_m_s2: &[f64], step_s: f64) -> f64 {
    let last = displacement_m.len() - 1;
    let moments = acceleration_m_s2.iter().enumerate().map(|(k, a)| (last - k) as f64 * a);
    let accelerated_m = moments.sum::<f64>() * step_s.powi(2);
    (displacement_m[last] - displacement_m[0] - accelerated_m) / (last as f64 * step_s)
}

/// Refuses a cycle whose last sample is its first one again: without it, the samples go on more smoothly.
pub(super) fn refuse_repetition(samples: &[f64], travel: f64) -> Result<(), MotionError> {
    let last = samples.len() - 1;
    let [low, high] = extremes(samples);
    let is_same = (samples[last] - samples[0] - travel).abs() <= SAME * (high - low);
    if !is_same || samples.len() < 2 * ORDER {
        return Ok(());
    }
    let whole = roughness(samples, travel);
    let dropped = roughness(&samples[..last], travel);
    if dropped < whole { Err(MotionError::Repeats { sample: last }) } else { Ok(()) }
}

/// Order of the differences by which samples are judged: lower ones are large where curvature changes fast.
const ORDER: usize = 6;

/// Sum of the differences over the end of a cycle.
fn roughness(samples: &[f64], travel: f64) -> f64 {
    let len = samples.len();
    let at = |k: usize| samples[k % len] + if k < len { 0.0 } else { travel };
    let mut around: Vec<f64> = (len - ORDER..len + ORDER).map(at).collect();
    for _ in 0..ORDER {
        around = around.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    around.iter().map(|difference| difference.abs()).sum()
}

/// Samples of a cycle with so many of the cycles beside it on either side.
pub(crate) fn wrapped(samples: &[f64], travel: f64, around: usize) -> Vec<f64> {
    let len = samples.len();
    let before = (0..around).map(|k| {
        let back = around - k;
        samples[(len - back % len) % len] - travel * back.div_ceil(len) as f64
    });
    let after = (0..around).map(|k| samples[k % len] + travel * (1 + k / len) as f64);
    before.chain(samples.iter().copied()).chain(after).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn cycle(len: u32, at: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..len).map(|k| at(f64::from(k) / 24.0)).collect()
    }

    #[test]
    fn a_last_row_that_is_the_first_again_is_found_wherever_the_cycle_starts() {
        for phase in [0.0, 0.1, 0.25, 0.3, 0.5, 0.77] {
            let at = |t: f64| (TAU * (t + phase)).sin() + 0.3 * (2.0 * TAU * (t + phase)).cos();
            assert_eq!(refuse_repetition(&cycle(24, at), 0.0), Ok(()), "{phase}");
            let again = refuse_repetition(&cycle(25, at), 0.0);
            assert_eq!(again, Err(MotionError::Repeats { sample: 24 }), "{phase}");
            let turning = |t: f64| 3.0 * t + at(t);
            assert_eq!(refuse_repetition(&cycle(24, turning), 3.0), Ok(()), "{phase}");
            assert!(refuse_repetition(&cycle(25, turning), 3.0).is_err(), "{phase}");
        }
        // Half a step off, the first and the last sample are equal, and no repetition.
        let between = |t: f64| (TAU * (t + 0.5 / 24.0)).cos();
        assert_eq!(refuse_repetition(&cycle(24, between), 0.0), Ok(()));
        // A cycle that rests at its end.
        let resting = |t: f64| if t < 0.5 { (TAU * t).sin().powi(4) } else { 0.0 };
        assert_eq!(refuse_repetition(&cycle(24, resting), 0.0), Ok(()));
    }

    #[test]
    fn a_cycle_goes_on_on_both_sides() {
        let all = wrapped(&[0.0, 1.0, 3.0], 6.0, 4);
        assert_eq!(all, [-9.0, -6.0, -5.0, -3.0, 0.0, 1.0, 3.0, 6.0, 7.0, 9.0, 12.0]);
    }

    #[test]
    fn velocities_at_the_ends_are_those_of_a_cubic() {
        let at = |t: f64| 2.0 * t - t * t + 0.5 * t.powi(3);
        let displacement: Vec<f64> = (0..11).map(|k| at(0.1 * f64::from(k))).collect();
        let columns = MotionColumns { displacement_m: Some(displacement), ..Default::default() };
        let (before, after) = Ends::Moving.velocities_m_s(&columns, 0.1).unwrap();
        assert!((before - 2.0).abs() < 1e-12 && (after.unwrap() - 1.5).abs() < 1e-12);
    }
}
