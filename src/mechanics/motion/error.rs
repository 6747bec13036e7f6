//! Errors of sampled columns and of curves that make no motion or no path.

use thiserror::Error;

use crate::numeric::NotUniform;
use crate::text::{plain, significant};

/// Reason why sampled columns are no tip motion that can be inverted.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MotionError {
    /// Columns differ in length, have fewer than 4 samples, or lack acceleration and displacement.
    #[error(
        "the motion has {samples} samples, but must have at least 4 of time and of acceleration or \
         displacement, all columns equally long"
    )]
    Shape {
        /// Number of samples of the time column.
        samples: usize,
    },
    /// A sample is NaN or infinite.
    #[error("{column} = {found}, but must be a finite number")]
    NotFinite {
        /// Number of the sample, from 0.
        sample: usize,
        /// Name of the column.
        column: &'static str,
        /// Value of the sample.
        found: f64,
    },
    /// Integrals or differences of the samples overflow.
    #[error("the motion reaches beyond double precision, but must stay far below 1e308 in SI")]
    TooLarge,
    /// Sums and squares of the samples underflow.
    #[error(
        "the motion's acceleration peaks at {peak_m_s2:e} m/s^2, but must reach {least_m_s2:e} m/s^2: squares of \
         smaller numbers vanish"
    )]
    TooSmall {
        /// Largest acceleration in m/s².
        peak_m_s2: f64,
        /// Required peak acceleration in m/s².
        least_m_s2: f64,
    },
    /// A time is off the uniform grid.
    #[error(transparent)]
    NotUniform(#[from] NotUniform),
    /// The factors leave no motion, or an endless one.
    #[error(
        "the motion's travel times {distance} and duration times {duration}, but both factors must be finite, that \
         of the travel not 0, that of the duration above 0"
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
    /// The acceleration leaves a velocity after the last sample.
    #[error(
        "the motion ends with a velocity of {velocity_m_s:.3e} m/s, {:.2} % of its peak, but must \
         end at rest: the acceleration must integrate to 0",
        100.0 * share
    )]
    AcceleratesAway {
        /// Velocity after the last sample, ∫a dt.
        velocity_m_s: f64,
        /// Ratio of this velocity to the peak velocity.
        share: f64,
    },
    /// The acceleration of a cycle adds velocity from cycle to cycle.
    #[error(
        "the acceleration of a cycle adds a velocity of {velocity_m_s:.3e} m/s, {:.2} % of its peak, but must \
         integrate to 0",
        100.0 * share
    )]
    AddsVelocity {
        /// Added velocity in m/s.
        velocity_m_s: f64,
        /// Ratio of this velocity to the peak velocity.
        share: f64,
    },
    /// The tip moves at its start, but only its acceleration is known.
    #[error(
        "the tip's velocity at the start is not known: the acceleration alone does not determine it"
    )]
    UnknownVelocity,
    /// The last sample of a cycle repeats its first one.
    #[error("the last row of the cycle repeats the first one, but must be the row before it")]
    Repeats {
        /// Number of the last sample.
        sample: usize,
    },
    /// A cycle does not lead back to its start.
    #[error(
        "a step after its last row the cycle is {off_m:.3e} m off its start, but must be back there, or as far on as \
         the velocity column states"
    )]
    Unclosed {
        /// Number of the last sample.
        sample: usize,
        /// Distance from the start in m.
        off_m: f64,
    },
    /// The tip accelerates at an end where it should have constant velocity.
    #[error(
        "the tip accelerates with {:.2} % of its peak, but must have constant velocity at the ends of the motion",
        100.0 * share
    )]
    AcceleratingEnd {
        /// Number of the sample, the first or the last.
        sample: usize,
        /// Ratio of the acceleration to its peak.
        share: f64,
    },
    /// The tip has constant velocity.
    #[error("the tip's velocity is the same in all samples, but must change")]
    Steady,
    /// The displacement begins or ends with a velocity.
    #[error(
        "the motion {} with a velocity of {velocity_m_s:.3e} m/s, {:.2} % of its peak, but must be \
         at rest there",
        if *sample == 0 { "starts" } else { "ends" },
        100.0 * share
    )]
    MovingAtEnd {
        /// Number of the sample, the first or the last.
        sample: usize,
        /// Velocity at this sample.
        velocity_m_s: f64,
        /// Ratio of this velocity to the peak velocity.
        share: f64,
    },
    /// Two columns contradict each other.
    #[error(
        "{column} = {found} {unit}, but must be {expected:.6e} {unit} to agree with the {other}"
    )]
    Disagree {
        /// Number of the sample with the largest contradiction, from 0.
        sample: usize,
        /// The contradicting column.
        column: &'static str,
        /// Unit of the column.
        unit: &'static str,
        /// Value in the column.
        found: f64,
        /// Value that follows from the other column.
        expected: f64,
        /// The column that the motion is computed from.
        other: &'static str,
    },
}

