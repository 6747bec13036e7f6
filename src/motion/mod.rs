//! The wanted tip motion: sampled columns, their checks, spectrum and cut-off.

mod chebyshev;
mod cutoff;
mod cutoff_search;
mod error;
mod images;
mod period;
mod profile;
mod samples;
mod scale;
mod shared;
mod spectrum;
mod target;
mod tip_motion;

pub use cutoff::{Cutoff, LOOSER, Shortfall};
pub use error::{MotionColumn, MotionError};
pub use images::{Images, TAIL_TERMS, TailTerms, tail_sum};
pub use period::{TipHistories, TipPeriod};
pub use profile::Profile;
pub use samples::MotionColumns;
pub use scale::MotionScale;
pub use shared::Periods;
pub use spectrum::TipSpectrum;
pub use target::{TipMotionHistories, TipTarget};
pub use tip_motion::{EndVelocity, TipMotion};
