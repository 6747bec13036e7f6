//! Files of a sweep: its table, its record, its rows while they come, its shards.

mod file;
mod identity;
mod merge;
mod record;
mod resume;
mod rows;
mod table;

pub use file::SweepFile;
pub use identity::{SweepIdentity, SweepInputs};
pub use merge::merge_shards;
pub(super) use record::read_record;
pub use record::{ForeignRecord, check_record, sweep_files, write_sweep};
pub use resume::{LeftRows, Resumed};
pub use rows::{SweepRows, SweptCase};
pub(super) use table::{ERROR, WARNINGS};
pub use table::{SweepColumn, SweepRecord, sweep_columns, sweep_header, sweep_row};
