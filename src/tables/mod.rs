//! CSV ⇄ data: every column's name and unit once; reading, and writing whole files or none.

mod csv_table;
mod folder;
mod frf_table;
mod header;
mod input;
mod link_record;
mod modes_tables;
mod motion_csv;
mod number;
mod plain_table;
mod quantity;
mod resample;
mod rows;
mod samples;
mod single_file;
mod solve_tables;
mod summary;
mod table_error;
mod time_format;
mod torque_csv;
mod torque_header;
mod trajectory_header;

pub use csv_table::{Column, ColumnGroup, write_csv};
pub use folder::{FolderAction, FolderError, OutputFolder};
pub use frf_table::write_frequency_response;
pub use input::{InputError, InputFile};
pub use modes_tables::ModesResult;
pub use motion_csv::{MotionTable, read_motion_table};
pub use number::{Digits, DigitsError, NumberFormat};
pub use single_file::write_file;
pub use solve_tables::{OptionalTable, SolveOutputs};
pub use summary::{RunInputs, Summary};
pub use table_error::TableError;
pub use time_format::time_format;
pub use torque_csv::read_torque_table;
