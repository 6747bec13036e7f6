//! CSV ⇄ data: every column's name and unit once; reading, and writing whole files or none.

mod csv_table;
mod folder;
mod header;
mod motion_csv;
mod motion_error;
mod number;
mod resample;
mod rows;
mod time_format;

pub use csv_table::{Column, ColumnGroup, write_csv};
pub use folder::{FolderAction, FolderError, OutputFolder};
pub use motion_csv::{MotionTable, read_motion_table};
pub use motion_error::MotionFileError;
pub use number::{Digits, DigitsError, NumberFormat};
pub use time_format::time_format;
