use thiserror::Error;

use super::tree::{Node, Place};
use crate::link::ParameterError;
use crate::numeric::visible;

/// Hint for a missing or wrong damping ratio.
pub(super) const USUAL_RATIO: &str = "0.02 is usual for metal links";

/// Why a link file, a `--set` on it, or a file of tolerances is refused.
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
    /// What to write instead, if there is something to say.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Makes control characters in `message` and `hint` visible: they quote the file.
    pub(super) fn new(place: String, message: &str, hint: Option<&str>) -> Self {
        let told = |text: &str| visible(text).into_owned();
        Self { place, message: told(message), hint: hint.map(told) }
    }
}

/// A refusal with a dotted path, before its line is looked up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    /// Paths that it concerns; the error points at the one written last.
    at: Vec<String>,
    message: String,
    hint: Option<String>,
}

impl Fault {
    pub(super) fn new(at: impl Into<String>, message: impl Into<String>) -> Self {
        Self::among(vec![at.into()], message)
    }

    pub(super) fn among(at: Vec<String>, message: impl Into<String>) -> Self {
        Self { at, message: message.into(), hint: None }
    }

    pub(super) fn hinting(mut self, hint: impl Into<Option<String>>) -> Self {
        self.hint = hint.into();
        self
    }

    /// The last of the places that it concerns.
    pub(super) fn place(&self, tree: &Node) -> Place {
        let places = self.at.iter().map(|path| tree.deepest(path).place);
        places.max().unwrap_or(Place::File)
    }

    /// The refusal, with its place as text.
    pub(super) fn at(self, place: String) -> SpecError {
        SpecError::new(place, &self.message, self.hint.as_deref())
    }
}

impl From<ParameterError> for Fault {
    fn from(error: ParameterError) -> Self {
        let hint = match error.parameter.as_str() {
            "damping.ratio" => Some(USUAL_RATIO.to_owned()),
            _ => None,
        };
        Self::new(error.parameter.clone(), error.to_string()).hinting(hint)
    }
}

/// The candidate with the spelling nearest to `word`, if one is near.
pub(super) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let scores =
        candidates.into_iter().map(|candidate| (candidate, strsim::jaro_winkler(word, candidate)));
    let best = scores.reduce(|best, next| if next.1 > best.1 { next } else { best });
    best.filter(|(_, score)| *score > 0.75).map(|(candidate, _)| candidate)
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
    fn a_misspelt_word_is_near_the_meant_one_and_a_strange_one_near_none() {
        let known = ["length", "mass_per_length", "EI", "elements"];
        assert_eq!(nearest("lenght", known), Some("length"));
        assert_eq!(nearest("mass_per_lenght", known), Some("mass_per_length"));
        assert_eq!(nearest("colour", known), None);
    }

    #[test]
    fn a_list_reads_like_a_sentence() {
        assert_eq!(listed(&["a"], "or"), "a");
        assert_eq!(listed(&["a", "b", "c"], "or"), "a, b or c");
    }
}
