//! A check behind every row of a sweep that is not finished: a number that was changed in it is noticed.

use super::input::sha256;
use super::table_error::{Place, TableError, quoted};

/// The last column of a part of the rows: the first digits of the SHA-256 of what stands before it.
pub(crate) const CHECK: &str = "check";

const CHECK_DIGITS: usize = 8;

/// Rows with the check of each behind it; one that is cut off has none.
pub fn checked_rows(rows: &str) -> String {
    let checked = |row: &str| match row.strip_suffix('\n') {
        Some(row) => format!("{row},{}\n", check_of(row)),
        None => row.to_owned(),
    };
    rows.split_inclusive('\n').map(checked).collect()
}

/// The row that names the columns of checked rows, with its line end.
pub fn checked_header(header: &str) -> String {
    format!("{},{CHECK}\n", header.trim_end())
}

/// Lines without their last column, the check.
pub(crate) fn without_checks(text: &str) -> String {
    text.lines()
        .flat_map(|line| [line.rsplit_once(',').map_or(line, |(row, _)| row), "\n"])
        .collect()
}

fn check_of(row: &str) -> String {
    let mut digits = sha256(row.as_bytes());
    digits.truncate(CHECK_DIGITS);
    digits
}

/// Refuses a row whose content is not that of its check.
pub(crate) fn check_content(row: &str, check: &str, place: Place) -> Result<(), TableError> {
    let must = check_of(row);
    if check == must {
        return Ok(());
    }
    Err(place.refuse(CHECK, quoted(check), format!("must be {} for this row", quoted(&must))))
}
