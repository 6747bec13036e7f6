//! A torque that repeats, and the motion to which the link settles.

use std::f64::consts::{PI, TAU};

use flexlink::link::{Damping, Gravity, Hub, Link, LinkParts};
use flexlink::response::{
    CycleError, Feedback, HubReference, Interpolation, Play, Played, SimulationError, Torque,
};

use super::{loaded, peak, plan_of, simulate, times};
use crate::common::apart;

const STEP_S: f64 = 0.01;
const SAMPLES: u32 = 90;

const BETA: Damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 3e-3 };

/// A torque of two harmonics and a mean, in N m, over so many cycles.
fn torque(cycles: u32, mean_n_m: f64) -> Torque {
    let time_s = times(STEP_S, cycles * SAMPLES - 1);
    let at = |k: u32| {
        let share = f64::from(k) / f64::from(SAMPLES);
        mean_n_m + 0.8 * (TAU * share).sin() + 0.3 * (TAU * (2.0 * share + 0.1)).cos()
    };
    Torque::new(&time_s, (0..cycles * SAMPLES).map(at).collect()).unwrap()
}

fn with_friction(friction: f64) -> Link {
    let parts: LinkParts = loaded(BETA).into();
    let hub = Hub { viscous_friction_n_m_s_rad: friction, ..parts.hub };
    Link::new(LinkParts { hub, ..parts }).unwrap()
}

fn played(link: &Link, play: &Play) -> Played {
    simulate(link, &plan_of(link, 10), play).unwrap()
}

/// Histories without a position of the free hub, and with that of a held one.
fn histories(of: &Played, is_held: bool) -> Vec<Vec<f64>> {
    let bent = of.tip_deflection_m();
    let free = [&of.hub().rate_rad_s, &of.tip[0].velocity_m_s, &of.hub().torque_n_m, &bent];
    let held = [&of.hub().angle_rad, &of.tip[0].displacement_m];
    free.into_iter().chain(held.into_iter().filter(|_| is_held)).cloned().collect()
}

#[test]
fn the_link_settles_to_it() {
    const CYCLES: u32 = 80;
    for interpolation in [Interpolation::Cubic, Interpolation::Linear, Interpolation::Zero] {
        for is_held in [false, true] {
            let link = with_friction(0.4);
            // The hub turns by the mean torque over the friction, and is held somewhere else.
            let (one, many) = (torque(1, 0.2), torque(CYCLES, 0.2));
            let feedback = |torque: &Torque| {
                let time_s = (0..torque.grid().len).map(|k| torque.grid().time_s(k));
                let time_s: Vec<f64> = time_s.collect();
                let angle = time_s.iter().map(|t| 0.1 * (TAU * t / 0.9).sin()).collect();
                Feedback::new(6.0, 2.0, HubReference::new(&time_s, angle, None).unwrap()).unwrap()
            };
            let [of_one, of_many] = [feedback(&one), feedback(&many)];
            let cycle = played(
                &link,
                &Play {
                    interpolation,
                    cycle_turn_rad: Some(0.0),
                    feedback: is_held.then_some(&of_one).map_or(&[], std::slice::from_ref),
                    ..Play::of(&one)
                },
            );
            let all = played(
                &link,
                &Play {
                    interpolation,
                    feedback: is_held.then_some(&of_many).map_or(&[], std::slice::from_ref),
                    ..Play::of(&many)
                },
            );
            // A spline's end is felt some samples away from it.
            let first = usize::try_from((CYCLES - 3) * SAMPLES).unwrap();
            let all = histories(&all, is_held);
            for (k, (found, all)) in histories(&cycle, is_held).iter().zip(all).enumerate() {
                let apart = apart(found, &all[first..]) / peak(found);
                assert!(apart < 1e-7, "{interpolation:?}, held {is_held}, {k}: {apart:e}");
            }
        }
    }
}

