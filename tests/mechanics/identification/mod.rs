//! Links that are fitted to measured values: published rigs, and links whose true values are known.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod responses;
mod rigs;
mod synthetic;

use std::fs;
use std::path::Path;

use flexlink::fit::{FitOutcome, Free, LinkFitError, Measurements, fit};
use flexlink::spec::{FreeValue, LinkDocument, Override, SpecError, read_measurements};

/// Fits the free values of a link's text to measurements.
fn fitted(
    text: &str,
    measured: &Measurements,
    free: &[&str],
) -> Result<FitOutcome, LinkFitError<SpecError>> {
    let document = LinkDocument::read("link.toml", text).unwrap();
    let values: Vec<FreeValue> = free.iter().map(|free| free.parse().unwrap()).collect();
    let bounds: Vec<Free> = values.iter().map(|value| document.free(value, &[]).unwrap()).collect();
    let link_at = |factors: &[f64]| {
        let changes = values.iter().zip(factors).map(|(value, factor)| value.times(*factor));
        let changes: Vec<Override> = changes.collect::<Result<_, _>>()?;
        let specification = document.specification("link.toml", &changes)?;
        Ok((specification.link, specification.mesh))
    };
    fit(measured, &bounds, link_at)
}

/// Text of a link of `specs` and the measurements of the same name.
fn rig(name: &str) -> (String, Measurements) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |folder: &str| fs::read_to_string(root.join(folder).join(name)).unwrap();
    let measured = read_measurements(name, &read("measurements")).unwrap();
    (read("specs"), Measurements::new(measured.values, Vec::new()).unwrap())
}

/// Text of a link of 1.5 m with stiffness, mass per length, hub inertia and payload, and a damping ratio.
fn free_text([stiffness, mass_per_length, hub, payload]: [f64; 4], ratio: f64) -> String {
    format!(
        "[[segments]]\nlength = 1.5\nEI = {stiffness}\nmass_per_length = {mass_per_length}\n\
         [hub]\ninertia = {hub}\n[payload]\nmass = {payload}\n[damping]\nratio = {ratio}\n"
    )
}
