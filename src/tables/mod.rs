//! CSV ⇄ data: every column's name and unit once; reading, and writing whole files or none.

mod csv_table;
mod folder;
mod header;
mod input;
mod link_record;
mod motion_csv;
mod motion_error;
mod number;
mod resample;
mod rows;
mod solve_tables;
mod summary;
mod time_format;

pub use csv_table::{Column, ColumnGroup, write_csv};
pub use folder::{FolderAction, FolderError, OutputFolder};
pub use input::{InputError, InputFile};
pub use motion_csv::{MotionTable, read_motion_table};
pub use motion_error::MotionFileError;
pub use number::{Digits, DigitsError, NumberFormat};
pub use solve_tables::{OptionalTable, SolveOutputs};
pub use summary::{RunInputs, Summary};
pub use time_format::time_format;
