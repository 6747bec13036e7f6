//! Flexible arm of Georgia Tech, data of De Luca and Siciliano.
//!
//! | | printed, SI |
//! |---|---|
//! | length | 1.2192 m (48 in) |
//! | bending stiffness | 11.82 N m² |
//! | mass per length | 0.2453 kg/m |
//! | hub inertia | 1.356 kg m² |
//! | payload | 0.0452 kg |
//! | natural frequencies | 2.12 Hz, 14.3 Hz |

use super::{assert_closed_form, clamped_frequencies, deviation_percent, hertz};

const FILE: &str = "georgia_tech_arm.toml";

/// The hub's 1.356 kg m² is ten times the rest, and the print's two frequencies are those of the
/// clamped arm. The data give both of them 2.9 % less: one factor for both means 6 % more
/// stiffness or less mass than printed. The data stay as printed.
#[test]
fn clamped_frequencies_lie_three_percent_below_the_printed_ones() {
    let computed = hertz(&clamped_frequencies(FILE, &[], 2));
    for (computed, printed, last_digit) in [(computed[0], 2.12, 0.01), (computed[1], 14.3, 0.1)] {
        let (deviation, print) = deviation_percent(computed, printed, last_digit);
        assert!((deviation + 2.9).abs() < 0.06, "{computed} Hz is {deviation} % off {printed} Hz");
        assert!(-deviation > print, "more than rounding");
    }
}

#[test]
fn frequencies_are_those_of_the_closed_form() {
    assert_closed_form(FILE, 2);
}
