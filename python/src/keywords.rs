//! Keywords of a call as options of the command, dictionaries as TOML.

use std::fmt::Write as _;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use flexlink::text::did_you_mean;

use crate::messages::usage;
use crate::options::common::option;
use crate::terminal::Failure;

/// Keywords as the command's arguments: `resample=0.001` as `--resample 0.001`, `True` as an option without a value. None
/// and `False` are left out.
pub(crate) fn arguments(keywords: &Bound<'_, PyDict>) -> PyResult<Vec<String>> {
    let mut found = Vec::new();
    for (key, value) in keywords {
        let name = format!("--{}", key.extract::<String>()?.replace('_', "-"));
        if value.is_none() {
            continue;
        }
        match value.cast::<PyBool>() {
            Ok(flag) if flag.is_true() => found.push(name),
            Ok(_) => {}
            Err(_) => found.extend(option(&name, words(&value)?)),
        }
    }
    Ok(found)
}

/// Keywords of a `write` as arguments; others than the `known` are refused.
pub(crate) fn of_writing(
    keywords: Option<&Bound<'_, PyDict>>,
    known: &[&str],
) -> PyResult<Vec<String>> {
    let Some(keywords) = keywords else { return Ok(Vec::new()) };
    for key in keywords.keys() {
        let key: String = key.extract()?;
        if !known.contains(&&*key) {
            return Err(unknown(&key, known.iter().copied()).into());
        }
    }
    arguments(keywords)
}

/// The refusal of a keyword that is none of the `known`.
pub(crate) fn unknown<'a>(key: &str, known: impl IntoIterator<Item = &'a str>) -> Failure {
    usage(&format!("unexpected keyword `{key}`"), did_you_mean(key, known).as_deref())
}

/// A value as the command reads it: lists with commas, dictionaries as `quantity=column`.
fn words(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(pairs) = value.cast::<PyDict>() {
        let pair = |(key, own): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok(format!("{}={}", key.str()?, own.str()?))
        };
        return Ok(pairs.iter().map(pair).collect::<PyResult<Vec<String>>>()?.join(","));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| Ok(item?.str()?.to_string()));
        return Ok(items.collect::<PyResult<Vec<String>>>()?.join(","));
    }
    Ok(value.str()?.to_string())
}

/// The refusal of keywords by the parser of the command: its first line, which names the option.
pub(crate) fn refused(error: &clap::Error) -> Failure {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    usage(&line.strip_prefix("error: ").unwrap_or(line), None)
}

/// Changes of a link file as `--set` reads them: `{"segments.*.EI*": 4}` as `segments.*.EI*=4`.
pub(crate) fn changes(given: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let change = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String = key.extract()?;
        Ok(format!("{key}={}", toml(&key, &value)?))
    };
    given.into_iter().flatten().map(change).collect()
}

/// The text of a link file with these keys, one a line.
pub(crate) fn document(keys: &Bound<'_, PyDict>) -> PyResult<String> {
    let mut text = String::new();
    for (key, value) in keys.iter().filter(|(_, value)| !value.is_none()) {
        let key: String = key.extract()?;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{key} = {}", toml(&key, &value)?);
    }
    Ok(text)
}

/// A value in TOML, on one line.
fn toml(key: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
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
            Ok(format!("{} = {}", quoted(&name), toml(&format!("{key}.{name}"), &own)?))
        };
        let given = table.iter().filter(|(_, own)| !own.is_none());
        let pairs = given.map(pair).collect::<PyResult<Vec<String>>>()?;
        return Ok(format!("{{{}}}", pairs.join(", ")));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| toml(key, &item?));
        return Ok(format!("[{}]", items.collect::<PyResult<Vec<String>>>()?.join(", ")));
    }
    // NumPy's numbers and arrays have Python's behind this.
    match value.call_method0("tolist") {
        Ok(plain) if !plain.get_type().is(value.get_type()) => toml(key, &plain),
        _ => {
            let found = value.get_type();
            let must = "must be a number, a text, a list or a dictionary";
            Err(PyTypeError::new_err(format!("{key} = {found}, but {must}")))
        }
    }
}

/// Every bit of a number, not a number and infinity as TOML writes them.
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
