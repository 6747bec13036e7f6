//! Errors that name the line of a table.

use thiserror::Error;

use crate::text::{excerpt, visible};

/// Error in a CSV file.
///
/// The text reads `traj.csv:17: displacement = nan, but must be a finite number`.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{place}: {message}")]
pub struct TableError {
    /// The file, and the faulty line if there is one.
    place: String,
    message: String,
    hint: Option<String>,
}

impl TableError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Sets the hint.
    pub(crate) fn with_hint(self, hint: impl Into<Option<String>>) -> Self {
        let hint = hint.into().map(|hint| visible(&hint).into_owned());
        Self { hint, ..self }
    }

    /// Adapts the error to a table without options of the reader: removes mentions of options.
    pub(super) fn of_named_file(self, hint: &str) -> Self {
        let message = self.message.replace("--columns", "columns");
        let speaks_of_option = self.hint.as_deref().is_some_and(|hint| hint.contains("--"));
        let is_of_unit = message.contains("unit of") || message.contains("unit in brackets");
        // A hint about the required unit helps here too, as does any hint without an option.
        let helps = |own: &String| own.starts_with("write ") || !(is_of_unit || speaks_of_option);
        let own = self.hint.filter(helps);
        let hint = match own {
            None if speaks_of_option || is_of_unit => Some(hint.to_owned()),
            own => own,
        };
        Self { place: self.place, message, hint }
    }

    /// Sets the hint unless the error has one.
    pub(crate) fn or_hint(self, hint: String) -> Self {
        let hint = self.hint.clone().or(Some(hint));
        self.with_hint(hint)
    }
}

/// Remedy for a file without options of the reader, for hints.
pub(super) const BY_HEADINGS: &str =
    "this file is read by its headings alone: correct its names, with units in brackets";

/// Place in a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    /// The file, as the user named it.
    pub(crate) file: &'a str,
    /// Line from 1; `None` for the whole file.
    pub(crate) line: Option<u64>,
}

impl Place<'_> {
    /// Error with the text *place: subject = found, but must*.
    pub(crate) fn refuse(
        &self,
        subject: impl Into<String>,
        found: impl Into<String>,
        must: impl Into<String>,
    ) -> TableError {
        let message = format!("{} = {}, but {}", subject.into(), found.into(), must.into());
        self.refuse_whole(&message)
    }

    /// Error with the text *place: column N = "name", but must*; `number` counts columns from 0.
    pub(crate) fn refuse_column(
        &self,
        number: usize,
        name: &str,
        must: impl Into<String>,
    ) -> TableError {
        self.refuse(format!("column {}", number + 1), quoted(name), must)
    }

    /// Refuses a row with another number of fields than columns.
    pub(crate) fn check_width(self, fields: usize, columns: usize) -> Result<(), TableError> {
        if fields == columns {
            return Ok(());
        }
        let must = format!("must be {columns}, as many as there are columns");
        Err(self.refuse("fields", fields.to_string(), must))
    }

    /// Error with the text *place: message*. Control characters are escaped, because a message may name columns of the
    /// file.
    pub(crate) fn refuse_whole(&self, message: &str) -> TableError {
        let place = match self.line {
            Some(line) => format!("{}:{line}", self.file),
            None => self.file.to_owned(),
        };
        TableError { place, message: visible(message).into_owned(), hint: None }
    }
}

/// A quoted excerpt of the file for a message, with escaped control characters.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", excerpt(text).escape_debug())
}
