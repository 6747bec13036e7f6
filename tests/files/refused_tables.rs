//! Tables that are refused, each with its line and what to do.

use flexlink::csv::{
    MotionTable, TableError, read_hub_reference, read_motion_table, read_torque_table,
};

use crate::snapshot;

#[test]
fn refusals_are_those_of_the_snapshot() {
    snapshot::compare("tables.txt", |section, words, input| {
        let (kind, name) = section.split_once(": ").unwrap();
        let column = words.strip_prefix("--column").map(str::trim);
        let motion = || read_motion_table(name, input.as_bytes(), 1.5);
        let refused: Option<TableError> = match kind {
            "Torques" => read_torque_table(name, input.as_bytes(), column).err(),
            "Motions" => motion().err(),
            "Samples that are no motion" => motion().and_then(MotionTable::into_motion).err(),
            "Motions of the hub" => read_hub_reference(name, input.as_bytes()).err(),
            _ => motion().and_then(MotionTable::into_target).err(),
        };
        let error = refused.expect(input);
        match error.hint() {
            Some(hint) => format!("{error}\nhint: {hint}"),
            None => error.to_string(),
        }
    });
}
