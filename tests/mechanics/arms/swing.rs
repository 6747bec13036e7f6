//! Arms that swing: what a cycle takes, steady turns, and what is told of an iteration.

use std::f64::consts::TAU;

use flexlink::elastica::{AngleHistories, ArmMotion, ArmPeriod, Kept, SecondOrder, follow_arm};
use flexlink::link::{Damping, Hub, LinkParts};

use super::laws::stiffer;
use super::{models, two_links};
use crate::elastica::STEP_S;
use crate::elastica::laws::Energy;

/// Samples of a cycle of half a second.
const CYCLE: usize = 512;

/// Two chords that swing by this angle around an elbow of 1.2 rad, three times.
fn swing(by_rad: f64, kept: Kept, gravity: [f64; 2]) -> ArmPeriod {
    let omega = TAU / (CYCLE as f64 * STEP_S);
    let chord = |middle_rad: f64, by_rad: f64| -> AngleHistories {
        let at = |k: usize| {
            let (sine, cosine) = (omega * k as f64 * STEP_S).sin_cos();
            [middle_rad + by_rad * sine, by_rad * omega * cosine, -by_rad * omega * omega * sine]
        };
        [0, 1, 2].map(|part| (0..3 * CYCLE).map(|k| at(k)[part]).collect())
    };
    let chords = vec![chord(-0.4, by_rad), chord(0.8, -0.7 * by_rad)];
    ArmPeriod::new(STEP_S, chords, kept, gravity).expect("a period")
}

/// Work of the torques over a cycle, and what damping takes, in J.
fn over_cycle(parts: &[LinkParts], elements: usize, found: &ArmMotion) -> [f64; 2] {
    let models = models(parts, elements);
    let hub = |joint: usize, k: usize| {
        let own = &found.links[joint];
        let before = match joint {
            0 => 0.0,
            _ => found.links[0].chord[0][k] + found.links[0].tip_slope_rad[k],
        };
        own.chord[0][k] + own.bent.hub_slope_rad[k] - before
    };
    let mut sums = [0.0; 2];
    for (joint, parts) in parts.iter().enumerate() {
        for k in CYCLE + 2..2 * CYCLE + 2 {
            let at = |k: usize| hub(joint, k);
            let rate = (8.0 * (at(k + 1) - at(k - 1)) - (at(k + 2) - at(k - 2))) / (12.0 * STEP_S);
            sums[0] += found.links[joint].bent.torque_n_m[k] * rate * STEP_S;
        }
        let Damping::Rayleigh { beta_s, .. } = parts.damping else { unreachable!() };
        let (nodes_m, bent) = (models[joint].mesh().nodes_m(), &found.links[joint].bent);
        let energy = Energy { parts, nodes_m, found: bent };
        let until = |last: usize| energy.dissipated(beta_s, last);
        sums[1] += until(2 * CYCLE + 2) - until(CYCLE + 2);
    }
    sums
}

/// What links shorten by swings twice as fast as they do, and is no part of the linear torques.
#[test]
fn a_cycle_takes_what_damping_takes() {
    let parts = two_links().map(|parts| LinkParts {
        damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2e-3 },
        ..parts
    });
    for kept in [Kept::Tip, Kept::Angles] {
        let found =
            follow_arm(&models(&parts, 8), &swing(0.3, kept, [0.0; 2]), SecondOrder::Full, 1e-9);
        let found = found.expect("a motion");
        let [work, taken] = over_cycle(&parts, 8, &found);
        assert!(found.iteration.error < 1e-5, "{:e}", found.iteration.error);
        let off = (work / taken - 1.0).abs();
        assert!(off < 1e-6, "{off:e} of {taken} J");
    }
}

