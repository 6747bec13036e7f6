//! Tables from files, and the matching of their rows.

use serde::Serialize;

/// A table of named columns from a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Columns, from the left, with different names and equal numbers of rows.
    pub columns: Vec<TableColumn>,
    /// Line of every row, from 1.
    pub lines: Vec<u64>,
}

impl Table {
    /// Finds a column by its name.
    pub fn column(&self, name: &str) -> Option<&TableColumn> {
        self.columns.iter().find(|column| column.name() == name)
    }

    /// Names of all columns, from the left.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(TableColumn::name)
    }

    /// Place of a row, with its number in the column that matches rows.
    pub(super) fn place(&self, row: usize, key: Option<&TableColumn>) -> RowPlace {
        RowPlace { line: self.lines[row], key: key.map(|key| key.numbers[row]) }
    }
}

/// One column of numbers and words.
#[derive(Debug, Clone, PartialEq)]
pub struct TableColumn {
    name: String,
    /// One number a row; NaN for a word.
    numbers: Vec<f64>,
    /// Row and text, in the order of the rows; an empty field is an empty word.
    words: Vec<(usize, String)>,
}

/// The content of one field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    /// A number, which may be NaN or infinite.
    Number(f64),
    /// A text that is not a number; empty for an empty field.
    Word(&'a str),
}

/// The place of a row in its file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RowPlace {
    /// Line of the file, from 1.
    pub line: u64,
    /// Value of the row in the column that matches rows, if there is one.
    pub key: Option<f64>,
}

impl TableColumn {
    /// A column without rows.
    pub fn new(name: String) -> Self {
        Self { name, numbers: Vec::new(), words: Vec::new() }
    }

    /// Adds a row.
    pub fn push(&mut self, cell: Cell) {
        match cell {
            Cell::Number(number) => self.numbers.push(number),
            Cell::Word(word) => {
                self.words.push((self.numbers.len(), word.to_owned()));
                self.numbers.push(f64::NAN);
            }
        }
    }

    /// Heading of the column.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Content of a row, counted from 0; an empty word beyond the last.
    pub fn cell(&self, row: usize) -> Cell<'_> {
        let Some(number) = self.numbers.get(row).copied() else { return Cell::Word("") };
        if !number.is_nan() {
            return Cell::Number(number);
        }
        match self.words.binary_search_by_key(&row, |(row, _)| *row) {
            Ok(found) => Cell::Word(&self.words[found].1),
            Err(_) => Cell::Number(number),
        }
    }

    /// Number in a row; NaN for a word and beyond the last row.
    pub fn number(&self, row: usize) -> f64 {
        self.numbers.get(row).copied().unwrap_or(f64::NAN)
    }

    /// Content of a row as text.
    pub fn text(&self, row: usize) -> String {
        match self.cell(row) {
            Cell::Number(number) => number.to_string(),
            Cell::Word(word) => word.to_owned(),
        }
    }

    /// Largest absolute value of the finite numbers; 0 without one.
    pub fn peak(&self) -> f64 {
        let finite = self.numbers.iter().map(|number| number.abs()).filter(|size| size.is_finite());
        finite.fold(0.0, f64::max)
    }

    /// True if all numbers are finite and each is above the one before.
    fn is_increasing(&self) -> bool {
        self.numbers.iter().all(|number| number.is_finite())
            && self.numbers.is_sorted_by(|before, next| before < next)
    }
}

/// Largest difference of the keys of one row, relative to the distance of the nearest row: rounding moves a time by far
/// less, another step by far more.
const KEY_SHARE: f64 = 1e-3;

/// Matching of EXPECTED's rows with ACTUAL's.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Pairing {
    /// Rows of EXPECTED and ACTUAL, in order.
    pub(super) pairs: Vec<(usize, usize)>,
    /// Rows that only EXPECTED has, in order.
    pub(super) expected: Vec<usize>,
    /// Rows that only ACTUAL has, in order.
    pub(super) actual: Vec<usize>,
}

/// The column that matches rows, in EXPECTED and in ACTUAL: the first one of EXPECTED, if ACTUAL has a column with its
/// name and both increase from row to row.
pub(super) fn key<'a>(expected: &'a Table, actual: &'a Table) -> Option<[&'a TableColumn; 2]> {
    let first = expected.columns.first()?;
    let other = actual.column(first.name())?;
    (first.is_increasing() && other.is_increasing()).then_some([first, other])
}

impl Pairing {
    /// Pairs the rows by their keys, or by their number.
    pub(super) fn of(expected: &Table, actual: &Table, keys: Option<[&TableColumn; 2]>) -> Self {
        match keys {
            Some([left, right]) => Self::by_key(&left.numbers, &right.numbers),
            None => Self::by_number(expected.lines.len(), actual.lines.len()),
        }
    }

