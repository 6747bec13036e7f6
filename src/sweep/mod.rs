//! Many cases of one link and motion: which values they take, the share of one machine, their numbers,
//! and their work in parallel with the order kept.

mod columns;
mod in_order;
mod plan;
mod variation;

pub use columns::{CaseNumbers, PlayedCase, SolvedCase, SweepKind};
pub use in_order::in_order;
pub use plan::{CaseValues, PlanError, Shard, ShardError, SweepPlan};
pub use variation::{Operation, Variation, VariationError};
