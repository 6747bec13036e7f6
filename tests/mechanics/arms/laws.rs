//! Laws that hold for every arm: rotation, units, the rigid limit, energy, weights at rest, links that weigh nothing.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use flexlink::elastica::{ArmMotion, ArmPeriod, ElasticaError, Kept, SecondOrder, follow_arm};
use flexlink::link::{Damping, Hub, LinkParts, LumpedMass, Payload, Segment};

use num_complex::Complex64;

use super::{line, models, newton_euler, period, turning, two_links};
use crate::common::{apart, peak};
use crate::elastica::laws::{Energy, GRAVITY, loaded_arm};
use crate::elastica::{BEFORE_S, STEP_S, Turn, arm, chord, follow, model};

pub(super) const LEVELS: [SecondOrder; 3] =
    [SecondOrder::None, SecondOrder::First, SecondOrder::Full];

/// Last sample of a motion, with a second of rest.
fn last() -> usize {
    Turn::sample(2.2)
}

/// Four different links, of which the first has all that a link can carry but shear; others have a hub's radius and a mass.
fn links(count: usize) -> Vec<LinkParts> {
    let [upper, lower] = two_links();
    let payload = Payload { offset_m: 0.03, ..loaded_arm().payload };
    let inner = LinkParts { payload, ..loaded_arm() };
    let payload = Payload { offset_m: 0.04, ..upper.payload };
    let upper = LinkParts { hub: Hub { radius_m: 0.05, ..upper.hub }, payload, ..upper };
    let mass = LumpedMass { at_m: 0.2, mass_kg: 0.08, inertia_kg_m2: 2e-4 };
    let lower = LinkParts { masses: vec![mass], ..lower };
    let last = LinkParts {
        segments: vec![Segment::uniform(0.3, 8.0, 0.3)],
        payload: Payload { mass_kg: 0.1, inertia_kg_m2: 2e-4, offset_m: 0.04 },
        hub: Hub { inertia_kg_m2: 2e-3, radius_m: 0.0, viscous_friction_n_m_s_rad: 0.05 },
        ..lower.clone()
    };
    let mut links = vec![stiffer(inner, 10.0), stiffer(upper, 3.0), stiffer(lower, 2.0), last];
    links.truncate(count);
    links
}

pub(super) fn stiffer(mut parts: LinkParts, times: f64) -> LinkParts {
    for segment in &mut parts.segments {
        segment.bending_stiffness_n_m2.inner *= times;
        segment.bending_stiffness_n_m2.outer *= times;
    }
    parts
}

/// Turns of so many chords, each by another angle.
fn turns(count: usize) -> Vec<Turn> {
    [[-1.0, 0.9], [0.2, 0.6], [1.1, -0.5], [0.3, 0.8]][..count]
        .iter()
        .map(|[from, turn]| Turn { from_rad: *from, by_rad: *turn, duration_s: 1.2 })
        .collect()
}

fn kept(count: usize) -> Kept {
    if count > 1 { Kept::Tip } else { Kept::Angles }
}

fn solved(parts: &[LinkParts], arm: &ArmPeriod, second_order: SecondOrder) -> ArmMotion {
    follow_arm(&models(parts, 6), arm, second_order, 1e-11).expect("a motion")
}

/// Largest difference of torques, those of the second arm times a factor, each over the largest of the first.
fn differ(a: &ArmMotion, b: &ArmMotion, factor: f64) -> f64 {
    let links = a.links.iter().zip(&b.links).map(|(a, b)| {
        let (a, b) = (&a.bent.torque_n_m, &b.bent.torque_n_m);
        let range = peak(a);
        a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - factor * b).abs())) / range
    });
    links.fold(0.0, f64::max)
}

/// Largest difference of the torques of an arm in a plane that is turned, with gravity and all directions.
pub(super) fn apart_in_turned_plane(
    parts: &[LinkParts],
    turns: &[Turn],
    kept: Kept,
    (turned_rad, level): (f64, SecondOrder),
) -> f64 {
    let (sine, cosine) = turned_rad.sin_cos();
    let gravity = [-GRAVITY[1] * sine, GRAVITY[1] * cosine];
    let upright = solved(parts, &turning(turns, kept, GRAVITY), level);
    let slanted = |turn: &Turn| Turn { from_rad: turn.from_rad + turned_rad, ..*turn };
    let slanted: Vec<_> = turns.iter().map(slanted).collect();
    differ(&upright, &solved(parts, &turning(&slanted, kept, gravity), level), 1.0)
}