#[test]
fn a_cycle_ends_where_it_begins() {
    for (friction, turn_rad) in [(0.0, 0.0), (0.0, 0.4), (0.2, 0.0)] {
        let link = with_friction(friction);
        let (one, mean) = (torque(1, 0.0), 1.0 / f64::from(SAMPLES));
        let two = 2.0 * STEP_S * f64::from(SAMPLES);
        let play = Play {
            cycle_turn_rad: Some(turn_rad),
            initial_tip_m: 0.3,
            until_s: Some(two),
            ..Play::of(&one)
        };
        let found = played(&link, &play);
        let samples = usize::try_from(SAMPLES).unwrap();
        let tip = &found.tip[0].displacement_m;
        assert!((tip[0] - 0.3).abs() < 1e-12);
        let travelled = tip[samples] - tip[0];
        let expected = turn_rad * link.length_m();
        assert!(friction > 0.0 || (travelled - expected).abs() < 1e-9, "{travelled}");
        for k in 0..=samples {
            assert!((tip[k + samples] - tip[k] - travelled).abs() < 1e-9, "{k}");
            let [a, b] = [k, k + samples].map(|k| found.hub().rate_rad_s[k]);
            assert!((a - b).abs() < 1e-9 * peak(&found.hub().rate_rad_s), "{k}: {a} and {b}");
        }
        // What friction and damping take in a cycle is what the motor gives.
        let account = played(&link, &Play { until_s: None, ..play }).energy(1);
        let missing = account.balances[0].work_j
            - account.balances[0].dissipated_j
            - (account.balances[0].kinetic_j + account.balances[0].strain_j - account.start_j);
        assert!(missing.abs() < 1e-6 * account.start_j.max(mean), "{missing:e}");
        assert!(found.modes().unwrap().residual.is_none());
    }
}

fn under_gravity(start_angle_rad: f64, friction: f64) -> Link {
    let acceleration_m_s2 = [0.0, -9.81];
    let gravity = Some(Gravity { acceleration_m_s2, start_angle_rad: Some(start_angle_rad) });
    let parts: LinkParts = with_friction(friction).into();
    Link::new(LinkParts { gravity, ..parts }).unwrap()
}

#[test]
fn a_link_at_large_angles_settles_to_it() {
    const CYCLES: u32 = 24;
    let hanging = under_gravity(-0.5 * PI, 3.0);
    for (link, is_large) in [(&hanging, false), (&with_friction(3.0), true)] {
        let (one, many) = (torque(1, 0.0), torque(CYCLES, 0.0));
        let play = |torque| Play { is_large, ..Play::of(torque) };
        let cycle = played(link, &Play { cycle_turn_rad: Some(0.0), ..play(&one) });
        let all = played(link, &play(&many));
        let first = usize::try_from((CYCLES - 3) * SAMPLES).unwrap();
        let is_held = link.gravity().is_some();
        let all = histories(&all, is_held);
        for (k, (found, all)) in histories(&cycle, is_held).iter().zip(all).enumerate() {
            let apart = apart(found, &all[first..]) / peak(found);
            assert!(apart < 1e-5, "gravity {is_held}, {k}: {apart:e}");
        }
    }
}

#[test]
fn what_does_not_repeat_is_refused() {
    let refused = |link: &Link, play: &Play| match simulate(link, &plan_of(link, 10), play) {
        Err(SimulationError::Cycle(error)) => error,
        Err(other) => panic!("{other:?}"),
        Ok(_) => panic!("it is played"),
    };
    let one = torque(1, 0.1);
    let play = Play { cycle_turn_rad: Some(0.0), ..Play::of(&one) };
    let CycleError::Mean { mean_n_m } = refused(&with_friction(0.0), &play) else { panic!() };
    assert!((mean_n_m - 0.1).abs() < 1e-12);
    let large = Play { is_large: true, ..play };
    assert_eq!(refused(&with_friction(0.0), &large), CycleError::Free);
    // An upright link falls, and swings on for long where it hangs.
    let short =
        Torque::new(&times(0.05, 7), vec![0.0, 0.1, 0.2, 0.1, 0.0, -0.1, -0.2, -0.1]).unwrap();
    let falls = Play { cycle_turn_rad: Some(0.0), ..Play::of(&short) };
    let falling = refused(&under_gravity(1.5, 0.0), &falls);
    assert!(matches!(falling, CycleError::Unsettled { .. }), "{falling:?}");
    let time_s = times(STEP_S, SAMPLES - 1);
    let turning = HubReference::new(&time_s, time_s.clone(), None).unwrap();
    let feedback = Feedback::new(1.0, 0.0, turning).unwrap();
    let held = Play { feedback: std::slice::from_ref(&feedback), ..play };
    assert!(matches!(refused(&with_friction(0.1), &held), CycleError::Reference { .. }));
}
