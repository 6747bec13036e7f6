//! Keywords of a call as options of the command, dictionaries as TOML.

use std::error::Error as _;
use std::fmt::Write as _;

use clap::error::{ContextKind, ContextValue, ErrorKind};

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use flexlink::cli::options::common::option;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::terminal::Failure;
use flexlink::text::did_you_mean;

use crate::messages::{Raised, usage};
use crate::motion::COLUMNS;

/// Gives keywords the names of their options.
pub(crate) fn rename(keywords: &Bound<'_, PyDict>, renamed: &[(&str, &str)]) -> PyResult<()> {
    for (option, name) in renamed {
        if let Some(value) = keywords.get_item(name)? {
            keywords.del_item(name)?;
            keywords.set_item(option, value)?;
        }
    }
    Ok(())
}

/// Refuses options of the command with another form in a call.
pub(crate) fn refuse_commands(keywords: &Bound<'_, PyDict>) -> Result<(), Raised> {
    let others = [
        ("set", r#"link.changed({"payload.mass": 0.2}) is the link with a change"#),
        ("verify", "write the solution's link and motion as files for `flexlink verify`"),
    ];
    for (name, hint) in others {
        if keywords.contains(name)? {
            return Err(usage(&format!("unexpected keyword `{name}`"), Some(hint)).into());
        }
    }
    Ok(())
}

/// Keywords as the command's arguments: `resample=0.001` as `--resample 0.001`, `True` as an option without a value.
/// Skips None and `False`.
pub(crate) fn arguments(keywords: &Bound<'_, PyDict>) -> PyResult<Vec<String>> {
    let mut found = Vec::new();
    for (key, value) in keywords {
        let name = format!("--{}", key.extract::<String>()?.replace('_', "-"));
        if value.is_none() {
            continue;
        }
        let of = value.get_type();
        if of.module()?.to_cow()? == "flexlink" {
            let must = "must be a number, a text or the path of a file";
            return Err(PyTypeError::new_err(format!("{key} = {of}, but {must}")));
        }
        match value.cast::<PyBool>() {
            Ok(flag) if flag.is_true() => found.push(name),
            Ok(_) => {}
            Err(_) => found.extend(option(&name, words(&value)?)),
        }
    }
    Ok(found)
}

/// Keywords of a `write` as arguments; refuses keywords outside the `known` ones.
pub(crate) fn of_writing(
    keywords: Option<&Bound<'_, PyDict>>,
    known: &[&str],
) -> Result<Vec<String>, Raised> {
    let Some(keywords) = keywords else { return Ok(Vec::new()) };
    for key in keywords.keys() {
        let key: String = key.extract()?;
        if !known.contains(&&*key) {
            return Err(unknown(&key, known.iter().copied()).into());
        }
    }
    Ok(arguments(keywords)?)
}

/// Refusal of a keyword outside the `known` ones.
pub(crate) fn unknown<'a>(key: &str, known: impl IntoIterator<Item = &'a str>) -> Failure {
    // A keyword of other calls must not be its own suggestion.
    let hint = did_you_mean(key, known.into_iter().filter(|other| *other != key));
    usage(&format!("unexpected keyword `{key}`"), hint.as_deref())
}

/// A value in the form of the command: lists with commas, dictionaries as `quantity=column`.
fn words(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(pairs) = value.cast::<PyDict>() {
        let pair = |(key, own): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok(format!("{}={}", key.str()?, own.str()?))
        };
        return Ok(pairs.iter().map(pair).collect::<PyResult<Vec<String>>>()?.join(","));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| Ok(item?.str()?.to_string()));
        return Ok(items.collect::<Result<Vec<String>, Raised>>()?.join(","));
    }
    Ok(value.str()?.to_string())
}

/// Keywords as the options of `solve`.
pub(crate) fn solve_options(arguments: &[String]) -> Result<SolveOptions, Failure> {
    let refused =
        |error| refused::<SolveOptions>(&error, &[&COLUMNS[..], &["x", "y"]].concat(), &[]);
    SolveOptions::recorded(arguments).map_err(refused)
}

/// The parser's refusal of keywords for the options `T`. `others` are further keywords; `renamed` are options whose
/// keywords have other names.
pub(crate) fn refused<T: clap::Args>(
    error: &clap::Error,
    others: &[&str],
    renamed: &[(&str, &str)],
) -> Failure {
    let keyword = |option: &str| keyword(option, renamed);
    let name = |kind| match error.get(kind)? {
        ContextValue::String(text) => Some(keyword(text)),
        ContextValue::Strings(texts) => {
            Some(texts.iter().map(|text| keyword(text)).collect::<Vec<_>>().join(", "))
        }
        _ => None,
    };
    let text = |kind| match error.get(kind)? {
        ContextValue::String(text) => Some(text.clone()),
        ContextValue::Strings(texts) => Some(texts.join(", ")),
        _ => None,
    };
    let argument = name(ContextKind::InvalidArg).unwrap_or_default();
    let value = text(ContextKind::InvalidValue).unwrap_or_default();
    let message = match error.kind() {
        ErrorKind::UnknownArgument => {
            let options = T::augment_args(clap::Command::new(""));
            let options = options.get_arguments().filter_map(clap::Arg::get_long).map(keyword);
            let known: Vec<String> =
                others.iter().copied().map(str::to_owned).chain(options).collect();
            return unknown(&argument, known.iter().map(String::as_str));
        }
        ErrorKind::InvalidValue if value.is_empty() => format!("{argument} needs a value"),
        ErrorKind::InvalidValue => {
            let known = text(ContextKind::ValidValue).unwrap_or_default();
            let hint = did_you_mean(&value, known.split(", "));
            let message = format!("{argument} = {value:?}, but must be one of {known}");
            return usage(&message, hint.as_deref());
        }
        ErrorKind::ValueValidation => match error.source() {
            Some(must) => format!("{argument} = {value}: {must}"),
            None => format!("{argument} = {value} is refused"),
        },
        ErrorKind::ArgumentConflict => {
            let other = name(ContextKind::PriorArg).unwrap_or_default();
            format!("{argument} must not stand beside {other}")
        }
        ErrorKind::MissingRequiredArgument => format!("{argument} must be given"),
        _ => {
            let text = error.to_string();
            let line = text.lines().next().unwrap_or_default();
            line.strip_prefix("error: ").unwrap_or(line).to_owned()
        }
    };
    usage(&message, None)
}

/// The keyword of an option in the parser's form: `--scale-duration <FACTOR>`, `<PROFILE>`.
fn keyword(option: &str, renamed: &[(&str, &str)]) -> String {
    let name = option.split([' ', '=']).next().unwrap_or_default();
    let name = name.trim_matches(['-', '<', '>']).replace('-', "_").to_lowercase();
    let renamed = renamed.iter().find(|(own, _)| *own == name);
    renamed.map_or(name, |(_, keyword)| (*keyword).to_owned())
}

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
            let found = value.get_type();
            let must = "must be a number, a text, a list or a dictionary";
            Err(PyTypeError::new_err(format!("{key} = {found}, but {must}")).into())
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
