//! The error that a simulation claims, held against the same torque on a mesh that is far finer.

use flexlink::link::Damping;
use flexlink::response::{Play, PlayError};

use super::{link, peak, plan_of, played, smooth, solved, torque, torque_of};

/// Claimed and true error of tip and hub angle on so many elements.
fn claimed_and_true(damping: &Damping, elements: usize, play: &Play) -> [(f64, f64); 2] {
    let link = link(|parts| parts.damping = damping.clone());
    let [coarse, fine] =
        [elements, 32 * elements].map(|elements| played(&link, &plan_of(&link, elements), play));
    let claimed = PlayError::of(&coarse, &link.clone().into(), play).unwrap().unwrap();
    let error = |a: &[f64], b: &[f64]| {
        let change: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        peak(&change) / peak(b)
    };
    [
        (claimed.tip, error(&coarse.tip[0].displacement_m, &fine.tip[0].displacement_m)),
        (claimed.hub_angle, error(&coarse.hub().angle_rad, &fine.hub().angle_rad)),
    ]
}

#[test]
fn the_claimed_error_is_the_true_one_on_coarse_and_fine_meshes() {
    let nominal = link(|parts| parts.damping = Damping::Hysteretic { ratio: 0.02 });
    let torque = torque_of(&solved(&nominal, &plan_of(&nominal, 10), &smooth(440), 1e-6));
    for damping in [Damping::None, Damping::Hysteretic { ratio: 0.02 }] {
        for elements in [3, 5, 10, 20] {
            for (claimed, error) in claimed_and_true(&damping, elements, &Play::of(&torque)) {
                let ratio = claimed / error;
                assert!((0.5..2.0).contains(&ratio), "{elements}: {claimed:e} for {error:e}");
            }
        }
    }
}

#[test]
fn a_torque_with_a_jump_on_few_elements_is_warned_of() {
    let jump = torque(0.001, 300, |_| 1.0);
    let link = link(|parts| parts.damping = Damping::None);
    let warns = |elements| {
        let simulation = played(&link, &plan_of(&link, elements), &Play::of(&jump));
        let error =
            PlayError::of(&simulation, &link.clone().into(), &Play::of(&jump)).unwrap().unwrap();
        error.warning(&simulation).map(|warning| warning.kind())
    };
    assert_eq!(warns(2), Some("coarse_mesh"));
    assert_eq!(warns(40), None);
}
