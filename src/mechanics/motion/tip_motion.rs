use std::sync::Arc;

use super::ends::{is_steady, moves, refuse_repetition, travel_of_cycle_m};
use super::error::MotionError;
use super::period::{TipPeriod, check_agreement};
use super::recording::Recording;
use super::samples::{
    Ends, FEW_DIGITS, MotionColumns, Samples, Source, at_rest, can_be_transformed,
};
use super::spectrum::Cutoff;
use crate::numeric::TimeGrid;

/// End velocity over peak velocity below which it is round-off.
const ROUND_OFF: f64 = 1e-9;

/// A velocity at the end of the samples, removed by a correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndVelocity {
    /// ∫a dt of the uncorrected samples, in m/s.
    pub velocity_m_s: f64,
    /// Ratio of this velocity to the peak velocity.
    pub share: f64,
}

/// A wanted tip motion on a uniform grid, from rest to rest unless its [`Ends`] differ. A clone shares the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct TipMotion {
    samples: Samples,
    moving: (usize, usize),
    corrected: Option<EndVelocity>,
    recording: Recording,
}

impl TipMotion {
    /// Makes a motion from sampled columns, from rest to rest.
    ///
    /// The acceleration samples define the motion or, without them, the displacement samples. Other columns must agree
    /// with it. If an acceleration ends with a velocity of up to 1e-3 of the peak, a constant over the samples that
    /// move the tip corrects it; see [`TipMotion::corrected`]. A velocity column may show that the tip moves at the
    /// ends.
    ///
    /// # Errors
    /// [`MotionError`]: times off a uniform grid, a motion without rest at both ends, contradictory columns, or no
    /// motion at all.
    pub fn new(columns: MotionColumns) -> Result<Self, MotionError> {
        Self::with_ends(columns, Ends::AtRest)
    }

    /// [`TipMotion::new`] with other ends.
    ///
    /// Their velocities come from the velocity column or else from the displacement; a cycle without either leads back
    /// to its start.
    ///
    /// # Errors
    /// Those of [`TipMotion::new`]; a cycle that ends with its first sample, or unknown velocities.
    pub fn with_ends(columns: MotionColumns, ends: Ends) -> Result<Self, MotionError> {
        columns.check()?;
        let grid = TimeGrid::through(&columns.time_s)?;
        let ends = ends.said_by(columns.velocity_m_s.as_deref());
        if ends == Ends::Periodic {
            refuse_repetition(&columns, grid.step_s)?;
        }
        let velocities_m_s = ends.velocities_m_s(&columns, grid.step_s)?;
        Self::of(grid, columns, (ends, velocities_m_s))
    }

    /// A motion from columns on a grid, with these ends and the known velocities there.
    pub(super) fn of(
        grid: TimeGrid,
        columns: MotionColumns,
        course: (Ends, (f64, Option<f64>)),
    ) -> Result<Self, MotionError> {
        let MotionColumns { acceleration_m_s2, velocity_m_s, displacement_m, .. } = columns;
        let (motion, other, displacement_m) = if let Some(samples) = acceleration_m_s2 {
            let initial_displacement_m = displacement_m.as_ref().map_or(0.0, |d| d[0]);
            let motion = Self::from_acceleration(grid, samples, course, initial_displacement_m)?;
            (motion, "acceleration", displacement_m)
        } else {
            let samples = displacement_m.unwrap_or_default();
            let (ends, (before_m_s, after_m_s)) = course;
            let course = (ends, [before_m_s, after_m_s.unwrap_or_default()]);
            let velocity = velocity_m_s.as_deref();
            (Self::from_displacement(grid, samples, course, velocity)?, "displacement", None)
        };
        let others = [velocity_m_s.as_deref(), displacement_m.as_deref()];
        check_agreement(&motion.samples, others, other)?;
        Ok(motion)
    }

