use std::io::{self, Write};

use super::number::{Digits, NumberFormat};

/// A column of a table that is not over time; one shorter than others ends in empty fields.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlainColumn {
    name: String,
    cells: Cells,
}

#[derive(Debug, Clone, PartialEq)]
enum Cells {
    Counts(Vec<usize>),
    Values(Vec<f64>),
}

impl PlainColumn {
    /// Whole numbers.
    pub(crate) fn counts(name: &str, cells: &[usize]) -> Self {
        Self { name: name.to_owned(), cells: Cells::Counts(cells.to_vec()) }
    }

    /// Quantities, with decimals for the column's own peak.
    pub(crate) fn values(name: &str, cells: &[f64]) -> Self {
        Self::of_values(name, cells.to_vec())
    }

    /// As [`PlainColumn::values`], taking the cells instead of copying them.
    pub(crate) fn of_values(name: &str, cells: Vec<f64>) -> Self {
        Self { name: name.to_owned(), cells: Cells::Values(cells) }
    }

    fn len(&self) -> usize {
        match &self.cells {
            Cells::Counts(cells) => cells.len(),
            Cells::Values(cells) => cells.len(),
        }
    }

    fn format(&self, digits: Digits) -> NumberFormat {
        match &self.cells {
            Cells::Counts(_) => NumberFormat::Fixed(0),
            Cells::Values(cells) => {
                let finite = cells.iter().filter(|value| value.is_finite());
                digits.for_peak(finite.fold(0.0, |peak, value| peak.max(value.abs())))
            }
        }
    }

    /// Text of a cell: empty beyond the end and where there is no number.
    fn write(&self, row: usize, format: NumberFormat, out: &mut Vec<u8>) {
        match &self.cells {
            Cells::Counts(cells) => {
                if let Some(count) = cells.get(row) {
                    out.extend_from_slice(count.to_string().as_bytes());
                }
            }
            Cells::Values(cells) => {
                if let Some(value) = cells.get(row).filter(|value| value.is_finite()) {
                    format.write(out, *value);
                }
            }
        }
    }
}

/// Text of a table is written in parts of about this many bytes: a long one is nowhere as a whole.
const PART_BYTES: usize = 1 << 16;

/// Writes a header and as many rows as the longest column has.
pub(crate) fn write_plain(
    out: &mut (impl Write + ?Sized),
    columns: &[PlainColumn],
    digits: Digits,
) -> io::Result<()> {
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let formats: Vec<NumberFormat> = columns.iter().map(|column| column.format(digits)).collect();
    let mut text = names.join(",").into_bytes();
    text.push(b'\n');
    for row in 0..columns.iter().map(PlainColumn::len).max().unwrap_or(0) {
        for (number, (column, format)) in columns.iter().zip(&formats).enumerate() {
            if number > 0 {
                text.push(b',');
            }
            column.write(row, *format, &mut text);
        }
        text.push(b'\n');
        if text.len() >= PART_BYTES {
            out.write_all(&text)?;
            text.clear();
        }
    }
    out.write_all(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_columns_and_missing_values_leave_fields_empty() {
        let columns = [
            PlainColumn::counts("mode", &[1, 2, 3]),
            PlainColumn::values("zero_per_s", &[2.0, f64::INFINITY]),
        ];
        let mut out = Vec::new();
        write_plain(&mut out, &columns, Digits::BelowPeak(2)).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "mode,zero_per_s\n1,2.00\n2,\n3,\n");
    }
}
