//! Tip motion before the first sample and after the last.

use super::error::MotionError;
use super::samples::{Ends, MotionColumns, moving_samples};
use crate::numeric::{extremes, largest};

/// Velocity at an end, over the peak velocity, above which a velocity column counts as moving there, and the share by
/// which the next samples may differ. A tip that accelerates there has not moved all along.
const MOVES: f64 = 1e-2;
const STEADY: f64 = 0.1;

/// Acceleration at an end, over the largest, above which a moving tip counts as accelerating there.
const ACCELERATES: f64 = 2e-2;

/// Mean velocity over the peak velocity below which it is round-off.
const NO_MEAN: f64 = 1e-9;

/// Step from the last sample to the next cycle, over the largest step between samples, above which a cycle does not
/// return. With a velocity column, distances of the steps from it replace the steps.
const JUMP: f64 = 3.0;

/// Difference of the first and the last sample, over the range of all, below which they are equal.
const SAME: f64 = 1e-6;

/// Roughness of a cycle over the range of its samples. Up to it, the last sample is a repetition only if leaving it out
/// lowers the roughness to a tenth: true for a wave at its crest, false for a bell nearly at rest.
const FLAT: f64 = 1e-5;

/// Second differences over the range of the samples below which they are round-off.
const ROUND_OFF: f64 = 1e-13;

impl Ends {
    /// Replaces rest at the ends by motion if a velocity column shows it.
    #[must_use]
    pub fn said_by(self, velocity_m_s: Option<&[f64]>) -> Self {
        let Some(velocity) = velocity_m_s.filter(|_| self == Self::AtRest) else { return self };
        let least = MOVES * largest(velocity);
        let moves = |end: f64, mut near: std::slice::Iter<f64>| {
            end.abs() > least && near.all(|own| (own - end).abs() <= STEADY * end.abs())
        };
        let last = velocity.len() - 1;
        let starts = moves(velocity[0], velocity[..4].iter());
        let ends = moves(velocity[last], velocity[last - 3..].iter());
        if starts || ends { Self::Moving } else { self }
    }