    fn from_acceleration(
        grid: TimeGrid,
        mut samples: Vec<f64>,
        (ends, (before_m_s, after_m_s)): (Ends, (f64, Option<f64>)),
        initial_displacement_m: f64,
    ) -> Result<Self, MotionError> {
        let moving = moves(&samples, ends)?;
        let velocities = samples.iter().scan(before_m_s, |sum, a| {
            *sum += a * grid.step_s;
            Some(*sum)
        });
        let (peak, last_m_s) =
            velocities.fold((0.0_f64, before_m_s), |(peak, _), v| (peak.max(v.abs()), v));
        if !peak.is_finite() || !can_be_transformed(&samples) {
            return Err(MotionError::TooLarge);
        }
        let after_m_s = after_m_s.unwrap_or(last_m_s);
        let velocity_m_s = last_m_s - after_m_s;
        let share = velocity_m_s.abs() / peak;
        if share > FEW_DIGITS {
            return Err(match ends {
                Ends::AtRest => MotionError::AcceleratesAway { velocity_m_s, share },
                Ends::Periodic => MotionError::AddsVelocity { velocity_m_s, share },
                Ends::Moving => MotionError::Disagree {
                    sample: samples.len() - 1,
                    column: "velocity",
                    unit: "m/s",
                    found: after_m_s,
                    expected: last_m_s,
                    other: "acceleration",
                },
            });
        }
        let corrected = (share > ROUND_OFF).then_some(EndVelocity { velocity_m_s, share });
        if corrected.is_some() {
            let own = &mut samples[moving.0..=moving.1];
            let excess = velocity_m_s / (grid.step_s * own.len() as f64);
            for a in own {
                *a -= excess;
            }
        }
        let travel_m = if ends == Ends::Periodic {
            before_m_s * grid.step_s * samples.len() as f64
        } else {
            // ∫v dt = v T − ∫ t a dt, with v at the last sample.
            let moments = samples.iter().enumerate().map(|(k, a)| k as f64 * a);
            after_m_s * grid.duration_s() - moments.sum::<f64>() * grid.step_s.powi(2)
        };
        if !travel_m.is_finite() {
            return Err(MotionError::TooLarge);
        }
        let source = Arc::new(Source::Acceleration(samples));
        let velocities_m_s = [before_m_s, after_m_s];
        let samples =
            Samples { grid, source, initial_displacement_m, travel_m, ends, velocities_m_s };
        Ok(Self { samples, moving, corrected, recording: Recording::default() })
    }

    fn from_displacement(
        grid: TimeGrid,
        samples: Vec<f64>,
        (ends, mut velocities_m_s): (Ends, [f64; 2]),
        velocity: Option<&[f64]>,
    ) -> Result<Self, MotionError> {
        let last = samples.len() - 1;
        let initial_displacement_m = samples[0];
        let [before_m, after_m] = velocities_m_s.map(|velocity| velocity * grid.step_s);
        let (travel_m, beside) = match ends {
            Ends::AtRest => {
                at_rest(&samples, grid.step_s)?;
                (samples[last] - samples[0], [samples[0], samples[last]])
            }
            Ends::Moving => {
                (samples[last] - samples[0], [samples[0] - before_m, samples[last] + after_m])
            }
            Ends::Periodic => {
                let mean = (velocities_m_s[0], grid.step_s);
                let travel_m = travel_of_cycle_m(&samples, velocity, mean)?;
                velocities_m_s = [travel_m / (samples.len() as f64 * grid.step_s); 2];
                (travel_m, [samples[last] - travel_m, samples[0] + travel_m])
            }
        };
        let at = |k: Option<usize>| match k {
            None => beside[0],
            Some(k) => samples.get(k).copied().unwrap_or(beside[1]),
        };
        let second_differences: Vec<f64> = (0..=last)
            .map(|k| {
                let (before, after) = (at(k.checked_sub(1)), at(Some(k + 1)));
                ((after - samples[k]) - (samples[k] - before)) / grid.step_s.powi(2)
            })
            .collect();
        if !can_be_transformed(&second_differences) {
            return Err(MotionError::TooLarge);
        }
        if ends != Ends::AtRest && is_steady(&samples, &second_differences, grid.step_s) {
            return Err(MotionError::Steady);
        }
        let moving = moves(&second_differences, ends)?;
        let source = Arc::new(Source::Displacement { samples, second_differences });
        let samples =
            Samples { grid, source, initial_displacement_m, travel_m, ends, velocities_m_s };
        Ok(Self { samples, moving, corrected: None, recording: Recording::default() })
    }

    /// This motion from another start, with the correction of another motion.
    pub(super) fn with_start(
        self,
        initial_displacement_m: f64,
        corrected: Option<EndVelocity>,
    ) -> Self {
        Self { samples: Samples { initial_displacement_m, ..self.samples }, corrected, ..self }
    }

    /// Attaches the quality of the samples.
    #[must_use]
    pub fn recorded(self, recording: Recording) -> Self {
        let own = recording.moving_samples(self.samples.displacements_m());
        Self { recording, moving: own.unwrap_or(self.moving), ..self }
    }

