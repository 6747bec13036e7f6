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

use super::{assert_clamped_frequency, assert_closed_form, specification};

const FILE: &str = "quanser_flexgage.toml";

#[test]
fn the_clamped_link_has_its_published_frequency() {
    // The stiffness was derived from this frequency.
    assert_clamped_frequency(FILE, 3.49, 0.01);
}

#[test]
fn clamped_and_free_frequencies_are_those_of_the_closed_form() {
    assert_closed_form(FILE, 3);
}

#[test]
fn the_hub_carries_its_friction() {
    let hub = *specification(FILE, &[]).link().hub();
    assert!((hub.viscous_friction_n_m_s_rad - 0.015).abs() < 1e-15);
}
