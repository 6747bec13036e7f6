//! Where the model ends: what it leaves out of the link that was given, against what was asked for.

use std::f64::consts::TAU;

use super::solution::Solution;
use crate::link::Link;
use crate::modal::{REPORTED_MODES, ThickLink, Thickness, clamped_frequency_below};
use crate::numeric::largest;

/// Largest hub rate over the first natural frequency of the clamped link from which on the user is
/// told.
const FAST_HUB: f64 = 0.7;

/// What centrifugal stiffening moves the tip by there, over its way.
const STIFFENING: f64 = 5e-3;

/// Most that the square is trusted for.
const MOST_STIFFENING: f64 = 0.1;

/// A hub that turns as fast as the link vibrates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FastHub {
    pub(super) rate_rad_s: f64,
    /// Over the first natural frequency of the clamped link.
    pub(super) share: f64,
}

/// What centrifugal stiffening, which grows with the square of the rate, moves the tip by where the hub
/// turns with this share of the first clamped frequency, in words.
pub(super) fn stiffening(share: f64) -> String {
    let moves = STIFFENING * (share / FAST_HUB).powi(2);
    if moves <= MOST_STIFFENING {
        format!("about {:.1} %", 100.0 * moves)
    } else {
        format!("more than {:.0} %", 100.0 * MOST_STIFFENING)
    }
}

/// The modes that shear and rotary inertia lower, of those that the torque is made of: the first one,
/// and those of the first few that lie in the band.
pub(super) fn thick_link(link: &Link, solution: &Solution) -> Option<ThickLink> {
    let (thickness, mesh) = (Thickness::known(link), solution.mesh());
    if thickness.is_slender(mesh, REPORTED_MODES) {
        return None;
    }
    let highest = TAU * solution.band.highest_hz;
    let mut modes = solution.natural_frequencies_rad_s(REPORTED_MODES);
    let within = modes.iter().filter(|omega| **omega <= highest).count();
    modes.truncate(within.max(1));
    thickness.noticeable(mesh, &modes)
}

pub(super) fn fast_hub(solution: &Solution) -> Option<FastHub> {
    let rate_rad_s = largest(&solution.hub_rate_rad_s);
    if rate_rad_s <= 0.0 {
        return None;
    }
    let clamped = clamped_frequency_below(solution.mesh(), rate_rad_s / FAST_HUB)?;
    Some(FastHub { rate_rad_s, share: rate_rad_s / clamped })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiffening_grows_with_the_square_of_the_rate_as_far_as_that_is_trusted() {
        let words = [0.7, 1.4, 21.0].map(stiffening);
        assert_eq!(words, ["about 0.5 %", "about 2.0 %", "more than 10 %"]);
    }
}
