//! The next effort of a repeated motion, from the measured error of the tip under the last one.

mod band;
mod correction;
mod error;
mod recorded;
mod summary;

pub use band::{Band, Contraction, Plant, Responses, responses};
pub use correction::{Correction, Saturation, Table, saturation};
pub use error::LearnError;
pub use recorded::Recorded;
pub use summary::LearnSummary;
