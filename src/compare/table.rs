/// A table of named columns, as a file holds it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns, from the left; no two have the same name, all have as many rows.
    pub columns: Vec<TableColumn>,
    /// The line of every row, from 1.
    pub lines: Vec<u64>,
}

impl Table {
    /// The column of this name.
    pub fn column(&self, name: &str) -> Option<&TableColumn> {
        self.columns.iter().find(|column| column.name() == name)
    }

    /// The names of all columns, from the left.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(TableColumn::name)
    }
}

/// One column of numbers and words.
#[derive(Debug, Clone, PartialEq)]
pub struct TableColumn {
    name: String,
    /// One per row; NaN where a word stands.
    numbers: Vec<f64>,
    /// Row and text, in the order of the rows; an empty field is an empty word.
    words: Vec<(usize, String)>,
}

/// The content of one field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    /// A number, which may be NaN or infinite.
    Number(f64),
    /// A text that is no number; empty for an empty field.
    Word(&'a str),
}

/// The place of a row in its file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowPlace {
    /// Line of the file, from 1.
    pub line: u64,
    /// The row's value in the column that rows are matched by, if there is one.
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

    /// The heading.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The content of a row, counted from 0.
    pub fn cell(&self, row: usize) -> Cell<'_> {
        let number = self.numbers[row];
        if !number.is_nan() {
            return Cell::Number(number);
        }
        match self.words.binary_search_by_key(&row, |(row, _)| *row) {
            Ok(found) => Cell::Word(&self.words[found].1),
            Err(_) => Cell::Number(number),
        }
    }

    /// The number in a row; NaN where a word stands.
    pub fn number(&self, row: usize) -> f64 {
        self.numbers[row]
    }

    /// The content of a row as text.
    pub fn text(&self, row: usize) -> String {
        match self.cell(row) {
            Cell::Number(number) => number.to_string(),
            Cell::Word(word) => word.to_owned(),
        }
    }

    /// Largest absolute value of its finite numbers; 0 where it has none.
    pub fn peak(&self) -> f64 {
        let finite = self.numbers.iter().map(|number| number.abs()).filter(|size| size.is_finite());
        finite.fold(0.0, f64::max)
    }

    /// Its numbers, if all are finite and each is above the one before.
    pub(super) fn increasing(&self) -> Option<&[f64]> {
        let finite = self.numbers.iter().all(|number| number.is_finite());
        let rising = self.numbers.windows(2).all(|pair| pair[0] < pair[1]);
        (finite && rising).then_some(&self.numbers)
    }
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
        assert_eq!(column.increasing(), None);
    }
}
