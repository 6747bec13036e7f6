//! The same laws for arms at random.

use flexlink::elastica::Kept;
use flexlink::link::{Damping, Hub, LinkParts, Payload, Segment, Taper};
use proptest::prelude::*;

use super::laws::{LEVELS, apart_from_rigid, apart_in_turned_plane, balance};
use crate::elastica::{Turn, arm};

/// Bending of the stiffest and of the softest link under twice the weight of all that it carries, over its length.
const SAG: [f64; 2] = [5e-4, 5e-3];

/// One link with a hub of up to half its own inertia and a payload; its stiffness is still to be found.
fn any_link() -> impl Strategy<Value = LinkParts> {
    let length = 0.25..0.8_f64;
    let masses = (0.1..0.8_f64, 0.3..1.0_f64, 0.0..0.4_f64);
    let hub = (0.02..0.5_f64, 0.0..0.1_f64, 0.0..0.3_f64);
    (length, masses, hub, 1e-4..1e-3_f64).prop_map(
        |(length_m, (mass, taper, payload), (inertia, radius_m, friction), beta_s)| LinkParts {
            segments: vec![Segment {
                mass_per_length_kg_m: Taper { inner: mass, outer: mass * taper },
                ..Segment::uniform(length_m, 1.0, mass)
            }],
            hub: Hub {
                inertia_kg_m2: inertia * mass * length_m.powi(3),
                radius_m,
                viscous_friction_n_m_s_rad: friction,
            },
            payload: Payload { mass_kg: payload, inertia_kg_m2: 1e-3 * payload, offset_m: 0.0 },
            damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s },
            ..arm()
        },
    )
}

/// An arm whose links sag by some thousandths of their lengths, and turns of its chords that keep the elbow bent.
fn any_arm() -> impl Strategy<Value = (Vec<LinkParts>, Vec<Turn>)> {
    let links = prop::collection::vec((any_link(), SAG[0]..SAG[1]), 1..=4);
    let elbow = (0.5..2.2_f64, 0.5..2.2_f64, any::<bool>());
    let outer = (-0.8..0.8_f64, -0.8..0.8_f64);
    (links, -1.5..1.5_f64, -1.0..1.0_f64, elbow, outer).prop_map(
        |(mut links, from_rad, by_rad, (bent_rad, bends_to_rad, is_left), (third, fourth))| {
            let mut outboard_kg = 0.0;
            for (link, sag) in links.iter_mut().rev() {
                let segment = &mut link.segments[0];
                let Taper { inner, outer } = segment.mass_per_length_kg_m;
                let length_m = segment.length_m;
                outboard_kg += 0.5 * (inner + outer) * length_m + link.payload.mass_kg;
                let stiffness = 20.0 * outboard_kg * length_m * length_m / (3.0 * *sag);
                segment.bending_stiffness_n_m2 = Taper { inner: stiffness, outer: 0.6 * stiffness };
            }
            let side = if is_left { 1.0 } else { -1.0 };
            let starts = [from_rad, from_rad + side * bent_rad, third, fourth];
            let ends = [by_rad, by_rad + side * (bends_to_rad - bent_rad), -third, 0.5 * third];
            let turns = starts.into_iter().zip(ends).take(links.len());
            let turns = turns.map(|(from_rad, by_rad)| Turn { from_rad, by_rad, duration_s: 1.2 });
            (links.iter().map(|(link, _)| link.clone()).collect(), turns.collect())
        },
    )
}

fn any_kept(links: usize, is_tip: bool) -> Kept {
    if is_tip && links > 1 { Kept::Tip } else { Kept::Angles }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 12,
        rng_seed: proptest::test_runner::RngSeed::Fixed(25),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_turned_plane_takes_the_same_torques(
        (parts, turns) in any_arm(),
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
        (parts, turns) in any_arm(),
        is_tip in any::<bool>(),
    ) {
        for level in LEVELS {
            let off = apart_from_rigid(&parts, &turns, any_kept(parts.len(), is_tip), level);
            prop_assert!(off < 1e-6, "{level:?}: {off:e} N m");
        }
    }

    #[test]
    fn the_work_of_the_torques_is_the_change_of_energy_and_what_damping_takes(
        (parts, turns) in any_arm(),
        is_tip in any::<bool>(),
    ) {
        let [work, stored, taken] = balance(&parts, &turns, any_kept(parts.len(), is_tip));
        let size = work.abs().max(stored.abs());
        let off = (work - stored - taken) / size;
        prop_assert!(off.abs() < 1e-5, "{off:e} of {size} J");
        prop_assert!(taken > 0.0);
    }
}
