//! Comparison of two tables, or of two sets of them, column by column.
//!
//! EXPECTED is the reference, ACTUAL the table to check. A number may differ by
//! `atol + rtol × the column's peak in EXPECTED`; everything else must be equal.

mod comparison;
mod table;
mod tolerance;

pub use comparison::{
    ColumnComparison, Comparison, FileComparison, FileOutcome, TableComparison, Unmatched, Worst,
    compare_tables,
};
pub use table::{Cell, RowPlace, Table, TableColumn};
pub use tolerance::{Change, ColumnRule, Rule, Tolerance, Tolerances};
