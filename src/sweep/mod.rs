//! Many cases of one link and motion: which values they take, the share of one machine, and their
//! work in parallel with the order kept.

mod case;
mod in_order;
mod plan;
mod shard;
mod values;
mod variation;

pub use case::{PlayedCase, SolvedCase};
pub use in_order::in_order;
pub use plan::{CaseValues, SweepPlan};
pub use shard::Shard;
pub use values::VariationError;
pub use variation::{Operation, Variation};
