//! Many cases of one link and motion: which values they take, the share of one machine, and their
//! work in parallel with the order kept.

mod in_order;
mod plan;
mod variation;

pub use in_order::in_order;
pub use plan::{CaseValues, Shard, SweepPlan};
pub use variation::{Operation, Variation, VariationError};
