//! E. Bayo, *A Finite-Element Approach to Control the End-Point Motion of a Single-Link Flexible
//! Robot*, Journal of Robotic Systems 4(1), 63-75, 1987, section "Application".
//!
//! | | printed | SI |
//! |---|---|---|
//! | length, elements | 150 cm, 10 of 15 cm | 1.5 m |
//! | Young's modulus | 2e7 N/cm² | 2e11 N/m² |
//! | I, example 1 | 0.25e-2 cm⁴ | EI = 5 N m² |
//! | I, example 2 | 1e-2 cm⁴ | EI = 20 N m² |
//! | first element | ten times stiffer | 50 and 200 N m² |
//! | density, area | 0.008 kg/cm³, 1 cm² | 0.8 kg/m |
//! | hub inertia | 1000 kg cm² | 0.1 kg m² |
//! | damping | 0.02 | hysteretic, 1 + 2iξ |
//! | periods | 0.525, 0.182, 0.0732, 0.0375, 0.0220 s | |
//! | torque before the tip moves, and after | 0.3 s, another 0.3 s | |
//!
//! The print of its figures is lost to us: one period of a sine acceleration that lasts 0.88 s
//! reproduces what its text says of them. That is a reconstruction.

use std::f64::consts::TAU;

use super::{assert_close, deviation_percent, frequencies, motion, specification};
use flexlink::beam::Mesh;
use flexlink::inverse::{Solution, invert};
use flexlink::modal::torque_zeros;
use flexlink::result::{JointMetrics, Metrics};

const FIRST: &str = "bayo1987_example1.toml";
const SECOND: &str = "bayo1987_example2.toml";

/// Ten elements to each of the paper's one.
const FINER: [&str; 2] = ["segments.root.elements=10", "segments.beam.elements=90"];

fn periods(file: &str, settings: &[&str]) -> Vec<f64> {
    frequencies(file, settings, 5).iter().map(|omega| TAU / omega).collect()
}

fn zeros(file: &str) -> Vec<f64> {
    let specification = specification(file, &[]);
    torque_zeros(&Mesh::new(specification.link(), specification.mesh()).unwrap(), 3)
}

fn solution(file: &str) -> Solution {
    let specification = specification(file, &[]);
    let motion = motion("sine_0.88s.csv", specification.link());
    invert(specification.link(), specification.mesh(), &motion, &specification.analysis).unwrap()
}

/// Fails unless the periods in s are the expected ones, which have eight decimals.
#[track_caller]
fn assert_rounded(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 0.5e-8, "{found} s for {expected} s");
    }
}

#[test]
fn the_rigid_inertia_is_one() {
    for file in [FIRST, SECOND] {
        let link = specification(file, &[]).link().clone();
        assert!((link.rigid_inertia_kg_m2() - 1.0).abs() < 1e-15);
    }
}

/// Consistent mass; five independent programs agree on these digits.
#[test]
fn periods_with_the_papers_ten_elements() {
    let expected = [0.526_425_12, 0.183_600_31, 0.074_942_73, 0.039_440_38, 0.024_270_99];
    assert_rounded(&periods(FIRST, &[]), &expected);
}

#[test]
fn periods_with_a_hundred_elements_and_the_same_stiff_piece() {
    let expected = [0.526_427_12, 0.183_608_96, 0.074_969_17, 0.039_491_22, 0.024_351_35];
    assert_rounded(&periods(FIRST, &FINER), &expected);
}

/// The paper's periods are shorter than those of the consistent mass matrix that it names, the
/// more so the higher the mode: 0.3 % to 10.3 %. Finer meshes lengthen the difference, so that it
/// is not discretisation; without the matrix's rotational entries, which is probably how they were
/// computed, periods are 0.5259 0.1825 0.0732 0.0374 0.0223 s. The matrix stays consistent here
/// and the deviation is stated, never tuned to.
#[test]
fn printed_periods_are_shorter_by_the_stated_deviations() {
    let printed = [0.525, 0.182, 0.0732, 0.0375, 0.0220];
    let last_digits = [1e-3, 1e-3, 1e-4, 1e-4, 1e-4];
    let stated = [0.3, 0.9, 2.4, 5.2, 10.3];
    let computed = periods(FIRST, &[]);
    for (k, stated) in stated.iter().enumerate() {
        let (deviation, print) = deviation_percent(computed[k], printed[k], last_digits[k]);
        assert!((deviation - stated).abs() <= 0.05, "period {k}: {deviation} %, not {stated} %");
        assert!(deviation > print, "period {k}: the deviation is not the rounding of the print");
    }
}

#[test]
fn zeros_of_torque_to_tip_are_those_of_the_stiff_rooted_link() {
    let found = zeros(FIRST);
    for ((found, expected), last_digit) in
        found.iter().zip([12.89, 72.08, 181.6]).zip([0.01, 0.01, 0.1])
    {
        assert!((found - expected).abs() <= 0.5 * last_digit, "{found} for {expected}");
    }
}

#[test]
fn four_times_the_stiffness_doubles_zeros_and_halves_periods() {
    let doubled: Vec<f64> = zeros(FIRST).iter().map(|z| 2.0 * z).collect();
    assert_close(&zeros(SECOND), &doubled, 1e-12);
    let halved: Vec<f64> = periods(FIRST, &[]).iter().map(|period| 0.5 * period).collect();
    assert_close(&periods(SECOND, &[]), &halved, 1e-12);
}

/// e^{−z₁ · 0.3 s} = 2 %: the paper's 0.3 s are the time in which the torque grows from 2 %.
#[test]
fn the_papers_lead_time_is_the_two_percent_level_of_the_first_zero() {
    let decay = (-0.3 * zeros(FIRST)[0]).exp();
    assert!((decay - 0.02).abs() < 0.002, "{decay}");
}

#[test]
fn the_torque_of_example_one_is_half_the_rigid_and_acts_three_tenths_of_a_second_longer() {
    let solution = solution(FIRST);
    let metrics = Metrics::of(&solution);
    let JointMetrics { torque_ratio, lead_s, lag_s, peak_rigid_torque_n_m, .. } = *metrics.hub();
    // The ratio is read off the paper's figure to two digits.
    assert!((torque_ratio - 0.50).abs() < 0.005, "{torque_ratio}");
    // 0.3 s in the text, to one digit; 0.305 s and 0.319 s with the reconstructed motion.
    let [lead_s, lag_s] = [lead_s, lag_s].map(Option::unwrap);
    assert!((lead_s - 0.305).abs() < 0.0011, "{lead_s}");
    assert!((lag_s - 0.319).abs() < 0.0011, "{lag_s}");
    // I a/L with the peak of the sine.
    let rigid = TAU * 0.5 / (0.88 * 0.88) / 1.5;
    assert!((peak_rigid_torque_n_m.value / rigid - 1.0).abs() < 1e-5);
}

#[test]
fn the_stiffer_link_of_example_two_is_nearer_to_the_rigid_one_and_leads_less() {
    let metrics = Metrics::of(&solution(SECOND));
    let JointMetrics { torque_ratio, lead_s, .. } = *metrics.hub();
    assert!((torque_ratio - 0.834).abs() < 0.005, "{torque_ratio}");
    let lead_s = lead_s.unwrap();
    assert!((lead_s - 0.114).abs() < 0.0011, "{lead_s}");
}

#[test]
fn neither_example_gives_a_warning() {
    for file in [FIRST, SECOND] {
        let warnings = solution(file).warnings;
        assert!(warnings.is_empty(), "{file}: {warnings:?}");
    }
}
