//! Flexible arm of the course ASEN 2003, University of Colorado Boulder: course file.
//!
//! | | printed, SI |
//! |---|---|
//! | length | 0.45 m |
//! | mass per length | 0.1333 kg/m (0.06 kg in all) |
//! | hub inertia | 0.0005 kg m² |
//! | tip mass | 0.05 kg |
//! | first frequency, clamped | 1.8 Hz |
//! | bending stiffness | 0.2496 N m², from the frequency by the course's lumped model |

use std::f64::consts::TAU;

use super::{assert_clamped_frequency, assert_closed_form, clamped_frequencies, hertz};

const FILE: &str = "boulder_asen2003.toml";

#[test]
fn the_clamped_arm_has_its_published_frequency() {
    assert_clamped_frequency(FILE, 1.8, 0.1);
}

#[test]
fn frequencies_are_those_of_the_closed_form() {
    assert_closed_form(FILE, 2);
}

/// A tip mass on a massless rod, with 33/140 of the rod's own mass: 0.07 % above the link.
#[test]
fn the_lumped_model_of_the_course_is_a_thousandth_high() {
    let found = hertz(&clamped_frequencies(FILE, &[], 1))[0];
    let mass = 0.05 + 33.0 / 140.0 * 0.1333 * 0.45;
    let lumped = (3.0 * 0.2496 / (0.45_f64.powi(3) * mass)).sqrt() / TAU;
    assert!(lumped > found && lumped / found - 1.0 < 1e-3, "{lumped} Hz");
}