impl MotionError {
    /// Number of the faulty sample, from 0, if the error has one.
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

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NotUniform(_) => Some(
                "write times with more decimals, or let --resample STEP make uneven samples uniform",
            ),
            Self::AcceleratesAway { .. } => Some(
                "add the samples that bring the tip to rest, or use --moving-ends or --periodic if it moves on",
            ),
            Self::MovingAtEnd { .. } => Some(
                "add the samples that bring the tip to rest, use --noise for a noisy recording, or --moving-ends or \
                 --periodic if the tip moves on",
            ),
            Self::AddsVelocity { .. } => {
                Some("give one whole cycle, without the row that begins the next one")
            }
            Self::UnknownVelocity => Some("add a column of the velocity or the displacement"),
            Self::Steady => Some(
                "change the motion: a constant velocity needs only the torque of the hub's friction",
            ),
            Self::Unclosed { .. } => Some("add a velocity column if each cycle ends farther on"),
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

/// Reason why sampled columns are no path.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PathError {
    /// Columns are missing for an arm with this number of links.
    #[error(
        "{missing} is missing: an arm of {links} links needs {}",
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
    #[error("{column} belongs to no link: the arm has {links} links")]
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
    Motion(#[from] MotionError),
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
        "{column} = {found:.6} rad, but must lie within half a turn of the {before:.6} rad before it: angles must \
         not wrap around"
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
            Self::Column { error, .. } | Self::Motion(error) => error.sample(),
            Self::Jump { sample, .. } | Self::TurnsAtEnd { sample, .. } => Some(*sample),
            _ => None,
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Column { error: MotionError::MovingAtEnd { .. }, .. }
            | Self::TurnsAtEnd { .. } => Some(
                "add the samples that bring the arm to rest, or state the noise of the samples with --noise",
            ),
            Self::Column { error: MotionError::Unclosed { .. }, .. } => {
                Some("a cycle of an arm ends where it begins, without further turns of its links")
            }
            Self::Column { error, .. } | Self::Motion(error) => error.hint(),
            Self::Jump { .. } => Some("add or subtract 2π, or 360 deg, from there on"),
            Self::TooMany { .. } => Some("leave the column out, or add the link to the arm file"),
            Self::Missing { .. } | Self::NoMotion => None,
        }
    }
}

/// Fewest steps of a move from rest to rest.
pub(crate) const FEWEST_STEPS: usize = 4;

/// Reason why points make no curve, or a curve no path.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CurveError {
    /// A coordinate or an angle is not finite or too large.
    #[error("{name} = {found:?}, but must be a number of at most 1e100 in size")]
    Range {
        /// Name of the number.
        name: &'static str,
        /// Value in m or rad.
        found: f64,
    },
    /// Two points in a row, or the start and the centre of an arc, are equal.
    #[error("points {number} and {} of the path are the same place, but must differ", number + 1)]
    Same {
        /// Number of the first one, from 1.
        number: usize,
    },
    /// The reach of rounded corners is out of range.
    #[error("the corner is {:?} m long, but must be from 1e-100 to 1e100 m", reach_m)]
    Corner {
        /// Length in m that a rounded corner takes of each leg.
        reach_m: f64,
    },
    /// An arc has no angle or no radius.
    #[error("the arc is {} m long, but must have a radius and an angle", plain(*.length_m))]
    NoArc {
        /// Length of the arc in m.
        length_m: f64,
    },
    /// A corner is too sharp to be rounded.
    #[error("the path turns by {} deg at point {number}, but must turn by at most 175 deg to be rounded", significant(turn_rad.to_degrees(), 4))]
    TurnsBack {
        /// Number of the point, from 1.
        number: usize,
        /// Turn of the path at the point in rad.
        turn_rad: f64,
    },
    /// Roundings take more than the length of a leg.
    #[error(
        "the rounded corners take {} m of the {} m from point {number} to point {}, but must not overlap",
        plain(*.taken_m),
        significant(*length_m, 5),
        number + 1
    )]
    Overlap {
        /// Number of the point before the leg, from 1.
        number: usize,
        /// Length in m that the roundings take of the leg.
        taken_m: f64,
        /// Length of the leg in m.
        length_m: f64,
    },
    /// A leg has too few of the steps.
    #[error(
        "leg {number} of the motion has {steps} of the {all} steps, but must have at least {} from rest to rest",
        FEWEST_STEPS
    )]
    FewSteps {
        /// Number of the leg, from 1.
        number: usize,
        /// Number of its steps.
        steps: usize,
        /// Number of all steps.
        all: usize,
    },
    /// The tip turns back at a stop without a rest, where the acceleration jumps.
    #[error(
        "the rest at stop {stop} = 0 steps, but must be at least 1: the tip turns back there, and the acceleration of \
         {profile} jumps"
    )]
    TurnsAtOnce {
        /// Number of the stop, from 1.
        stop: usize,
        /// Name of the profile.
        profile: &'static str,
    },
}

impl CurveError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Range { .. } | Self::Same { .. } | Self::NoArc { .. } | Self::Corner { .. } => {
                None
            }
            Self::TurnsBack { .. } => Some("leave --corner out: the tip then stops at each point"),
            Self::Overlap { .. } => Some("use a smaller --corner"),
            Self::FewSteps { .. } => Some(
                "use a longer duration or a shorter step; on the path of an arm, --corner avoids the stops",
            ),
            Self::TurnsAtOnce { .. } => {
                Some("use --dwell TIME, or a profile without jumps: sine, min-jerk or septic")
            }
        }
    }
}
