//! The table of the next effort of `learn`, and its record.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::json::{FORMAT, Fingerprint, json};
use super::names::{ANGLE, Form, TORQUE};
use crate::csv::{Column, ColumnGroup, Digits, write_csv};
use crate::learn::{LearnSummary, Table};
use crate::link::Arm;
use crate::result::Notice;
use crate::robust::Hold;

const COMMAND: &str = "learn";

/// Inputs of a step: its files, and its arguments as the program takes them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LearnInputs {
    /// The link file.
    pub link: Fingerprint,
    /// The motion.
    pub motion: Fingerprint,
    /// The recording.
    pub measured: Fingerprint,
    /// The applied table; absent for that of `solve`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub applied: Option<Fingerprint>,
    /// The record of the fit that gives intervals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<Fingerprint>,
    /// Its arguments.
    pub arguments: Vec<String>,
}

#[derive(Serialize)]
struct Record<'a> {
    format: u32,
    flexlink: &'static str,
    command: &'static str,
    title: &'a str,
    inputs: &'a LearnInputs,
    #[serde(flatten)]
    summary: &'a LearnSummary,
    warnings: &'a [Notice],
}

/// The record of a step as JSON.
pub fn learn_json(
    (title, inputs): (&str, &LearnInputs),
    summary: &LearnSummary,
    warnings: &[Notice],
) -> String {
    let (flexlink, command) = (env!("CARGO_PKG_VERSION"), COMMAND);
    json(&Record { format: FORMAT, flexlink, command, title, inputs, summary, warnings })
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
    let form = Form::of(arm.links().iter().map(|own| &own.link));
    let file = if hold == Hold::Position { &ANGLE } else { &TORQUE };
    let columns = table.joints.iter().enumerate().flat_map(|(joint, columns)| {
        columns.iter().enumerate().map(move |(number, values)| Column {
            name: file.column(form, joint, number),
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
