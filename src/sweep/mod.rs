//! Many cases of one link and motion: which values they take, the share of one machine, and their
//! work in parallel with the order kept.

mod in_order;
mod plan;
mod range;
mod rows;
mod shard;
mod variation;

pub use in_order::in_order;
pub use plan::{CaseValues, SweepPlan};
pub use rows::{PlayedCase, SolvedCase};
pub use shard::Shard;
pub use variation::{Operation, Variation, VariationError};