    fn by_number(expected: usize, actual: usize) -> Self {
        let both = expected.min(actual);
        Self {
            pairs: (0..both).map(|row| (row, row)).collect(),
            expected: (both..expected).collect(),
            actual: (both..actual).collect(),
        }
    }

    /// Removes rows of only one side before the first pair or after the last one, and returns their number.
    pub(super) fn leave_ends_aside(&mut self) -> usize {
        let (Some(first), Some(last)) = (self.pairs.first(), self.pairs.last()) else { return 0 };
        let all = self.expected.len() + self.actual.len();
        self.expected.retain(|row| (first.0..=last.0).contains(row));
        self.actual.retain(|row| (first.1..=last.1).contains(row));
        all - self.expected.len() - self.actual.len()
    }

    /// Pairs rows by keys, both strictly increasing.
    fn by_key(expected: &[f64], actual: &[f64]) -> Self {
        let mut found = Self::default();
        let (mut e, mut a) = (0, 0);
        while e < expected.len() && a < actual.len() {
            let (left, right) = (expected[e], actual[a]);
            let reach = KEY_SHARE * gap(expected, e).min(gap(actual, a));
            if (left - right).abs() <= reach {
                found.pairs.push((e, a));
                e += 1;
                a += 1;
            } else if left < right {
                found.expected.push(e);
                e += 1;
            } else {
                found.actual.push(a);
                a += 1;
            }
        }
        found.expected.extend(e..expected.len());
        found.actual.extend(a..actual.len());
        found
    }
}

/// Distance of a key to its nearest neighbour; infinite for a single key.
fn gap(keys: &[f64], row: usize) -> f64 {
    let before = if row > 0 { keys[row] - keys[row - 1] } else { f64::INFINITY };
    let after = keys.get(row + 1).map_or(f64::INFINITY, |next| next - keys[row]);
    before.min(after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_keep_their_row_and_a_written_nan_is_a_number() {
        let mut column = TableColumn::new("a".into());
        let cells = [Cell::Number(-3.0), Cell::Word(""), Cell::Number(2.0), Cell::Word("x")];
        for cell in cells.into_iter().chain([f64::NAN, f64::NEG_INFINITY].map(Cell::Number)) {
            column.push(cell);
        }
        for (row, cell) in cells.into_iter().enumerate() {
            assert_eq!(column.cell(row), cell);
        }
        assert!(matches!(column.cell(4), Cell::Number(nan) if nan.is_nan()));
        assert!((column.peak() - 3.0).abs() < 1e-15);
        assert!(!column.is_increasing());
    }

    #[test]
    fn keys_match_across_rounding_and_not_across_steps() {
        let expected = [-0.2, -0.1, 0.0, 0.1, 0.3];
        let actual = [-0.1 + 9e-5, 1e-17, 0.1 - 2e-4, 0.3, 0.4];
        let found = Pairing::by_key(&expected, &actual);
        assert_eq!(found.pairs, [(1, 0), (2, 1), (4, 3)]);
        assert_eq!(found.expected, [0, 3]);
        assert_eq!(found.actual, [2, 4]);
    }

    #[test]
    fn rows_at_the_ends_are_left_aside_and_gaps_are_not() {
        let expected = [-0.2, -0.1, 0.0, 0.1, 0.2, 0.3];
        let actual = [-0.1, 0.0, 0.2, 0.3, 0.4, 0.5];
        let mut found = Pairing::by_key(&expected, &actual);
        assert_eq!(found.leave_ends_aside(), 3);
        assert_eq!((&found.expected[..], &found.actual[..]), (&[3][..], &[][..]));
        let mut apart = Pairing::by_key(&[0.0, 1.0], &[5.0, 6.0]);
        assert_eq!((apart.leave_ends_aside(), apart.expected.len()), (0, 2));
    }

    #[test]
    fn a_logarithmic_key_is_measured_by_its_own_steps() {
        let expected = [1e-6, 1e-5, 1.0, 1e6];
        let actual = [1e-6 + 1e-10, 1e-5, 1.0, 1e6 * (1.0 + 1e-9)];
        assert_eq!(Pairing::by_key(&expected, &actual).pairs, [(0, 0), (1, 1), (2, 2), (3, 3)]);
    }

    #[test]
    fn single_rows_belong_together() {
        assert_eq!(Pairing::by_key(&[5.0], &[7.0]).pairs, [(0, 0)]);
    }

    #[test]
    fn the_longer_table_keeps_its_last_rows() {
        let found = Pairing::by_number(2, 4);
        assert_eq!((found.pairs.len(), found.expected.len()), (2, 0));
        assert_eq!(found.actual, [2, 3]);
    }
}
