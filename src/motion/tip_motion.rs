use std::sync::Arc;

use super::checks::{agree, at_rest, finite};
use super::columns::MotionColumns;
use super::error::{MotionColumn, MotionError};
use super::period::LastPeriods;
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid, fast_length, largest};

/// Share of the peak acceleration below which the tip counts as at rest.
const MOTION_THRESHOLD: f64 = 1e-6;

/// End velocity over peak velocity that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// End velocity over peak velocity that a file with few digits may have; it is corrected.
const FEW_DIGITS: f64 = 1e-3;

/// Periods of so many times the motion's own samples are transformed without a number too large.
const PERIODS: f64 = 64.0;

/// Peak acceleration in m/s² of which the amplitudes of a spectrum, and their squares, are numbers.
const LEAST_M_S2: f64 = 1e-120;

/// What the samples of a motion were.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Source {
    /// Accelerations in m/s².
    Acceleration(Vec<f64>),
    /// Displacements in m and their second differences over the squared step in m/s².
    Displacement { samples: Vec<f64>, second_differences: Vec<f64> },
}

/// A velocity that the samples left the tip with, and that was taken out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndVelocity {
    /// ∫a dt of the samples as given, in m/s.
    pub velocity_m_s: f64,
    /// The same over the peak velocity.
    pub share: f64,
}

/// A wanted tip motion on a uniform grid, from rest to rest. A clone shares the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct TipMotion {
    grid: TimeGrid,
    source: Arc<Source>,
    initial_displacement_m: f64,
    travel_m: f64,
    moving: (usize, usize),
    corrected: Option<EndVelocity>,
    last_periods: LastPeriods,
}

