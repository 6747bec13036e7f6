//! The wanted tip motion: sampled columns, their checks, spectrum and cut-off.

mod course;
mod curve;
mod cutoff;
mod ends;
mod error;
mod images;
mod path;
mod period;
mod periods;
mod profile;
mod recording;
mod samples;
mod scale;
mod spectrum;
mod tip_motion;
mod uncertain;
mod wanted;

pub use course::Course;
pub use curve::Curve;
pub(crate) use ends::{is_repeated, wrapped};
pub(crate) use error::FEWEST_STEPS;
pub use error::{CurveError, MotionError, PathError};
pub(crate) use images::{TAIL_TERMS, TailTerms, tail_sum};
pub use path::{ArmPath, PathColumn, PathColumns, Prescribed};
pub(crate) use path::{CourseHistories, refuse_jump};
pub(crate) use period::TipPeriod;
pub use period::{TipHistories, TipMotionHistories};
pub use periods::Periods;
pub use profile::Profile;
pub use recording::{Between, Noise, Recording, Uncertainty};
pub use samples::{Ends, MotionColumns};
pub use scale::{MotionScale, TipTarget};
pub(crate) use spectrum::TipSpectrum;
pub use spectrum::{Cutoff, InputBand, Shortfall};
pub use tip_motion::{EndVelocity, TipMotion};
pub use wanted::Motion;
