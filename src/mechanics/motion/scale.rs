//! A motion over another distance, duration or step, and a target for comparison.

use std::ops::Mul;

use super::ends::wrapped;
use super::error::MotionError;
use super::period::{TipHistories, farthest_m};
use super::samples::{Ends, MotionColumns, Source};
use super::spectrum::Cutoff;
use super::tip_motion::{EndVelocity, TipMotion};
use crate::link::ParameterError;
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid, fast_length, largest};

/// Number of samples of adjacent cycles in the spline of a cycle: the effect of a spline's end falls by 3.7 from one
/// sample to the next.
const AROUND: usize = 30;

/// Share of the largest acceleration above which a step of the acceleration is a jump.
const JUMP: f64 = 0.4;

/// Factors on a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionScale {
    /// Factor on the displacement; not 0.
    pub distance: f64,
    /// Factor on the duration; the first sample's time stays; above 0.
    pub duration: f64,
}

impl Default for MotionScale {
    fn default() -> Self {
        Self { distance: 1.0, duration: 1.0 }
    }
}

impl Mul for MotionScale {
    type Output = Self;

    /// Combines the factors of both.
    fn mul(self, other: Self) -> Self {
        Self { distance: self.distance * other.distance, duration: self.duration * other.duration }
    }
}

impl TipMotion {
    /// True if the motion has acceleration samples that jump: a sample is far from the next but one, while those before
    /// and after hardly change.
    pub fn jumps(&self) -> bool {
        if self.is_from_displacement() {
            return false;
        }
        let own = self.samples().forcing_m_s2();
        let least = JUMP * largest(own);
        // A resting tip has no acceleration.
        let beside: &[f64] = if self.ends() == Ends::AtRest { &[0.0; 3] } else { &[] };
        let samples = [beside, own, beside].concat();
        let is_jump = |a: &[f64]| {
            let jump = (a[3] - a[1]).abs();
            let beside = (a[1] - a[0]).abs().max((a[4] - a[3]).abs());
            // The sample at a jump has either value, or their mean.
            let values = [a[1], 0.5 * (a[1] + a[3]), a[3]];
            let off = values.iter().map(|value| (a[2] - value).abs()).fold(jump, f64::min);
            jump > least && beside < 0.1 * jump && off < 0.05 * jump
        };
        samples.windows(5).any(is_jump)
    }

    /// Largest acceleration of the samples in m/s², or largest second difference of displacements.
    pub fn largest_acceleration_m_s2(&self) -> f64 {
        largest(self.samples().forcing_m_s2())
    }

    /// This motion over another distance and duration: the same number of samples, with the step and the rests scaled
    /// like the duration.
    ///
    /// # Errors
    /// [`MotionError::Scale`] for factors out of their range, and those of [`TipMotion::new`] if the scaled numbers are
    /// too large.
    pub fn scaled(&self, scale: MotionScale) -> Result<Self, MotionError> {
        self.scaled_about(scale, 0.0)
    }

    /// [`TipMotion::scaled`] with a displacement in m that stays.
    pub(super) fn scaled_about(
        &self,
        scale: MotionScale,
        still_m: f64,
    ) -> Result<Self, MotionError> {
        if scale == MotionScale::default() {
            return Ok(self.clone());
        }
        let MotionScale { distance, duration } = scale;
        let possible = [distance, duration, duration.recip()].iter().all(|x| x.is_finite());
        if !possible || distance == 0.0 || duration <= 0.0 {
            return Err(MotionError::Scale { distance, duration });
        }
        let own = self.grid();
        let grid = TimeGrid { step_s: duration * own.step_s, ..own };
        let from_m = (1.0 - distance) * still_m;
        let times = |samples: &[f64], factor: f64| samples.iter().map(|x| factor * x).collect();
        let placed = |samples: &[f64]| samples.iter().map(|x| from_m + distance * x).collect();
        let scaled = self.on_grid(
            grid,
            distance / duration,
            |accelerations| times(accelerations, distance / duration.powi(2)),
            placed,
        )?;
        let velocity = distance / duration;
        let corrected = self
            .corrected()
            .map(|end| EndVelocity { velocity_m_s: velocity * end.velocity_m_s, share: end.share });
        let start_m = from_m + distance * self.initial_displacement_m();
        let recording = self.recording().scaled(distance, duration);
        Ok(scaled.with_start(start_m, corrected).recorded(recording))
    }

    /// This motion sampled twice as often, by a cubic spline through its samples.
    ///
    /// # Errors
    /// Those of [`TipMotion::new`].
    pub fn twice_as_often(&self) -> Result<Self, MotionError> {
        let grid = self.grid();
        let is_periodic = self.ends() == Ends::Periodic;
        let len = if is_periodic { 2 * grid.len } else { 2 * grid.len - 1 };
        // A cycle has known neighbours, so that the ends of their spline are far away.
        let around = if is_periodic { AROUND } else { 0 };
        let finer = |samples: &[f64], travel: f64, ends| {
            let spline = if is_periodic {
                CubicSpline::uniform(&wrapped(samples, travel, around), SplineEnds::NotAKnot)
            } else {
                CubicSpline::uniform(samples, ends)
            };
            (0..len).map(|k| spline.value(around as f64 + 0.5 * k as f64)).collect()
        };
        let half = TimeGrid { step_s: 0.5 * grid.step_s, len, ..grid };
        let rests =
            if self.ends() == Ends::AtRest { SplineEnds::Clamped } else { SplineEnds::NotAKnot };
        let finer = self.on_grid(
            half,
            1.0,
            |accelerations| finer(accelerations, 0.0, SplineEnds::NotAKnot),
            |displacements| finer(displacements, self.travel_m(), rests),
        )?;
        Ok(finer.recorded(*self.recording()))
    }