    /// Quality of the samples.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// The motion on a period of `len` samples, an even number of at least the motion's, up to a cut-off. The padding
    /// from `seam` on precedes the motion. A periodic motion needs a multiple of [`TipMotion::cycles`].
    ///
    /// # Panics
    /// If `len` is odd or below the number of samples, or `seam` is not in the padding.
    pub(crate) fn over_period(&self, len: usize, seam: usize, cutoff: Cutoff) -> TipPeriod {
        TipPeriod::of(&self.samples, len, seam, cutoff)
    }

    /// Smallest even number of samples that contains whole cycles of a periodic motion.
    pub(crate) fn cycles(&self) -> Option<usize> {
        self.samples.cycles()
    }

    /// Tip motion before the first sample and after the last.
    pub fn ends(&self) -> Ends {
        self.samples.ends
    }

    /// Velocities in m/s before the motion and after it; for a periodic motion, the mean velocity.
    pub fn end_velocities_m_s(&self) -> [f64; 2] {
        self.samples.velocities_m_s
    }

    /// True if both motions have the same start and recording, and share their samples.
    pub(super) fn is_clone_of(&self, other: &Self) -> bool {
        let start = |motion: &Self| motion.initial_displacement_m().to_bits();
        Arc::ptr_eq(&self.samples.source, &other.samples.source)
            && start(self) == start(other)
            && self.recording == other.recording
    }

    pub(super) fn samples(&self) -> &Samples {
        &self.samples
    }

    /// Grid of the input samples.
    pub fn grid(&self) -> TimeGrid {
        self.samples.grid
    }

    /// True if displacements, rather than accelerations, define the motion.
    pub fn is_from_displacement(&self) -> bool {
        matches!(*self.samples.source, Source::Displacement { .. })
    }

    /// Tip displacement before the motion in m.
    pub fn initial_displacement_m(&self) -> f64 {
        self.samples.initial_displacement_m
    }

    /// Displacement after the motion minus displacement before it, in m; for a tip that moves at its ends, last sample
    /// minus first; for a periodic motion, the travel of one cycle.
    pub fn travel_m(&self) -> f64 {
        self.samples.travel_m
    }

    /// Turn in rad of a joint over a cycle, of a tip that a rigid link has at `rigid_tip_m` m per rad; `None` for a motion that
    /// does not repeat.
    pub fn turn_of_cycle_rad(&self, rigid_tip_m: f64) -> Option<f64> {
        (self.ends() == Ends::Periodic).then(|| self.travel_m() / rigid_tip_m)
    }

    /// Numbers of the last sample at rest before the motion and of the first one after it: below 1e-6 of the peak
    /// acceleration or, for noisy samples, where the place leaves the rest. A periodic motion always moves.
    pub fn moving_samples(&self) -> (usize, usize) {
        self.moving
    }

    /// End velocity that a correction removed from the samples.
    pub fn corrected(&self) -> Option<EndVelocity> {
        self.corrected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.01;

    fn columns(f: impl Fn(f64) -> f64, count: usize) -> (Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..count).map(|k| 0.5 + k as f64 * STEP_S).collect();
        let samples = time_s.iter().map(|t| f((t - 0.5) / (STEP_S * (count - 1) as f64)));
        let samples = samples.collect();
        (time_s, samples)
    }

    fn accelerated(f: impl Fn(f64) -> f64) -> Result<TipMotion, MotionError> {
        let (time_s, samples) = columns(f, 101);
        let acceleration_m_s2 = Some(samples);
        TipMotion::new(MotionColumns { time_s, acceleration_m_s2, ..MotionColumns::default() })
    }

