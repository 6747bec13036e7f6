//! The same motion over another distance, duration or step.

use super::error::MotionError;
use super::samples::{MotionColumns, Source};
use super::tip_motion::{EndVelocity, TipMotion};
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid};

/// Factors on a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionScale {
    /// On the displacement; not 0.
    pub distance: f64,
    /// On the duration, the first sample's time kept; above 0.
    pub duration: f64,
}

impl Default for MotionScale {
    fn default() -> Self {
        Self { distance: 1.0, duration: 1.0 }
    }
}

impl TipMotion {
    /// The same motion over another distance and duration: as many samples, the step and the rests
    /// scaled with the duration.
    ///
    /// # Errors
    /// [`MotionError::Scale`] for factors out of their range, and as [`TipMotion::new`] where the scaled
    /// numbers are too large.
    pub fn scaled(&self, scale: MotionScale) -> Result<Self, MotionError> {
        if scale == MotionScale::default() {
            return Ok(self.clone());
        }
        let MotionScale { distance, duration } = scale;
        let possible = [distance, duration, duration.recip()].iter().all(|x| x.is_finite());
        if !possible || distance == 0.0 || duration <= 0.0 {
            return Err(MotionError::Scale { distance, duration });
        }
        let mut grid = self.grid();
        grid.step_s *= duration;
        let times = |samples: &[f64], factor: f64| samples.iter().map(|x| factor * x).collect();
        let mut columns = MotionColumns {
            time_s: (0..grid.len).map(|k| grid.time_s(k)).collect(),
            ..MotionColumns::default()
        };
        match &*self.samples().source {
            Source::Acceleration(samples) => {
                let factor = distance / duration.powi(2);
                columns.acceleration_m_s2 = Some(times(samples, factor));
            }
            Source::Displacement { samples, .. } => {
                columns.displacement_m = Some(times(samples, distance));
            }
        }
        let velocity = distance / duration;
        let corrected = self
            .corrected()
            .map(|end| EndVelocity { velocity_m_s: velocity * end.velocity_m_s, share: end.share });
        let start_m = distance * self.initial_displacement_m();
        Ok(Self::new(columns)?.with_start(start_m, corrected))
    }

    /// The same motion sampled twice as often, by a cubic spline through its samples.
    ///
    /// # Errors
    /// As [`TipMotion::new`].
    pub fn twice_as_often(&self) -> Result<Self, MotionError> {
        let grid = self.grid();
        let finer = |samples: &[f64], ends| {
            let spline = CubicSpline::uniform(samples, ends);
            (0..2 * grid.len - 1).map(|k| spline.value(0.5 * k as f64)).collect()
        };
        let half = TimeGrid { step_s: 0.5 * grid.step_s, len: 2 * grid.len - 1, ..grid };
        let time_s = (0..half.len).map(|k| half.time_s(k)).collect();
        let mut columns = MotionColumns { time_s, ..MotionColumns::default() };
        match &*self.samples().source {
            Source::Acceleration(samples) => {
                columns.acceleration_m_s2 = Some(finer(samples, SplineEnds::NotAKnot));
            }
            Source::Displacement { samples, .. } => {
                columns.displacement_m = Some(finer(samples, SplineEnds::Clamped));
            }
        }
        Self::new(columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Profile;

    fn septic() -> TipMotion {
        let acceleration =
            Profile::Septic.sampled(0.5, 1e-3, 800, [0, 0]).acceleration_m_s2.unwrap();
        let time_s = (0..acceleration.len()).map(|k| 0.25 + 1e-3 * k as f64).collect();
        let columns = MotionColumns {
            time_s,
            acceleration_m_s2: Some(acceleration),
            ..MotionColumns::default()
        };
        TipMotion::new(columns).unwrap()
    }

    #[test]
    fn twice_the_travel_in_half_the_time_takes_eight_times_the_acceleration() {
        let motion = septic();
        let scaled = motion.scaled(MotionScale { distance: 2.0, duration: 0.5 }).unwrap();
        assert!((scaled.travel_m() - 2.0 * motion.travel_m()).abs() < 1e-14);
        let (before, after) = (motion.grid(), scaled.grid());
        assert!((after.time_s(0) - 0.25).abs() < 1e-15);
        assert!((after.duration_s() - 0.5 * before.duration_s()).abs() < 1e-14);
        let (before, after) = (motion.samples().forcing_m_s2(), scaled.samples().forcing_m_s2());
        assert!(before.iter().zip(after).all(|(a, b)| (8.0 * a - b).abs() < 1e-12));
        assert_eq!(motion.moving_samples(), scaled.moving_samples());
    }

    #[test]
    fn a_displacement_keeps_where_it_starts_in_proportion() {
        let steps = |k: i32| 1.0 + f64::from((k - 3).clamp(0, 2));
        let columns = MotionColumns {
            time_s: (0..9).map(f64::from).collect(),
            displacement_m: Some((0..9).map(steps).collect()),
            ..MotionColumns::default()
        };
        let motion = TipMotion::new(columns).unwrap();
        let scaled = motion.scaled(MotionScale { distance: -3.0, duration: 1.0 }).unwrap();
        assert_eq!((scaled.initial_displacement_m(), scaled.travel_m()), (-3.0, -6.0));
    }

    #[test]
    fn factors_that_leave_no_motion_are_refused() {
        for (distance, duration) in [(0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (f64::NAN, 1.0)] {
            let refused = septic().scaled(MotionScale { distance, duration });
            assert!(matches!(refused, Err(MotionError::Scale { .. })), "{distance}, {duration}");
        }
        let refused = septic().scaled(MotionScale { distance: 1e300, duration: 1e-10 });
        assert!(refused.is_err());
    }
}
