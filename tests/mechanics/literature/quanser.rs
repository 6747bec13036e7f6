//! Quanser FLEXGAGE rotary flexible link: university laboratory handout.
//!
//! | | printed, SI |
//! |---|---|
//! | length | 0.419 m |
//! | bending stiffness | 0.1864 N m² |
//! | mass per length | 0.1551 kg/m |
//! | hub inertia | 0.00208 kg m² |
//! | hub friction | 0.015 N m s/rad |
//! | first frequency, clamped | 3.49 Hz |

use super::closed_form::{self, Uniform};
use super::{
    FINE, assert_close, clamped_frequencies, deviation_percent, frequencies, hertz, specification,
};

const FILE: &str = "quanser_flexgage.toml";

#[test]
fn the_clamped_link_has_its_published_frequency() {
    let found = hertz(&clamped_frequencies(FILE, &[], 1))[0];
    let (deviation, print) = deviation_percent(found, 3.49, 0.01);
    // The stiffness was derived from this frequency: only rounding may lie between.
    assert!(deviation.abs() <= print, "{found} Hz deviates by {deviation} %");
}

#[test]
fn clamped_and_free_frequencies_are_those_of_the_closed_form() {
    let link = specification(FILE, &[]).link;
    let uniform = Uniform::of(&link);
    let clamped = closed_form::frequencies(&link, &uniform.clamped_numbers(3));
    assert_close(&clamped_frequencies(FILE, &[FINE], 3), &clamped, 1e-9);
    let free = closed_form::frequencies(&link, &uniform.free_hub_numbers(3));
    assert_close(&frequencies(FILE, &[FINE], 3), &free, 1e-9);
}

#[test]
fn the_hub_carries_its_friction() {
    let hub = *specification(FILE, &[]).link.hub();
    assert!((hub.viscous_friction_n_m_s_rad - 0.015).abs() < 1e-15);
}