    /// The motion on another grid, with samples derived from its samples, and end velocities multiplied by `faster`.
    fn on_grid(
        &self,
        grid: TimeGrid,
        faster: f64,
        of_accelerations: impl FnOnce(&[f64]) -> Vec<f64>,
        of_displacements: impl FnOnce(&[f64]) -> Vec<f64>,
    ) -> Result<Self, MotionError> {
        let time_s = (0..grid.len).map(|k| grid.time_s(k)).collect();
        let mut columns = MotionColumns { time_s, ..MotionColumns::default() };
        match &*self.samples().source {
            Source::Acceleration(own) => columns.acceleration_m_s2 = Some(of_accelerations(own)),
            Source::Displacement { samples, .. } => {
                columns.displacement_m = Some(of_displacements(samples));
            }
        }
        columns.check()?;
        let grid = TimeGrid::through(&columns.time_s)?;
        let [before_m_s, after_m_s] = self.end_velocities_m_s().map(|own| faster * own);
        Self::of(grid, columns, (self.ends(), (before_m_s, Some(after_m_s))))
    }
}

/// A tip displacement for comparison. It need not be at rest at its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct TipTarget {
    grid: TimeGrid,
    displacement_m: Vec<f64>,
    start_angle_rad: Option<f64>,
}

impl TipTarget {
    /// Displacements in m at the times of `grid`, which ends with their last.
    pub fn new(grid: TimeGrid, displacement_m: Vec<f64>) -> Self {
        let grid = TimeGrid { len: displacement_m.len(), ..grid };
        Self { grid, displacement_m, start_angle_rad: None }
    }

    /// Sets the direction of the chord in rad at displacement 0, if the motion has one.
    #[must_use]
    pub fn from_angle(self, start_angle_rad: Option<f64>) -> Self {
        Self { start_angle_rad, ..self }
    }

    /// Direction of the chord in rad at displacement 0, if the motion has one.
    pub fn start_angle_rad(&self) -> Option<f64> {
        self.start_angle_rad
    }

    /// Times of the samples.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// Displacement along the arc in m.
    pub fn displacement_m(&self) -> &[f64] {
        &self.displacement_m
    }

    /// Displacement at the first sample in m; 0 without samples.
    pub fn start_m(&self) -> f64 {
        self.displacement_m.first().copied().unwrap_or(0.0)
    }

    /// Largest displacement from the first sample in m.
    pub fn largest_travel_m(&self) -> f64 {
        farthest_m(self.start_m(), &self.displacement_m)
    }
}

impl TipMotion {
    /// The motion on a period of `len` samples up to a cut-off. The padding from `seam` on precedes the motion.
    ///
    /// # Errors
    /// [`ParameterError`] if `len` is odd or below the number of samples, or `seam` is not in the padding; for a
    /// periodic motion, if `len` is no multiple of the cycle, or `seam` is not its end.
    pub fn histories_over(
        &self,
        len: usize,
        seam: usize,
        cutoff: Cutoff,
    ) -> Result<TipHistories, ParameterError> {
        let given = self.grid().len;
        if len < given || !len.is_multiple_of(2) {
            let must = format!("must be even and at least {given}");
            return Err(ParameterError::new("the period", len, "samples", must));
        }
        if self.ends() == Ends::Periodic && (!len.is_multiple_of(given) || seam != len) {
            let must = format!("must hold cycles of {given} samples, and no other");
            return Err(ParameterError::new("the period", len, "samples", must));
        }
        if !(given..=len).contains(&seam) {
            let must = format!("must lie from {given} to {len}");
            return Err(ParameterError::new("the seam", seam, "", must));
        }
        Ok(self.over_period(len, seam, cutoff).histories)
    }

    /// The motion as a target, with the rest around it, in whole steps, between two times in s.
    pub fn target(&self, from_s: f64, until_s: f64) -> TipTarget {
        let own = self.grid();
        // A time within a millionth of a step of a sample counts as the sample.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of steps, at least 0"
        )]
        let steps = |time_s: f64| (time_s / own.step_s + 1e-6).floor().max(0.0) as usize;
        let (before, after) = (steps(own.time_s(0) - from_s), steps(until_s - own.end_s()));
        let (len, seam) = self.cycles().map_or_else(
            || {
                let len = fast_length(2 * own.len + before + after);
                (len, own.len + after + own.len / 2)
            },
            |len| (len, len),
        );
        let period_m = self.over_period(len, seam, Cutoff::ALL).histories.displacement_m;
        let displacement_m = period_m[len - before..].iter().chain(&period_m[..own.len + after]);
        let first = own.first.saturating_sub_unsigned(before as u64);
        let grid = TimeGrid { first, len: before + own.len + after, ..own };
        TipTarget::new(grid, displacement_m.copied().collect())
            .from_angle(self.recording().start_angle_rad)
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

    #[test]
    fn a_target_rests_before_and_after_its_motion() {
        let motion = TipMotion::new(Profile::Septic.sampled(0.5, 0.01, 100, [0, 0])).unwrap();
        let target = motion.target(-0.25, 1.5);
        let (grid, at) = (target.grid(), target.displacement_m());
        assert_eq!((grid.len, grid.time_s(25)), (176, 0.0));
        assert!(at[..26].iter().all(|d| d.abs() < 1e-8));
        assert!(at[125..].iter().all(|d| (d - 0.5).abs() < 1e-8));
        assert!((at[75] - 0.25).abs() < 1e-12, "half the travel after half the time");
        assert_eq!(motion.target(0.3, 0.6).grid(), motion.grid(), "no sample is cut off");
    }
}
