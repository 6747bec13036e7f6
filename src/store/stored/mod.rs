//! Results read back: folders of runs and tables of sweeps, for `report` and `solve --repeat`.

mod folder;
mod repetition;
mod result;
mod run;
mod tables;

pub use repetition::{FoundInput, InputRole, RunRecord, TemporaryFolder};
pub use result::read_result;
