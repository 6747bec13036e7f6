//! CSV ⇄ data: every column's name and unit once; reading, and writing whole files or none.

mod csv_table;
mod folder;
mod frf_table;
mod header;
mod input;
mod link_record;
mod modes_tables;
mod motion_csv;
mod motion_error;
mod number;
mod plain_table;
mod resample;
mod rows;
mod single_file;
mod solve_tables;
mod summary;
mod time_format;

pub use csv_table::{Column, ColumnGroup, write_csv};
pub use folder::{FolderAction, FolderError, OutputFolder};
pub use frf_table::write_frequency_response;
pub use input::{InputError, InputFile};
pub use modes_tables::{HeldModes, ModesResult};
pub use motion_csv::{MotionTable, read_motion_table};
pub use motion_error::MotionFileError;
pub use number::{Digits, DigitsError, NumberFormat};
pub use single_file::write_file;
pub use solve_tables::{OptionalTable, SolveOutputs};
pub use summary::{RunInputs, Summary};
pub use time_format::time_format;
