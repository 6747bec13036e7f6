//! Errors and warnings with the command's text and hint, as Python's.

use flexlink::cli::terminal::{Exit, Failure};
use flexlink::csv::Reading;
use flexlink::result::Notice;
use pyo3::prelude::*;

use crate::wording::{hint_in_python, in_python};

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
            let hint = failure.hint.as_deref().map(hint_in_python);
            Ok(PyErr::from_value(class.call1((in_python(&failure.message), hint))?))
        };
        Self(Python::attach(|py| made(py).unwrap_or_else(|error| error)))
    }
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
        |own: &Notice| class.call1((in_python(&own.message), hint_in_python(&own.hint), &own.kind));
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
