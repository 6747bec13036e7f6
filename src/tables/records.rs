//! Parts that the summaries of several commands share.

use serde::Serialize;

use super::input::InputFile;
use crate::beam::Mesh;

/// An input file of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Fingerprint {
    name: String,
    sha256: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct MeshRecord {
    elements: usize,
    degrees_of_freedom: usize,
    resolved_hz: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct WarningRecord {
    pub(super) kind: &'static str,
    pub(super) message: String,
    pub(super) hint: &'static str,
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
    text
}