    /// Least-jerk position and acceleration over a unit time.
    fn least_jerk(t: f64) -> (f64, f64) {
        (t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t), 60.0 * t - 180.0 * t * t + 120.0 * t.powi(3))
    }

    #[test]
    fn travel_follows_from_the_acceleration_with_the_square_of_the_step() {
        let motion = accelerated(|t| least_jerk(t).1).unwrap();
        // The sum of t·a misses the integral by Δt²/12 of (t a)' at the end, which is 60.
        let expected = 1.0 - 5.0 * STEP_S * STEP_S;
        assert!((motion.travel_m() - expected).abs() < 1e-6, "travel {}", motion.travel_m());
        assert_eq!(motion.corrected(), None);
        assert_eq!(motion.moving_samples(), (0, 100));
    }

    #[test]
    fn few_digits_are_corrected_and_told_and_a_velocity_is_refused() {
        let rounded = accelerated(|t| (least_jerk(t).1 * 1e3).round() / 1e3 + 4e-4).unwrap();
        let end = rounded.corrected().unwrap();
        assert!((end.velocity_m_s - 4e-4 * 101.0 * STEP_S).abs() < 1e-5, "{end:?}");
        assert!((end.share - end.velocity_m_s / 1.875).abs() < 1e-5, "{end:?}");
        let sum: f64 = rounded.samples().forcing_m_s2().iter().sum();
        assert!((sum * STEP_S).abs() < 1e-13);
        let error = accelerated(|t| least_jerk(t).1 + 0.01).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the motion ends with a velocity of 1.010e-2 m/s, 0.54 % of its peak, but must end at \
             rest: the acceleration must integrate to 0"
        );
    }

    #[test]
    fn a_tip_that_stands_still_is_refused() {
        assert_eq!(accelerated(|_| 0.0), Err(MotionError::NoMotion));
        let (time_s, samples) = columns(|_| 0.3, 8);
        let displacement_m = Some(samples);
        let still = MotionColumns { time_s, displacement_m, ..MotionColumns::default() };
        assert_eq!(TipMotion::new(still), Err(MotionError::NoMotion));
    }

    #[test]
    fn columns_that_agree_are_taken_and_one_in_other_units_is_named() {
        let (time_s, displacement) = columns(|t| 0.2 + least_jerk(t).0, 101);
        let (_, acceleration) = columns(|t| least_jerk(t).1, 101);
        let (_, velocity) = columns(|t| 30.0 * t * t * (1.0 - t) * (1.0 - t), 101);
        let both = MotionColumns {
            time_s,
            acceleration_m_s2: Some(acceleration),
            velocity_m_s: Some(velocity),
            displacement_m: Some(displacement),
        };
        let motion = TipMotion::new(both.clone()).unwrap();
        assert!((motion.initial_displacement_m() - 0.2).abs() < 1e-15);
        let mut centimetres = both.clone();
        for d in centimetres.displacement_m.iter_mut().flatten() {
            *d *= 100.0;
        }
        let error = TipMotion::new(centimetres).unwrap_err();
        let is_displacement =
            matches!(error, MotionError::Disagree { column: "displacement", sample: 100, .. });
        assert!(is_displacement, "{error}");
        let mut late = both;
        late.velocity_m_s.as_mut().unwrap().rotate_right(5);
        let error = TipMotion::new(late).unwrap_err();
        assert!(matches!(error, MotionError::Disagree { column: "velocity", .. }));
    }

    #[test]
    fn samples_that_are_no_numbers_are_refused_wherever_they_stand() {
        for bad in [f64::NAN, f64::INFINITY] {
            let (time_s, mut samples) = columns(|t| least_jerk(t).1, 101);
            samples[7] = bad;
            let acceleration_m_s2 = Some(samples);
            let columns = MotionColumns { time_s, acceleration_m_s2, ..Default::default() };
            let error = TipMotion::new(columns).unwrap_err();
            assert_eq!(error.sample(), Some(7));
            assert!(error.to_string().starts_with("acceleration = "), "{error}");
        }
        assert_eq!(accelerated(|t| 1e307 * least_jerk(t).1), Err(MotionError::TooLarge));
        // Every sample and difference is finite, but their transform is not.
        let displacement_m = Some(vec![0.0, 0.0, 3e306, 3e306, 3e306]);
        let time_s = vec![0.0, 1.0, 2.0, 3.0, 4.0];
        let columns = MotionColumns { time_s, displacement_m, ..MotionColumns::default() };
        assert_eq!(TipMotion::new(columns), Err(MotionError::TooLarge));
    }

    #[test]
    fn ragged_or_short_columns_are_refused() {
        let (time_s, mut samples) = columns(|t| least_jerk(t).1, 101);
        samples.pop();
        let ragged =
            MotionColumns { time_s, acceleration_m_s2: Some(samples), ..Default::default() };
        assert_eq!(TipMotion::new(ragged), Err(MotionError::Shape { samples: 101 }));
        let nothing = MotionColumns { time_s: vec![0.0, 1.0, 2.0, 3.0], ..Default::default() };
        assert_eq!(TipMotion::new(nothing), Err(MotionError::Shape { samples: 4 }));
    }
}
