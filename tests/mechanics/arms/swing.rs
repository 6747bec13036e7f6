//! Arms that swing: what a cycle takes, steady turns, and what is told of an iteration.

use std::f64::consts::TAU;

use flexlink::elastica::{AngleHistories, ArmMotion, ArmPeriod, Kept, SecondOrder, follow_arm};
use flexlink::link::{Damping, Hub, LinkParts};

use super::laws::stiffer;
use super::{models, two_links};
use crate::common::{self, peak};
use crate::elastica::STEP_S;
use crate::elastica::laws::Energy;
use crate::recordings::ninth;

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

/// Torques of the joints at so many samples of a second in which two chords swing, in one wave or in several.
fn torques_of_a_second(len: usize, has_several: bool, second_order: SecondOrder) -> [Vec<f64>; 2] {
    let chord = |middle_rad: f64, by_rad: f64| -> AngleHistories {
        let waves = if has_several { 5 } else { 1 };
        let at = |k: usize| {
            let sum = |derived: fn(f64, f64) -> f64| -> f64 {
                // The odd terms of a triangle's series.
                let terms = (0..waves).map(|term| {
                    let n = f64::from(2 * term + 1);
                    derived(TAU * n, TAU * n * k as f64 / len as f64) / n.powi(4)
                });
                by_rad * terms.sum::<f64>()
            };
            [
                middle_rad + sum(|_, at| at.cos()),
                sum(|omega, at| -omega * at.sin()),
                sum(|omega, at| -omega * omega * at.cos()),
            ]
        };
        [0, 1, 2].map(|part| (0..len).map(|k| at(k)[part]).collect())
    };
    let chords = vec![chord(-0.4, 0.3), chord(0.8, -0.2)];
    let arm = ArmPeriod::new(1.0 / len as f64, chords, Kept::Tip, [0.0, -9.81]).expect("a period");
    let found = follow_arm(&models(&two_links(), 6), &arm, second_order, 1e-10).expect("a motion");
    [0, 1].map(|joint: usize| found.links[joint].bent.torque_n_m.clone())
}

/// A length that is twice a prime number has no samples to leave out.
#[test]
fn a_motion_takes_the_same_torques_however_few_samples_tell_it() {
    let amplitudes = |torque_n_m: &[f64]| -> Vec<[f64; 2]> {
        let turn = |k: usize, n: usize| TAU * (k * n % torque_n_m.len()) as f64;
        let at = |k: usize, n: usize| turn(k, n) / torque_n_m.len() as f64;
        let sum = |n: usize, of: fn(f64) -> f64| -> f64 {
            let own = torque_n_m.iter().enumerate().map(|(k, torque)| torque * of(at(k, n)));
            own.sum::<f64>() / torque_n_m.len() as f64
        };
        (0..12).map(|n| [sum(n, f64::cos), sum(n, f64::sin)]).collect()
    };
    for second_order in [SecondOrder::None, SecondOrder::Full] {
        for has_several in [false, true] {
            let few = torques_of_a_second(1024, has_several, second_order);
            let all = torques_of_a_second(2 * 509, has_several, second_order);
            for (few, all) in few.iter().zip(&all) {
                let [low, high] = [f64::min, f64::max].map(|of| few.iter().copied().reduce(of));
                let range = high.unwrap() - low.unwrap();
                let (few, all) = (amplitudes(few), amplitudes(all));
                for (n, (few, all)) in few.iter().zip(&all).enumerate() {
                    for (few, all) in few.iter().zip(all) {
                        let off = (few - all).abs() / range;
                        assert!(off < 1e-10, "{second_order:?}, {has_several}, {n}: {off:.1e}");
                    }
                }
            }
        }
    }
}

