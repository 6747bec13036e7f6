//! The wanted tip motion: sampled columns, what they must satisfy, and their spectrum.

mod checks;
mod columns;
mod cutoff;
mod error;
mod histories;
mod images;
mod period;
mod profile;
mod scale;
mod spectrum;
mod target;
#[cfg(test)]
mod tests;
mod tip_motion;

pub use columns::MotionColumns;
pub use cutoff::{Cutoff, LOOSER, Shortfall};
pub use error::{MotionColumn, MotionError};
pub use histories::{TipHistories, TipMotionHistories};
pub use images::{Images, TAIL_TERMS, TailTerms, tail_sum};
pub use period::TipPeriod;
pub use profile::Profile;
pub use scale::MotionScale;
pub use spectrum::TipSpectrum;
pub use target::TipTarget;
pub use tip_motion::{EndVelocity, TipMotion};
