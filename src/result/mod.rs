//! What a run found: the numbers that a person reads first.

mod metrics;

pub use metrics::{Metrics, Peak, TIMING_LEVEL};
