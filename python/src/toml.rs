//! Dictionaries of Python as TOML.

use std::fmt::Write as _;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use crate::messages::{Raised, usage};

/// Changes of a link file in the form of `--set`: `{"segments.*.EI*": 4}` as `segments.*.EI*=4`.
pub(crate) fn changes(given: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let change = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String = key.extract()?;
        Ok(format!("{key}={}", toml(&key, &value)?))
    };
    given.into_iter().flatten().map(change).collect()
}

/// The text of a link file with these keys, one on each line.
pub(crate) fn document(keys: &Bound<'_, PyDict>) -> PyResult<String> {
    let mut text = String::new();
    for (key, value) in keys.iter().filter(|(_, value)| !value.is_none()) {
        let key: String = key.extract()?;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{key} = {}", toml(&key, &value)?);
    }
    Ok(text)
}

/// Deepest nesting of lists and dictionaries in a value; files have three levels.
const DEEPEST: usize = 32;

/// A value in TOML, on one line.
fn toml(key: &str, value: &Bound<'_, PyAny>) -> Result<String, Raised> {
    toml_within(key, value, DEEPEST)
}

/// A value in TOML, with at most `depth` levels of lists and dictionaries.
fn toml_within(key: &str, value: &Bound<'_, PyAny>, depth: usize) -> Result<String, Raised> {
    let Some(inner) = depth.checked_sub(1) else {
        let key = key.split('.').next().unwrap_or_default();
        let must = format!("must be at most {DEEPEST} deep");
        let message = format!("{key} = nested lists or dictionaries, but {must}");
        return Err(usage(&message, Some("a value that holds itself has no end")).into());
    };
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(flag.is_true().to_string());
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(quoted(&text.to_cow()?));
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_string());
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(number(value.extract()?));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let pair = |(name, own): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let name: String = name.extract()?;
            Ok(format!(
                "{} = {}",
                quoted(&name),
                toml_within(&format!("{key}.{name}"), &own, inner)?
            ))
        };
        let given = table.iter().filter(|(_, own)| !own.is_none());
        let pairs = given.map(pair).collect::<Result<Vec<String>, Raised>>()?;
        return Ok(format!("{{{}}}", pairs.join(", ")));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| toml_within(key, &item?, inner));
        return Ok(format!("[{}]", items.collect::<Result<Vec<String>, Raised>>()?.join(", ")));
    }
    // This method converts NumPy's numbers and arrays to Python's.
    match value.call_method0("tolist") {
        Ok(plain) if !plain.get_type().is(value.get_type()) => toml_within(key, &plain, inner),
        _ => {
            let must = "must be a number, a text, a list or a dictionary";
            let message = format!("{key} = {}, but {must}", value.get_type());
            Err(PyTypeError::new_err(message).into())
        }
    }
}

/// A number with every bit; not a number and infinity as in TOML.
fn number(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:?}") }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => {
                // Writing to a string cannot fail.
                let _ = write!(quoted, "\\u{:04x}", u32::from(letter));
            }
            letter => quoted.push(letter),
        }
    }
    quoted + "\""
}