/// Largest difference of torques, each over the range of the second.
fn apart(a: &ArmMotion, b: &ArmMotion) -> f64 {
    let of = |motion: &ArmMotion, joint: usize| motion.links[joint].bent.torque_n_m.clone();
    let joints = (0..b.links.len()).map(|joint| {
        let (a, b) = (of(a, joint), of(b, joint));
        let [low, high] = b.iter().fold([f64::MAX, f64::MIN], |[l, h], t| [l.min(*t), h.max(*t)]);
        let off = a.iter().zip(&b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        off / (high - low)
    });
    joints.fold(0.0, f64::max)
}

#[test]
fn what_an_iteration_leaves_is_told() {
    for (softness, gravity) in [(1.0, [0.0; 2]), (0.7, [0.0, -9.81]), (0.5, [0.0, -9.81])] {
        let models = models(&two_links().map(|parts| stiffer(parts, softness)), 6);
        for kept in [Kept::Tip, Kept::Angles] {
            let arm = swing(0.12, kept, gravity);
            let solved = |tolerance: f64| {
                follow_arm(&models, &arm, SecondOrder::Full, tolerance).expect("a motion")
            };
            let best = solved(1e-11);
            for tolerance in [1e-2, 1e-3, 1e-4, 1e-6] {
                let found = solved(tolerance);
                let (off, told) = (apart(&found, &best), found.iteration.error);
                assert!(
                    off <= 1.1 * told + best.iteration.error,
                    "{off:e}, told {told:e}: {softness}, {kept:?}, {tolerance:e}"
                );
            }
        }
    }
}

#[test]
fn friction_of_joints_is_no_change_of_the_second_order() {
    let with = |friction: f64| {
        let parts = two_links().map(|parts| LinkParts {
            hub: Hub { viscous_friction_n_m_s_rad: friction, ..parts.hub },
            ..parts
        });
        let arm = swing(0.1, Kept::Tip, [0.0, -9.81]);
        follow_arm(&models(&parts, 6), &arm, SecondOrder::Full, 1e-9).expect("a motion")
    };
    let (without, rubbed) = (with(0.0), with(5.0));
    let off = rubbed.iteration.second_order_change / without.iteration.second_order_change - 1.0;
    assert!(off.abs() < 1e-9, "{off:e}");
    // Friction acts on the rate of each joint, and on nothing else.
    let torque = |motion: &ArmMotion, k: usize| motion.links[1].bent.torque_n_m[k];
    let angle = |k: usize| {
        let [inner, outer] = [0, 1].map(|link| &without.links[link]);
        outer.chord[0][k] + outer.bent.hub_slope_rad[k] - inner.chord[0][k] - inner.tip_slope_rad[k]
    };
    for k in 2..CYCLE {
        let rate =
            (8.0 * (angle(k + 1) - angle(k - 1)) - (angle(k + 2) - angle(k - 2))) / (12.0 * STEP_S);
        let rubbed = torque(&rubbed, k) - torque(&without, k);
        assert!((rubbed - 5.0 * rate).abs() < 1e-6 * 5.0, "{rubbed} N m at {rate} rad/s");
    }
}

/// Two links that turn together at one rate: nothing moves against the chords, so that all but one frequency are round-off.
#[test]
fn a_steady_turn_is_solved() {
    let rate = 3.0;
    let steady = |from_rad: f64| -> AngleHistories {
        let angle = |k: usize| from_rad + rate * k as f64 * STEP_S;
        [(0..256).map(angle).collect(), vec![rate; 256], vec![0.0; 256]]
    };
    for elbow_rad in [0.4, 1.0, 1.57, 2.5] {
        for kept in [Kept::Tip, Kept::Angles] {
            let chords = vec![steady(0.2), steady(0.2 + elbow_rad)];
            let arm = ArmPeriod::new(STEP_S, chords, kept, [0.0; 2]).expect("a period");
            for level in [SecondOrder::None, SecondOrder::First, SecondOrder::Full] {
                let found = follow_arm(&models(&two_links(), 6), &arm, level, 1e-10);
                let found = found
                    .unwrap_or_else(|error| panic!("{elbow_rad}, {kept:?}, {level:?}: {error}"));
                // What turns steadily takes no torque at the first joint, which holds the whole.
                let torque = &found.links[0].bent.torque_n_m;
                let size = found.links[0].force_n[0].iter().fold(0.0, |m: f64, f| m.max(f.abs()));
                assert!(torque.iter().all(|t| t.abs() < 1e-5 * size), "{level:?}: {torque:?}");
            }
        }
    }
}
