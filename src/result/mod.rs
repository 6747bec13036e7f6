//! What a run found: the numbers that a person reads first.

mod limits;
mod metrics;

pub use limits::{Exceeded, Limits};
pub use metrics::{Metrics, Peak, TIMING_LEVEL};
