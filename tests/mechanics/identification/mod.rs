//! Links and arms that are fitted to measured values: published rigs, and those whose true values are known.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod arms;
mod closed_loops;
mod decays;
mod ratios;
mod records;
mod responses;
mod rigs;
mod synthetic;

use std::fs;
use std::path::Path;

use flexlink::fit::{FitOutcome, Free, LinkFitError, Measurements, Specimen, fit};
use flexlink::link::Payload;
use flexlink::model::Sensor;
use flexlink::spec::{FreeValue, LinkDocument, Override, SpecError, read_measurements};
use num_complex::Complex64;

use crate::theory::closed_form::UniformLink;

/// Fits the free values of a link's or an arm's text to measurements.
fn fitted(
    text: &str,
    measured: &Measurements,
    free: &[&str],
) -> Result<FitOutcome, LinkFitError<SpecError>> {
    let document = LinkDocument::read("link.toml", text).unwrap();
    let values: Vec<FreeValue> = free.iter().map(|free| free.parse().unwrap()).collect();
    let bounds: Vec<Free> = values.iter().map(|value| document.free(value, &[]).unwrap()).collect();
    let specimen_at = |factors: &[f64]| {
        let changes = values.iter().zip(factors).map(|(value, factor)| value.times(*factor));
        let changes: Vec<Override> = changes.collect::<Result<_, _>>()?;
        let own = document.specification("link.toml", &changes)?;
        Ok(Specimen::of(own.arm, &own.meshes))
    };
    fit(measured, &bounds, specimen_at)
}

/// Text of a link of `specs` and the measurements of the same name.
fn rig(name: &str) -> (String, Measurements) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |folder: &str| fs::read_to_string(root.join(folder).join(name)).unwrap();
    let measured = read_measurements(name, &read("measurements"), (1, false)).unwrap();
    (read("specs"), Measurements::new(measured.values, vec![], vec![]).unwrap())
}

/// Text of a link of 1.5 m with stiffness, mass per length, hub inertia and payload, and keys of damping.
fn free_text([stiffness, mass_per_length, hub, payload]: [f64; 4], damping: &str) -> String {
    format!(
        "[[segments]]\nlength = 1.5\nEI = {stiffness}\nmass_per_length = {mass_per_length}\n\
         [hub]\ninertia = {hub}\n[payload]\nmass = {payload}\n[damping]\n{damping}\n"
    )
}

/// The link that responses and records are of.
fn truth() -> UniformLink {
    let payload = Payload { mass_kg: 0.3, inertia_kg_m2: 0.0, offset_m: 0.0 };
    UniformLink { payload, ..UniformLink::BAYO }
}

/// A transfer of the closed form per torque for a relative complex stiffness; the strain is `w''`.
fn per_torque(sensor: Sensor, omega: f64, stiffness: Complex64) -> Complex64 {
    let lambda = Complex64::from(omega.powi(2)) / stiffness;
    let link = truth();
    let exact = link.solve(lambda);
    let acceleration = exact.inertia_kg_m().inv();
    let tip = -acceleration / omega.powi(2);
    let angle = exact.angle_rad_m() * tip;
    match sensor {
        Sensor::HubAngle | Sensor::Carriage => angle,
        Sensor::HubRate | Sensor::CarriageVelocity => Complex64::new(0.0, omega) * angle,
        Sensor::TipDeflection => tip - 1.5 * angle,
        Sensor::TipAcceleration => acceleration,
        Sensor::RootStrain => exact.moment_kg_m(0.0) * acceleration / (-5.0 * stiffness),
    }
}
