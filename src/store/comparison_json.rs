use serde::Serialize;

use super::golden::GoldenChanges;
use super::json::json;
use crate::compare::{
    ColumnComparison, Comparison, FileComparison, FileOutcome, RowPlace, TableComparison, Unmatched,
};

#[derive(Debug, Serialize)]
struct ComparisonRecord<'a> {
    equal: bool,
    files: Vec<FileRecord<'a>>,
    /// Number of files that are no tables.
    not_compared: usize,
    blessed: Option<BlessedRecord<'a>>,
}

#[derive(Debug, Serialize)]
struct BlessedRecord<'a> {
    written: Vec<&'a str>,
    removed: &'a [String],
}

#[derive(Debug, Serialize)]
struct FileRecord<'a> {
    file: &'a str,
    outcome: &'static str,
    /// Nothing where one side alone has the file.
    table: Option<TableRecord<'a>>,
}

#[derive(Debug, Serialize)]
struct TableRecord<'a> {
    /// Name of the column; nothing where rows were matched by their number.
    matched_by: Option<&'a str>,
    rows: usize,
    columns: Vec<ColumnRecord<'a>>,
    columns_only_in_expected: &'a [String],
    columns_only_in_actual: &'a [String],
    rows_only_in_expected: Option<RowsRecord>,
    rows_only_in_actual: Option<RowsRecord>,
}

#[derive(Debug, Serialize)]
struct RowsRecord {
    count: usize,
    first: PlaceRecord,
}

#[derive(Debug, Serialize)]
struct PlaceRecord {
    line: u64,
    key: Option<f64>,
}

#[derive(Debug, Serialize)]
struct ColumnRecord<'a> {
    column: &'a str,
    outcome: &'static str,
    peak: f64,
    rtol: Option<f64>,
    atol: Option<f64>,
    allowed: Option<f64>,
    rows_beyond: usize,
    worst: Option<WorstRecord<'a>>,
}

#[derive(Debug, Serialize)]
struct WorstRecord<'a> {
    /// Nothing where not both fields are finite numbers.
    difference: Option<f64>,
    /// Nothing where the peak is 0, too.
    relative_to_peak: Option<f64>,
    expected: PlaceRecord,
    actual: PlaceRecord,
    expected_field: &'a str,
    actual_field: &'a str,
}

/// The JSON text of a comparison, and of what was changed after it.
///
/// Differences are in the columns' own units; those that are no finite numbers are null.
pub fn comparison_json(comparison: &Comparison, blessed: Option<&GoldenChanges>) -> String {
    json(&ComparisonRecord {
        equal: comparison.is_equal(),
        files: comparison.files.iter().map(FileRecord::of).collect(),
        not_compared: comparison.not_compared,
        blessed: blessed.map(|changes| BlessedRecord {
            written: changes.written.keys().map(String::as_str).collect(),
            removed: &changes.removed,
        }),
    })
}

impl<'a> FileRecord<'a> {
    fn of(file: &'a FileComparison) -> Self {
        let (outcome, table) = match &file.outcome {
            FileOutcome::Compared(table) if table.is_equal() => ("equal", Some(table)),
            FileOutcome::Compared(table) => ("different", Some(table)),
            FileOutcome::OnlyExpected(_) => ("only in expected", None),
            FileOutcome::OnlyActual(_) => ("only in actual", None),
        };
        Self { file: &file.name, outcome, table: table.map(TableRecord::of) }
    }
}

impl<'a> TableRecord<'a> {
    fn of(table: &'a TableComparison) -> Self {
        Self {
            matched_by: table.matched_by.as_deref(),
            rows: table.rows,
            columns: table.columns.iter().map(ColumnRecord::of).collect(),
            columns_only_in_expected: &table.columns_expected,
            columns_only_in_actual: &table.columns_actual,
            rows_only_in_expected: table.rows_expected.map(RowsRecord::of),
            rows_only_in_actual: table.rows_actual.map(RowsRecord::of),
        }
    }
}

impl RowsRecord {
    fn of(rows: Unmatched) -> Self {
        Self { count: rows.count, first: PlaceRecord::of(rows.first) }
    }
}

impl PlaceRecord {
    fn of(place: RowPlace) -> Self {
        Self { line: place.line, key: place.key }
    }
}

impl<'a> ColumnRecord<'a> {
    fn of(column: &'a ColumnComparison) -> Self {
        let outcome = match column.tolerance {
            None => "ignored",
            Some(_) if column.fails() => "beyond",
            Some(_) => "within",
        };
        let finite = |number: f64| Some(number).filter(|number| number.is_finite());
        let worst = column.worst.as_ref().map(|worst| WorstRecord {
            difference: finite(worst.difference),
            relative_to_peak: finite(column.relative()),
            expected: PlaceRecord::of(worst.expected),
            actual: PlaceRecord::of(worst.actual),
            expected_field: &worst.expected_field,
            actual_field: &worst.actual_field,
        });
        Self {
            column: &column.name,
            outcome,
            peak: column.peak,
            rtol: column.tolerance.map(|tolerance| tolerance.rtol),
            atol: column.tolerance.map(|tolerance| tolerance.atol),
            allowed: column.allowed(),
            rows_beyond: column.rows_beyond,
            worst,
        }
    }
}
