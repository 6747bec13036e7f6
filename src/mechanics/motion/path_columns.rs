//! Sampled columns of an arm's path, and their errors.

use std::f64::consts::PI;

use thiserror::Error;

use super::error::MotionError;
use super::recording::Recording;
use crate::numeric::NotUniform;

/// One column of a path: its name in the file, its samples, and their quality.
#[derive(Debug, Clone, PartialEq)]
pub struct PathColumn {
    /// Name, for messages: `x`, `angle1`.
    pub name: String,
    /// Samples in m or rad.
    pub values: Vec<f64>,
    /// Quality of the samples, in m or rad.
    pub recording: Recording,
}

/// Sampled columns of a path, of equal length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathColumns {
    /// Time in s.
    pub time_s: Vec<f64>,
    /// x and y of the tip in m.
    pub tip: Option<[PathColumn; 2]>,
    /// Directions of the chords in rad, counterclockwise from x; the inner link first, `None` for a link without a
    /// column.
    pub angles: Vec<Option<PathColumn>>,
}

impl PathColumns {
    /// Columns of a tip at these places in m, one a step from 0 s on, with constant directions in rad for links from
    /// the third on.
    pub fn of_tip(step_s: f64, places_m: &[[f64; 2]], outer_rad: &[f64]) -> Self {
        let column =
            |name: String, values| PathColumn { name, values, recording: Recording::default() };
        let axis = |axis: usize| places_m.iter().map(|place| place[axis]).collect();
        let held = |(link, angle_rad): (usize, &f64)| {
            Some(column(format!("angle{}", link + 3), vec![*angle_rad; places_m.len()]))
        };
        Self {
            time_s: (0..places_m.len()).map(|k| k as f64 * step_s).collect(),
            tip: Some([column("x".to_owned(), axis(0)), column("y".to_owned(), axis(1))]),
            angles: [None, None]
                .into_iter()
                .chain(outer_rad.iter().enumerate().map(held))
                .collect(),
        }
    }

    /// Multiplies the path's duration by a factor; the first sample's time stays.
    ///
    /// # Errors
    /// [`MotionError::Scale`] for a factor that is not finite and above 0.
    pub fn slowed(mut self, factor: f64) -> Result<Self, MotionError> {
        let possible = [factor, factor.recip()].iter().all(|x| x.is_finite());
        if !possible || factor <= 0.0 {
            return Err(MotionError::Scale { distance: 1.0, duration: factor });
        }
        let first_s = self.time_s.first().copied().unwrap_or_default();
        if factor.total_cmp(&1.0).is_ne() {
            self.time_s.iter_mut().for_each(|t| *t = first_s + factor * (*t - first_s));
            for column in self.tip.iter_mut().flatten().chain(self.angles.iter_mut().flatten()) {
                column.recording = column.recording.scaled(1.0, factor);
            }
        }
        Ok(self)
    }
}

/// Reason why sampled columns are no path.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PathError {
    /// Columns are missing for an arm with this number of links.
    #[error(
        "{missing} = nothing, but must be given for an arm of {links} links: {}",
        match links { 2 => "x and y, or angle1 and angle2".to_owned(), links => format!(
            "x and y with angle3{}, or angle1 to angle{links}",
            if *links == 3 { String::new() } else { format!(" to angle{links}") }
        ) }
    )]
    Missing {
        /// Name of a column.
        missing: String,
        /// Number of links.
        links: usize,
    },
    /// The column is a direction of a link that the arm does not have.
    #[error("{column} is given, but the arm has {links} links")]
    TooMany {
        /// Name of the column.
        column: String,
        /// Number of links.
        links: usize,
    },
    /// A column is no motion from rest to rest.
    #[error("{column}: {error}")]
    Column {
        /// Name of the column.
        column: String,
        /// Reason.
        error: MotionError,
    },
    /// The times are no uniform grid.
    #[error(transparent)]
    Time(NotUniform),
    /// An angle is not at rest at an end.
    #[error(
        "{column}: the link {} with a rate of {rate_rad_s:.3e} rad/s, {:.2} % of its peak, but must be at rest there",
        if *sample == 0 { "starts" } else { "ends" },
        100.0 * share
    )]
    TurnsAtEnd {
        /// Name of the column.
        column: String,
        /// Number of the sample, the first or the last.
        sample: usize,
        /// Rate at this sample in rad/s.
        rate_rad_s: f64,
        /// Ratio of this rate to the peak rate.
        share: f64,
    },
    /// An angle jumps from one sample to the next.
    #[error(
        "{column} = {found:.6} rad, but must lie within half a turn of the {before:.6} rad before it: angles go on over whole turns"
    )]
    Jump {
        /// Name of the column.
        column: String,
        /// Number of the sample, from 0.
        sample: usize,
        /// Angle of the sample in rad.
        found: f64,
        /// Angle of the sample before in rad.
        before: f64,
    },
    /// No column changes.
    #[error("the arm stands still in all samples, but must move")]
    NoMotion,
}

impl PathError {
    /// Number of the faulty sample, from 0, if the error has one.
    pub fn sample(&self) -> Option<usize> {
        match self {
            Self::Column { error, .. } => error.sample(),
            Self::Jump { sample, .. }
            | Self::TurnsAtEnd { sample, .. }
            | Self::Time(NotUniform { sample, .. }) => Some(*sample),
            _ => None,
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Time(_) => Some(
                "write times with more decimals, or let --resample STEP make uneven samples uniform",
            ),
            Self::Column { error: MotionError::MovingAtEnd { .. }, .. }
            | Self::TurnsAtEnd { .. } => {
                Some("a path goes from rest to rest; add the samples that bring the arm to rest")
            }
            Self::Column { error, .. } => error.hint(),
            Self::Jump { .. } => Some("add or take away 2π, or 360 deg, from there on"),
            Self::TooMany { .. } => Some("leave the column out, or give the arm file all links"),
            Self::Missing { .. } | Self::NoMotion => None,
        }
    }
}

/// Refuses an angle that jumps by half a turn or more.
pub(crate) fn refuse_jump(column: &PathColumn) -> Result<(), PathError> {
    let jumps = |pair: &[f64]| (pair[1] - pair[0]).abs() >= PI;
    match column.values.windows(2).position(jumps) {
        None => Ok(()),
        Some(at) => Err(PathError::Jump {
            column: column.name.clone(),
            sample: at + 1,
            found: column.values[at + 1],
            before: column.values[at],
        }),
    }
}
