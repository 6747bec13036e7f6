//! The record of a fit: NAME.json beside the fitted link file NAME.toml.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::files::{is_stream, record_beside};
use super::json::{FORMAT, Fingerprint, Head, json};
use crate::csv::InputFile;
use crate::fit::{FitOutcome, Replaced};
use crate::result::{Notice, Origin};

const COMMAND: &str = "fit";

/// Path of the record of a fitted link file; `None` for a device or a pipe.
pub fn fit_record(link_file: &Path) -> Option<PathBuf> {
    (!is_stream(link_file)).then(|| record_beside(link_file, "toml"))
}

/// The file in the place of the record of a fitted link file, if no fit has written it.
pub fn foreign_fit_record(link_file: &Path) -> Option<PathBuf> {
    let path = fit_record(link_file)?;
    path.symlink_metadata().ok()?;
    let file = if path.is_file() { InputFile::read(&path).ok() } else { None };
    let is_record = |file: InputFile| {
        let head: Result<Head, _> = serde_json::from_slice(&file.bytes);
        head.is_ok_and(|head| head.flexlink.is_some() && head.command.as_deref() == Some(COMMAND))
    };
    (!file.is_some_and(is_record)).then_some(path)
}

/// Inputs of a fit: its files, and its arguments as the program takes them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FitInputs {
    /// The link file.
    pub link: Fingerprint,
    /// The file of measured values.
    pub measured: Fingerprint,
    /// The responses and records that it names.
    pub named: Vec<Fingerprint>,
    /// `--set`, `payload.mass=0`, `--free`, `hub.inertia`, in order.
    pub arguments: Vec<String>,
}

impl FitInputs {
    /// Origin of the fit for a page; `title` is the link's.
    pub fn origin(&self, title: &str) -> Origin {
        let named = self.named.iter().map(|file| file.input("measured"));
        let files = [self.link.input("link"), self.measured.input("measured")];
        Origin {
            command: COMMAND.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            title: title.to_owned(),
            inputs: files.into_iter().chain(named).collect(),
            arguments: self.arguments.clone(),
        }
    }
}

/// The record of a fit.
#[derive(Serialize)]
struct FitRecord<'a> {
    format: u32,
    flexlink: &'static str,
    command: &'static str,
    inputs: &'a FitInputs,
    /// Values of the link file before and after.
    replaced: &'a [Replaced],
    #[serde(flatten)]
    outcome: &'a FitOutcome,
    warnings: Vec<Notice>,
}

/// The record of a fit as JSON: the values with their standard errors, the residuals, the correlations, the values
/// that the data do not determine, and the end of each start.
pub fn fit_json(inputs: &FitInputs, replaced: &[Replaced], outcome: &FitOutcome) -> String {
    let (flexlink, command) = (env!("CARGO_PKG_VERSION"), COMMAND);
    let warnings = outcome.warnings();
    json(&FitRecord { format: FORMAT, flexlink, command, inputs, replaced, outcome, warnings })
}