/// Holds forces on the inner ends of two links that hardly bend, and the torque of the second one, against those of rigid
/// links, in the horizontal plane, over a second in which the chords move as given: angle, rate, acceleration.
fn assert_rigid(motion: [&dyn Fn(f64) -> [f64; 3]; 2], len: usize) {
    let parts = two_links().map(|own| stiffer(own, 1e6));
    let models = models(&parts, 4);
    let chord = |of: &dyn Fn(f64) -> [f64; 3]| -> AngleHistories {
        let at: Vec<[f64; 3]> = (0..len).map(|k| of(k as f64 / len as f64)).collect();
        [0, 1, 2].map(|part| at.iter().map(|own| own[part]).collect())
    };
    let chords = vec![chord(motion[0]), chord(motion[1])];
    let arm = ArmPeriod::new(1.0 / len as f64, chords, Kept::Angles, [0.0; 2]).expect("a period");
    let found = follow_arm(&models, &arm, SecondOrder::None, 1e-9).expect("a motion");
    let link = |number: usize| models[number].link();
    let [mut worst, mut largest] = [[0.0_f64; 3]; 2];
    for k in 0..len {
        let now = motion.map(|of| of(k as f64 / len as f64));
        // Of a length along the chord: ℓ θ̈ n − ℓ θ̇² e.
        let turned = |number: usize| {
            let [angle, rate, turning] = now[number];
            let (sine, cosine) = angle.sin_cos();
            [
                -turning * sine - rate * rate * cosine,
                turning * cosine - rate * rate * sine,
                -sine,
                cosine,
            ]
        };
        let (first, second) = (turned(0), turned(1));
        let elbow = [0, 1].map(|axis: usize| link(0).length_m() * first[axis]);
        let own = |axis: usize| {
            link(1).mass_kg() * elbow[axis] + link(1).mass_moment_kg_m() * second[axis]
        };
        let on_second = [own(0), own(1)];
        let both = |axis: usize| on_second[axis] + link(0).mass_moment_kg_m() * first[axis];
        let across = elbow[0] * second[2] + elbow[1] * second[3];
        let inertia = link(1).rigid_inertia_kg_m2();
        let torque_n_m = inertia * now[1][2] + link(1).mass_moment_kg_m() * across;
        let forces = [[both(0), both(1)], on_second];
        for (number, expected) in forces.iter().enumerate() {
            for axis in [0, 1] {
                let off = found.links[number].force_n[axis][k] - expected[axis];
                worst[number] = worst[number].max(off.abs());
                largest[number] = largest[number].max(expected[axis].abs());
            }
        }
        worst[2] = worst[2].max((found.links[1].bent.torque_n_m[k] - torque_n_m).abs());
        largest[2] = largest[2].max(torque_n_m.abs());
    }
    for (worst, largest) in worst.iter().zip(largest) {
        assert!(worst / largest < 1e-4, "{worst:e} of {largest:e}");
    }
}

/// Chords that turn together turn forces faster than anything else changes.
#[test]
fn forces_of_chords_that_turn_far_together_are_those_of_rigid_links() {
    let turned = |by_rad: f64, from_rad: f64| {
        move |t: f64| {
            // A step of ninth order between 0.2 and 0.8 s, by whole turns.
            let [step, rate, turning] = ninth((t - 0.2) / 0.6);
            [from_rad + by_rad * step, by_rad * rate / 0.6, by_rad * turning / 0.36]
        }
    };
    let together = 8.0 * TAU;
    assert_rigid([&turned(together, 0.1), &turned(together, 1.4)], 1024);
}

/// Steady turns have neither angular accelerations nor others that change along the first link.
#[test]
fn torques_of_steady_turns_at_different_rates_are_those_of_rigid_links() {
    let steady = |turns: f64| move |t: f64| [TAU * turns * t, TAU * turns, 0.0];
    assert_rigid([&steady(3.0), &steady(10.0)], 1024);
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
        common::apart(&a, &b) / (high - low)
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
                let size = peak(&found.links[0].force_n[0]);
                assert!(torque.iter().all(|t| t.abs() < 1e-5 * size), "{level:?}: {torque:?}");
            }
        }
    }
}
