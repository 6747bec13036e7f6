//! Two tables, or two sets of them, held against each other column by column.
//!
//! EXPECTED is the one that is right, ACTUAL the one in question. A number may differ by
//! `atol + rtol × the column's peak in EXPECTED`, everything else not at all.

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
