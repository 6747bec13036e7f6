//! CSV: reading, writing, and numbers as text; the name and the unit of every column once.

mod any_table;
mod cells;
mod error;
mod fixed;
mod heading;
mod hub;
mod in_order;
mod input;
mod memory;
mod motion;
mod number;
mod resample;
mod rows;
mod samples;
mod table;

pub use any_table::read_table;
pub use error::TableError;
pub(crate) use error::{Place, quoted};
pub(crate) use heading::{check_separator, refuse_missing};
pub use hub::{read_hub_reference, read_torque_table};
pub use input::{InputError, InputFile, system_words};
pub(crate) use input::{remedy, sha256};
pub use memory::{available_addresses, available_memory};
pub use motion::{MotionTable, read_motion_table, write_trajectory};
pub use number::{Digits, DigitsError, NumberFormat, time_format};
pub(crate) use rows::read_rows;
pub(crate) use rows::{CHECK, check_content, without_checks};
pub use rows::{checked_header, checked_rows};
pub use table::{Column, ColumnGroup, write_csv};
pub(crate) use table::{group, write_columns, write_nodal};
