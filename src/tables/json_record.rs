//! Records in JSON: their format, and what to say of those that another version wrote.

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::table_error::{Place, TableError};

/// Format of all records. It grows with each change that readers of the one before must know of.
pub(super) const FORMAT: u32 = 2;

/// What tells a record from other files.
#[derive(Debug, Deserialize)]
pub(super) struct Head {
    pub(super) format: Option<u32>,
    pub(super) flexlink: Option<String>,
    pub(super) command: Option<String>,
}

/// Refuses a record of another format than this version writes and reads.
pub(super) fn check_format(
    found: Option<u32>,
    version: &str,
    place: Place,
) -> Result<(), TableError> {
    match found {
        Some(FORMAT) => Ok(()),
        Some(later) if later > FORMAT => Err(newer(refused(&later.to_string(), place), version)),
        Some(earlier) => Err(older(&earlier.to_string(), version, place)),
        None => Err(without_format(version, place)),
    }
}

/// Refuses a record of the time before records had a format.
pub(super) fn without_format(version: &str, place: Place) -> TableError {
    older("nothing", version, place)
}

fn older(found: &str, version: &str, place: Place) -> TableError {
    let hint = format!("flexlink {version} wrote it in an older format: run it again");
    refused(found, place).with_hint(hint)
}

fn refused(found: &str, place: Place) -> TableError {
    place.refuse("format", found, format!("must be {FORMAT}"))
}

/// Reads a record, or refuses it with what it `must` be and, where `place` has none, the line.
pub(super) fn parsed<T: DeserializeOwned>(
    bytes: &[u8],
    place: Place,
    must: &str,
) -> Result<T, TableError> {
    serde_json::from_slice(bytes).map_err(|error| {
        let line = u64::try_from(error.line()).ok().filter(|line| *line > 0);
        let text = error.to_string();
        let found = text.split(" at line ").next().unwrap_or_default().to_owned();
        Place { line: place.line.or(line), ..place }.refuse("content", found, must)
    })
}

/// What a record of this version must be.
pub(super) fn as_written() -> String {
    format!("must be as flexlink {} writes it", env!("CARGO_PKG_VERSION"))
}

/// Adds to an error that a later version than this one wrote the file, if one did.
pub(super) fn newer(error: TableError, version: &str) -> TableError {
    let own = env!("CARGO_PKG_VERSION");
    if numbers(version) <= numbers(own) {
        return error;
    }
    error.or_hint(format!("flexlink {version} wrote it, and this is {own}: take that version"))
}

/// The numbers of a version, the first one first.
fn numbers(version: &str) -> Vec<u64> {
    let plain = version.split(['-', '+']).next().unwrap_or_default();
    plain.split('.').map(|number| number.parse().unwrap_or(0)).collect()
}
