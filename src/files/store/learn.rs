//! The table of the next effort of `learn`, and the inputs of its record.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::json::Fingerprint;
use super::names::{ANGLE, Form, TORQUE};
use crate::csv::{Column, ColumnGroup, Digits, write_csv};
use crate::learn::Table;
use crate::link::Arm;
use crate::robust::Hold;

/// Inputs of a step: its files, and its arguments as the program takes them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LearnInputs {
    /// The link file; absent for a program without files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<Fingerprint>,
    /// The motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<Fingerprint>,
    /// The recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<Fingerprint>,
    /// The applied table; absent for that of `solve`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub applied: Option<Fingerprint>,
    /// The record of the fit that gives intervals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<Fingerprint>,
    /// Its arguments.
    pub arguments: Vec<String>,
}

/// Writes what the joints play, with the columns of the table of `solve`.
///
/// # Errors
/// Those of `out`.
pub fn write_next(
    out: &mut (dyn Write + Send),
    arm: &Arm,
    (table, hold): (&Table, Hold),
    digits: Digits,
) -> io::Result<()> {
    let links = arm.links().len();
    let form = Form::of(arm.links().iter().map(|own| &own.link));
    let form = |joint: usize| if joint < links { form } else { Form::Carriage };
    let file = if hold == Hold::Position { &ANGLE } else { &TORQUE };
    let columns = table.joints.iter().enumerate().flat_map(|(joint, columns)| {
        columns.iter().enumerate().map(move |(number, values)| Column {
            name: file.column(form(joint), joint, number),
            values: &values[..],
        })
    });
    let columns: Vec<Column<'_>> = columns.collect();
    let groups = if hold == Hold::Position {
        columns.into_iter().map(|own| ColumnGroup { columns: vec![own] }).collect()
    } else {
        vec![ColumnGroup { columns }]
    };
    write_csv(out, &table.grid.thinned(std::num::NonZeroUsize::MIN), &groups, digits)
}
