//! The wanted tip motion: sampled columns, their checks, spectrum and cut-off.

mod cutoff;
mod images;
mod period;
mod periods;
mod profile;
mod samples;
mod scale;
mod spectrum;
mod tip_motion;

pub use images::{Images, TAIL_TERMS, TailTerms, tail_sum};
pub use period::{TipHistories, TipMotionHistories, TipPeriod};
pub use periods::Periods;
pub use profile::Profile;
pub use samples::{MotionColumns, MotionError};
pub use scale::{MotionScale, TipTarget};
pub use spectrum::{Cutoff, LOOSER, Shortfall, TipSpectrum};
pub use tip_motion::{EndVelocity, TipMotion};
