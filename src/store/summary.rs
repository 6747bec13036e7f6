//! summary.json: what a run of `solve` or `simulate` was given, its numbers, and how far to trust them.
//! One record is written and read back.

use std::borrow::Cow;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::file_names::SUMMARY;
use super::json::{FORMAT, Fingerprint, Head, as_written, check_format, json, newer, parsed};
use super::numbers::Numbers;
use crate::beam::Mesh;
use crate::csv::{InputFile, Place, TableError, quoted};
use crate::link::{
    Damping, Drive, Hub, Link, LinkParts, LumpedMass, ParameterError, Payload, Segment,
};
use crate::modal::DampingLaw;
use crate::result::{Origin, StoredCheck, StoredWarning};
use crate::verify::{Check, Outcome, Verification};

/// How a message describes a folder whose files are missing.
pub(super) const A_RUN: &str = "the folder of a run of `flexlink solve` or `simulate`";

/// A key that one of the two commands does not write, and the other writes as null if it has no value. Null
/// is read back as a key that is not there.
type Nullable<T> = Option<Option<T>>;

/// The content of summary.json, in the order of its keys. Keys of one command alone are optional; keys that
/// nothing reads back are skipped, and unknown ones too, so that a later version may have more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    pub(super) format: u32,
    pub(super) flexlink: String,
    pub(super) command: String,
    pub(super) title: String,
    pub(super) inputs: Inputs,
    pub(super) link: LinkRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) drive: Nullable<Drive>,
    #[serde(skip_deserializing)]
    pub(super) mesh: MeshRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) motion: Option<MotionRecord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) torque: Option<TorqueRecord>,
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub(super) feedback: Nullable<Numbers>,
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub(super) modes: Option<ModesRecord>,
    #[serde(skip_deserializing)]
    pub(super) periods_s: Vec<f64>,
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub(super) natural_frequencies_hz: Option<Vec<f64>>,
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub(super) modal_damping_ratios: Option<Vec<f64>>,
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub(super) viscous_damping_ratios: Option<Vec<f64>>,
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub(super) zeros_per_s: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) analysis: Option<AnalysisRecord>,
    pub(super) results: Numbers,
    pub(super) errors: Option<Numbers>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) verification: Nullable<Vec<CheckRecord>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) residual: Option<Numbers>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tip_error: Nullable<Numbers>,
    pub(super) warnings: Vec<StoredWarning>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) remarks: Option<Vec<StoredWarning>>,
    pub(super) files: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Inputs {
    pub(super) link: Fingerprint,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) motion: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) torque: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) target: Nullable<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) reference: Nullable<Fingerprint>,
    pub(super) arguments: Vec<String>,
}

