//! Arguments as a run records them: to be given to the program again as they stand.

use std::fmt::Display;

use flexlink::csv::Digits;

/// An option and its value, one text where the value alone would be taken for an option.
pub(crate) fn option(name: &str, value: impl Display) -> Vec<String> {
    let value = value.to_string();
    if value.starts_with('-') {
        vec![format!("{name}={value}")]
    } else {
        vec![name.to_owned(), value]
    }
}

/// The digits of a run, where they are not the usual ones.
pub(crate) fn digits_arguments(digits: Digits) -> Vec<String> {
    if digits == Digits::default() { Vec::new() } else { option("--digits", digits) }
}
