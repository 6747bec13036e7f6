//! Dictionaries of Python as TOML.

use std::fmt::Write as _;

use pyo3::types::{PyFloat, PyInt, PyString};

use crate::prelude::*;

/// Changes of a link file in the form of `--set`: `{"segments.*.EI*": 4}` as `segments.*.EI*=4`.
pub(crate) fn changes(changes: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let change = |(key, value): (Any<'_>, Any<'_>)| {
        let key: String = key.extract()?;
        Ok(format!("{key}={}", toml(&key, &value, DEEPEST)?))
    };
    changes.into_iter().flatten().map(change).collect()
}

/// The text of a link file with these keys, one on each line.
pub(crate) fn document(keys: &Bound<'_, PyDict>) -> PyResult<String> {
    let mut text = String::new();
    for (key, value) in keys.iter().filter(|(_, value)| !value.is_none()) {
        let key: String = key.extract()?;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{key} = {}", toml(&key, &value, DEEPEST)?);
    }
    Ok(text)
}

/// Deepest nesting of lists and dictionaries in a value; files have three levels.
const DEEPEST: usize = 32;

/// A value in TOML, with at most `depth` levels of lists and dictionaries.
fn toml(key: &str, value: &Any<'_>, depth: usize) -> Raises<String> {
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
        let number: f64 = value.extract()?;
        return Ok(if number.is_nan() { "nan".to_owned() } else { format!("{number:?}") });
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let pair = |(name, own): (Any<'_>, Any<'_>)| {
            let name: String = name.extract()?;
            let own = toml(&format!("{key}.{name}"), &own, inner)?;
            Ok(format!("{} = {own}", quoted(&name)))
        };
        let pairs = table.iter().filter(|(_, own)| !own.is_none()).map(pair);
        let pairs = pairs.collect::<Raises<Vec<String>>>()?;
        return Ok(format!("{{{}}}", pairs.join(", ")));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| toml(key, &item?, inner));
        return Ok(format!("[{}]", items.collect::<Raises<Vec<String>>>()?.join(", ")));
    }
    // This method converts NumPy's numbers and arrays to Python's.
    match value.call_method0("tolist") {
        Ok(plain) if !plain.get_type().is(value.get_type()) => toml(key, &plain, inner),
        _ => {
            let must = "must be a number, a text, a list or a dictionary";
            let message = format!("{key} = {}, but {must}", value.get_type());
            Err(PyTypeError::new_err(message).into())
        }
    }
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