#[test]
fn a_turned_plane_takes_the_same_torques() {
    for count in 1..=4 {
        for level in LEVELS {
            let (parts, turns) = (links(count), turns(count));
            let off = apart_in_turned_plane(&parts, &turns, kept(count), (0.8, level));
            assert!(off < 1e-9, "{count} links, {level:?}: {off:e}");
        }
    }
}

/// Amplitude of a history at a bin.
fn amplitude(history: &[f64], bin: usize) -> Complex64 {
    let turn = TAU * bin as f64 / history.len() as f64;
    let wave = |k: usize| Complex64::from_polar(1.0, -turn * k as f64);
    let sum: Complex64 = history.iter().enumerate().map(|(k, value)| wave(k) * value).sum();
    sum / history.len() as f64
}

/// Without weight and second order, each frequency of the torque is the tip's acceleration times the straight link's
/// transfer, which another recursion finds from the hub's tangent line; friction is on the hub's rate.
#[test]
fn an_arm_of_one_link_that_hardly_bends_is_the_straight_link() {
    let turn = Turn { from_rad: -1.2, by_rad: 1.7, duration_s: 1.2 };
    let hub = Hub { radius_m: 0.05, viscous_friction_n_m_s_rad: 0.4, ..arm().hub };
    let plain = LinkParts { hub, ..arm() };
    let hysteretic =
        |parts: LinkParts| LinkParts { damping: Damping::Hysteretic { ratio: 0.05 }, ..parts };
    for parts in [plain.clone(), loaded_arm(), hysteretic(plain), hysteretic(loaded_arm())] {
        let (model, period) = (model(&parts, 6), chord(&turn, [0.0; 2]));
        let length_m = model.mesh().length_m();
        let moved = |part: usize| -> Vec<f64> {
            let until = Turn::sample(turn.duration_s + 1.5);
            (0..until).map(|k| turn.at(k as f64 * STEP_S - BEFORE_S)[part]).collect()
        };
        let [rate, turning] = [moved(1), moved(2)];
        let found = follow(&model, &period, SecondOrder::None, 1e-11).expect("a motion").torque_n_m;
        let spread = |history: &[f64]| {
            let mut all = history.to_vec();
            all.resize(found.len(), 0.0);
            all
        };
        let ([rate, turning], mut largest) = ([spread(&rate), spread(&turning)], 0.0_f64);
        let mut off = 0.0_f64;
        for bin in 1..80 {
            let omega = TAU * bin as f64 / (found.len() as f64 * STEP_S);
            let transfer = model.tip_transfer(omega);
            let [rate, turning] = [&rate, &turning].map(|history| amplitude(history, bin));
            let hub_rate = rate * length_m * transfer.angle_rad_m;
            let expected = transfer.inertia_kg_m * turning * length_m
                + hub_rate * parts.hub.viscous_friction_n_m_s_rad;
            largest = largest.max(expected.norm());
            off = off.max((amplitude(&found, bin) - expected).norm());
        }
        assert!(off < 1e-10 * largest, "{off:e} of {largest}");
    }
}

/// Largest difference of the torques of an arm 1e8 times as stiff from those of the rigid one, in N m.
pub(super) fn apart_from_rigid(
    parts: &[LinkParts],
    turns: &[Turn],
    kept: Kept,
    level: SecondOrder,
) -> f64 {
    let damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-9 };
    let stiff =
        |parts: &LinkParts| LinkParts { damping: damping.clone(), ..stiffer(parts.clone(), 1e8) };
    let parts: Vec<_> = parts.iter().map(stiff).collect();
    let found = solved(&parts, &turning(turns, kept, GRAVITY), level);
    let samples = (0..last()).step_by(7).flat_map(|k| {
        let expected =
            newton_euler::torques_n_m(&parts, turns, GRAVITY, k as f64 * STEP_S - BEFORE_S);
        let pairs = found.links.iter().zip(expected);
        pairs.map(move |(link, t)| (link.bent.torque_n_m[k] - t).abs()).collect::<Vec<_>>()
    });
    samples.fold(0.0, f64::max)
}

