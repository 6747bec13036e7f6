//! Comparison of two tables, or of two sets of tables, column by column.
//!
//! EXPECTED is the reference, ACTUAL the table to check. A number may differ by
//! `atol + rtol × the column's peak in EXPECTED`; everything else must be equal.

mod table;

pub use table::{Cell, RowPlace, Table, TableColumn};

use serde::Serialize;
use wildmatch::WildMatch;

use table::{Pairing, key};

/// Comparison of one column of EXPECTED with that of ACTUAL.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnComparison {
    /// Heading of the column.
    pub name: String,
    /// Largest absolute value of EXPECTED's finite numbers, in the column's unit.
    pub peak: f64,
    /// Tolerance of the column; `None` if it is not compared.
    pub tolerance: Option<Tolerance>,
    /// Field with the largest difference, the first of equals; `None` if all are equal.
    pub worst: Option<Worst>,
    /// Number of rows beyond tolerance.
    pub rows_beyond: usize,
}

/// Field of a column with the largest difference.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// Absolute difference in the column's unit; infinite unless both fields are finite numbers.
    pub difference: f64,
    /// Row in EXPECTED.
    pub expected: RowPlace,
    /// Row in ACTUAL.
    pub actual: RowPlace,
    /// Field in EXPECTED as text: empty, a word or a number.
    pub expected_field: String,
    /// Field in ACTUAL as text.
    pub actual_field: String,
}

impl ColumnComparison {
    /// Largest allowed difference, in the column's unit; `None` if the column is not compared.
    pub fn allowed(&self) -> Option<f64> {
        self.tolerance.map(|tolerance| tolerance.allowed(self.peak))
    }

    /// True if a row is beyond tolerance.
    pub fn fails(&self) -> bool {
        self.rows_beyond > 0
    }

    /// Largest difference relative to the peak; 0 without a difference.
    pub fn relative(&self) -> f64 {
        self.worst.as_ref().map_or(0.0, |worst| worst.difference / self.peak)
    }

    /// Largest difference over the allowed one, for ranking.
    fn severity(&self) -> f64 {
        match (self.allowed(), &self.worst) {
            (Some(allowed), Some(worst)) => worst.difference / allowed,
            _ => 0.0,
        }
    }
}

/// Compares a common column in these pairs of rows; `place` returns their places.
fn compare_column(
    expected: &TableColumn,
    actual: &TableColumn,
    tolerance: Tolerance,
    pairs: &[(usize, usize)],
    place: impl Fn(usize, usize) -> (RowPlace, RowPlace),
) -> ColumnComparison {
    let column = ignored(expected);
    let allowed = tolerance.allowed(column.peak);
    let mut rows_beyond = 0;
    let mut largest = (0.0, None);
    for &(e, a) in pairs {
        let difference = difference(expected.cell(e), actual.cell(a));
        // Different words fail even with an infinite tolerance.
        rows_beyond += usize::from(difference > allowed || difference.is_infinite());
        if difference > largest.0 {
            largest = (difference, Some((e, a)));
        }
    }
    let worst = largest.1.map(|(e, a)| {
        let (expected_place, actual_place) = place(e, a);
        Worst {
            difference: largest.0,
            expected: expected_place,
            actual: actual_place,
            expected_field: field(expected.cell(e)),
            actual_field: field(actual.cell(a)),
        }
    });
    ColumnComparison { tolerance: Some(tolerance), worst, rows_beyond, ..column }
}

/// Absolute difference of two fields: 0 if equal, infinite if one is not a finite number.
fn difference(expected: Cell, actual: Cell) -> f64 {
    match (expected, actual) {
        (Cell::Number(e), Cell::Number(a)) if e.is_finite() && a.is_finite() => (e - a).abs(),
        (Cell::Number(e), Cell::Number(a)) if e.total_cmp(&a).is_eq() => 0.0,
        // The sign of a NaN depends on the processor.
        (Cell::Number(e), Cell::Number(a)) if e.is_nan() && a.is_nan() => 0.0,
        (Cell::Word(e), Cell::Word(a)) if e == a => 0.0,
        _ => f64::INFINITY,
    }
}

