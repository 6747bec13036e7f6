use std::fmt;

use thiserror::Error;

use crate::numeric::NotUniform;

/// A column of a tip motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionColumn {
    /// Tip velocity.
    Velocity,
    /// Tip displacement.
    Displacement,
}

impl fmt::Display for MotionColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
        })
    }
}

impl MotionColumn {
    fn unit(self) -> &'static str {
        match self {
            Self::Velocity => "m/s",
            Self::Displacement => "m",
        }
    }
}

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
    /// A time that does not stand on the uniform grid.
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
        "{column} = {found} {}, but must be {expected:.6e} {} to agree with the {}",
        column.unit(),
        column.unit(),
        if *from_acceleration { "acceleration" } else { "displacement" }
    )]
    Disagree {
        /// Number of the sample, from 0: the one that is farthest off.
        sample: usize,
        /// The column that is checked.
        column: MotionColumn,
        /// What it holds.
        found: f64,
        /// What the other column makes of it.
        expected: f64,
        /// Whether the other column is the acceleration; else the displacement.
        from_acceleration: bool,
    },
}

impl MotionError {
    /// Number of the sample, from 0, that is to blame, where one is.
    pub fn sample(&self) -> Option<usize> {
        match self {
            Self::NotFinite { sample, .. }
            | Self::NotUniform(NotUniform { sample, .. })
            | Self::MovingAtEnd { sample, .. }
            | Self::Disagree { sample, .. } => Some(*sample),
            Self::Shape { .. }
            | Self::TooLarge
            | Self::TooSmall { .. }
            | Self::Scale { .. }
            | Self::NoMotion
            | Self::AcceleratesAway { .. } => None,
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NotUniform(_) => Some(
                "write times with more decimals, or let --resample STEP make uneven samples uniform",
            ),
            Self::AcceleratesAway { .. } | Self::MovingAtEnd { .. } => {
                Some("a motion goes from rest to rest; add the samples that bring the tip to rest")
            }
            Self::Disagree { .. } => {
                Some("check the units in the header, or leave one of the columns out")
            }
            Self::TooSmall { .. } => Some("check the units of the motion, and their powers of ten"),
            Self::Shape { .. }
            | Self::NotFinite { .. }
            | Self::TooLarge
            | Self::Scale { .. }
            | Self::NoMotion => None,
        }
    }
}
