//! Published examples: each file cites one source, gives its data as printed and in SI, and states
//! for every number how far this program may lie from it, and why.
//!
//! The expected numbers of uniform links come from the closed form, solved here by bisection; the
//! program has no part in it.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod bayo1987;
mod boulder;
mod closed_form;
mod georgia_tech;
mod gu_petkov;
mod nasa;
mod quanser;
mod rome;

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use flexlink::beam::Mesh;
use flexlink::csv::read_motion_table;
use flexlink::link::Link;
use flexlink::modal::{held_frequencies, natural_frequencies};
use flexlink::motion::TipMotion;
use flexlink::spec::{Override, Specification, read_specification};

use closed_form::Uniform;

/// Enough elements for ten digits of the first five frequencies of a uniform link.
const FINE: &str = "mesh.elements=800";

fn file(folder: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join(name)
}

/// A link file of this repository with some `--set` applied.
fn specification(name: &str, settings: &[&str]) -> Specification {
    let overrides: Vec<Override> = settings.iter().map(|set| set.parse().unwrap()).collect();
    let text = fs::read_to_string(file("specs", name)).unwrap();
    read_specification(name, &text, &overrides).unwrap()
}

/// A trajectory of this repository.
fn motion(name: &str, link: &Link) -> TipMotion {
    let bytes = fs::read(file("trajectories", name)).unwrap();
    read_motion_table(name, &bytes, link.length_m())
        .unwrap()
        .into_motion()
        .unwrap()
        .into_tip()
        .unwrap()
}

/// The first natural frequencies of a link in rad/s, its hub free of torque.
fn frequencies(name: &str, settings: &[&str], count: usize) -> Vec<f64> {
    let own = specification(name, settings);
    let (link, mesh) = (own.link().clone(), own.mesh().clone());
    natural_frequencies(&Mesh::new(&link, &mesh).unwrap(), count)
}

/// The first natural frequencies of a link in rad/s, its hub clamped.
fn clamped_frequencies(name: &str, settings: &[&str], count: usize) -> Vec<f64> {
    let own = specification(name, settings);
    let (link, mesh) = (own.link().clone(), own.mesh().clone());
    held_frequencies(&Mesh::new(&link, &mesh).unwrap(), f64::INFINITY, count)
}

fn hertz(frequencies_rad_s: &[f64]) -> Vec<f64> {
    frequencies_rad_s.iter().map(|omega| omega / TAU).collect()
}

/// Fails unless each number lies within a relative tolerance of the expected one.
#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        let error = (found / expected - 1.0).abs();
        assert!(error <= tolerance, "{found} is {error:.1e} off {expected}");
    }
}

/// Deviation of a computed number from a printed one in % of the latter, and how much of it the
/// rounding of the print leaves open.
fn deviation_percent(computed: f64, printed: f64, last_digit: f64) -> (f64, f64) {
    (100.0 * (computed / printed - 1.0), 50.0 * last_digit / printed)
}

/// Fails unless the first clamped frequency is the printed one, but for the rounding of the print.
#[track_caller]
fn assert_clamped_frequency(name: &str, printed_hz: f64, last_digit_hz: f64) {
    let found = hertz(&clamped_frequencies(name, &[], 1))[0];
    let (deviation, print) = deviation_percent(found, printed_hz, last_digit_hz);
    assert!(deviation.abs() <= print, "{found} Hz deviates by {deviation} %");
}

/// Fails unless the first frequencies of a uniform link, clamped and free, are those of the closed form.
#[track_caller]
fn assert_closed_form(name: &str, count: usize) {
    let link = specification(name, &[]).link().clone();
    let uniform = Uniform::of(&link);
    let clamped = closed_form::frequencies(&link, &uniform.clamped_numbers(count));
    assert_close(&clamped_frequencies(name, &[FINE], count), &clamped, 1e-9);
    let free = closed_form::frequencies(&link, &uniform.free_hub_numbers(count));
    assert_close(&frequencies(name, &[FINE], count), &free, 1e-9);
}
