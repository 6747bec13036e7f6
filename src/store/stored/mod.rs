//! Result folders and tables of sweeps, read back: the other half of what a run writes.

mod folder;
mod link;
mod mesh;
mod nodal;
mod numbers;
mod readings;
mod record;
mod repetition;
mod result;
mod run;
mod solved;
mod summary;
mod sweep;

pub use record::{FoundInput, InputRole, RunRecord};
pub use repetition::TemporaryFolder;
pub use result::read_result;
pub use summary::is_run;