fn field(cell: Cell) -> String {
    match cell {
        Cell::Number(number) => format!("{number:?}"),
        Cell::Word(word) => word.to_owned(),
    }
}

/// Rows that only one side has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Unmatched {
    /// Number of rows, above 0.
    pub count: usize,
    /// First of the rows.
    pub first: RowPlace,
}

/// The comparison of two tables.
#[derive(Debug, Clone, PartialEq)]
pub struct TableComparison {
    /// Name of the column that matches rows; `None` for matching by number.
    pub matched_by: Option<String>,
    /// Number of common rows.
    pub rows: usize,
    /// Number of ignored rows at the ends of either side.
    pub rows_aside: usize,
    /// Common columns, and columns of either side that are not compared, in the order of EXPECTED, then of ACTUAL.
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
    /// True if both are equal within tolerance.
    pub fn is_equal(&self) -> bool {
        let complete = self.columns_expected.is_empty() && self.columns_actual.is_empty();
        let matched = self.rows_expected.is_none() && self.rows_actual.is_none();
        complete && matched && !self.columns.iter().any(ColumnComparison::fails)
    }

    /// Columns beyond tolerance, the worst first.
    pub fn failing(&self) -> Vec<&ColumnComparison> {
        let mut failing: Vec<_> = self.columns.iter().filter(|column| column.fails()).collect();
        failing.sort_by(|a, b| b.severity().total_cmp(&a.severity()));
        failing
    }
}

/// Compares two tables with the rules for `file`.
///
/// Rows are matched by EXPECTED's first column if both sides have it, it is not ignored and increases on both;
/// otherwise by their number. The order of columns does not matter. If only common rows count, all rows still count
/// when matched by number, or when less than half of EXPECTED's are common.
pub fn compare_tables(
    file: &str,
    expected: &Table,
    actual: &Table,
    tolerances: &Tolerances,
) -> TableComparison {
    let rule = |name: &str| tolerances.rule(file, name);
    let compared = |name: &&str| rule(name) != Rule::Ignore;
    let keys = key(expected, actual).filter(|[key, _]| compared(&key.name()));
    let mut pairing = Pairing::of(expected, actual, keys);
    // A table cut off half-way is no moved window.
    let has_most = 2 * pairing.pairs.len() >= expected.lines.len();
    let is_common = tolerances.common_rows && keys.is_some() && has_most;
    let rows_aside = if is_common { pairing.leave_ends_aside() } else { 0 };
    let [expected_key, actual_key] = [0, 1].map(|side| keys.map(|keys| keys[side]));
    let place = |e, a| (expected.place(e, expected_key), actual.place(a, actual_key));
    let columns = expected.columns.iter().filter_map(|column| match rule(column.name()) {
        Rule::Ignore => Some(ignored(column)),
        Rule::Within(tolerance) => {
            let other = actual.column(column.name())?;
            Some(compare_column(column, other, tolerance, &pairing.pairs, place))
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
    let unmatched = |rows: &[usize], table: &Table, key| {
        let first = rows.first().filter(|_| any)?;
        Some(Unmatched { count: rows.len(), first: table.place(*first, key) })
    };
    TableComparison {
        matched_by: keys.map(|[key, _]| key.name().to_owned()),
        rows: pairing.pairs.len(),
        rows_aside,
        columns: columns.collect(),
        columns_expected: alone(expected, actual),
        columns_actual: alone(actual, expected),
        rows_expected: unmatched(&pairing.expected, expected, expected_key),
        rows_actual: unmatched(&pairing.actual, actual, actual_key),
    }
}

/// A column that is not compared.
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
    /// Path from the compared folders, with slashes.
    pub name: String,
    /// The result.
    pub outcome: FileOutcome,
    /// Inputs that differ between the runs of two summary.json, in words.
    pub inputs: Vec<String>,
}

/// The result for one file.
#[derive(Debug, Clone, PartialEq)]
pub enum FileOutcome {
    /// Both sides have the file.
    Compared(TableComparison),
    /// Only EXPECTED has the file, with these columns.
    OnlyExpected(Vec<String>),
    /// Only ACTUAL has the file, with these columns.
    OnlyActual(Vec<String>),
}

impl FileComparison {
    /// True if both sides have the file, equal within tolerance.
    pub fn is_equal(&self) -> bool {
        matches!(&self.outcome, FileOutcome::Compared(table) if table.is_equal())
    }

    /// Names of the file's columns on either side.
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

/// Comparison of all files of two sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The files, in the order of their names.
    pub files: Vec<FileComparison>,
    /// Number of files on either side that are not tables.
    pub not_compared: usize,
}

impl Comparison {
    /// True if nothing differs beyond tolerance.
    pub fn is_equal(&self) -> bool {
        self.files.iter().all(FileComparison::is_equal)
    }

    /// Rules that match no column of any file.
    pub fn idle<'a>(&self, tolerances: &'a Tolerances) -> Vec<&'a ColumnRule> {
        let files: Vec<_> = self.files.iter().map(|file| (&file.name, file.columns())).collect();
        let is_idle = |entry: &&ColumnRule| {
            !files.iter().any(|(file, names)| names.iter().any(|name| entry.names(file, name)))
        };
        tolerances.entries.iter().filter(is_idle).collect()
    }
}

