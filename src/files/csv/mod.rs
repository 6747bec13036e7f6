//! CSV: reading, writing, and numbers as text; defines the name and the unit of every column once.

mod clock;
mod columns;
mod dialect;
mod encoding;
mod format;
mod head;
mod heading;
mod input;
mod joints;
mod motion;
mod motion_begins;
mod motion_columns;
mod number;
mod quality;
mod record;
mod recorded;
mod response;
mod rows;
mod samples;
mod table;
mod uniform;
mod unit_name;

pub use clock::ClockTime;
pub use format::{ColumnChoice, ColumnScale, Decimal, Delimiter, Reading, SampleRate, TableFormat};
pub(crate) use heading::{check_separator, refuse_missing};
pub use input::{InputError, InputFile, TableError, system_words};
pub(crate) use input::{Place, quoted, sha256};
pub use joints::{
    Joints, read_hub_reference, read_joint_references, read_joint_torques, read_tip_places,
    read_torque_table, read_torque_table_as,
};
pub use motion::{
    MotionTable, SampleRows, read_motion_table, read_motion_table_as, read_target, write_path,
    write_trajectory,
};
pub use motion_begins::MotionBegins;
pub(crate) use number::time_format;
pub use number::{Digits, NumberFormat};
pub use record::{RecordTable, read_decay, read_record, read_recording, read_recording_as};
pub use response::{ResponseTable, read_frequency_response};
pub(crate) use rows::{CHECK, check_content, read_rows, utf8, without_checks};
pub use rows::{checked_header, checked_rows, read_table};
pub use table::{Column, ColumnGroup, write_csv};
pub(crate) use table::{write_columns, write_formatted, write_nodal};
pub use unit_name::UnitName;
