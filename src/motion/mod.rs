//! The wanted tip motion: sampled columns, their checks, spectrum and cut-off.

mod course;
mod curve;
mod cutoff;
mod ends;
mod error;
mod images;
mod path;
mod path_columns;
mod period;
mod periods;
mod profile;
mod recording;
mod samples;
mod scale;
mod spectrum;
mod tip_motion;

pub use course::Course;
pub use curve::Curve;
pub(crate) use ends::{is_repeated, wrapped};
pub(crate) use error::FEWEST_STEPS;
pub use error::{CurveError, MotionError};
pub(crate) use images::{TAIL_TERMS, TailTerms, tail_sum};
pub(crate) use path::CourseHistories;
pub use path::{ArmPath, Prescribed};
pub(crate) use path_columns::refuse_jump;
pub use path_columns::{PathColumn, PathColumns, PathError};
pub(crate) use period::TipPeriod;
pub use period::{TipHistories, TipMotionHistories};
pub use periods::Periods;
pub use profile::Profile;
pub use recording::{Recording, Uncertainty};
pub use samples::{Ends, MotionColumns};
pub use scale::{MotionScale, TipTarget};
pub(crate) use spectrum::TipSpectrum;
pub use spectrum::{Cutoff, InputBand, Shortfall};
pub use tip_motion::{EndVelocity, TipMotion};
