//! Errors and warnings with the command's text and hint, as Python's.

use pyo3::prelude::*;

use flexlink::csv::Reading;
use flexlink::inverse::{ArmWarning, Warning};
use flexlink::result::{CoarseMesh, Exceeded, Remark, StoredWarning};

use crate::terminal::{Exit, Failure};

/// The module that defines the classes.
const CLASSES: &str = "flexlink._messages";

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        let class = match failure.exit {
            Exit::Usage | Exit::InputRefused => "InputError",
            Exit::NotSolvable | Exit::Interrupted => "NotSolvableError",
            Exit::CannotWrite => "WriteError",
        };
        let made = |py: Python<'_>| -> PyResult<PyErr> {
            let class = py.import(CLASSES)?.getattr(class)?;
            Ok(PyErr::from_value(class.call1((failure.message, failure.hint))?))
        };
        Python::attach(|py| made(py).unwrap_or_else(|error| error))
    }
}

/// A refusal of what a call was given.
pub(crate) fn usage(message: &impl ToString, hint: Option<&str>) -> Failure {
    Failure::new(Exit::Usage, message, hint)
}

pub(crate) fn of_solution(warning: &Warning) -> StoredWarning {
    notice(warning.kind(), warning, warning.hint())
}

pub(crate) fn of_arm(warning: &ArmWarning) -> StoredWarning {
    notice(warning.kind(), warning, warning.hint())
}

pub(crate) fn of_limit(exceeded: &Exceeded) -> StoredWarning {
    notice(Exceeded::KIND, exceeded, exceeded.hint())
}

pub(crate) fn of_mesh(warning: &CoarseMesh) -> StoredWarning {
    notice(warning.kind(), warning, warning.hint())
}

/// What was found in a file beyond the standard form.
pub(crate) fn of_reading(shown: &str, reading: &Reading) -> Vec<StoredWarning> {
    let note = reading.note().map(|note| notice("reading", &format!("{shown}: {note}"), ""));
    let remarks = reading.remark().into_iter().chain(reading.jitter());
    let remarks = remarks.map(|(own, hint)| notice("reading", &format!("{shown}: {own}"), hint));
    note.into_iter().chain(remarks).collect()
}

pub(crate) fn of_remark(remark: &Remark) -> StoredWarning {
    notice(remark.kind(), remark, remark.hint())
}

/// What a user must know: its kind, its text, and what to do about it.
pub(crate) fn notice(kind: &str, message: &impl ToString, hint: &str) -> StoredWarning {
    StoredWarning { kind: kind.to_owned(), message: message.to_string(), hint: hint.to_owned() }
}

/// Warnings as objects of Python.
pub(crate) fn objects<'py>(
    py: Python<'py>,
    warnings: &[StoredWarning],
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let class = py.import(CLASSES)?.getattr("FlexlinkWarning")?;
    let made = |own: &StoredWarning| class.call1((&own.message, &own.hint, &own.kind));
    warnings.iter().map(made).collect()
}

/// Gives warnings to Python's filters, at the line of the caller.
pub(crate) fn warn(py: Python<'_>, warnings: &[StoredWarning]) -> PyResult<()> {
    if warnings.is_empty() {
        return Ok(());
    }
    let filters = py.import("warnings")?;
    for warning in objects(py, warnings)? {
        filters.call_method1("warn", (warning,))?;
    }
    Ok(())
}