/// Largest allowed difference of a number from the expected one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Part relative to the column's peak.
    pub rtol: f64,
    /// Absolute part in the column's unit.
    pub atol: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { rtol: 1e-9, atol: 0.0 }
    }
}

impl Tolerance {
    /// Largest allowed difference in a column of this peak, in the column's unit.
    pub fn allowed(&self, peak: f64) -> f64 {
        self.atol + self.rtol * peak
    }
}

/// Comparison of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// The column is not compared and may be missing.
    Ignore,
    /// The column is compared within a tolerance.
    Within(Tolerance),
}

/// Effect of a rule on its columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// The columns are not compared.
    Ignore,
    /// The columns have another tolerance; a part that is `None` stays general.
    Tolerance {
        /// Part relative to the column's peak.
        rtol: Option<f64>,
        /// Absolute part in the column's unit.
        atol: Option<f64>,
    },
}

/// A pattern of columns, and the effect on them.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnRule {
    /// Place of the rule, for messages.
    pub place: String,
    /// Pattern of the file's name, or of its path if the pattern has a slash; `None` matches any file.
    pub file: Option<String>,
    /// Pattern of the column's name.
    pub column: String,
    /// Effect on the columns.
    pub change: Change,
}

impl ColumnRule {
    /// True if the rule matches this column of the file with this path, whose folders end in slashes.
    ///
    /// In patterns `*` matches any text and `?` one character.
    pub fn names(&self, file: &str, column: &str) -> bool {
        self.is_of(file) && WildMatch::new(&self.column).matches(column)
    }

    /// True if the rule matches columns of the file with this path.
    pub fn is_of(&self, file: &str) -> bool {
        self.file.as_deref().is_none_or(|pattern| {
            let name = file.rsplit('/').next().unwrap_or(file);
            WildMatch::new(pattern).matches(if pattern.contains('/') { file } else { name })
        })
    }
}

/// The tolerances of all columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tolerances {
    /// Tolerance of columns without a rule.
    pub general: Tolerance,
    /// Exceptions; the last matching one counts.
    pub entries: Vec<ColumnRule>,
    /// True if rows of only one side before the first common row or after the last one do not count.
    pub common_rows: bool,
}

