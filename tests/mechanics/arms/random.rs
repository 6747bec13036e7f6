//! The same laws for arms at random.

use flexlink::elastica::Kept;
use flexlink::link::{Damping, Hub, LinkParts, LumpedMass, Payload, Segment, Taper};
use flexlink::spec::read_specification;
use proptest::prelude::*;

use super::laws::{
    LEVELS, apart_from_rigid, apart_from_weightless, apart_from_weights, apart_in_turned_plane,
    apart_where_slower, balance,
};
use crate::elastica::{Turn, arm};

/// Bending of the stiffest and of the softest link under twice the weight of all that it carries, over its length.
const SAG: [f64; 2] = [5e-4, 5e-3];

/// One link of a segment or two that taper, with a hub of up to half its own inertia, a mass on it, and a payload beyond
/// its tip; its stiffness is still to be found.
fn any_link() -> impl Strategy<Value = LinkParts> {
    let lengths = (0.25..0.8_f64, prop_oneof![Just(1.0), 0.3..0.7_f64]);
    let masses = (0.1..0.8_f64, 0.3..1.0_f64, 0.0..0.4_f64, 0.0..0.2_f64);
    let hub = (0.02..0.5_f64, 0.0..0.1_f64, 0.0..0.3_f64);
    let places = (0.1..0.9_f64, 0.0..0.05_f64);
    (lengths, masses, hub, places, 1e-4..1e-3_f64).prop_map(
        |(lengths, masses, hub, places, beta_s)| {
            let ((length_m, split), (mass, taper, payload, lumped)) = (lengths, masses);
            let ((inertia, radius_m, friction), (at, offset_m)) = (hub, places);
            let ends = Taper { inner: mass, outer: mass * taper };
            let piece = |from: f64, to: f64| Segment {
                mass_per_length_kg_m: Taper { inner: ends.at(from), outer: ends.at(to) },
                ..Segment::uniform((to - from) * length_m, 1.0, mass)
            };
            let mut segments = vec![piece(0.0, split)];
            if split < 1.0 {
                segments.push(piece(split, 1.0));
            }
            let at_m = radius_m + at * length_m;
            LinkParts {
                segments,
                hub: Hub {
                    inertia_kg_m2: inertia * mass * length_m.powi(3),
                    radius_m,
                    viscous_friction_n_m_s_rad: friction,
                },
                masses: vec![LumpedMass { at_m, mass_kg: lumped, inertia_kg_m2: 1e-3 * lumped }],
                payload: Payload { mass_kg: payload, inertia_kg_m2: 1e-3 * payload, offset_m },
                damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s },
                ..arm()
            }
        },
    )
}

/// Links so stiff that each sags by a share of its length under twice the weight of what it carries; each piece of one is
/// softer outward, and the second by a step.
fn stiffened(links: Vec<(LinkParts, f64)>) -> Vec<LinkParts> {
    let (mut outboard_kg, mut found) = (0.0, Vec::new());
    for (mut link, sag) in links.into_iter().rev() {
        let beam = link.segments.iter().map(|own| own.length_m * own.mass_per_length_kg_m.at(0.5));
        outboard_kg += beam.sum::<f64>() + link.payload.mass_kg + link.masses[0].mass_kg;
        let length_m: f64 = link.segments.iter().map(|own| own.length_m).sum();
        let mut stiffness = 20.0 * outboard_kg * length_m * length_m / (3.0 * sag);
        for segment in &mut link.segments {
            segment.bending_stiffness_n_m2 = Taper { inner: stiffness, outer: 0.6 * stiffness };
            stiffness *= 0.5;
        }
        found.insert(0, link);
    }
    found
}

/// An arm whose links sag by some thousandths of their lengths, and turns of its chords that keep the elbow bent.
fn any_arm(least: usize) -> impl Strategy<Value = (Vec<LinkParts>, Vec<Turn>)> {
    let links = prop::collection::vec((any_link(), SAG[0]..SAG[1]), least..=4);
    let elbow = (0.5..2.2_f64, 0.5..2.2_f64, any::<bool>());
    let outer = (-0.8..0.8_f64, -0.8..0.8_f64);
    (links, -1.5..1.5_f64, -1.0..1.0_f64, elbow, outer).prop_map(
        |(links, from_rad, by_rad, (bent_rad, bends_to_rad, is_left), (third, fourth))| {
            let side = if is_left { 1.0 } else { -1.0 };
            let starts = [from_rad, from_rad + side * bent_rad, third, fourth];
            let ends = [by_rad, by_rad + side * (bends_to_rad - bent_rad), -third, 0.5 * third];
            let turns = starts.into_iter().zip(ends).take(links.len());
            let turns = turns.map(|(from_rad, by_rad)| Turn { from_rad, by_rad, duration_s: 1.2 });
            (stiffened(links), turns.collect())
        },
    )
}

