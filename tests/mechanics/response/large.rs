//! Links with weight and at large angles, played: against the linear link, a rigid pendulum, the conservation of
//! energy, the elastica at rest, and the inversion, which shares no equation with the play.

use std::f64::consts::{FRAC_PI_2, PI};

use flexlink::elastica::SecondOrder;
use flexlink::inverse::{Analysis, invert};
use flexlink::link::{Damping, Gravity, Hub, Link, LinkParts, Payload, Segment};
use flexlink::motion::TipMotion;
use flexlink::response::{
    Feedback, HubReference, Interpolation, Play, PlayError, Played, SimulationError,
    SimulationWarning, Torque,
};

use super::{bayo, difference, loaded, peak, plan_of, simulate, smooth, times, torque, torque_of};
use crate::common::displaced;
use crate::elastica::statics::elastica;
use crate::recordings::min_jerk;

const G: f64 = 9.81;

const BETA: Damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 };

/// A link with all that it can have, hanging or standing.
fn weighted(start_angle_rad: f64, damping: Damping) -> Link {
    let gravity = Gravity { acceleration_m_s2: [0.0, -G], start_angle_rad: Some(start_angle_rad) };
    let mut parts = LinkParts::from(loaded(damping));
    // Bayo's link would hang down from its hub.
    parts.segments.iter_mut().for_each(|segment| {
        segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(10.0);
    });
    Link::new(LinkParts { gravity: Some(gravity), ..parts }).unwrap()
}

/// A torque that rises and falls once, then nothing.
fn pulse(torque_n_m: f64) -> Torque {
    torque(0.004, 400, |t| if t < 0.8 { torque_n_m * (PI * t / 0.8).sin().powi(4) } else { 0.0 })
}

fn large(link: &Link, play: &Play) -> Played {
    simulate(link, &plan_of(link, 20), &Play { is_large: true, ..*play }).unwrap()
}

/// The link whose motion is small moves as the linear one; what they differ by is of third order.
#[test]
fn a_small_motion_is_that_of_the_linear_link() {
    let hysteretic = Damping::Hysteretic { ratio: 0.02 };
    for damping in [BETA, hysteretic] {
        let link = loaded(damping.clone());
        let apart = [1.0, 0.5].map(|share| {
            let torque = pulse(0.1 * share);
            let play = Play::of(&torque);
            let (linear, found) =
                (simulate(&link, &plan_of(&link, 60), &play).unwrap(), large(&link, &play));
            // The node that carries the mass, on either mesh.
            let every = std::num::NonZeroUsize::new(3).unwrap();
            let node = |of: &Played| {
                of.mesh().nodes_m().iter().position(|x| (x - 0.8).abs() < 1e-9).unwrap()
            };
            let [own, other] = [&found, &linear]
                .map(|of| of.displacements_m(&[node(of)], every).unwrap().samples.swap_remove(0));
            let error = difference(&own, &other);
            assert!(error < 1e-3 * share * share, "{}: node {error:e}", damping.name());
            difference(&found.tip[0].displacement_m, &linear.tip[0].displacement_m)
        });
        assert!(apart[0] < 1e-3 && apart[0] > 1e-6, "{}: {apart:?}", damping.name());
        let ratio = apart[0] / apart[1];
        assert!((ratio - 4.0).abs() < 0.4, "{}: {apart:?}, ratio {ratio}", damping.name());
    }
}

#[test]
fn a_hub_that_moves_a_little_bends_the_link_as_the_linear_one() {
    let link = loaded(Damping::Hysteretic { ratio: 0.02 });
    let time_s = times(0.004, 300);
    let turned = |t: &f64| 0.002 * (1.0 - (PI * t.min(0.8) / 0.8).cos()).powi(3);
    let hub = HubReference::new(&time_s, time_s.iter().map(turned).collect(), None).unwrap();
    let play = Play::turning(&hub);
    let (linear, found) =
        (simulate(&link, &plan_of(&link, 60), &play).unwrap(), large(&link, &play));
    for (name, own, other) in [
        ("tip", &found.tip[0].displacement_m, &linear.tip[0].displacement_m),
        ("acceleration", &found.tip[0].acceleration_m_s2, &linear.tip[0].acceleration_m_s2),
        ("torque", &found.hub().torque_n_m, &linear.hub().torque_n_m),
        ("hub", &found.hub().angle_rad, &linear.hub().angle_rad),
    ] {
        let error = difference(own, other);
        assert!(error < 1e-3, "{name}: {error:e}");
    }
}

