use std::fmt::Display;

use serde::de;
use thiserror::Error;

use super::value::Count;
use crate::link::ParameterError;
use crate::text::{did_you_mean, excerpt, visible};

/// Hint for a missing or wrong damping ratio.
pub(super) const USUAL_RATIO: &str = "0.02 is usual for metal links";

/// Error in a link file, a `--set` on it, or a file of tolerances.
///
/// Reads `link.toml:14: damping.ratio = -0.02, but must lie in [0, 1)`.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{place}: {message}")]
pub struct SpecError {
    place: String,
    message: String,
    hint: Option<String>,
}

impl SpecError {
    /// Suggests a remedy, if there is one.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Replaces the hint.
    pub(super) fn hinting(self, hint: String) -> Self {
        Self { hint: Some(hint), ..self }
    }
}

/// An error with a dotted path, before the search for its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    /// Paths concerned; the error points at the one written last.
    pub(super) paths: Vec<String>,
    message: String,
    hint: Option<String>,
}

impl Fault {
    pub(super) fn new(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self::among(vec![path.into()], message)
    }

    /// Error with the text *path words*.
    pub(super) fn on(path: impl Into<String>, words: impl Display) -> Self {
        let path = path.into();
        let message = format!("{path} {words}");
        Self::new(path, message)
    }

    pub(super) fn among(paths: Vec<String>, message: impl Into<String>) -> Self {
        Self { paths, message: message.into(), hint: None }
    }

    pub(super) fn hinting(mut self, hint: impl Into<Option<String>>) -> Self {
        self.hint = hint.into();
        self
    }

    /// Relates an error in a link file's content to a link of an arm.
    pub(super) fn of_link(mut self, (link, called): (usize, &str), is_last: bool) -> Self {
        if !is_last {
            // The tip of an inner link is read as a payload.
            let renamed = |text: &str| match text.strip_prefix("payload") {
                Some(rest) => format!("tip{rest}"),
                None => text.replace(" payload", " tip"),
            };
            self.message = renamed(&self.message);
            self.paths = self.paths.iter().map(|path| renamed(path)).collect();
        }
        let shared = |path: &String| {
            ["mesh", "analysis", "gravity", "start_angle", "title"].iter().any(|key| {
                path == key || path.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'))
            })
        };
        if self.paths.iter().any(shared) {
            return self;
        }
        let below = |path: &str| {
            if path.is_empty() { format!("links.{link}") } else { format!("links.{link}.{path}") }
        };
        let own = format!("links.{called}");
        let named =
            self.paths.iter().any(|path| !path.is_empty() && self.message.starts_with(path));
        self.message = if named || self.message.starts_with("unknown key") {
            let of_tail = self.message.replacen(" in ", &format!(" in {own}."), 1);
            if named {
                format!("{own}.{}", self.message)
            } else if of_tail == self.message {
                format!("{} in {own}", self.message)
            } else {
                of_tail
            }
        } else {
            format!("{own}: {}", self.message)
        };
        self.paths = self.paths.iter().map(|path| below(path)).collect();
        if self.message.starts_with("unknown key") {
            let carried = if is_last { "payload" } else { "tip" };
            let known = [
                "name", "theory", "segments", "hub", "masses", carried, "damping", "drive",
                "limits",
            ];
            let key =
                self.paths.first().and_then(|path| path.rsplit('.').next().map(str::to_owned));
            let is_of_link = self.paths.iter().all(|path| path.matches('.').count() == 2);
            if is_of_link {
                let near = key.and_then(|key| did_you_mean(&key, known));
                self.hint = near.or_else(|| Some(format!("known here: {}", listed(&known, "and"))));
            }
        }
        self
    }

    /// Makes the error for a place. Control characters become visible, because the texts quote the file.
    pub(super) fn at(self, place: String) -> SpecError {
        let shown = |text: String| visible(&text).into_owned();
        SpecError { place, message: shown(self.message), hint: self.hint.map(shown) }
    }
}

impl From<ParameterError> for Fault {
    fn from(error: ParameterError) -> Self {
        let hint = (error.parameter == "damping.ratio").then(|| USUAL_RATIO.to_owned());
        Self::new(error.parameter.clone(), error.to_string()).hinting(hint)
    }
}

/// Mismatch of a value with the raw form.
#[derive(Debug, Error)]
#[error("{reason:?}")]
pub(super) struct Misfit {
    /// Path to the value, outermost step first.
    steps: Vec<String>,
    /// The value as messages quote it.
    found: Option<String>,
    reason: Reason,
}

#[derive(Debug)]
enum Reason {
    /// `must be …`, or words after the value. A second line is the hint.
    Value(String),
    NotTables,
    Unknown {
        key: String,
        known: Vec<&'static str>,
    },
    Missing {
        key: &'static str,
    },
}

