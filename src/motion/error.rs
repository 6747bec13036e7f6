//! Why sampled columns are no tip motion.

use thiserror::Error;

use crate::numeric::NotUniform;

/// Why sampled columns are no tip motion that can be inverted.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MotionError {
    /// Columns of different lengths, fewer than 4 samples, or neither acceleration nor
    /// displacement.
    #[error(
        "the motion has {samples} samples, but must have at least 4 of time and of acceleration or \
         displacement, all columns equally long"
    )]
    Shape {
        /// Samples of the time column.
        samples: usize,
    },
    /// A sample that is no number, or is infinite.
    #[error("{column} = {found}, but must be a finite number")]
    NotFinite {
        /// Number of the sample, from 0.
        sample: usize,
        /// Name of the column.
        column: &'static str,
        /// What was found.
        found: f64,
    },
    /// Samples whose integrals or differences leave the range of numbers.
    #[error("the motion reaches beyond double precision, but must stay far below 1e308 in SI")]
    TooLarge,
    /// Samples so small that their sums and squares are no numbers.
    #[error(
        "the motion's acceleration peaks at {peak_m_s2:e} m/s^2, but must reach {least_m_s2:e} m/s^2: \
         what is smaller cannot be squared"
    )]
    TooSmall {
        /// Largest acceleration in m/s².
        peak_m_s2: f64,
        /// The least that it must reach, in m/s².
        least_m_s2: f64,
    },
    /// A time off the uniform grid.
    #[error(transparent)]
    NotUniform(#[from] NotUniform),
    /// Factors that leave no motion, or none that ends.
    #[error(
        "the motion's distance times {distance} and duration times {duration}, but these must be \
         finite factors, that of the duration above 0 and that of the distance not 0"
    )]
    Scale {
        /// Factor on the distance.
        distance: f64,
        /// Factor on the duration.
        duration: f64,
    },
    /// The tip stands still.
    #[error("the tip stands still in all samples, but must move")]
    NoMotion,
    /// The acceleration leaves the tip moving after the last sample.
    #[error(
        "the motion ends with a velocity of {velocity_m_s:.3e} m/s, {:.2} % of its peak, but must \
         end at rest: the acceleration must integrate to 0",
        100.0 * share
    )]
    AcceleratesAway {
        /// Velocity after the last sample, ∫a dt.
        velocity_m_s: f64,
        /// The same over the peak velocity.
        share: f64,
    },
    /// An acceleration that makes a tip faster from cycle to cycle.
    #[error(
        "the acceleration of a cycle adds a velocity of {velocity_m_s:.3e} m/s, {:.2} % of its peak, but must \
         integrate to 0",
        100.0 * share
    )]
    AddsVelocity {
        /// The velocity in m/s.
        velocity_m_s: f64,
        /// The same over the peak velocity.
        share: f64,
    },
    /// A tip that moves at its start, of which the acceleration alone is given.
    #[error(
        "the tip's velocity at the start = unknown, but must be given where the tip may move there"
    )]
    UnknownVelocity,
    /// A cycle that ends with the sample with which it begins.
    #[error("the last row of the cycle = the first one again, but must be the one before it")]
    Repeats {
        /// Number of the last sample.
        sample: usize,
    },
    /// A cycle that does not lead back to its start.
    #[error(
        "a step after its last row the cycle = {off_m:.3e} m off its start, but must be back there, or as far on as the \
         velocity says"
    )]
    Unclosed {
        /// Number of the last sample.
        sample: usize,
        /// The distance in m.
        off_m: f64,
    },
    /// A tip that accelerates where it should move at constant velocity.
    #[error(
        "the tip accelerates there, with {:.2} % of its peak, but must move at constant velocity at its ends",
        100.0 * share
    )]
    AcceleratingEnd {
        /// Number of the sample, the first or the last.
        sample: usize,
        /// The acceleration over its peak.
        share: f64,
    },
    /// A tip that keeps its velocity.
    #[error("the tip keeps its velocity in all samples, but must change it")]
    Steady,
    /// The displacement jumps into or out of motion.
    #[error(
        "the motion {} with a velocity of {velocity_m_s:.3e} m/s, {:.2} % of its peak, but must be \
         at rest there",
        if *sample == 0 { "starts" } else { "ends" },
        100.0 * share
    )]
    MovingAtEnd {
        /// Number of the sample, the first or the last.
        sample: usize,
        /// Velocity there.
        velocity_m_s: f64,
        /// The same over the peak velocity.
        share: f64,
    },
    /// Two columns that contradict each other.
    #[error(
        "{column} = {found} {unit}, but must be {expected:.6e} {unit} to agree with the {other}"
    )]
    Disagree {
        /// Number of the sample, from 0: the one that is farthest off.
        sample: usize,
        /// The column that is checked.
        column: &'static str,
        /// Its unit.
        unit: &'static str,
        /// What it holds.
        found: f64,
        /// The value that follows from the other column.
        expected: f64,
        /// The column that the motion is computed from.
        other: &'static str,
    },
}

impl MotionError {
    /// Number of the sample, from 0, that is to blame, where one is.
    pub fn sample(&self) -> Option<usize> {
        match self {
            Self::NotFinite { sample, .. }
            | Self::NotUniform(NotUniform { sample, .. })
            | Self::MovingAtEnd { sample, .. }
            | Self::Repeats { sample }
            | Self::Unclosed { sample, .. }
            | Self::AcceleratingEnd { sample, .. }
            | Self::Disagree { sample, .. } => Some(*sample),
            _ => None,
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NotUniform(_) => Some(
                "write times with more decimals, or let --resample STEP make uneven samples uniform",
            ),
            Self::AcceleratesAway { .. } => Some(
                "a motion goes from rest to rest; add the samples that bring the tip to rest, or say that it \
                 moves on: --moving-ends, --periodic",
            ),
            Self::MovingAtEnd { .. } => Some(
                "a motion goes from rest to rest; add the samples that bring the tip to rest, give a \
                 recording's noise: --noise, or say that it moves on: --moving-ends, --periodic",
            ),
            Self::AddsVelocity { .. } => {
                Some("give one whole cycle, without the row that begins the next one")
            }
            Self::UnknownVelocity => {
                Some("give a velocity or a displacement beside the acceleration")
            }
            Self::Steady => {
                Some("a constant velocity takes the torque of the hub's friction alone")
            }
            Self::Unclosed { .. } => Some("a velocity column says how far a cycle leads on"),
            Self::AcceleratingEnd { .. } => {
                Some("begin and end with rows at constant velocity, or at rest")
            }
            Self::Repeats { .. } => {
                Some("leave the last row out: the first row follows the last one, a step later")
            }
            Self::Disagree { .. } => {
                Some("check the units in the header, or leave one of the columns out")
            }
            Self::TooSmall { .. } => Some("check the units of the motion, and their powers of ten"),
            _ => None,
        }
    }
}