#[test]
fn an_arm_that_hardly_bends_takes_the_torques_of_the_rigid_one() {
    for count in 1..=4 {
        for level in LEVELS {
            let off = apart_from_rigid(&links(count), &turns(count), kept(count), level);
            assert!(off < 1e-6, "{count} links, {level:?}: {off:e} N m");
        }
    }
}

/// Largest difference of the torques of an arm without its last link from those with one that weighs nothing.
pub(super) fn apart_from_weightless(
    parts: &[LinkParts],
    turns: &[Turn],
    level: SecondOrder,
) -> f64 {
    let (last, inner) = parts.split_last().expect("links");
    let nothing = Payload { mass_kg: 0.0, inertia_kg_m2: 0.0, offset_m: 0.0 };
    let weightless = LinkParts {
        segments: vec![Segment::uniform(0.6, 15.0, 1e-11)],
        payload: nothing,
        hub: Hub::default(),
        masses: Vec::new(),
        ..last.clone()
    };
    let with: Vec<_> = inner.iter().cloned().chain([weightless]).collect();
    let with = solved(&with, &turning(turns, Kept::Angles, GRAVITY), level);
    let arm = turning(&turns[..inner.len()], Kept::Angles, GRAVITY);
    differ(&solved(inner, &arm, level), &with, 1.0)
}

#[test]
fn a_last_link_that_weighs_nothing_changes_nothing_inboard() {
    for level in LEVELS {
        let off = apart_from_weightless(&links(3), &turns(3), level);
        assert!(off < 1e-9, "{level:?}: {off:e}");
    }
}

/// Largest difference of the torques of an arm without weight from those of a softer one that is slower by a factor,
/// times its square.
pub(super) fn apart_where_slower(
    parts: &[LinkParts],
    (turns, kept): (&[Turn], Kept),
    (slower, level): (f64, SecondOrder),
) -> f64 {
    let soft = |parts: &LinkParts| {
        let mut parts = stiffer(parts.clone(), (slower * slower).recip());
        parts.hub.viscous_friction_n_m_s_rad /= slower;
        if let Damping::Rayleigh { beta_s, .. } = &mut parts.damping {
            *beta_s *= slower;
        }
        parts
    };
    let fast = solved(parts, &turning(turns, kept, [0.0; 2]), level);
    let parts: Vec<_> = parts.iter().map(soft).collect();
    let slow = solved(&parts, &slowed(turns, kept, [0.0; 2], slower), level);
    differ(&fast, &slow, slower * slower)
}

#[test]
fn slower_softer_arms_without_weight_take_less_torque() {
    for count in 1..=3 {
        for level in LEVELS {
            let turns = (&turns(count)[..], kept(count));
            let off = apart_where_slower(&links(count), turns, (3.0, level));
            assert!(off < 1e-9, "{count} links, {level:?}: {off:e}");
        }
    }
}

/// The same turns, all times that many times as long.
fn slowed(turns: &[Turn], kept: Kept, gravity: [f64; 2], slower: f64) -> ArmPeriod {
    let until = Turn::sample(turns[0].duration_s + BEFORE_S + 1.0);
    let chord = |turn: &Turn| {
        let at = |k: usize| turn.at(k as f64 * STEP_S - BEFORE_S);
        let part = |part: usize| {
            let scale = [1.0, slower.recip(), slower.powi(-2)][part];
            (0..=until).map(|k| scale * at(k)[part]).collect()
        };
        [0, 1, 2].map(part)
    };
    period(turns.iter().map(chord).collect(), kept, gravity, slower * STEP_S)
}

