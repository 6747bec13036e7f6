//! Studies of solutions: their numbers, checks and comparisons, links that fit measurements, sweeps.

pub mod compare;
pub mod fit;
pub mod learn;
pub mod result;
pub mod robust;
pub mod sweep;
pub mod verify;
