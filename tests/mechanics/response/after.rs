//! What is left to see when the torque has ended.

use std::f64::consts::PI;

use super::{link, plan_of, played, times, torque};
use flexlink::link::{Damping, Taper};
use flexlink::response::{Feedback, HubReference, Interpolation, Play, Torque};

/// A link that only friction slows down is bent by `b θ̇`, as slowly as that falls, and still.
#[test]
fn what_friction_bends_a_turning_link_to_is_no_vibration() {
    let link = link(|parts| {
        parts.damping = Damping::Modal { ratios: vec![0.02] };
        parts.hub.viscous_friction_n_m_s_rad = 0.02;
    });
    let torque = torque(0.01, 800, |t| (PI * t / 8.0).sin().powi(8));
    let found = played(&link, &plan_of(&link, 10), &Play::of(&torque));
    let bent_m = found.tip_deflection_m()[found.grid.len - 1].abs();
    let vibrating_m = found.modes().unwrap().residual.unwrap().amplitude_m;
    assert!(bent_m > 1e-3, "{bent_m} m");
    assert!(vibrating_m < 0.01 * bent_m, "{vibrating_m:e} m of {bent_m} m");
}

/// A hub alone on its axis: nothing bends, and nothing is left to vibrate.
#[test]
fn a_link_without_modes_turns_and_has_no_vibration() {
    let link = link(|parts| {
        for segment in &mut parts.segments {
            segment.mass_per_length_kg_m = Taper::constant(0.0);
        }
    });
    let torque = torque(0.01, 50, |_| 0.4);
    let found = played(&link, &plan_of(&link, 4), &Play::of(&torque));
    let turned = 0.5 * 0.4 / 0.1 * 0.5_f64.powi(2);
    assert!((found.hub().angle_rad[50] - turned).abs() < 1e-12, "{}", found.hub().angle_rad[50]);
    assert!((found.tip[0].displacement_m[50] - 1.5 * turned).abs() < 1e-12);
    let residual = found.modes().unwrap().residual.unwrap();
    assert_eq!((residual.frequency_hz, residual.decay_s), (None, Some(0.0)));
    assert_eq!(residual.amplitude_m.to_bits(), 0.0_f64.to_bits());
}

/// The same hub under a torque that a converter holds from sample to sample: `θ̇ = Δt Σ T_k/I_H`.
#[test]
fn a_held_torque_turns_a_hub_by_the_sum_of_its_samples() {
    let link = link(|parts| {
        for segment in &mut parts.segments {
            segment.mass_per_length_kg_m = Taper::constant(0.0);
        }
    });
    let samples: Vec<f64> = (0..=50).map(|k| (0.7 * f64::from(k)).sin() + 0.3).collect();
    let torque = Torque::new(&times(0.01, 50), samples.clone()).unwrap();
    let play = Play { interpolation: Interpolation::Zero, ..Play::of(&torque) };
    let found = played(&link, &plan_of(&link, 4), &play);
    let (mut rate, mut angle) = (0.0, 0.0);
    for (k, sample) in samples.iter().enumerate() {
        assert!((found.hub().rate_rad_s[k] - rate).abs() < 1e-12, "sample {k}");
        assert!((found.hub().angle_rad[k] - angle).abs() < 1e-12, "sample {k}");
        angle += 0.01 * rate + 0.5 * 0.01 * 0.01 * sample / 0.1;
        rate += 0.01 * sample / 0.1;
    }
}

/// Feedback brings a link to where its reference ends, slowly: there is nothing to vibrate about.
#[test]
fn a_link_at_its_goal_under_feedback_does_not_vibrate_wherever_that_is() {
    let link = link(|parts| parts.damping = Damping::Modal { ratios: vec![0.05] });
    let time_s = times(0.01, 400);
    let torque = torque(0.01, 400, |_| 0.0);
    for goal_rad in [0.2, -0.1] {
        let risen = |t: f64| t / 4.0 - (2.0 * PI * t / 4.0).sin() / (2.0 * PI);
        let angles = time_s.iter().map(|t| goal_rad * risen(*t)).collect();
        let reference = HubReference::new(&time_s, angles, None).unwrap();
        let feedback = Feedback::new(200.0, 20.0, reference).unwrap();
        let play = Play { feedback: std::slice::from_ref(&feedback), ..Play::of(&torque) };
        let residual = played(&link, &plan_of(&link, 10), &play).modes().unwrap().residual.unwrap();
        assert!(residual.share < 0.05, "{goal_rad} rad: {residual:?}");
    }
}