/// The link in SI, keyed as in its file, but for its title and its drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LinkRecord {
    length_m: f64,
    rigid_inertia_kg_m2: f64,
    segments: Vec<Segment>,
    hub: Hub,
    masses: Vec<LumpedMass>,
    payload: Payload,
    damping: Damping,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub(super) struct MeshRecord {
    elements: usize,
    degrees_of_freedom: usize,
    resolved_hz: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct MotionRecord {
    pub(super) given: Cow<'static, str>,
    pub(super) samples: usize,
    pub(super) step_s: f64,
    pub(super) start_s: f64,
    pub(super) moves_from_s: f64,
    pub(super) moves_until_s: f64,
    pub(super) travel_m: f64,
    pub(super) peak_velocity_m_s: f64,
    pub(super) peak_acceleration_m_s2: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct TorqueRecord {
    pub(super) samples: usize,
    pub(super) step_s: f64,
    pub(super) start_s: f64,
    pub(super) end_s: f64,
    pub(super) simulated_until_s: f64,
    pub(super) interpolation: Cow<'static, str>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ModesRecord {
    pub(super) kept: usize,
    pub(super) of_mesh: usize,
    pub(super) torque_band_hz: f64,
    pub(super) highest_hz: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct AnalysisRecord {
    pub(super) tolerance: f64,
    pub(super) tip_tolerance: f64,
    /// Null if every frequency of the samples is solved for.
    pub(super) band_hz: Option<f64>,
    /// Null if all modes are kept.
    pub(super) modes: Option<usize>,
    pub(super) period_s: f64,
    pub(super) fft_length: usize,
    pub(super) frequencies: usize,
    pub(super) highest_frequency_hz: f64,
    pub(super) nyquist_hz: f64,
    pub(super) window_start_s: f64,
    pub(super) window_end_s: f64,
    pub(super) rows: usize,
}

/// One check of an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct CheckRecord {
    name: Cow<'static, str>,
    what: Cow<'static, str>,
    of: Cow<'static, str>,
    /// Null if it was not measured.
    found: Option<f64>,
    bound: Option<f64>,
    /// Why it was not measured.
    reason: Option<String>,
    passes: bool,
}

/// Whether a folder has the summary of a run, of any version.
pub fn is_run(folder: &Path) -> bool {
    let file = InputFile::read(&folder.join(SUMMARY));
    let head = file.ok().and_then(|file| serde_json::from_slice::<Head>(&file.bytes).ok());
    head.is_some_and(|head| head.flexlink.is_some())
}

impl Summary {
    /// A summary with the keys of both commands.
    pub(super) fn begun(
        command: &str,
        inputs: Inputs,
        (link, law, mesh): (&Link, &DampingLaw, &Mesh),
        results: Numbers,
    ) -> Self {
        Self {
            format: FORMAT,
            flexlink: env!("CARGO_PKG_VERSION").to_owned(),
            command: command.to_owned(),
            title: link.title().to_owned(),
            inputs,
            link: LinkRecord::of(link, law),
            drive: None,
            mesh: MeshRecord::of(mesh),
            motion: None,
            torque: None,
            feedback: None,
            modes: None,
            periods_s: Vec::new(),
            natural_frequencies_hz: None,
            modal_damping_ratios: None,
            viscous_damping_ratios: None,
            zeros_per_s: None,
            analysis: None,
            results,
            errors: None,
            verification: None,
            residual: None,
            tip_error: None,
            warnings: Vec::new(),
            remarks: None,
            files: Vec::new(),
        }
    }

    /// The JSON text, indented, with a final line end.
    ///
    /// # Panics
    /// Never: the summary holds nothing that JSON cannot.
    pub fn to_json(&self) -> String {
        json(self)
    }

    pub(super) fn read(file: &InputFile) -> Result<Self, TableError> {
        let whole = Place { file: &file.shown, line: None };
        let head: Head = parsed(&file.bytes, whole, "must be the summary of a run, in JSON")?;
        let Some(version) = head.flexlink else {
            let must = format!("must be the version that wrote it: {A_RUN}");
            return Err(whole.refuse("flexlink", "nothing", must));
        };
        let command = head.command.unwrap_or_default();
        if !["solve", "simulate"].contains(&command.as_str()) {
            let must = "must be \"solve\" or \"simulate\"";
            return Err(whole.refuse("command", quoted(&command), must));
        }
        check_format(head.format, &version, whole)?;
        parsed(&file.bytes, whole, &as_written()).map_err(|error| newer(error, &version))
    }

    pub(super) fn origin(&self) -> Origin {
        let Inputs { link, motion, torque, target, reference, arguments } = &self.inputs;
        let files = [
            ("link", Some(link)),
            ("motion", motion.as_ref()),
            ("torque", torque.as_ref()),
            ("target", target.as_ref().and_then(Option::as_ref)),
            ("reference", reference.as_ref().and_then(Option::as_ref)),
        ];
        Origin {
            command: self.command.clone(),
            version: self.flexlink.clone(),
            title: self.title.clone(),
            inputs: files.into_iter().filter_map(|(role, file)| Some(file?.input(role))).collect(),
            arguments: arguments.clone(),
        }
    }

    /// The link, with the ranges of its parameters checked.
    pub(super) fn link(&self) -> Result<Link, ParameterError> {
        let record = self.link.clone();
        let link = Link::new(LinkParts {
            title: self.title.clone(),
            segments: record.segments,
            hub: record.hub,
            masses: record.masses,
            payload: record.payload,
            damping: record.damping,
            drive: self.drive.flatten(),
        })?;
        let length_m = record.length_m;
        if (length_m - link.length_m()).abs() <= 1e-9 * link.length_m() {
            return Ok(link);
        }
        let must = format!("must be {} m, the sum of hub radius and segments", link.length_m());
        Err(ParameterError::new("length_m", length_m, "m", must))
    }

    /// First and last time in s of the histories.
    pub(super) fn window_s(&self) -> Option<(f64, f64)> {
        let solved = self.analysis.as_ref().map(|w| (w.window_start_s, w.window_end_s));
        solved.or(self.torque.as_ref().map(|torque| (torque.start_s, torque.simulated_until_s)))
    }

    /// All numbers by name: results, those of residual and tip error, errors.
    pub(super) fn readings(&self) -> Vec<(String, f64)> {
        let prefixed = |numbers: Option<&Numbers>, prefix| {
            numbers.map(|numbers| numbers.prefixed(prefix)).unwrap_or_default()
        };
        let errors = prefixed(self.errors.as_ref(), "").into_iter();
        [
            self.results.prefixed(""),
            prefixed(self.residual.as_ref(), "residual_"),
            prefixed(self.tip_error.as_ref().and_then(Option::as_ref), "tip_error_"),
            errors.map(|(name, error)| (format!("{name}_error"), error)).collect(),
        ]
        .concat()
    }

    pub(super) fn checks(&self) -> Vec<StoredCheck> {
        self.verification.iter().flatten().flatten().map(CheckRecord::stored).collect()
    }
}

impl LinkRecord {
    fn of(link: &Link, law: &DampingLaw) -> Self {
        let damping = match (link.damping(), law) {
            (damping @ Damping::Caughey { .. }, _) => damping.clone(),
            (_, DampingLaw::Rayleigh { alpha_per_s, beta_s }) => {
                Damping::Rayleigh { alpha_per_s: *alpha_per_s, beta_s: *beta_s }
            }
            (damping @ (Damping::Modal { .. } | Damping::Hysteretic { .. }), _) => damping.clone(),
            _ => Damping::None,
        };
        Self {
            length_m: link.length_m(),
            rigid_inertia_kg_m2: link.rigid_inertia_kg_m2(),
            segments: link.segments().iter().map(without_section).collect(),
            hub: *link.hub(),
            masses: link.masses().to_vec(),
            payload: *link.payload(),
            damping,
        }
    }
}

/// A segment as the summary keeps it.
fn without_section(segment: &Segment) -> Segment {
    Segment { cross_section: None, ..segment.clone() }
}

impl MeshRecord {
    fn of(mesh: &Mesh) -> Self {
        let elements = mesh.elements().len();
        Self {
            elements,
            degrees_of_freedom: 2 * elements + 1,
            resolved_hz: mesh.resolved_frequency_rad_s() / std::f64::consts::TAU,
        }
    }
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
        let [name, what] = [&check.name, &check.what].map(|text| Cow::Owned(text.clone()));
        let of = Cow::Borrowed(check.of);
        Self { name, what, of, found, bound, reason, passes: !check.fails() }
    }

    fn stored(&self) -> StoredCheck {
        let reason =
            || self.reason.clone().unwrap_or_else(|| "no finite number was found".to_owned());
        StoredCheck {
            what: self.what.to_string(),
            of: self.of.to_string(),
            outcome: self.found.zip(self.bound).ok_or_else(reason),
            passes: self.passes,
        }
    }
}

/// The JSON text of a verification: a list of its checks.
pub fn verification_json(verification: &Verification) -> String {
    json(&CheckRecord::all(verification))
}
