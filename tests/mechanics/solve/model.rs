//! What the linear model leaves out, against a geometrically exact code and against all terms of second order.

use flexlink::elastica::SecondOrder;
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment};
use flexlink::motion::{Profile, TipMotion};
use flexlink::numeric::{largest, largest_difference};
use flexlink::response::{Play, Torque};

use super::{plan_of, uniform};
use crate::recordings::Random;

/// Elements of each mesh.
const ELEMENTS: usize = 10;

fn solved(link: &Link, motion: &TipMotion, analysis: &Analysis) -> Solution {
    invert(link, &plan_of(link, ELEMENTS), motion, analysis).unwrap()
}

fn warns(solution: &Solution) -> bool {
    solution.warnings.iter().any(|warning| warning.kind() == "inexact_model")
}

/// A link of 1 m, 0.5 kg/m on a hub of 0.02 kg m², and how far its tip moves in so many seconds.
struct Played {
    stiffness_n_m2: f64,
    payload_kg: f64,
    travel_m: f64,
    duration_s: f64,
    /// How far the tip strayed in Exudyn 1.9, 16 elements of absolute nodal coordinates, under the linear torque, over its
    /// travel.
    strays: f64,
    /// Largest claim, over what is true.
    most: f64,
}

const fn played(
    [stiffness_n_m2, payload_kg, travel_m, duration_s]: [f64; 4],
    strays: f64,
    most: f64,
) -> Played {
    Played { stiffness_n_m2, payload_kg, travel_m, duration_s, strays, most }
}

/// Small travels that bend the link far, one of a third of a turn, and several turns that bend it little.
const PLAYED: [Played; 7] = [
    played([0.2833, 0.5, 0.05, 1.0], 0.0112, 3.0),
    played([0.5247, 0.5, 0.1, 1.0], 0.0145, 3.0),
    played([0.015_465, 0.0, 0.1, 1.0], 0.0126, 3.0),
    played([3.0, 0.5, 0.6, 1.0], 0.0100, 3.0),
    played([30.0, 0.1, 20.0, 2.0], 0.0005, 5.0),
    played([30.0, 0.1, 40.0, 2.0], 0.0010, 5.0),
    played([30.0, 0.1, 60.0, 2.0], 0.0012, 5.0),
];

#[test]
fn the_tip_strays_as_far_as_in_a_geometrically_exact_code() {
    for case in PLAYED {
        let link = Link::new(LinkParts {
            segments: vec![Segment::uniform(1.0, case.stiffness_n_m2, 0.5)],
            hub: Hub { inertia_kg_m2: 0.02, ..Hub::default() },
            payload: Payload { mass_kg: case.payload_kg, ..Payload::default() },
            damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 5e-4 },
            ..uniform()
        });
        let motion = Profile::Septic.motion(case.travel_m, case.duration_s, 500).unwrap();
        let solution = solved(&link.unwrap(), &motion, &Analysis::default());
        let claimed = solution.tip_model_error.unwrap() / case.strays;
        let of = (case.stiffness_n_m2, case.travel_m);
        assert!(claimed > 0.9 && claimed < case.most, "{claimed} of {} at {of:?}", case.strays);
        assert_eq!(warns(&solution), case.strays >= 0.01, "{of:?}");
    }
}

