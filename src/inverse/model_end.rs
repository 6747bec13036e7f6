//! Where the model ends: what it leaves out of the link that was given, against what was asked for.

use super::solution::Solution;
use crate::link::Link;
use crate::modal::{NOTICEABLE, REPORTED_MODES, Thickness, clamped_frequency_below};
use crate::numeric::largest;

/// Largest hub rate over the first natural frequency of the clamped link from which on the user is
/// told.
const FAST_HUB: f64 = 0.7;

/// What centrifugal stiffening moves the tip by there, over its way.
const STIFFENING: f64 = 5e-3;

/// Most that the square is trusted for.
const MOST_STIFFENING: f64 = 0.1;

/// Most that the first order is trusted for.
const MOST_THICK: f64 = 0.3;

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

/// Share by which shear and rotary inertia, which the model leaves out, change the torque, where that
/// is noticeable.
pub(super) fn thick_link(link: &Link, solution: &Solution) -> Option<f64> {
    let (thickness, mesh) = (Thickness::known(link), solution.mesh());
    if thickness.is_slender(mesh, REPORTED_MODES) {
        return None;
    }
    let modes = solution.natural_frequencies_rad_s(REPORTED_MODES);
    let forcing = solution.forcing();
    let torque = (forcing.omegas_rad_s(), &solution.hub.torque_n_m[..]);
    let share = thickness.torque_change(mesh, solution.law(), &modes, torque);
    (share > NOTICEABLE).then_some(share)
}

/// Such a share in words.
pub(super) fn thick(share: f64) -> String {
    if share <= MOST_THICK {
        format!("about {:.0} %", 100.0 * share)
    } else {
        format!("more than {:.0} %", 100.0 * MOST_THICK)
    }
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

    #[test]
    fn a_change_of_the_torque_is_told_as_far_as_the_first_order_is_trusted() {
        assert_eq!([0.0123, 0.3, 0.31].map(thick), ["about 1 %", "about 30 %", "more than 30 %"]);
    }
}