impl TipMotion {
    /// Checks sampled columns and makes a motion of them.
    ///
    /// Acceleration samples rule where they are given; else displacement samples. Other columns
    /// must agree with them. An acceleration that leaves the tip with up to 1e-3 of its peak
    /// velocity is corrected by a constant over the motion's own samples, and says so in
    /// [`TipMotion::corrected`].
    ///
    /// # Errors
    /// [`MotionError`]: times off a uniform grid, a motion that is not at rest at both ends,
    /// columns that contradict each other, or no motion at all.
    pub fn new(columns: MotionColumns) -> Result<Self, MotionError> {
        let MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m } = columns;
        let len = time_s.len();
        let given = [&acceleration_m_s2, &velocity_m_s, &displacement_m];
        let ragged = given.into_iter().flatten().any(|column| column.len() != len);
        if ragged || len < 4 || (acceleration_m_s2.is_none() && displacement_m.is_none()) {
            return Err(MotionError::Shape { samples: len });
        }
        let named = [
            ("time", Some(&time_s)),
            ("acceleration", acceleration_m_s2.as_ref()),
            ("velocity", velocity_m_s.as_ref()),
            ("displacement", displacement_m.as_ref()),
        ];
        named.into_iter().try_for_each(|(name, samples)| finite(name, samples))?;
        let grid = TimeGrid::through(&time_s)?;
        let initial_displacement_m = displacement_m.as_ref().map_or(0.0, |d| d[0]);
        let from_acceleration = acceleration_m_s2.is_some();
        let mut motion = match (acceleration_m_s2, &displacement_m) {
            (Some(samples), _) => Self::from_acceleration(grid, samples)?,
            (None, Some(samples)) => Self::from_displacement(grid, samples.clone())?,
            (None, None) => return Err(MotionError::Shape { samples: len }),
        };
        motion.initial_displacement_m = initial_displacement_m;
        motion.check_agreement(
            velocity_m_s.as_deref(),
            displacement_m.as_deref(),
            from_acceleration,
        )?;
        Ok(motion)
    }

    fn from_acceleration(grid: TimeGrid, mut samples: Vec<f64>) -> Result<Self, MotionError> {
        let moving = moving_samples(&samples)?;
        let velocities = samples.iter().scan(0.0, |sum, a| {
            *sum += a * grid.step_s;
            Some(*sum)
        });
        let (peak, velocity_m_s) =
            velocities.fold((0.0_f64, 0.0), |(peak, _), v| (peak.max(v.abs()), v));
        if !peak.is_finite() || !can_be_transformed(&samples) {
            return Err(MotionError::TooLarge);
        }
        let share = velocity_m_s.abs() / peak;
        if share > FEW_DIGITS {
            return Err(MotionError::AcceleratesAway { velocity_m_s, share });
        }
        let corrected = (share > ROUND_OFF).then_some(EndVelocity { velocity_m_s, share });
        if corrected.is_some() {
            let own = &mut samples[moving.0..=moving.1];
            let excess = velocity_m_s / (grid.step_s * own.len() as f64);
            for a in own {
                *a -= excess;
            }
        }
        // ∫v dt = −∫ t a dt, from rest to rest.
        let moments = samples.iter().enumerate().map(|(k, a)| k as f64 * a);
        let travel_m = -moments.sum::<f64>() * grid.step_s.powi(2);
        if !travel_m.is_finite() {
            return Err(MotionError::TooLarge);
        }
        let source = Arc::new(Source::Acceleration(samples));
        Ok(Self {
            grid,
            source,
            initial_displacement_m: 0.0,
            travel_m,
            moving,
            corrected,
            last_periods: LastPeriods::default(),
        })
    }

    fn from_displacement(grid: TimeGrid, samples: Vec<f64>) -> Result<Self, MotionError> {
        at_rest(&samples, grid.step_s)?;
        let last = samples.len() - 1;
        let at = |k: Option<usize>| samples[k.unwrap_or(0).min(last)];
        let second_differences: Vec<f64> = (0..=last)
            .map(|k| {
                let (before, after) = (at(k.checked_sub(1)), at(Some(k + 1)));
                ((after - samples[k]) - (samples[k] - before)) / grid.step_s.powi(2)
            })
            .collect();
        if !can_be_transformed(&second_differences) {
            return Err(MotionError::TooLarge);
        }
        let moving = moving_samples(&second_differences)?;
        let (initial_displacement_m, travel_m) = (samples[0], samples[last] - samples[0]);
        let source = Arc::new(Source::Displacement { samples, second_differences });
        Ok(Self {
            grid,
            source,
            initial_displacement_m,
            travel_m,
            moving,
            corrected: None,
            last_periods: LastPeriods::default(),
        })
    }

    fn check_agreement(
        &self,
        velocity_m_s: Option<&[f64]>,
        displacement_m: Option<&[f64]>,
        from_acceleration: bool,
    ) -> Result<(), MotionError> {
        let displacement_m = displacement_m.filter(|_| from_acceleration);
        if velocity_m_s.is_none() && displacement_m.is_none() {
            return Ok(());
        }
        let len = fast_length(2 * self.grid.len);
        let expected = self.histories(&self.spectrum(len, len - self.grid.len / 2));
        let peak = |samples: &[f64]| largest(&samples[..self.grid.len]) * self.grid.step_s;
        if let Some(found) = velocity_m_s {
            let jump = peak(&expected.acceleration_m_s2);
            let expected = &expected.velocity_m_s[..self.grid.len];
            agree(MotionColumn::Velocity, found, expected, jump, from_acceleration)?;
        }
        if let Some(found) = displacement_m {
            let jump = peak(&expected.velocity_m_s);
            let expected = &expected.displacement_m[..self.grid.len];
            agree(MotionColumn::Displacement, found, expected, jump, true)?;
        }
        Ok(())
    }

    /// The same motion sampled twice as often, by a cubic spline through its samples.
    ///
    /// # Errors
    /// As [`TipMotion::new`].
    pub fn twice_as_often(&self) -> Result<Self, MotionError> {
        let grid = self.grid;
        let finer = |samples: &[f64], ends| {
            let spline = CubicSpline::uniform(samples, ends);
            (0..2 * grid.len - 1).map(|k| spline.value(0.5 * k as f64)).collect()
        };
        let half = TimeGrid { step_s: 0.5 * grid.step_s, len: 2 * grid.len - 1, ..grid };
        let time_s = (0..half.len).map(|k| half.time_s(k)).collect();
        let mut columns = MotionColumns { time_s, ..MotionColumns::default() };
        match &*self.source {
            Source::Acceleration(samples) => {
                columns.acceleration_m_s2 = Some(finer(samples, SplineEnds::NotAKnot));
            }
            Source::Displacement { samples, .. } => {
                columns.displacement_m = Some(finer(samples, SplineEnds::Clamped));
            }
        }
        Self::new(columns)
    }

    /// The same samples, told of a motion that starts elsewhere and had been corrected before.
    pub(super) fn standing_for(
        self,
        initial_displacement_m: f64,
        corrected: Option<EndVelocity>,
    ) -> Self {
        Self { initial_displacement_m, corrected, last_periods: LastPeriods::default(), ..self }
    }

    /// Grid of the given samples.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    pub(super) fn source(&self) -> &Source {
        &self.source
    }

    pub(super) fn last_periods(&self) -> &LastPeriods {
        &self.last_periods
    }

    /// Whether displacements were given rather than accelerations.
    pub fn is_from_displacement(&self) -> bool {
        matches!(*self.source, Source::Displacement { .. })
    }

    /// What drives the motion, in m/s²: accelerations, or second differences of displacements.
    pub(super) fn forcing_m_s2(&self) -> &[f64] {
        match &*self.source {
            Source::Acceleration(samples) => samples,
            Source::Displacement { second_differences, .. } => second_differences,
        }
    }

    /// Tip displacement before the motion in m.
    pub fn initial_displacement_m(&self) -> f64 {
        self.initial_displacement_m
    }

    /// Tip displacement after the motion less that before it, in m.
    pub fn travel_m(&self) -> f64 {
        self.travel_m
    }

    /// Numbers of the last sample at rest before the motion and of the first one after it.
    ///
    /// At rest: below 1e-6 of the peak acceleration.
    pub fn moving_samples(&self) -> (usize, usize) {
        self.moving
    }

    /// The end velocity that was taken out of the samples, where they had one.
    pub fn corrected(&self) -> Option<EndVelocity> {
        self.corrected
    }
}

/// Whether the sums of a Fourier transform over many times the motion stay numbers.
fn can_be_transformed(forcing: &[f64]) -> bool {
    let sum: f64 = forcing.iter().map(|a| a.abs()).sum();
    (sum * PERIODS * forcing.len() as f64).is_finite()
}

/// Numbers of the last sample before those that move the tip and of the first one after them.
fn moving_samples(forcing: &[f64]) -> Result<(usize, usize), MotionError> {
    let peak_m_s2 = largest(forcing);
    let moves = |a: &f64| a.abs() > MOTION_THRESHOLD * peak_m_s2;
    let ends = forcing.iter().position(moves).zip(forcing.iter().rposition(moves));
    let (first, last) = ends.filter(|_| peak_m_s2 > 0.0).ok_or(MotionError::NoMotion)?;
    if peak_m_s2 < LEAST_M_S2 {
        return Err(MotionError::TooSmall { peak_m_s2, least_m_s2: LEAST_M_S2 });
    }
    Ok((first.saturating_sub(1), (last + 1).min(forcing.len() - 1)))
}
