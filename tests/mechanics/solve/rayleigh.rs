//! Rayleigh damping through the ratios of two modes.

use super::{Smooth, link, solved};
use flexlink::link::Damping;
use flexlink::modal::DampingLaw;

#[test]
fn two_modes_get_the_ratios_that_were_asked_for() {
    for (modes, ratios) in [([1, 2], [0.02, 0.02]), ([1, 3], [0.03, 0.01]), ([2, 5], [0.01, 0.05])]
    {
        let damping = Damping::RayleighThroughModes { modes, ratios };
        let link = link(|parts| parts.damping = damping);
        let solution = solved(&link, 10, &Smooth::MOVE.motion());
        for (mode, ratio) in modes.iter().zip(ratios) {
            let omega = solution.links[0].natural_frequencies_rad_s(*mode)[mode - 1];
            let found = solution.links[0].law().modal_ratio(*mode, omega);
            assert!((found - ratio).abs() < 1e-14, "mode {mode}: {found}");
        }
    }
}

#[test]
fn modes_between_the_two_are_damped_less_and_modes_beyond_more() {
    let damping = Damping::RayleighThroughModes { modes: [1, 3], ratios: [0.02, 0.02] };
    let solution = solved(&link(|parts| parts.damping = damping), 10, &Smooth::MOVE.motion());
    let frequencies = solution.links[0].natural_frequencies_rad_s(5);
    let ratios: Vec<f64> = (1..)
        .zip(frequencies)
        .map(|(k, omega)| solution.links[0].law().modal_ratio(k, omega))
        .collect();
    assert!(ratios[1] < 0.02 && ratios[3] > 0.02 && ratios[4] > ratios[3], "{ratios:?}");
}

#[test]
fn the_numbers_may_be_given_themselves() {
    let law = Damping::Rayleigh { alpha_per_s: 0.3, beta_s: 2e-4 };
    let solution = solved(&link(|parts| parts.damping = law), 10, &Smooth::MOVE.motion());
    assert_eq!(*solution.links[0].law(), DampingLaw::Rayleigh { alpha_per_s: 0.3, beta_s: 2e-4 });
    let omega = solution.links[0].natural_frequencies_rad_s(1)[0];
    let expected = 0.15 / omega + 1e-4 * omega;
    assert!((solution.links[0].law().modal_ratio(1, omega) - expected).abs() < 1e-15);
}

#[test]
fn a_hysteretic_link_has_one_ratio_for_all_modes() {
    let solution = solved(&link(|_| ()), 10, &Smooth::MOVE.motion());
    for omega in &solution.links[0].natural_frequencies_rad_s(5) {
        assert!((solution.links[0].law().modal_ratio(1, *omega) - 0.02).abs() < 1e-15);
    }
}
