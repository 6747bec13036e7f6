//! Keywords of a call as options of the command, and dictionaries of Python as TOML.

use std::error::Error as _;
use std::fmt::Write as _;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use flexlink::cli::options::common::option;
use flexlink::cli::options::reading::TableName;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::text::did_you_mean;
use pyo3::types::{PyFloat, PyInt, PyString};

use crate::prelude::*;

/// Columns of a motion of one link, and of the tip of an arm.
pub(crate) const OF_LINK: [&str; 4] = ["acceleration", "velocity", "displacement", "angle"];
pub(crate) const OF_TIP: [&str; 2] = ["x", "y"];

/// Keywords whose options have another name: `from` is a word of Python.
pub(crate) type Renamed<'a> = &'a [(&'a str, &'a str)];

/// Removes a keyword and returns its value, unless it is None.
pub(crate) fn take<'py>(keywords: &Keywords<'py>, name: &str) -> PyResult<Option<Any<'py>>> {
    let Some(value) = keywords.get_item(name)? else { return Ok(None) };
    keywords.del_item(name)?;
    Ok((!value.is_none()).then_some(value))
}

/// Takes the keywords of these names, as arguments.
pub(crate) fn take_arguments(keywords: &Keywords<'_>, names: &[&str]) -> PyResult<Vec<String>> {
    let own = PyDict::new(keywords.py());
    for name in names {
        if let Some(value) = take(keywords, name)? {
            own.set_item(name, value)?;
        }
    }
    arguments(&own, &[])
}

/// Takes the keyword `uncertain` as arguments: a text, a list of texts, or a dictionary of intervals by key, each a text or
/// its two ends.
pub(crate) fn take_uncertain(keywords: &Keywords<'_>) -> Raises<Vec<String>> {
    let Some(values) = take(keywords, "uncertain")? else { return Ok(Vec::new()) };
    let texts: PyResult<Vec<String>> = if let Ok(intervals) = values.cast::<PyDict>() {
        let text = |(key, interval): (Any<'_>, Any<'_>)| match interval.extract::<[f64; 2]>() {
            Ok([low, high]) => Ok(format!("{key}={low:?}..{high:?}")),
            Err(_) => Ok(format!("{key}={}", interval.extract::<String>()?)),
        };
        intervals.iter().map(text).collect()
    } else {
        values.extract::<String>().map(|one| vec![one]).or_else(|_| values.extract())
    };
    let texts = texts.map_err(|_| {
        let must = "must be a text, a list of texts, or a dictionary of intervals by key";
        PyTypeError::new_err(format!("uncertain = {values}, but {must}"))
    })?;
    Ok(texts.iter().flat_map(|text| option("--uncertain", text)).collect())
}

