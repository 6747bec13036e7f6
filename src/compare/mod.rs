//! Two tables, or two sets of them, held against each other column by column.
//!
//! EXPECTED is the one that is right, ACTUAL the one in question. A number may differ by
//! `atol + rtol × the column's peak in EXPECTED`, everything else not at all.

mod column;
mod compared;
mod pairing;
mod set;
mod table;
mod tolerance;

pub use column::{ColumnComparison, Worst};
pub use compared::{Place, TableComparison, Unmatched, compare_tables};
pub use set::{Comparison, FileComparison, FileOutcome};
pub use table::{Cell, Table, TableColumn};
pub use tolerance::{Change, Entry, Rule, Tolerance, Tolerances};
