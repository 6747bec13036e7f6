//! The command's messages and hints in words of a call: keywords for options, functions for commands.

use std::f64::consts::PI;
use std::fmt::Write as _;

use pyo3::prelude::*;

/// Values of options that are words.
const WORDS: [&str; 28] = [
    "comma",
    "point",
    "zero",
    "linear",
    "cubic",
    "effort",
    "position",
    "velocity",
    "acceleration",
    "feedback",
    "inverse",
    "rigid",
    "zv",
    "zvd",
    "ei",
    "2hump",
    "held",
    "free",
    "line",
    "arc",
    "torque",
    "force",
    "best",
    "voltage",
    "hub-angle",
    "uniform",
    "motor",
    "halstreamer",
];

/// Options without a value.
const FLAGS: [&str; 6] = ["bless", "drop-outliers", "periodic", "moving-ends", "linear", "cycle"];

/// Options with another keyword: words of Python.
const RENAMED: [(&str, &str); 2] = [("from", "start"), ("with", "quantities")];

/// Phrases of a command line, and of a call.
const PHRASES: [(&str, &str); 7] = [
    ("solve --write", "solution.table().write"),
    ("flexlink compare --bless", "--bless"),
    ("`flexlink modes --at`", "`modes(link, at=…)`"),
    ("modes --at ANGLE", "modes(link, at=ANGLE)"),
    ("modes --at", "modes(link, at=…)"),
    ("LINK, a TOML file, comes before MOTION or TORQUE", "the link, a TOML file, comes first"),
    ("`flexlink ", "`flexlink."),
];

/// Words for arguments of a command line, and of a call.
const ARGUMENTS: [(&str, &str); 3] =
    [("PROFILE", "profile"), ("EXPECTED", "expected"), ("ACTUAL", "actual")];

/// A message with keywords for options: `resample=STEP` for `--resample STEP`, and changes for `--set`.
pub(crate) fn in_python(text: &str) -> String {
    worded(text, |change| format!("the change '{change}'"))
}

/// A hint in the same words. Changes are calls: `link.changed({"payload.mass": 0.2})`.
pub(crate) fn hint_in_python(text: &str) -> String {
    worded(text, |change| {
        let (path, value) = change.split_once('=').unwrap_or((change, ""));
        format!("link.changed({{\"{path}\": {}}})", python_value(value))
    })
}

/// The text of a message, and of a hint, in words of a call.
#[pyfunction]
pub(crate) fn wording(text: &str) -> (String, String) {
    (in_python(text), hint_in_python(text))
}

/// A value of TOML in Python: tables become dictionaries.
fn python_value(value: &str) -> String {
    let Some(inner) = value.strip_prefix('{').and_then(|rest| rest.strip_suffix('}')) else {
        return value.to_owned();
    };
    let pairs = inner.split(',').map(|pair| match pair.split_once('=') {
        Some((key, own)) => format!("\"{}\": {}", key.trim(), own.trim()),
        None => pair.to_owned(),
    });
    format!("{{{}}}", pairs.collect::<Vec<_>>().join(", "))
}

/// The text with another word for a whole word. A word in a path or before a colon is the name of a file, and stays.
fn renamed(text: &str, from: &str, to: &str) -> String {
    let is_name = |c: char| c.is_alphanumeric() || "_-./\\:".contains(c);
    let (mut rest, mut shown) = (text, String::new());
    while let Some(at) = rest.find(from) {
        let (before, after) = (&rest[..at], &rest[at + from.len()..]);
        // The full stop of a sentence ends no name.
        let next = after.strip_prefix('.').filter(|next| !next.starts_with(is_name));
        let is_word = !before.ends_with(is_name) && !next.unwrap_or(after).starts_with(is_name);
        shown.push_str(before);
        shown.push_str(if is_word { to } else { from });
        rest = after;
    }
    shown + rest
}

fn worded(text: &str, change: impl Fn(&str) -> String) -> String {
    let text = PHRASES.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to));
    let text = text.replace("`flexlink.help", "`flexlink help");
    let text = ARGUMENTS.iter().fold(text, |text, (from, to)| renamed(&text, from, to));
    let (mut rest, mut shown) = (&*text, String::new());
    while let Some(at) = rest.find("--") {
        let (before, option) = (&rest[..at], &rest[at + 2..]);
        let end = option.find(|c: char| !(c.is_ascii_lowercase() || c == '-'));
        let (name, after) = option.split_at(end.unwrap_or(option.len()));
        let begins = before.chars().next_back().is_none_or(|c| " '\"`(".contains(c));
        shown.push_str(before);
        rest = after;
        if !begins || !name.starts_with(|c: char| c.is_ascii_lowercase()) {
            let _ = write!(shown, "--{name}");
            continue;
        }
        let value = after.strip_prefix(' ').unwrap_or_default();
        let quoted = value.strip_prefix('\'').and_then(|rest| rest.split_once('\''));
        let word = value.split([' ', ';', ')', '`']).next().unwrap_or_default();
        let word = word.trim_end_matches([',', '.', ':']);
        if name == "set" {
            match (quoted, word.split_once('=')) {
                (Some((text, left)), _) => {
                    shown.push_str(&change(text));
                    rest = left;
                }
                (None, Some((path, _))) if !path.is_empty() => {
                    shown.push_str(&change(word));
                    rest = &after[1 + word.len()..];
                }
                _ => shown.push_str("link.changed"),
            }
            continue;
        }
        let renamed = RENAMED.iter().find(|(own, _)| *own == name);
        shown.push_str(&renamed.map_or_else(|| name.replace('-', "_"), |(_, own)| (*own).into()));
        if let Some((text, left)) = quoted
            && let Some(value) = quoted_value(text)
        {
            let _ = write!(shown, "={value}");
            rest = left;
        } else if let Some(value) = as_value(word) {
            let _ = write!(shown, "={value}");
            rest = &after[1 + word.len()..];
        } else if FLAGS.contains(&name) && !after.starts_with('=') && !value.starts_with('=') {
            shown.push_str("=True");
        }
    }
    shown + rest
}

/// A quoted value of an option: a text with a sign, or directions in rad.
fn quoted_value(text: &str) -> Option<String> {
    let angle = |text: &str| text.strip_suffix(" deg")?.parse::<f64>().ok();
    let angles: Option<Vec<String>> =
        text.split(',').map(|own| Some(format!("{:.2}", angle(own)? * PI / 180.0))).collect();
    match angles.as_deref() {
        Some([one]) => Some(one.clone()),
        Some(several) => Some(format!("[{}]", several.join(", "))),
        None => text.contains('=').then(|| format!("{text:?}")),
    }
}

/// The value of an option in the form of a keyword's value; `None` for another word.
fn as_value(word: &str) -> Option<String> {
    let is_placeholder =
        |word: &str| !word.is_empty() && word.chars().all(|c| c.is_ascii_uppercase());
    let is_plain = |word: &str| is_placeholder(word) || word.parse::<f64>().is_ok();
    if word.contains(',') && word.split(',').all(is_plain) {
        return Some(format!("({})", word.replace(',', ", ")));
    }
    if word.contains(',') && word.split(',').all(|own| WORDS.contains(&own)) {
        return Some(format!("[\"{}\"]", word.replace(',', "\", \"")));
    }
    let is_text = word.find('=').is_some_and(|at| at > 0) || WORDS.contains(&word);
    let text = || format!("{:?}", word.replace("hub-angle", "hub_angle"));
    is_plain(word).then(|| word.to_owned()).or_else(|| is_text.then(text))
}
