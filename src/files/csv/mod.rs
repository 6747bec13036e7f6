//! CSV: reading, writing, and numbers as text; defines the name and the unit of every column once.

mod cells;
mod columns;
mod dialect;
mod format;
mod given;
mod heading;
mod input;
mod joints;
mod motion;
mod motion_columns;
mod number;
mod outliers;
mod place;
mod quality;
mod record;
mod recorded;
mod response;
mod rows;
mod samples;
mod table;
mod uniform;
mod unit_name;

pub use format::{ColumnChoice, ColumnScale, Decimal, Delimiter, Reading, TableFormat};
pub(crate) use heading::{check_separator, refuse_missing};
pub(crate) use input::sha256;
pub use input::{InputError, InputFile, system_words};
pub use joints::{
    read_hub_reference, read_joint_references, read_joint_torques, read_tip_places,
    read_torque_table, read_torque_table_as,
};
pub use motion::{
    MotionTable, SampleRows, read_motion_table, read_motion_table_as, read_target, write_path,
    write_trajectory,
};
pub(crate) use number::time_format;
pub use number::{Digits, NumberFormat};
pub use record::{RecordTable, read_decay, read_record, read_recording, read_recording_as};
pub use response::{ResponseTable, read_frequency_response};
pub(crate) use rows::{CHECK, Place, check_content, quoted, read_rows, utf8, without_checks};
pub use rows::{TableError, checked_header, checked_rows};
pub use samples::read_table;
pub use table::{Column, ColumnGroup, write_csv};
pub(crate) use table::{write_columns, write_nodal};
pub use unit_name::UnitName;
