use serde::Serialize;

use super::json::{FORMAT, Fingerprint, json};
use crate::fit::FitOutcome;
use crate::spec::Replaced;

/// The record of a fit, fit.json.
#[derive(Serialize)]
struct FitRecord<'a> {
    format: u32,
    flexlink: &'static str,
    command: &'static str,
    link: &'a Fingerprint,
    measured: &'a Fingerprint,
    /// Values of the link file before and after.
    replaced: &'a [Replaced],
    #[serde(flatten)]
    outcome: &'a FitOutcome,
}

/// The record of a fit as JSON: the values with their standard errors, the residuals, the correlations, and
/// what the data do not determine.
pub fn fit_json(
    link: &Fingerprint,
    measured: &Fingerprint,
    replaced: &[Replaced],
    outcome: &FitOutcome,
) -> String {
    let (flexlink, command) = (env!("CARGO_PKG_VERSION"), "fit");
    json(&FitRecord { format: FORMAT, flexlink, command, link, measured, replaced, outcome })
}