impl Misfit {
    fn new(reason: Reason) -> Self {
        Self { steps: Vec::new(), found: None, reason }
    }

    pub(super) fn not_tables() -> Self {
        Self::new(Reason::NotTables)
    }

    /// Adds known keys to an unknown one of the outermost table.
    pub(super) fn knowing(mut self, keys: &[&'static str]) -> Self {
        if let (Reason::Unknown { known, .. }, []) = (&mut self.reason, &self.steps[..]) {
            known.extend(keys);
        }
        self
    }

    /// Adds an outer step to the path; `found` quotes the value unless an inner quote exists.
    pub(super) fn below(mut self, step: String, found: impl FnOnce() -> String) -> Self {
        self.steps.insert(0, step);
        self.found.get_or_insert_with(found);
        self
    }
}

impl de::Error for Misfit {
    fn custom<T: Display>(message: T) -> Self {
        Self::new(Reason::Value(message.to_string()))
    }

    fn invalid_type(_: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        match expected.to_string().as_str() {
            "a sequence" => Self::custom("must be a list"),
            "f64" => Self::custom("must be a number"),
            "i64" => Self::custom(format!("must be {}", Count::WORDS)),
            "usize" => Self::custom("must be a whole number from 0"),
            expected => Self::custom(format!("must be {expected}")),
        }
    }

    fn invalid_value(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        Self::invalid_type(found, expected)
    }

    fn invalid_length(_: usize, expected: &dyn de::Expected) -> Self {
        Self::custom(format!("must be {expected}"))
    }

    fn unknown_variant(word: &str, known: &'static [&'static str]) -> Self {
        let hint = did_you_mean(word, known.iter().copied()).unwrap_or_default();
        Self::custom(format!("must be {}\n{hint}", listed(known, "or")))
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Self {
        Self::new(Reason::Unknown { key: key.to_owned(), known: known.to_vec() })
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new(Reason::Missing { key })
    }
}

/// Keys of a segment for which a hint names the whole path.
const OF_SEGMENTS: [&str; 10] = [
    "length",
    "EI",
    "E",
    "I",
    "mass_per_length",
    "density",
    "area",
    "section",
    "shear_stiffness",
    "poisson_ratio",
];

/// Hint for a path that is the bare key of a segment, in the file of a link or of an arm.
pub(super) fn of_segments(path: &str, is_arm: bool) -> Option<String> {
    let segments = if is_arm { "links.*.segments.*" } else { "segments.*" };
    let hint = || format!("{path} is a key of segments: {segments}.{path} changes all of them");
    OF_SEGMENTS.contains(&path).then(hint)
}

impl From<Misfit> for Fault {
    fn from(misfit: Misfit) -> Self {
        let path = misfit.steps.join(".");
        let inner = |key: &str| {
            let dot = if path.is_empty() { "" } else { "." };
            format!("{path}{dot}{key}")
        };
        let found = format!("{} = {}", excerpt(&path), misfit.found.unwrap_or_default());
        match misfit.reason {
            Reason::Value(text) => {
                let (wrong, hint) = text.split_once('\n').unwrap_or((&text, ""));
                let but = if wrong.starts_with("must") { ", but" } else { "" };
                let hint = Some(hint.to_owned()).filter(|hint| !hint.is_empty());
                Self::new(path, format!("{found}{but} {wrong}")).hinting(hint)
            }
            Reason::NotTables => {
                let message = format!("{found}, but must be tables headed [[{path}]]");
                Self::new(path, message)
            }
            Reason::Unknown { key, known } => {
                let place = if path.is_empty() { String::new() } else { format!(" in {path}") };
                let of_carriage = (path == "hub" && key == "mass")
                    .then(|| "a hub that slides is a [carriage], which has a mass".to_owned());
                let hint = of_carriage
                    .or_else(|| of_segments(&inner(&key), known.contains(&"links")))
                    .or_else(|| did_you_mean(&key, known.iter().copied()))
                    .unwrap_or_else(|| format!("known here: {}", listed(&known, "and")));
                Self::new(inner(&key), format!("unknown key `{}`{place}", excerpt(&key)))
                    .hinting(hint)
            }
            Reason::Missing { key } => Self::new(inner(key), format!("{} is missing", inner(key))),
        }
    }
}

/// `a`, `a and b`, `a, b and c`, with `joint` for `and`.
pub(super) fn listed<T: AsRef<str>>(words: &[T], joint: &str) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.split_last() {
        None => String::new(),
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} {joint} {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_reads_like_a_sentence() {
        assert_eq!(listed(&["a"], "or"), "a");
        assert_eq!(listed(&["a", "b", "c"], "or"), "a, b or c");
    }
}
