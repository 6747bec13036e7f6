//! From the tip's motion to the hub torque.

mod analysis;

pub use analysis::Analysis;