fn any_kept(links: usize, is_tip: bool) -> Kept {
    if is_tip && links > 1 { Kept::Tip } else { Kept::Angles }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 6,
        rng_seed: proptest::test_runner::RngSeed::Fixed(25),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_turned_plane_takes_the_same_torques(
        (parts, turns) in any_arm(1),
        is_tip in any::<bool>(),
        turned_rad in -3.0..3.0_f64,
    ) {
        for level in LEVELS {
            let kept = any_kept(parts.len(), is_tip);
            let off = apart_in_turned_plane(&parts, &turns, kept, (turned_rad, level));
            prop_assert!(off < 1e-8, "{level:?}: {off:e}");
        }
    }

    #[test]
    fn an_arm_that_hardly_bends_takes_the_torques_of_the_rigid_one(
        (parts, turns) in any_arm(1),
        is_tip in any::<bool>(),
    ) {
        for level in LEVELS {
            let off = apart_from_rigid(&parts, &turns, any_kept(parts.len(), is_tip), level);
            prop_assert!(off < 1e-6, "{level:?}: {off:e} N m");
        }
    }

    #[test]
    fn the_work_of_the_torques_is_the_change_of_energy_and_what_damping_takes(
        (parts, turns) in any_arm(1),
        is_tip in any::<bool>(),
    ) {
        let [work, raised, bent, rubbed, damped] = balance((&parts, 6), &turns, any_kept(parts.len(), is_tip));
        let (stored, taken) = (raised + bent, rubbed + damped);
        let size = work.abs().max(stored.abs());
        let off = (work - stored - taken) / size;
        prop_assert!(off.abs() < 1e-5, "{off:e} of {size} J");
        prop_assert!(taken > 0.0);
    }

    #[test]
    fn a_last_link_that_weighs_nothing_changes_nothing_inboard((parts, turns) in any_arm(2)) {
        for level in LEVELS {
            let off = apart_from_weightless(&parts, &turns, level);
            prop_assert!(off < 1e-8, "{level:?}: {off:e}");
        }
    }

    #[test]
    fn at_rest_each_torque_holds_the_weights_outboard(
        (parts, turns) in any_arm(1),
        is_tip in any::<bool>(),
    ) {
        let kept = any_kept(parts.len(), is_tip);
        let [coarse, fine] =
            [6, 12].map(|elements| apart_from_weights((&parts, elements), &turns, kept));
        prop_assert!(fine[0] < 1e-7 && fine[0] < (0.2 * coarse[0]).max(1e-9), "{coarse:?} {fine:?}");
        prop_assert!(fine[1] < 1e-9, "{:e} of the weight", fine[1]);
    }

    #[test]
    fn slower_softer_arms_without_weight_take_less_torque(
        (parts, turns) in any_arm(1),
        is_tip in any::<bool>(),
        slower in 1.5..4.0_f64,
    ) {
        for level in LEVELS {
            let kept = any_kept(parts.len(), is_tip);
            let off = apart_where_slower(&parts, (&turns, kept), (slower, level));
            prop_assert!(off < 1e-8, "{level:?}: {off:e}");
        }
    }

    /// One link in either form of the file is the same link, mesh and analysis: what they lead to has the same bytes.
    #[test]
    fn an_arm_file_of_one_link_is_the_link_file(
        numbers in prop::array::uniform6(0.01..1.0_f64),
        elements in 2..20_usize,
        has_weight in any::<bool>(),
    ) {
        let [length, stiffness, mass, inertia, payload, ratio] = numbers;
        let own = format!(
            "segments = [{{ length = {length}, EI = {stiffness}, mass_per_length = {mass} }}]\n\
             hub = {{ inertia = {inertia} }}\npayload = {{ mass = {payload} }}\n\
             damping = {{ model = 'hysteretic', ratio = {} }}\n",
            0.9 * ratio
        );
        let gravity = if has_weight { "gravity = [1.0, -9.0]\n" } else { "" };
        let once = format!("title = 'one'\n{gravity}");
        let mesh = format!("mesh.elements = {elements}\n");
        let read = |text: &str| read_specification("link.toml", text, &[]).expect("a link");
        let arm = read(&format!("{once}{mesh}[[links]]\nname = 'only'\n{own}"));
        prop_assert_eq!(read(&format!("{once}{own}{mesh}")), arm);
    }
}