/// A stiff link under its weight alone is a pendulum: `I θ̈ = −S g cos θ`, here by Runge and Kutta's rule.
#[test]
fn a_stiff_link_falls_as_a_pendulum() {
    let mut parts = LinkParts::from(weighted(0.3, BETA));
    parts.segments.iter_mut().for_each(|segment| {
        segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(1e6);
    });
    parts.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-6 };
    parts.hub.viscous_friction_n_m_s_rad = 0.0;
    let link = Link::new(parts).unwrap();
    let time_s = times(0.004, 400);
    let torque = Torque::new(&time_s, vec![0.0; time_s.len()]).unwrap();
    let found = large(&link, &Play::of(&torque));
    let (inertia, moment) = (link.rigid_inertia_kg_m2(), link.mass_moment_kg_m());
    let rate = |[angle, rate]: [f64; 2]| [rate, -moment * G * angle.cos() / inertia];
    let (mut y, h) = ([0.3, 0.0], 0.001);
    for (sample, own) in found.hub().angle_rad.iter().enumerate() {
        // Strain of 1e-6 of the first link's moves it by as much.
        assert!((own - y[0]).abs() < 1e-5, "{sample}: {own} is not {}", y[0]);
        for _ in 0..4 {
            let moved = |d: [f64; 2], by: f64| [y[0] + by * d[0], y[1] + by * d[1]];
            let a = rate(y);
            let b = rate(moved(a, 0.5 * h));
            let c = rate(moved(b, 0.5 * h));
            let d = rate(moved(c, h));
            y = [0, 1].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
    }
    assert!(found.hub().angle_rad.iter().any(|angle| *angle < -3.0), "it swings to the other side");
}

/// Undamped, a soft link that falls keeps its energy; damped, it loses what damping and friction take.
#[test]
fn energy_is_kept_or_accounted_for() {
    for (damping, friction) in [(Damping::None, 0.0), (BETA, 0.05)] {
        let mut parts = LinkParts::from(weighted(0.5, damping));
        parts.hub.viscous_friction_n_m_s_rad = friction;
        let link = Link::new(parts).unwrap();
        let rest = torque(0.002, 600, |_| 0.0);
        let holding_n_m = large(&link, &Play::of(&rest)).hub().holding_n_m.expect("it has weight");
        // The motor lets go of it smoothly.
        let held = |t: f64| holding_n_m * (PI * t.min(0.6) / 1.2).cos().powi(4);
        let torque = torque(0.002, 600, held);
        let found = large(&link, &Play::of(&torque));
        let account = found.energy(40);
        let most = account.balances.iter().map(|own| own.kinetic_j).fold(0.0, f64::max);
        assert!(most > 1.0, "{most} J");
        for own in &account.balances {
            let missing = own.work_j - own.kinetic_j - own.strain_j - own.dissipated_j;
            let error = missing.abs() / most;
            assert!(error < 1e-8, "{} s: {error:e}, friction {friction}", own.time_s);
        }
        let lost = account.balances.last().unwrap().dissipated_j;
        assert!(if friction > 0.0 { lost > 1e-2 * most } else { lost == 0.0 }, "{lost} J");
    }
}

#[test]
fn it_starts_from_the_elastica_at_rest_and_stays_there_while_that_torque_holds() {
    for chord_rad in [0.0, 0.7, -0.9, 2.4] {
        let gravity = Gravity { acceleration_m_s2: [0.0, -G], start_angle_rad: Some(chord_rad) };
        let link = Link::new(LinkParts {
            segments: vec![Segment::uniform(1.1, 6.0, 0.5)],
            hub: Hub::default(),
            payload: Payload { mass_kg: 0.1, ..Payload::default() },
            damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 0.01 },
            gravity: Some(gravity),
            ..bayo()
        });
        // A hub without inertia moves no mass: as little as changes nothing here.
        let mut parts = LinkParts::from(link.unwrap());
        parts.hub.inertia_kg_m2 = 1e-3;
        let link = Link::new(parts).unwrap();
        let [torque_n_m, direction_rad] = elastica(&LinkParts::from(link.clone()), chord_rad);
        let torque = torque(0.01, 20, |_| torque_n_m);
        let found = large(&link, &Play::of(&torque));
        for (own, tip_m) in found.hub().angle_rad.iter().zip(&found.tip[0].displacement_m) {
            assert!((own - direction_rad).abs() < 1e-9, "{own} is not {direction_rad}");
            assert!(tip_m.abs() < 1e-8, "{tip_m:e}");
        }
        assert!((found.tip_deflection_m()[0] / 1.1).abs() > 0.05, "it bends");
        assert_eq!(found.warnings, [], "what holds it is what is played");
    }
}

