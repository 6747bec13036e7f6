//! A simulation that goes on from the state that another one left, against the whole of both.

use std::f64::consts::TAU;

use flexlink::link::{Damping, Gravity, Link, LinkParts};
use flexlink::response::{
    Feedback, HubReference, Interpolation, LinkState, Play, Played, SimulationError, State, Torque,
};

use super::{loaded, peak, plan_of, simulate, times};
use crate::common::apart;

const STEP_S: f64 = 0.004;

/// Samples of the whole, and the one at which it is cut.
const SAMPLES: u32 = 300;
const CUT: usize = 130;

const BETA: Damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 };

fn torque_at(time_s: f64) -> f64 {
    0.8 * (TAU * time_s / 0.9).sin()
}

/// Torque and reference from one sample on.
fn driven(from: usize, until: usize) -> (Torque, HubReference) {
    let time_s = times(STEP_S, SAMPLES)[from..=until].to_vec();
    let torque = time_s.iter().map(|t| torque_at(*t)).collect();
    let angle = time_s.iter().map(|t| 0.4 + 0.05 * t).collect();
    let rate = Some(vec![0.05; time_s.len()]);
    let reference = HubReference::new(&time_s, angle, rate).unwrap();
    (Torque::new(&time_s, torque).unwrap(), reference)
}

/// The whole, and its second part from the state that the first part leaves.
fn both(link: &Link, is_large: bool, has_feedback: bool) -> (Played, Played) {
    let last = usize::try_from(SAMPLES).unwrap();
    let played = |from: usize, until: usize, state: Option<&State>| {
        let (torque, reference) = driven(from, until);
        let feedback = Feedback::new(5.0, 0.5, reference).unwrap();
        let play = Play {
            interpolation: Interpolation::Linear,
            feedback: if has_feedback { std::slice::from_ref(&feedback) } else { &[] },
            // The reference of the whole begins there.
            initial_tip_m: 0.4 * link.length_m(),
            is_large,
            state,
            ..Play::of(&torque)
        };
        simulate(link, &plan_of(link, 12), &play).unwrap()
    };
    let first = played(0, CUT, None);
    (played(0, last, None), played(CUT, last, Some(&first.state())))
}

#[test]
fn a_motion_goes_on_from_its_state_as_the_whole_does() {
    let gravity = Gravity { acceleration_m_s2: [0.0, -9.81], start_angle_rad: Some(-1.0) };
    let hysteretic = Damping::Hysteretic { ratio: 0.02 };
    let weighted = Link::new(LinkParts { gravity: Some(gravity), ..loaded(BETA).into() }).unwrap();
    for (link, is_large) in [
        (loaded(BETA), false),
        (loaded(Damping::None), false),
        (loaded(hysteretic), false),
        (loaded(BETA), true),
        (weighted, true),
    ] {
        for has_feedback in [false, true] {
            let (whole, second) = both(&link, is_large, has_feedback);
            for (name, whole, second) in [
                ("tip", &whole.tip[0].displacement_m, &second.tip[0].displacement_m),
                ("velocity", &whole.tip[0].velocity_m_s, &second.tip[0].velocity_m_s),
                ("hub", &whole.hub().angle_rad, &second.hub().angle_rad),
                ("torque", &whole.hub().torque_n_m, &second.hub().torque_n_m),
            ] {
                let apart = apart(&whole[CUT..], second) / peak(whole);
                // With feedback the torque has the hub's rate.
                let bound = if ["velocity", "torque"].contains(&name) { 1e-6 } else { 1e-8 };
                assert!(
                    apart < bound,
                    "{name} {apart:e}, {}, large: {is_large}, feedback: {has_feedback}",
                    link.damping().name()
                );
            }
            let every = std::num::NonZeroUsize::MIN;
            let [whole, second] =
                [&whole, &second].map(|of| of.displacements_m(&[7], every).unwrap().samples);
            let apart = apart(&whole[0][CUT..], &second[0]) / peak(&whole[0]);
            assert!(apart < 1e-8, "node {apart:e}, large: {is_large}");
        }
    }
}

