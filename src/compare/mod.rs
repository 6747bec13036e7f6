//! Comparison of two tables, or of two sets of them, column by column.
//!
//! EXPECTED is the reference, ACTUAL the table to check. A number may differ by
//! `atol + rtol × the column's peak in EXPECTED`; everything else must be equal.

mod column;
mod comparison;
mod pairing;
mod table;
mod tolerance;

pub use column::{ColumnComparison, Worst};
pub use comparison::{
    Comparison, FileComparison, FileOutcome, TableComparison, Unmatched, compare_tables,
};
pub use table::{Cell, RowPlace, Table, TableColumn};
pub use tolerance::{Change, ColumnRule, Rule, Tolerance, Tolerances};
