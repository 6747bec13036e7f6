//! Files of a sweep: its table, its record, its rows while they come, its shards.

mod file;
mod identity;
mod record;
mod rows;
mod table;

pub use file::{LeftRows, Resumed, SweepFile};
pub use identity::{SweepIdentity, SweepInputs};
pub use record::{ForeignRecord, sweep_files, write_sweep};
pub(super) use record::{is_sweep, read_sweep};
pub use rows::{SweepRows, SweptCase, merge_shards};
pub use table::{sweep_header, sweep_row};