/// Potential and strain energy of links from one on, and the first moment of their masses about its joint along x over
/// gravity: what the weights turn it by.
fn energies(
    (parts, elements): (&[LinkParts], usize),
    found: &ArmMotion,
    sample: usize,
    from: usize,
) -> [f64; 3] {
    let models = models(parts, elements);
    let (mut joint, mut sums) = ([0.0; 2], [0.0; 3]);
    for (link, parts) in parts.iter().enumerate().skip(from) {
        let own = &found.links[link];
        let nodes_m = models[link].mesh().nodes_m();
        let energy = Energy { parts, nodes_m, found: &own.bent };
        let angle = own.chord[0][sample];
        let [potential, strain] = energy.at(sample, angle);
        let [turned, _] = energy.at(sample, angle + FRAC_PI_2);
        let weight = weight_n(parts);
        let added = [potential + weight * joint[1], strain, turned + weight * joint[0]];
        sums.iter_mut().zip(added).for_each(|(sum, part)| *sum += part);
        let chord_m = own.chord_length_m[sample];
        joint = [joint[0] + chord_m * angle.cos(), joint[1] + chord_m * angle.sin()];
    }
    sums
}

/// Largest difference of the torques of an arm at rest, before and after its motion, from the moments of the weights
/// outboard, and of the force on its first joint from the weight of all, over these.
pub(super) fn apart_from_weights(
    (parts, elements): (&[LinkParts], usize),
    turns: &[Turn],
    kept: Kept,
) -> [f64; 2] {
    let arm = turning(turns, kept, GRAVITY);
    let found = follow_arm(&models(parts, elements), &arm, SecondOrder::Full, 1e-11);
    let found = found.expect("a motion");
    let samples = [2, last()].into_iter();
    let off = samples.flat_map(|sample| {
        let moment = |joint| energies((parts, elements), &found, sample, joint)[2];
        let moments: Vec<f64> = (0..parts.len()).map(moment).collect();
        let most = peak(&moments);
        let pairs = found.links.iter().zip(moments);
        let off = pairs.map(move |(link, moment)| link.bent.torque_n_m[sample] - moment);
        off.map(move |off| off.abs() / most).collect::<Vec<_>>()
    });
    let off = off.fold(0.0, f64::max);
    let [along_x, along_y] = [0, 1].map(|axis| found.links[0].force_n[axis][2]);
    let weight: f64 = parts.iter().map(weight_n).sum();
    [off, (along_y - weight).hypot(along_x) / weight]
}

/// A mesh that is bent cannot turn rigidly, so that the balance holds to the mesh's error.
#[test]
fn at_rest_each_torque_holds_the_weights_outboard() {
    for count in 1..=4 {
        let parts = links(count);
        let off = |elements| apart_from_weights((&parts, elements), &turns(count), kept(count));
        let ([coarse, _], [fine, force]) = (off(6), off(12));
        assert!(
            fine < 1e-6 && fine < (0.15 * coarse).max(1e-9),
            "{count} links: {coarse:e}, {fine:e}"
        );
        assert!(force < 1e-9, "{count} links: {force:e} of the weight");
    }
}

fn weight_n(parts: &LinkParts) -> f64 {
    let mass_per_length = |segment: &Segment| segment.mass_per_length_kg_m.at(0.5);
    let beam: f64 = parts.segments.iter().map(|s| s.length_m * mass_per_length(s)).sum();
    let lumped: f64 = parts.masses.iter().map(|mass| mass.mass_kg).sum();
    -GRAVITY[1] * (beam + lumped + parts.payload.mass_kg)
}

/// Work of the torques, changes of potential and of strain energy, and what friction and damping take, in J.
pub(super) fn balance(
    (parts, elements): (&[LinkParts], usize),
    turns: &[Turn],
    kept: Kept,
) -> [f64; 5] {
    let models = models(parts, elements);
    let arm = turning(turns, kept, GRAVITY);
    let found = follow_arm(&models, &arm, SecondOrder::Full, 1e-11).expect("a motion");
    let hub = |joint: usize, k: usize| {
        let own = &found.links[joint];
        let before = joint.checked_sub(1).map_or(0.0, |before| {
            found.links[before].chord[0][k] + found.links[before].tip_slope_rad[k]
        });
        own.chord[0][k] + own.bent.hub_slope_rad[k] - before
    };
    let rate = |joint: usize, k: usize| {
        let at = |k: usize| hub(joint, k);
        (8.0 * (at(k + 1) - at(k - 1)) - (at(k + 2) - at(k - 2))) / (12.0 * STEP_S)
    };
    let [mut work, mut rubbed, mut damped] = [0.0; 3];
    for (joint, parts) in parts.iter().enumerate() {
        let friction = parts.hub.viscous_friction_n_m_s_rad;
        for k in 2..last() {
            let rate = rate(joint, k);
            work += found.links[joint].bent.torque_n_m[k] * rate * STEP_S;
            rubbed += friction * rate * rate * STEP_S;
        }
        let Damping::Rayleigh { beta_s, .. } = parts.damping else { unreachable!() };
        let nodes_m = models[joint].mesh().nodes_m();
        let energy = Energy { parts, nodes_m, found: &found.links[joint].bent };
        damped += energy.dissipated(beta_s, last());
    }
    let [[v0, u0, _], [v1, u1, _]] =
        [2, last()].map(|sample| energies((parts, elements), &found, sample, 0));
    [work, v1 - v0, u1 - u0, rubbed, damped]
}

