//! Errors and warnings with the command's text and hint, as Python's.

use std::fmt::Write as _;

use flexlink::cli::terminal::{Exit, Failure};
use flexlink::csv::Reading;
use flexlink::result::Notice;
use pyo3::prelude::*;

/// The module that defines the classes.
const CLASSES: &str = "flexlink._messages";

/// A Python exception, from another one or from a failure of the command.
#[derive(Debug)]
pub(crate) struct Raised(PyErr);

impl From<Raised> for PyErr {
    fn from(Raised(error): Raised) -> Self {
        error
    }
}

impl From<PyErr> for Raised {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<Failure> for Raised {
    fn from(failure: Failure) -> Self {
        let class = match failure.exit {
            _ if failure.is_of_memory => "OutOfMemoryError",
            Exit::Usage | Exit::InputRefused => "InputError",
            Exit::NotSolvable | Exit::Interrupted => "NotSolvableError",
            Exit::CannotWrite => "WriteError",
        };
        let made = |py: Python<'_>| -> PyResult<PyErr> {
            let class = py.import(CLASSES)?.getattr(class)?;
            let hint = failure.hint.as_deref().map(in_python);
            Ok(PyErr::from_value(class.call1((in_python(&failure.message), hint))?))
        };
        Self(Python::attach(|py| made(py).unwrap_or_else(|error| error)))
    }
}

/// A text with keywords for options: `resample=STEP` for `--resample STEP`, and changes for `--set`.
pub(crate) fn in_python(text: &str) -> String {
    let mut rest = text;
    let mut shown = String::new();
    while let Some(at) = rest.find("--") {
        let (before, option) = (&rest[..at], &rest[at + 2..]);
        let end = option.find(|c: char| !(c.is_ascii_lowercase() || c == '-'));
        let (name, after) = option.split_at(end.unwrap_or(option.len()));
        let begins = before.chars().next_back().is_none_or(|c| " '\"`(".contains(c));
        shown.push_str(before);
        rest = after;
        match name {
            "set" if begins && after.starts_with(" '") => shown.push_str("the change"),
            "set" if begins => shown.push_str("a change"),
            _ if begins && name.starts_with(|c: char| c.is_ascii_lowercase()) => {
                shown.push_str(&name.replace('-', "_"));
                let value = after.strip_prefix(' ').unwrap_or_default();
                let quoted = value.strip_prefix('\'').and_then(|rest| rest.split_once('\''));
                if let Some((text, _)) = quoted.filter(|(text, _)| text.contains('=')) {
                    let _ = write!(shown, "={text:?}");
                    rest = &after[3 + text.len()..];
                    continue;
                }
                let value = value.split([' ', ';', ')', '`']).next().unwrap_or_default();
                let value = value.trim_end_matches([',', '.']);
                if let Some(value_of) = as_value(value) {
                    shown.push_str(&value_of);
                    rest = &after[1 + value.len()..];
                }
            }
            _ => {
                shown.push_str("--");
                shown.push_str(name);
            }
        }
    }
    shown + rest
}

/// The value of an option in the form of a keyword's value; `None` for another word.
fn as_value(word: &str) -> Option<String> {
    let is_placeholder = !word.is_empty() && word.chars().all(|c| c.is_ascii_uppercase());
    let is_number = word.parse::<f64>().is_ok();
    let is_text = word.find('=').is_some_and(|at| at > 0) || ["comma", "point"].contains(&word);
    let plain = (is_placeholder || is_number).then(|| format!("={word}"));
    plain.or_else(|| is_text.then(|| format!("={word:?}")))
}

/// Refusal of an argument.
pub(crate) fn usage(message: &impl ToString, hint: Option<&str>) -> Failure {
    Failure::new(Exit::Usage, message, hint)
}

/// A text in JSON as objects of Python.
pub(crate) fn loaded<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}

/// Remarks on forms in a file beyond the standard.
pub(crate) fn of_reading(shown: &str, reading: &Reading) -> Vec<Notice> {
    let of = |text: &str, hint| Notice::new("reading", format!("{shown}: {text}"), hint);
    let note = reading.note().map(|note| of(&note, ""));
    let remarks = reading.remarks().map(|(remark, hint)| of(remark, hint));
    note.into_iter().chain(remarks).collect()
}

/// Warnings as objects of Python.
pub(crate) fn objects<'py>(
    py: Python<'py>,
    warnings: &[Notice],
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let class = py.import(CLASSES)?.getattr("FlexlinkWarning")?;
    let made =
        |own: &Notice| class.call1((in_python(&own.message), in_python(&own.hint), &own.kind));
    warnings.iter().map(made).collect()
}

/// Gives warnings to Python's filters, at the line of the caller.
pub(crate) fn warn(py: Python<'_>, warnings: &[Notice]) -> PyResult<()> {
    if warnings.is_empty() {
        return Ok(());
    }
    let filters = py.import("warnings")?;
    for warning in objects(py, warnings)? {
        filters.call_method1("warn", (warning,))?;
    }
    Ok(())
}