    /// Velocities in m/s before the first sample and after the last one; for a periodic motion both are the mean
    /// velocity. The second is `None` if it follows from the acceleration.
    ///
    /// # Errors
    /// [`MotionError::UnknownVelocity`] for a moving tip with only an acceleration column.
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
                let moves = mean.abs() > NO_MEAN * velocity.map_or(0.0, largest);
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

/// True if the second differences of displacements, over the squared step, are round-off.
pub(super) fn is_steady(displacement_m: &[f64], second_differences: &[f64], step_s: f64) -> bool {
    let [low, high] = extremes(displacement_m);
    largest(second_differences) * step_s.powi(2) <= ROUND_OFF * (high - low)
}

/// Numbers of the samples between which the tip moves, or changes its velocity in a motion that moves at its ends.
pub(super) fn moves(forcing_m_s2: &[f64], ends: Ends) -> Result<(usize, usize), MotionError> {
    let moving = moving_samples(forcing_m_s2).map_err(|error| match error {
        MotionError::NoMotion if ends != Ends::AtRest => MotionError::Steady,
        error => error,
    })?;
    if ends == Ends::Moving {
        refuse_acceleration(forcing_m_s2)?;
    }
    Ok(if ends == Ends::Periodic { (0, forcing_m_s2.len() - 1) } else { moving })
}

/// Slope at the first of some samples per step, exact for a cubic.
fn slope(samples: &[f64]) -> f64 {
    let [a, b, c, d] = [samples[0], samples[1], samples[2], samples[3]];
    (18.0 * b - 11.0 * a - 9.0 * c + 2.0 * d) / 6.0
}

/// Velocity before the first sample, chosen so that the acceleration leads from the first displacement to the last one.
fn start_velocity(displacement_m: &[f64], acceleration_m_s2: &[f64], step_s: f64) -> f64 {
    let last = displacement_m.len() - 1;
    let moments = acceleration_m_s2.iter().enumerate().map(|(k, a)| (last - k) as f64 * a);
    let accelerated_m = moments.sum::<f64>() * step_s.powi(2);
    (displacement_m[last] - displacement_m[0] - accelerated_m) / (last as f64 * step_s)
}

/// Refuses a cycle if the last sample of a column repeats its first one.
pub(super) fn refuse_repetition(columns: &MotionColumns, step_s: f64) -> Result<(), MotionError> {
    let last = columns.time_s.len() - 1;
    let velocity = columns.velocity_m_s.as_deref();
    let travel_m = velocity.map_or(0.0, |v| v[..last].iter().sum::<f64>() * step_s);
    let repeats = [
        columns.acceleration_m_s2.as_deref().map(|own| is_repeated(own, 0.0)),
        velocity.map(|own| is_repeated(own, 0.0)),
        columns.displacement_m.as_deref().map(|own| is_repeated(own, travel_m)),
    ];
    if repeats.contains(&Some(true)) {
        return Err(MotionError::Repeats { sample: last });
    }
    Ok(())
}

/// True if the last sample of a cycle repeats its first one: the cycle is smoother without it.
pub(crate) fn is_repeated(samples: &[f64], travel: f64) -> bool {
    let last = samples.len() - 1;
    let [low, high] = extremes(samples);
    let is_same = (samples[last] - samples[0] - travel).abs() <= SAME * (high - low);
    let order = MOST_ORDER.min(last / 2);
    if !is_same || order <= 1 {
        return false;
    }
    let [with, without] = [samples, &samples[..last]].map(|own| roughness(own, travel, order));
    let share = if with > FLAT * (high - low) { 1.0 } else { 0.1 };
    without < share * with
}

/// Highest order of the differences that measure roughness: lower ones are large where curvature changes fast.
const MOST_ORDER: usize = 6;

/// Sum of absolute differences of an order across the end of a cycle.
fn roughness(samples: &[f64], travel: f64, order: usize) -> f64 {
    let len = samples.len();
    let at = |k: usize| samples[k % len] + if k < len { 0.0 } else { travel };
    let mut around: Vec<f64> = (len - order..len + order).map(at).collect();
    for _ in 0..order {
        around = around.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    around.iter().map(|difference| difference.abs()).sum()
}

/// Displacement in m over a cycle: 0 if the displacement returns, otherwise the travel from the velocity column.
///
/// # Errors
/// [`MotionError::Unclosed`] if the displacement fits neither.
pub(super) fn travel_of_cycle_m(
    displacement_m: &[f64],
    velocity_m_s: Option<&[f64]>,
    (mean_m_s, step_s): (f64, f64),
) -> Result<f64, MotionError> {
    let last = displacement_m.len() - 1;
    let steps = |k: usize| displacement_m[k + 1] - displacement_m[k];
    let back_m = displacement_m[0] - displacement_m[last];
    let travel_m = mean_m_s * step_s * displacement_m.len() as f64;
    let Some(velocity) = velocity_m_s else {
        // Derived from a cycle that was already checked.
        if mean_m_s != 0.0 {
            return Ok(travel_m);
        }
        let most = (0..last).fold(0.0_f64, |most, k| most.max(steps(k).abs()));
        return if back_m.abs() <= JUMP * most {
            Ok(0.0)
        } else {
            Err(MotionError::Unclosed { sample: last, off_m: back_m })
        };
    };
    let said = |k: usize, next: usize| 0.5 * step_s * (velocity[k] + velocity[next]);
    let most = (0..last).fold(0.0_f64, |most, k| most.max((steps(k) - said(k, k + 1)).abs()));
    let [low, high] = extremes(displacement_m);
    let allowed = JUMP * most + NO_MEAN * (high - low);
    let off = |travel_m: f64| back_m + travel_m - said(last, 0);
    let found = [0.0, travel_m].into_iter().find(|travel_m| off(*travel_m).abs() <= allowed);
    found.ok_or(MotionError::Unclosed { sample: last, off_m: off(travel_m) })
}

/// Refuses a tip that accelerates at an end where it should have constant velocity.
fn refuse_acceleration(forcing_m_s2: &[f64]) -> Result<(), MotionError> {
    let last = forcing_m_s2.len() - 1;
    let peak = largest(forcing_m_s2);
    let accelerates = |k: &usize| forcing_m_s2[*k].abs() > ACCELERATES * peak;
    [0, last].into_iter().find(accelerates).map_or(Ok(()), |sample| {
        let share = forcing_m_s2[sample].abs() / peak;
        Err(MotionError::AcceleratingEnd { sample, share })
    })
}

/// Samples of a cycle with `around` samples of the adjacent cycles on either side.
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
            assert!(!is_repeated(&cycle(24, at), 0.0), "{phase}");
            assert!(is_repeated(&cycle(25, at), 0.0), "{phase}");
            let turning = |t: f64| 3.0 * t + at(t);
            assert!(!is_repeated(&cycle(24, turning), 3.0), "{phase}");
            assert!(is_repeated(&cycle(25, turning), 3.0), "{phase}");
        }
        // At a crest, with many samples.
        let crest = |t: f64| (TAU * t / 400.0).cos();
        assert!(!is_repeated(&cycle(9600, crest), 0.0) && is_repeated(&cycle(9601, crest), 0.0));
        // Half a step off, the first and the last sample are equal without a repetition.
        let between = |t: f64| (TAU * (t + 0.5 / 24.0)).cos();
        assert!(!is_repeated(&cycle(24, between), 0.0));
        // A cycle that rests at its end.
        let resting = |t: f64| if t < 0.5 { (TAU * t).sin().powi(4) } else { 0.0 };
        assert!(!is_repeated(&cycle(24, resting), 0.0));
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
