use serde::Serialize;

use super::json::{FORMAT, Fingerprint, json};
use crate::fit::{FitOutcome, Replaced};
use crate::result::{Origin, StoredWarning};

/// What a fit was given: its files, and its arguments as the program takes them.
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
    /// The same for a page; `title` is that of the link.
    pub fn origin(&self, title: &str) -> Origin {
        let named = self.named.iter().map(|file| file.input("measured"));
        let files = [self.link.input("link"), self.measured.input("measured")];
        Origin {
            command: "fit".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            title: title.to_owned(),
            inputs: files.into_iter().chain(named).collect(),
            arguments: self.arguments.clone(),
        }
    }
}

/// The record of a fit, fit.json.
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
    warnings: Vec<StoredWarning>,
}

/// The record of a fit as JSON: the values with their standard errors, the residuals, the correlations, what
/// the data do not determine, and where each start ended.
pub fn fit_json(inputs: &FitInputs, replaced: &[Replaced], outcome: &FitOutcome) -> String {
    let (flexlink, command) = (env!("CARGO_PKG_VERSION"), "fit");
    let warnings = outcome.warnings();
    let stored = warnings.iter().map(|found| StoredWarning::new(found.kind(), found, found.hint()));
    let warnings = stored.collect();
    json(&FitRecord { format: FORMAT, flexlink, command, inputs, replaced, outcome, warnings })
}