/// Refuses options of the command with another form in a call.
pub(crate) fn refuse_commands(keywords: &Keywords<'_>) -> Raises<()> {
    let others = [
        ("set", r#"link.changed({"payload.mass": 0.2}) is the link with a change"#),
        ("verify", "flexlink.verify(solution) checks it"),
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
pub(crate) fn arguments(keywords: &Keywords<'_>, renamed: Renamed<'_>) -> PyResult<Vec<String>> {
    let mut arguments = Vec::new();
    for (key, value) in keywords.iter().filter(|(_, value)| !value.is_none()) {
        let word: String = key.extract()?;
        let option_of = renamed.iter().find(|(_, keyword)| *keyword == word);
        let name = option_of.map_or(&*word, |(option, _)| option);
        let name = format!("--{}", name.replace('_', "-"));
        let of = value.get_type();
        if of.module()?.to_cow()? == "flexlink" {
            let must = "must be a number, a text or the path of a file";
            return Err(PyTypeError::new_err(format!("{key} = {of}, but {must}")));
        }
        match value.cast::<PyBool>() {
            Ok(flag) if flag.is_true() => arguments.push(name),
            Ok(_) => {}
            Err(_) => arguments.extend(option(&name, words(&value)?)),
        }
    }
    Ok(arguments)
}

/// Keywords of a `write` as arguments; refuses keywords outside the `known` ones.
pub(crate) fn of_writing(keywords: Option<&Keywords<'_>>, known: &[&str]) -> Raises<Vec<String>> {
    let Some(keywords) = keywords else { return Ok(Vec::new()) };
    for key in keywords.keys() {
        let key: String = key.extract()?;
        if !known.contains(&&*key) {
            return Err(unknown(&key, known.iter().copied()).into());
        }
    }
    Ok(arguments(keywords, &[])?)
}

/// Refusal of a keyword outside the `known` ones.
pub(crate) fn unknown<'a>(key: &str, known: impl IntoIterator<Item = &'a str>) -> Failure {
    // A keyword of other calls must not be its own suggestion.
    let hint = did_you_mean(key, known.into_iter().filter(|other| *other != key));
    usage(&format!("unexpected keyword `{key}`"), hint.as_deref())
}

/// A value in the form of the command: lists with commas, dictionaries as `quantity=column`.
fn words(value: &Any<'_>) -> PyResult<String> {
    if let Ok(pairs) = value.cast::<PyDict>() {
        let pair = |(key, own): (Any<'_>, Any<'_>)| Ok(format!("{}={}", key.str()?, own.str()?));
        return Ok(pairs.iter().map(pair).collect::<PyResult<Vec<String>>>()?.join(","));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| Ok(item?.str()?.to_string()));
        return Ok(items.collect::<Raises<Vec<String>>>()?.join(","));
    }
    Ok(value.str()?.to_string())
}

/// Keywords as the options of `solve`, whose one table is that of the motion.
pub(crate) fn solve_options(arguments: &[String]) -> Fails<SolveOptions> {
    let options: SolveOptions = parsed(arguments, &[&OF_LINK[..], &OF_TIP].concat(), &[])?;
    options.motion.read.check(&[TableName::Motion])?;
    Ok(options)
}

/// Reads arguments as the options `T`. `others` are further keywords of the call.
pub(crate) fn parsed<T: clap::Args>(
    arguments: &[String],
    others: &[&str],
    renamed: Renamed<'_>,
) -> Fails<T> {
    let command = T::augment_args(clap::Command::new("").no_binary_name(true));
    let matches = command.disable_help_flag(true).try_get_matches_from(arguments);
    let read = matches.and_then(|matches| T::from_arg_matches(&matches));
    read.map_err(|error| refused::<T>(&error, others, renamed))
}

/// The parser's refusal of keywords for the options `T`.
fn refused<T: clap::Args>(error: &clap::Error, others: &[&str], renamed: Renamed<'_>) -> Failure {
    let keyword = |option: &str| keyword(option, renamed);
    let texts = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => vec![text.clone()],
        Some(ContextValue::Strings(texts)) => texts.clone(),
        _ => Vec::new(),
    };
    let name = |kind| texts(kind).iter().map(|text| keyword(text)).collect::<Vec<_>>().join(", ");
    let argument = name(ContextKind::InvalidArg);
    let value = texts(ContextKind::InvalidValue).join(", ");
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
            let known = texts(ContextKind::ValidValue).join(", ");
            let hint = did_you_mean(&value, known.split(", "));
            let message = format!("{argument} = {value:?}, but must be one of {known}");
            return usage(&message, hint.as_deref());
        }
        ErrorKind::ValueValidation => match error.source() {
            Some(own) if own.to_string().starts_with("--") => own.to_string(),
            Some(must) => format!("{argument} = {value}: {must}"),
            None => format!("{argument} = {value} is refused"),
        },
        ErrorKind::ArgumentConflict => {
            format!("{argument} must not stand beside {}", name(ContextKind::PriorArg))
        }
        ErrorKind::MissingRequiredArgument => format!("{argument} is missing"),
        _ => {
            let text = error.to_string();
            let line = text.lines().next().unwrap_or_default();
            line.strip_prefix("error: ").unwrap_or(line).to_owned()
        }
    };
    usage(&message, None)
}

/// The keyword of an option in the parser's form: `--scale-duration <FACTOR>`, `<PROFILE>`.
fn keyword(option: &str, renamed: Renamed<'_>) -> String {
    let name = option.split([' ', '=']).next().unwrap_or_default();
    let name = name.trim_matches(['-', '<', '>']).replace('-', "_").to_lowercase();
    let renamed = renamed.iter().find(|(own, _)| *own == name);
    renamed.map_or(name, |(_, keyword)| (*keyword).to_owned())
}

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