#[test]
fn the_work_of_the_torques_is_the_change_of_energy_and_what_damping_takes() {
    let wider = vec![Turn { from_rad: -1.2, by_rad: 1.7, duration_s: 1.2 }];
    let soft = [arm(), loaded_arm()].map(|parts| (vec![parts], wider.clone(), 8));
    let several = (1..=4).map(|count| (links(count), turns(count), 6));
    for (links, turns, elements) in soft.into_iter().chain(several) {
        let count = links.len();
        let [work, raised, bent, rubbed, damped] = balance((&links, elements), &turns, kept(count));
        let off = (work - raised - bent - rubbed - damped) / work;
        assert!(off.abs() < 1e-6, "{count} links: {off:e} of {work} J");
        assert!(rubbed + damped > 1e-3 * work.abs());
        assert!(elements < 8 || damped > 1e-3 * work && bent.abs() > 1e-6 * work);
    }
}

/// A slow turn bends hysteretic links as it bends viscous ones: weight alone, which comes and goes with the directions, is
/// not damped. At rest before and after the motion the arm hangs as if it had no damping.
#[test]
fn hysteretic_damping_leaves_the_sag_alone() {
    let hysteretic =
        |parts: LinkParts| LinkParts { damping: Damping::Hysteretic { ratio: 0.05 }, ..parts };
    for count in 1..=3 {
        for level in LEVELS {
            let arm = slowed(&turns(count), kept(count), GRAVITY, 30.0);
            let viscous = solved(&links(count), &arm, level);
            let damped: Vec<_> = links(count).into_iter().map(hysteretic).collect();
            let found = solved(&damped, &arm, level);
            for (joint, (a, b)) in found.links.iter().zip(&viscous.links).enumerate() {
                let [a, b] = [a, b].map(|link| &link.bent.hub_slope_rad);
                let sag = peak(b);
                let off = apart(a, b);
                // Damped as a whole, the sag would be off by 7e-2.
                assert!(off < 2e-3 * sag, "joint {joint} of {count}, {level:?}: {:e}", off / sag);
                let at_rest = (a[2] - b[2]).abs() / sag;
                assert!(at_rest < 1e-5, "joint {joint} of {count}, {level:?}: {at_rest:e}");
            }
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let refusal = |parts: &[LinkParts], arm: &ArmPeriod| {
        follow_arm(&models(parts, 4), arm, SecondOrder::Full, 1e-9).unwrap_err().to_string()
    };
    let dragged = Damping::Rayleigh { alpha_per_s: 0.1, beta_s: 1e-4 };
    let dragged = two_links().map(|parts| LinkParts { damping: dragged.clone(), ..parts });
    assert!(refusal(&dragged, &line(GRAVITY)).ends_with("a link with alpha = 0"));
    let straight = vec![[vec![0.3; 8], vec![0.0; 8], vec![0.0; 8]]; 2];
    let stretched = ArmPeriod::new(0.01, straight, Kept::Tip, GRAVITY).unwrap_err();
    assert_eq!(stretched, ElasticaError::Elbow { sample: 0, sine: 0.0 });
    let one = vec![[vec![0.3; 8], vec![0.0; 8], vec![0.0; 8]]];
    assert!(ArmPeriod::new(0.01, one, Kept::Tip, GRAVITY).is_err());
    let folded = [0.1, PI - 0.01].map(|angle| [vec![angle; 8], vec![0.0; 8], vec![0.0; 8]]);
    assert!(ArmPeriod::new(0.01, folded.to_vec(), Kept::Angles, GRAVITY).is_ok());
}