/// What swings goes on to swing: no torque is needed to play a state.
#[test]
fn a_state_moves_without_a_torque() {
    let link = loaded(Damping::None);
    let torque = driven(0, CUT).0;
    let first = simulate(&link, &plan_of(&link, 12), &Play::of(&torque)).unwrap();
    let state = first.state();
    let none = super::torque(STEP_S, 100, |_| 0.0);
    let play = Play { state: Some(&state), ..Play::of(&none) };
    let found = simulate(&link, &plan_of(&link, 12), &play).unwrap();
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let momentum_starts = first.hub().rate_rad_s[CUT];
    assert!(
        (found.hub().rate_rad_s[0] - momentum_starts).abs() < 1e-9 * peak(&first.hub().rate_rad_s)
    );
    assert!(peak(&found.tip[0].velocity_m_s) > 0.1);
    let rest = simulate(&link, &plan_of(&link, 12), &Play::of(&none)).unwrap_err();
    assert_eq!(rest, SimulationError::NoTorque);
    // Another mesh has other cubics; what they change is small, and what is left out is told.
    let other = simulate(&link, &plan_of(&link, 31), &play).unwrap();
    let apart = (other.tip[0].displacement_m[100] - found.tip[0].displacement_m[100]).abs();
    assert!(apart < 1e-4 * peak(&found.tip[0].displacement_m), "{apart:e}");
}

#[test]
fn a_state_of_another_link_is_refused() {
    let link = loaded(BETA);
    let torque = driven(0, CUT).0;
    let play = Play::of(&torque);
    let plan = plan_of(&link, 12);
    let linear = simulate(&link, &plan, &play).unwrap().state();
    let large = simulate(&link, &plan, &Play { is_large: true, ..play }).unwrap().state();
    let refusal = |state: &State, is_large| {
        let play = Play { is_large, state: Some(state), ..play };
        simulate(&link, &plan, &play).unwrap_err().to_string()
    };
    assert_eq!(
        refusal(&large, false),
        "the state is of a link at large angles, but must be of a linear one"
    );
    assert_eq!(
        refusal(&linear, true),
        "the state is of a linear link, but must be one at large angles"
    );
    let mut shorter = large.clone();
    shorter.links[0].x_m.iter_mut().for_each(|x| *x *= 0.9);
    assert!(
        refusal(&shorter, true).ends_with("but must reach from 0.05 to 1.55 m, as the link does")
    );
    let mut fewer = large.clone();
    fewer.links[0].slope_rad.pop();
    assert!(refusal(&fewer, true).contains("as many numbers in every list"));
    let mut lost = linear.clone();
    lost.links[0].slope_rate_rad_s[3] = f64::NAN;
    assert_eq!(refusal(&lost, false), "the state holds NaN, but must hold finite numbers");
    let mut turned = linear.clone();
    turned.links[0].x_m.swap(2, 3);
    assert!(refusal(&turned, false).ends_with("but must have rising places"));
    // Without the place of the mass the pieces have no ends.
    let mut without = large.clone();
    let mass = without.links[0].x_m.iter().position(|x| (x - 0.8).abs() < 1e-9).unwrap();
    let LinkState { x_m, slope_rad, slope_rate_rad_s, .. } = &mut without.links[0];
    for list in [x_m, slope_rad, slope_rate_rad_s] {
        list.remove(mass);
    }
    assert!(refusal(&without, true).contains("those at both ends among them"));
    let hub = driven(0, CUT).1;
    let held = Play { state: Some(&linear), ..Play::turning(&hub) };
    let held = simulate(&link, &plan, &held).unwrap_err().to_string();
    assert_eq!(held, "the state comes with a motion of the hub, but must come with a torque");
}