/// The tip turned by an angle as its smooth motion goes.
fn by_angle(turn_rad: f64, link: &Link) -> TipMotion {
    let short = smooth(220);
    let grid = short.grid();
    let scale = turn_rad * link.length_m() / short.travel_m();
    let period = short.target(grid.time_s(0), grid.end_s());
    let displacement_m = period.displacement_m().iter().map(|v| scale * v).collect();
    let time_s = (0..grid.len).map(|k| grid.time_s(k)).collect();
    displaced(time_s, displacement_m)
}

/// The torque of the inversion makes the tip follow, from hanging and from upright, with weight and without: the two
/// have no equation in common.
#[test]
fn the_tip_follows_under_the_torque_that_was_solved() {
    let analysis = Analysis::new(1e-7, None, None).unwrap().with_tip_tolerance(1e-7).unwrap();
    let analysis = analysis.with_second_order(SecondOrder::Full);
    for (start_rad, has_weight) in [(-FRAC_PI_2, true), (1.2, true), (0.0, false)] {
        let mut link = weighted(start_rad, BETA);
        if !has_weight {
            link = Link::new(LinkParts { gravity: None, ..link.into() }).unwrap();
        }
        let motion = by_angle(0.6, &link);
        let wanted = invert(&link, &plan_of(&link, 20), &motion, &analysis).unwrap();
        let torque = torque_of(&wanted);
        let time_s: Vec<f64> = (0..wanted.grid.len).map(|k| wanted.grid.time_s(k)).collect();
        let hub = HubReference::new(&time_s, wanted.hub().angle_rad.clone(), None).unwrap();
        let gains = Feedback::new(20.0, 2.0, hub.clone()).unwrap();
        let initial_tip_m = wanted.tip[0].displacement_m[0];
        let of_torque = Play { initial_tip_m, ..Play::of(&torque) };
        let plays = [
            ("torque", of_torque),
            ("feedback", Play { feedback: std::slice::from_ref(&gains), ..of_torque }),
            ("hub", Play::turning(&hub)),
        ];
        for (name, play) in plays {
            let found = large(&link, &play);
            let tip = difference(&found.tip[0].displacement_m, &wanted.tip[0].displacement_m);
            let torque = difference(&found.hub().torque_n_m, &wanted.hub().torque_n_m);
            let hub = difference(&found.hub().angle_rad, &wanted.hub().angle_rad);
            // Upright, the torque alone lets every error grow.
            let most = if name == "torque" && start_rad > 0.0 { 1e-4 } else { 5e-6 };
            assert!(tip < most, "{name} from {start_rad}: tip {tip:e}");
            assert!(hub < most, "{name} from {start_rad}: hub {hub:e}");
            assert!(torque < 5e-5, "{name} from {start_rad}: torque {torque:e}");
            assert!(found.warnings.is_empty(), "{:?}", found.warnings);
            let error = PlayError::of(&found, &link.clone().into(), &play).unwrap().unwrap();
            assert!(error.tip < 1e-6 && error.hub_angle < 1e-6, "{error:?}");
        }
        // The check can fail: a torque that is off by a thousandth misses.
        let off = wanted.hub().torque_n_m.iter().map(|torque| 1.001 * torque).collect();
        let off = Torque::new(&time_s, off).unwrap();
        let found = large(&link, &Play { initial_tip_m, ..Play::of(&off) });
        let tip = difference(&found.tip[0].displacement_m, &wanted.tip[0].displacement_m);
        assert!(tip > 1e-4, "{tip:e}");
    }
}

