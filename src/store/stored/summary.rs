//! summary.json read back.

use std::path::Path;

use serde::Deserialize;

use super::super::file_names::SUMMARY;
use super::super::json_record::{Head, as_written, check_format, newer, parsed};
use super::super::link_record::{DriveRecord, LinkRecord};
use super::super::records::{CheckRecord, Fingerprint, WarningRecord};
use super::folder::A_RUN;
use super::readings::Readings;
use crate::csv::{InputFile, Place, TableError, quoted};
use crate::result::{Origin, StoredCheck, StoredInput, StoredWarning};

/// What of a summary is read; other keys are passed over, so that a later version may have more.
#[derive(Debug, Deserialize)]
pub(super) struct StoredSummary {
    flexlink: String,
    pub(super) command: String,
    pub(super) title: String,
    inputs: Inputs,
    pub(super) link: LinkRecord,
    /// Of solve alone, as `motion`, `analysis` and `errors`.
    pub(super) drive: Option<DriveRecord>,
    pub(super) motion: Option<Moving>,
    pub(super) analysis: Option<Window>,
    errors: Option<Readings>,
    /// Of simulate alone, as `residual` and `tip_error`.
    pub(super) torque: Option<Played>,
    residual: Option<Readings>,
    tip_error: Option<Readings>,
    pub(super) results: Readings,
    verification: Option<Vec<CheckRecord>>,
    warnings: Vec<WarningRecord>,
    /// Of solve alone.
    #[serde(default)]
    remarks: Vec<WarningRecord>,
    pub(super) files: Vec<String>,
}

#[derive(Debug, Deserialize)]
struct Inputs {
    link: Fingerprint,
    motion: Option<Fingerprint>,
    torque: Option<Fingerprint>,
    target: Option<Fingerprint>,
    reference: Option<Fingerprint>,
    arguments: Vec<String>,
}

/// Times in s between which the tip moves.
#[derive(Debug, Deserialize)]
pub(super) struct Moving {
    pub(super) moves_from_s: f64,
    pub(super) moves_until_s: f64,
}

/// What was solved, and written of it.
#[derive(Debug, Deserialize)]
pub(super) struct Window {
    pub(super) modes: Option<usize>,
    #[serde(rename = "window_start_s")]
    pub(super) start_s: f64,
    #[serde(rename = "window_end_s")]
    pub(super) end_s: f64,
}

/// What was played.
#[derive(Debug, Deserialize)]
pub(super) struct Played {
    pub(super) start_s: f64,
    pub(super) simulated_until_s: f64,
}

/// Whether a folder has the summary of a run, of any version.
pub fn is_run(folder: &Path) -> bool {
    let file = InputFile::read(&folder.join(SUMMARY));
    let head = file.ok().and_then(|file| serde_json::from_slice::<Head>(&file.bytes).ok());
    head.is_some_and(|head| head.flexlink.is_some())
}

impl StoredSummary {
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

    /// Adds to an error that the run is of a later version than this one, if it is.
    pub(super) fn told(&self, error: TableError) -> TableError {
        newer(error, &self.flexlink)
    }

    pub(super) fn origin(&mut self) -> Origin {
        let Inputs { link, motion, torque, target, reference, arguments } = &mut self.inputs;
        let roles = [
            ("link", Some(link)),
            ("motion", motion.as_mut()),
            ("torque", torque.as_mut()),
            ("target", target.as_mut()),
            ("reference", reference.as_mut()),
        ];
        let input = |(role, file): (&str, Option<&mut Fingerprint>)| {
            let Fingerprint { name, sha256 } = file?.clone();
            Some(StoredInput { role: role.to_owned(), name, sha256 })
        };
        Origin {
            command: self.command.clone(),
            version: self.flexlink.clone(),
            title: self.title.clone(),
            inputs: roles.into_iter().filter_map(input).collect(),
            arguments: std::mem::take(arguments),
        }
    }

    /// All numbers by name.
    pub(super) fn take_readings(&mut self) -> Vec<(String, f64)> {
        let parts = [
            ("", Some(std::mem::take(&mut self.results))),
            ("residual_", self.residual.take()),
            ("tip_error_", self.tip_error.take()),
        ];
        let named = |(prefix, part): (&'static str, Option<Readings>)| {
            part.unwrap_or_default().prefixed(prefix)
        };
        let errors = self.errors.take().unwrap_or_default().0.into_iter();
        let errors = errors.map(|(name, error)| (format!("{name}_error"), error));
        parts.into_iter().flat_map(named).chain(errors).collect()
    }

    pub(super) fn take_checks(&mut self) -> Vec<StoredCheck> {
        let check = |check: CheckRecord| StoredCheck {
            what: check.what.into_owned(),
            of: check.of.into_owned(),
            outcome: match (check.found, check.bound) {
                (Some(found), Some(bound)) => Ok((found, bound)),
                _ => Err(check.reason.unwrap_or_else(|| "no finite number was found".to_owned())),
            },
            passes: check.passes,
        };
        self.verification.take().unwrap_or_default().into_iter().map(check).collect()
    }

    pub(super) fn take_warnings(&mut self) -> Vec<StoredWarning> {
        stored(&mut self.warnings)
    }

    pub(super) fn take_remarks(&mut self) -> Vec<StoredWarning> {
        stored(&mut self.remarks)
    }
}

fn stored(records: &mut Vec<WarningRecord>) -> Vec<StoredWarning> {
    let stored = |record: WarningRecord| StoredWarning {
        message: record.message,
        hint: record.hint.into_owned(),
    };
    std::mem::take(records).into_iter().map(stored).collect()
}
