use super::column::{ColumnComparison, compare_column};
use super::pairing::{Pairing, key};
use super::table::{RowPlace, Table, TableColumn};
use super::tolerance::{ColumnRule, Rule, Tolerances};

/// Rows that only one side has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unmatched {
    /// Their number, above 0.
    pub count: usize,
    /// The first of them.
    pub first: RowPlace,
}

/// The comparison of two tables.
#[derive(Debug, Clone, PartialEq)]
pub struct TableComparison {
    /// Name of the column that rows were matched by; `None`: by their number.
    pub matched_by: Option<String>,
    /// Number of rows that both sides have.
    pub rows: usize,
    /// The columns that both sides have, and those of either that are not compared, in the order of
    /// EXPECTED, then of ACTUAL.
    pub columns: Vec<ColumnComparison>,
    /// Names of columns that only EXPECTED has.
    pub columns_expected: Vec<String>,
    /// Names of columns that only ACTUAL has.
    pub columns_actual: Vec<String>,
    /// Rows that only EXPECTED has.
    pub rows_expected: Option<Unmatched>,
    /// Rows that only ACTUAL has.
    pub rows_actual: Option<Unmatched>,
}

impl TableComparison {
    /// True if the two are the same within tolerance.
    pub fn is_equal(&self) -> bool {
        let complete = self.columns_expected.is_empty() && self.columns_actual.is_empty();
        let matched = self.rows_expected.is_none() && self.rows_actual.is_none();
        complete && matched && !self.columns.iter().any(ColumnComparison::fails)
    }

    /// The columns beyond tolerance, the worst first.
    pub fn failing(&self) -> Vec<&ColumnComparison> {
        let mut failing: Vec<_> = self.columns.iter().filter(|column| column.fails()).collect();
        failing.sort_by(|a, b| b.severity().total_cmp(&a.severity()));
        failing
    }
}

/// Compares two tables that the rules know as `file`.
///
/// Rows are matched by EXPECTED's first column if both sides have it, it is not ignored and increases
/// on both; otherwise by their number. The order of columns does not matter.
pub fn compare_tables(
    file: &str,
    expected: &Table,
    actual: &Table,
    tolerances: &Tolerances,
) -> TableComparison {
    let rule = |name: &str| tolerances.rule(file, name);
    let compared = |name: &&str| rule(name) != Rule::Ignore;
    let keys = key(expected, actual).filter(|[key, _]| compared(&key.name()));
    let pairing = pair(expected, actual, keys);
    let place = |e: usize, a: usize| {
        let [left, right] = [0, 1].map(|side| keys.map(|keys| keys[side]));
        (place_of(expected, left, e), place_of(actual, right, a))
    };
    let columns = expected.columns.iter().filter_map(|column| match rule(column.name()) {
        Rule::Ignore => Some(ignored(column)),
        Rule::Within(tolerance) => {
            let other = actual.column(column.name())?;
            Some(compare_column(column, other, tolerance, &pairing, place))
        }
    });
    let only_actual =
        actual.columns.iter().filter(|column| expected.column(column.name()).is_none());
    let columns =
        columns.chain(only_actual.filter(|column| !compared(&column.name())).map(ignored));
    let alone = |side: &Table, other: &Table| {
        let missing = |name: &&str| other.column(name).is_none();
        side.names().filter(missing).filter(compared).map(str::to_owned).collect()
    };
    // If no column is compared, missing rows do not count.
    let any = expected.names().chain(actual.names()).any(|name| compared(&name));
    let unmatched = |rows: &[usize], place: &dyn Fn(usize) -> RowPlace| {
        let first = rows.first().filter(|_| any)?;
        Some(Unmatched { count: rows.len(), first: place(*first) })
    };
    TableComparison {
        matched_by: keys.map(|[key, _]| key.name().to_owned()),
        rows: pairing.pairs.len(),
        columns: columns.collect(),
        columns_expected: alone(expected, actual),
        columns_actual: alone(actual, expected),
        rows_expected: unmatched(&pairing.expected, &|row| {
            place_of(expected, keys.map(|keys| keys[0]), row)
        }),
        rows_actual: unmatched(&pairing.actual, &|row| {
            place_of(actual, keys.map(|keys| keys[1]), row)
        }),
    }
}

fn pair(expected: &Table, actual: &Table, keys: Option<[&TableColumn; 2]>) -> Pairing {
    match keys.map(|keys| keys.map(TableColumn::increasing)) {
        Some([Some(left), Some(right)]) => Pairing::by_key(left, right),
        _ => Pairing::by_number(expected.lines.len(), actual.lines.len()),
    }
}

fn place_of(table: &Table, key: Option<&TableColumn>, row: usize) -> RowPlace {
    RowPlace { line: table.lines[row], key: key.map(|key| key.number(row)) }
}

fn ignored(column: &TableColumn) -> ColumnComparison {
    ColumnComparison {
        name: column.name().to_owned(),
        peak: column.peak(),
        tolerance: None,
        worst: None,
        rows_beyond: 0,
    }
}

/// One file that EXPECTED, ACTUAL or both have.
#[derive(Debug, Clone, PartialEq)]
pub struct FileComparison {
    /// Path from the folders that are compared, with slashes.
    pub name: String,
    /// The result.
    pub outcome: FileOutcome,
}

/// The result for one file.
#[derive(Debug, Clone, PartialEq)]
pub enum FileOutcome {
    /// Both sides have it.
    Compared(TableComparison),
    /// Only EXPECTED has it, with these columns.
    OnlyExpected(Vec<String>),
    /// Only ACTUAL has it, with these columns.
    OnlyActual(Vec<String>),
}

impl FileComparison {
    /// True if both sides have it, the same within tolerance.
    pub fn is_equal(&self) -> bool {
        matches!(&self.outcome, FileOutcome::Compared(table) if table.is_equal())
    }

    /// Names of its columns on either side.
    fn columns(&self) -> Vec<&str> {
        match &self.outcome {
            FileOutcome::OnlyExpected(names) | FileOutcome::OnlyActual(names) => {
                names.iter().map(String::as_str).collect()
            }
            FileOutcome::Compared(table) => {
                let both = table.columns.iter().map(|column| &column.name);
                let alone = table.columns_expected.iter().chain(&table.columns_actual);
                both.chain(alone).map(String::as_str).collect()
            }
        }
    }
}

/// The comparison of all files of two sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The files, in the order of their names.
    pub files: Vec<FileComparison>,
    /// Number of files on either side that are no tables.
    pub not_compared: usize,
}

impl Comparison {
    /// True if nothing differs beyond tolerance.
    pub fn is_equal(&self) -> bool {
        self.files.iter().all(FileComparison::is_equal)
    }

    /// The rules that name no column of any file.
    pub fn idle<'a>(&self, tolerances: &'a Tolerances) -> Vec<&'a ColumnRule> {
        let files: Vec<_> = self.files.iter().map(|file| (&file.name, file.columns())).collect();
        let is_idle = |entry: &&ColumnRule| {
            !files.iter().any(|(file, names)| names.iter().any(|name| entry.names(file, name)))
        };
        tolerances.entries.iter().filter(is_idle).collect()
    }
}
