//! Parts that the summaries of several commands share.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::beam::Mesh;
use crate::csv::InputFile;
use crate::numeric::is_hidden;
use crate::verify::{Check, Outcome, Verification};

/// An input file of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Fingerprint {
    pub(super) name: String,
    pub(super) sha256: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct MeshRecord {
    elements: usize,
    degrees_of_freedom: usize,
    resolved_hz: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct WarningRecord {
    pub(super) kind: Cow<'static, str>,
    pub(super) message: String,
    pub(super) hint: Cow<'static, str>,
}

/// One check of an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct CheckRecord {
    pub(super) name: Cow<'static, str>,
    pub(super) what: Cow<'static, str>,
    pub(super) of: Cow<'static, str>,
    /// Nothing where it was not measured.
    pub(super) found: Option<f64>,
    pub(super) bound: Option<f64>,
    /// Why it was not measured.
    pub(super) reason: Option<String>,
    pub(super) passes: bool,
}

impl CheckRecord {
    pub(super) fn all(verification: &Verification) -> Vec<Self> {
        verification.checks.iter().map(Self::of).collect()
    }

    fn of(check: &Check) -> Self {
        let (found, bound, reason) = match &check.outcome {
            Outcome::Measured { found, bound } => (Some(*found), Some(*bound), None),
            Outcome::NotMeasured { reason } => (None, None, Some(reason.clone())),
        };
        let Check { name, what, of, .. } = *check;
        let [name, what, of] = [name, what, of].map(Cow::Borrowed);
        Self { name, what, of, found, bound, reason, passes: !check.fails() }
    }
}

impl Fingerprint {
    pub(super) fn of(file: &InputFile) -> Self {
        Self { name: file.name.clone(), sha256: file.sha256() }
    }
}

impl MeshRecord {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let elements = mesh.elements().len();
        Self {
            elements,
            degrees_of_freedom: 2 * elements + 1,
            resolved_hz: mesh.resolved_frequency_rad_s() / std::f64::consts::TAU,
        }
    }
}

/// The JSON text of a summary, indented, with a final line end.
///
/// # Panics
/// Never: the summaries hold nothing that JSON cannot.
pub(super) fn json(summary: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(summary).expect("plain records are JSON");
    text.push('\n');
    without_controls(text)
}

/// The JSON text of a record on one line, without a line end.
///
/// # Panics
/// Never, as [`json`].
pub(super) fn json_line(record: &impl Serialize) -> String {
    without_controls(serde_json::to_string(record).expect("plain records are JSON"))
}

/// JSON lets U+007F to U+009F and what turns the direction of writing stand as they are, which terminals
/// obey; they can only be in strings.
fn without_controls(text: String) -> String {
    let is_bare = |letter: char| is_hidden(letter) && letter != '\n';
    if !text.contains(is_bare) {
        return text;
    }
    let escaped = |letter: char| match letter {
        letter if is_bare(letter) => format!("\\u{:04x}", u32::from(letter)),
        letter => letter.to_string(),
    };
    text.chars().map(escaped).collect()
}

/// The JSON text of a verification: a list of its checks.
pub fn verification_json(verification: &Verification) -> String {
    json(&CheckRecord::all(verification))
}