#[test]
fn what_does_not_begin_where_the_link_rests_is_told() {
    let link = weighted(-0.4, BETA);
    let torque = pulse(2.0);
    let found = large(&link, &Play::of(&torque));
    let Some(SimulationWarning::BeginsUnheld { torque_n_m, holding_n_m, share, .. }) =
        found.warnings.first()
    else {
        panic!("{:?}", found.warnings);
    };
    assert!(*torque_n_m == 0.0 && *holding_n_m > 5.0 && *share > 1.0);
    let held = *holding_n_m;
    let torque = super::torque(0.004, 40, |_| held);
    let angle = vec![found.hub().angle_rad[0] + 0.01; 41];
    let reference = HubReference::new(&times(0.004, 40), angle, None).unwrap();
    let feedback = Feedback::new(20.0, 2.0, reference).unwrap();
    let found =
        large(&link, &Play { feedback: std::slice::from_ref(&feedback), ..Play::of(&torque) });
    assert!(
        matches!(found.warnings[..], [SimulationWarning::ReferenceApart { .. }]),
        "{:?}",
        found.warnings
    );
    // It turns towards the reference, and its weight is still held.
    assert!(found.hub().angle_rad[40] > found.hub().angle_rad[0] + 1e-4);
    assert!(peak(&found.tip_deflection_m()) < 0.5 * link.length_m());
}

#[test]
fn links_whose_large_motion_is_not_known_are_refused() {
    let refusal = |change: &dyn Fn(&mut LinkParts)| {
        let mut parts = LinkParts::from(weighted(-1.0, BETA));
        change(&mut parts);
        let link = Link::new(parts).unwrap();
        simulate(&link, &plan_of(&link, 8), &Play::of(&pulse(1.0))).unwrap_err()
    };
    let alpha = Damping::Rayleigh { alpha_per_s: 0.1, beta_s: 0.0 };
    assert_eq!(
        refusal(&|parts| parts.damping = alpha.clone()).to_string(),
        "the damping drags every mass (alpha), but weight and second-order terms need a link with alpha = 0"
    );
    let modal = Damping::Modal { ratios: vec![0.01] };
    assert!(matches!(
        refusal(&|parts| parts.damping = modal.clone()),
        SimulationError::NotDerived { .. }
    ));
    let nowhere = Gravity { acceleration_m_s2: [0.0, -G], start_angle_rad: None };
    assert_eq!(refusal(&|parts| parts.gravity = Some(nowhere)), SimulationError::NoStartAngle);
}

/// More than half a turn from sample to sample: the tip goes where the hub goes.
#[test]
fn whole_turns_are_counted_however_long_the_step() {
    let mut parts = LinkParts::from(loaded(BETA));
    parts.segments.iter_mut().for_each(|segment| {
        segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(1e4);
    });
    let link = Link::new(parts).unwrap();
    let time_s = times(0.25, 40);
    let turned = |t: &f64| 100.0 * min_jerk(t / 10.0)[0];
    let hub = HubReference::new(&time_s, time_s.iter().map(turned).collect(), None).unwrap();
    let found = large(&link, &Play::turning(&hub));
    let most = found.hub().angle_rad.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    assert!(most > PI, "{most} rad a sample");
    for (tip_m, angle_rad) in found.tip[0].displacement_m.iter().zip(&found.hub().angle_rad) {
        let apart = tip_m / link.length_m() - angle_rad;
        assert!(apart.abs() < 0.05, "{tip_m} m at {angle_rad} rad");
    }
}

/// A torque that jumps turns the hub at once: every row belongs to one instant.
#[test]
fn accelerations_at_a_jump_are_those_of_the_torque_after_it() {
    let link = loaded(BETA);
    let time_s = times(0.004, 60);
    let steps = |k: usize| if k < 30 { 0.0 } else { 0.05 };
    let torque = Torque::new(&time_s, (0..=60).map(steps).collect()).unwrap();
    let play = Play { interpolation: Interpolation::Zero, ..Play::of(&torque) };
    let found = large(&link, &play);
    assert!(found.hub().acceleration_rad_s2[29] == 0.0);
    // At once the hub alone, and the link next to it, are turned.
    let all = 0.05 / link.rigid_inertia_kg_m2();
    let own = found.hub().acceleration_rad_s2[30];
    assert!((2.0 * all..=0.05 / 0.1).contains(&own), "{own} rad/s², all together {all}");
}
