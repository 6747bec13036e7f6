//! Tables that are refused, each with its line and what to do.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use flexlink::csv::{
    MotionTable, TableError, TableFormat, read_hub_reference, read_motion_table_as,
    read_torque_table_as,
};

use crate::snapshot;

/// The form that options such as `--columns time=1 --skip 2` describe.
pub(crate) fn format_of(words: &str) -> TableFormat {
    let mut format = TableFormat::default();
    for option in words.split("--").filter(|option| !option.is_empty()) {
        let (name, value) = option.trim().split_once(' ').unwrap();
        match name {
            "columns" => {
                format.columns = value.split(',').map(|one| one.parse().unwrap()).collect();
            }
            "scale" => format.scales = vec![value.parse().unwrap()],
            "skip" => format.skip = value.parse().unwrap(),
            "unit" => format.unit = Some(value.parse().unwrap()),
            "time-unit" => format.time_unit = Some(value.parse().unwrap()),
            "sample-rate" => format.sample_rate = Some(value.parse().unwrap()),
            "resample" => format.resample_s = Some(value.parse().unwrap()),
            "decimal" => format.decimal = Some(value.parse().unwrap()),
            _ => format.delimiter = Some(value.parse().unwrap()),
        }
    }
    format
}

#[test]
fn refusals_are_those_of_the_snapshot() {
    snapshot::compare("tables.txt", |section, words, input| {
        let (kind, name) = section.split_once(": ").unwrap();
        let column = words.strip_prefix("--column ").or(words.strip_suffix("--column"));
        let format = if column.is_some() { TableFormat::default() } else { format_of(words) };
        let motion = || read_motion_table_as(name, input.as_bytes(), &[1.5], &format);
        let refused: Option<TableError> = match kind {
            "Torques" => read_torque_table_as(name, input.as_bytes(), 1, column, &format).err(),
            "Motions" => motion().err(),
            "Samples that are no motion" => motion().and_then(MotionTable::into_motion).err(),
            "Motions of the hub" => read_hub_reference(name, input.as_bytes()).err(),
            _ => motion().and_then(MotionTable::into_target).err(),
        };
        let error = refused.expect(input);
        snapshot::told(&error, error.hint())
    });
}