impl Tolerances {
    /// Comparison of a column.
    pub fn rule(&self, file: &str, column: &str) -> Rule {
        let general = self.general;
        match self.entries.iter().rfind(|entry| entry.names(file, column)) {
            None => Rule::Within(general),
            Some(ColumnRule { change: Change::Ignore, .. }) => Rule::Ignore,
            Some(ColumnRule { change: Change::Tolerance { rtol, atol }, .. }) => {
                Rule::Within(Tolerance {
                    rtol: rtol.unwrap_or(general.rtol),
                    atol: atol.unwrap_or(general.atol),
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_tolerance_makes_a_word_a_number() {
        let column = |cell| {
            let mut column = TableColumn::new("a".into());
            column.push(cell);
            column
        };
        let compared = |actual| {
            let tolerance = Tolerance { rtol: f64::MAX, atol: f64::MAX };
            let place = |_, _| [1, 1].map(|line| RowPlace { line, key: None }).into();
            let expected = column(Cell::Number(2.0));
            compare_column(&expected, &column(actual), tolerance, &[(0, 0)], place)
        };
        assert!(!compared(Cell::Number(1e300)).fails());
        assert!(compared(Cell::Word("two")).fails());
    }

    #[test]
    fn only_finite_numbers_have_a_distance() {
        let number = Cell::Number;
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        for same in [
            [number(nan), number(-nan)],
            [number(inf), number(inf)],
            [number(0.0), number(-0.0)],
            [Cell::Word(""), Cell::Word("")],
            [Cell::Word("root"), Cell::Word("root")],
        ] {
            assert!(difference(same[0], same[1]) == 0.0, "{same:?}");
        }
        for other in [
            [number(nan), number(0.0)],
            [number(inf), number(-inf)],
            [number(1e308), number(inf)],
            [Cell::Word(""), number(0.0)],
            [Cell::Word(""), number(nan)],
            [Cell::Word("root"), Cell::Word("Root")],
        ] {
            assert!(difference(other[0], other[1]).is_infinite(), "{other:?}");
            assert!(difference(other[1], other[0]).is_infinite(), "{other:?}");
        }
        assert!((difference(number(1.0), number(-2.5)) - 3.5).abs() < 1e-15);
    }

    fn entry(file: Option<&str>, column: &str, change: Change) -> ColumnRule {
        let file = file.map(str::to_owned);
        ColumnRule { place: "t:1".into(), file, column: column.into(), change }
    }

    fn within(rtol: f64, atol: f64) -> Rule {
        Rule::Within(Tolerance { rtol, atol })
    }

    #[test]
    fn the_last_entry_that_names_a_column_holds_and_leaves_the_rest_general() {
        let rtol = |rtol| Change::Tolerance { rtol: Some(rtol), atol: None };
        let tolerances = Tolerances {
            general: Tolerance { rtol: 1e-6, atol: 1e-3 },
            entries: vec![
                entry(None, "v?_m", rtol(1e-4)),
                entry(None, "*", Change::Tolerance { rtol: None, atol: Some(0.5) }),
                entry(Some("t*.csv"), "v1_m", Change::Ignore),
                entry(Some("a/*.csv"), "v2_m", rtol(0.25)),
            ],
            common_rows: false,
        };
        assert_eq!(tolerances.rule("x.csv", "v1_m"), within(1e-6, 0.5));
        assert_eq!(tolerances.rule("deep/down/t.csv", "v1_m"), Rule::Ignore);
        assert_eq!(tolerances.rule("a/x.csv", "v2_m"), within(0.25, 1e-3));
        assert_eq!(tolerances.rule("b/a.csv", "v2_m"), within(1e-6, 0.5));
        let first = Tolerances { entries: tolerances.entries[..1].to_vec(), ..tolerances };
        assert_eq!(first.rule("x.csv", "v1_m"), within(1e-4, 1e-3));
        assert_eq!(first.rule("x.csv", "v10_m"), within(1e-6, 1e-3));
    }
}