/// Random links: short and long, on hubs of every size, some with a radius or a payload, turned by 9° to ten turns.
#[test]
fn the_claim_is_half_to_thirty_times_what_all_terms_change_of_the_torque() {
    let mut random = Random::of(49);
    let mut told = 0;
    for number in 0..40 {
        let mut between = |low: f64, high: f64| low * (high / low).powf(random.next());
        let (length_m, kg_m) = (between(0.2, 3.0), between(0.05, 2.0));
        let beam_kg = kg_m * length_m;
        let hub = beam_kg * length_m.powi(2) * between(3e-3, 3.0);
        let payload_kg = if number % 3 == 0 { beam_kg * between(0.03, 3.0) } else { 0.0 };
        let radius_m = if number % 4 == 0 { length_m * between(0.1, 3.0) } else { 0.0 };
        let duration_s = between(0.3, 2.0);
        let first_rad_s = between(0.5, 4.0) * std::f64::consts::TAU / duration_s;
        let stiffness = (first_rad_s / 3.5).powi(2) * (beam_kg + 4.0 * payload_kg);
        let link = Link::new(LinkParts {
            segments: vec![Segment::uniform(length_m, stiffness * length_m.powi(3), kg_m)],
            hub: Hub { inertia_kg_m2: hub, radius_m, ..Hub::default() },
            payload: Payload { mass_kg: payload_kg, ..Payload::default() },
            damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 0.02 / first_rad_s },
            ..uniform()
        })
        .unwrap();
        let travel_m = between(0.025, 10.0) * link.length_m();
        let motion = Profile::Septic.motion(travel_m, duration_s, 500).unwrap();
        let solution = solved(&link, &motion, &Analysis::default());
        let all = Analysis::default().with_second_order(SecondOrder::Full);
        let Ok(full) = invert(&link, &plan_of(&link, ELEMENTS), &motion, &all) else {
            assert!(warns(&solution), "case {number} is refused with all terms");
            continue;
        };
        // Over the times that both have.
        let first = solution.grid.first.max(full.grid.first);
        let from = |own: &Solution| usize::try_from(first - own.grid.first).unwrap();
        let [own, full] = [&solution, &full].map(|own| &own.hub().torque_n_m[from(own)..]);
        let len = own.len().min(full.len());
        let truth = largest_difference(&own[..len], &full[..len]) / largest(own);
        let claimed = solution.hub().errors.torque.model.unwrap();
        // Below that the tolerance of the window is as large.
        if truth > 1e-5 {
            let factor = claimed / truth;
            assert!((0.5..30.0).contains(&factor), "case {number}: {claimed} for {truth}");
            told += 1;
        }
        assert!(truth < 0.06 || warns(&solution), "case {number}: {truth}");
    }
    assert!(told > 20, "{told} cases only");
}

/// The torques played on the same link, with and without all terms.
#[test]
fn what_a_simulation_claims_is_half_to_thirty_times_what_all_terms_change() {
    let cases = [
        (0.2833, 0.05, 1.0, 0.02),
        (3.0, 0.6, 1.0, 0.02),
        (30.0, 20.0, 2.0, 0.02),
        (2.0, 0.3, 1.5, 0.2),
    ];
    for (stiffness, travel_m, duration_s, hub) in cases {
        let link = Link::new(LinkParts {
            segments: vec![Segment::uniform(1.0, stiffness, 0.5)],
            hub: Hub { inertia_kg_m2: hub, ..Hub::default() },
            damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 5e-3 },
            ..uniform()
        })
        .unwrap();
        let motion = Profile::Septic.motion(travel_m, duration_s, 200).unwrap();
        let solution = solved(&link, &motion, &Analysis::default());
        let time_s: Vec<f64> = (0..solution.grid.len).map(|k| solution.grid.time_s(k)).collect();
        let torque = Torque::new(&time_s, solution.hub().torque_n_m.clone()).unwrap();
        let play = |is_large| {
            let play = Play { is_large, ..Play::of(&torque) };
            crate::response::simulate(&link, &plan_of(&link, ELEMENTS), &play).unwrap()
        };
        let (linear, all) = (play(false), play(true));
        let [own, full] = [&linear, &all].map(|own| &own.tip[0].displacement_m);
        let strays = largest_difference(own, full) / largest(own);
        let [own, full] = [&linear, &all].map(|own| largest(&own.tip_deflection_m()));
        let bends = (full / own - 1.0).abs();
        let claimed = linear.modes().unwrap().model_error;
        let factors = [claimed.tip / strays, claimed.deflection / bends];
        let within = factors.iter().all(|factor| (0.5..30.0).contains(factor));
        assert!(within, "{factors:?} of {strays}, {bends} at EI = {stiffness}");
    }
}
