//! The cells of a row or a column, which share one format.

use super::decimals::{Decimals, Spelled};
use super::number::NumberFormat;

/// How cells are written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    format: NumberFormat,
    /// Where many at a time can be.
    decimals: Option<Decimals>,
}

/// Numbers that are ready to be written.
pub(super) struct ReadyCells<'a> {
    cells: Cells,
    values: &'a [f64],
    spelled: &'a [Spelled],
}

impl Cells {
    pub(super) fn new(format: NumberFormat) -> Self {
        let decimals = match format {
            NumberFormat::Fixed(count) => Decimals::new(count),
            NumberFormat::Shortest => None,
        };
        Self { format, decimals }
    }

    /// Makes these numbers ready, in memory that serves again and again.
    pub(super) fn of<'a>(
        &self,
        values: &'a [f64],
        spelled: &'a mut Vec<Spelled>,
    ) -> ReadyCells<'a> {
        if let Some(decimals) = &self.decimals {
            decimals.spell(values, spelled);
        }
        ReadyCells { cells: *self, values, spelled }
    }
}

impl ReadyCells<'_> {
    /// Appends a separator and the number of cell `k`.
    pub(super) fn append(&self, out: &mut Vec<u8>, separator: u8, k: usize) {
        let value = self.values[k];
        if let Some(decimals) = &self.cells.decimals {
            decimals.append(out, separator, self.spelled, (k, value));
        } else {
            out.push(separator);
            self.cells.format.write(out, value);
        }
    }
}
