//! Arm of the NASA Johnson Space Center: ASME DETC2007-35511.
//!
//! | | printed, SI |
//! |---|---|
//! | length | 3.372 m |
//! | bending stiffness | 100.64 N m² |
//! | mass per length | 2.82 kg/m |
//! | payload | 49.447 kg, 5.2 times the link's own (the print says 5.18) |
//! | hub inertia | none |

use super::closed_form::{Uniform, unit_frequency};
use super::{FINE, assert_close, frequencies, specification};

const FILE: &str = "nasa_jsc_arm.toml";

/// b₁ … b₅ of the pinned link with 5.2 of its own mass at the tip.
const NUMBERS: [f64; 5] =
    [3.171_011_466_89, 6.298_221_426_56, 9.434_866_134_38, 12.573_959_496_8, 15.714_044_953_7];

#[test]
fn the_payload_is_5_2_times_the_links_mass_and_not_5_18() {
    let link = specification(FILE, &[]).link().clone();
    let ratio = Uniform::of(&link).payload;
    assert!((ratio - 5.2).abs() < 1e-6, "{ratio}");
    assert!((ratio / 5.18 - 1.0).abs() > 3e-3);
}

#[test]
fn five_frequencies_of_the_free_hub_are_those_of_the_closed_form() {
    assert_close(&Uniform { hub: 0.0, payload: 5.2 }.free_hub_numbers(5), &NUMBERS, 1e-11);
    // 5.2 · 2.82 kg/m · 3.372 m: the kilograms as printed are 1.6e-7 less.
    let settings = [FINE, "payload.mass=49.447008"];
    let unit = unit_frequency(specification(FILE, &[]).link());
    let found = frequencies(FILE, &settings, 5);
    let numbers: Vec<f64> = found.iter().map(|omega| (omega / unit).sqrt()).collect();
    // Discretisation: (b/800)⁴/2880 of b is 5e-11 for the fifth.
    assert_close(&numbers, &NUMBERS, 1e-10);
}

#[test]
fn so_heavy_a_payload_all_but_pins_the_tip() {
    for (k, b) in NUMBERS.iter().enumerate() {
        let pinned = std::f64::consts::PI * (k + 1) as f64;
        assert!(*b > pinned && b / pinned < 1.01);
    }
}
