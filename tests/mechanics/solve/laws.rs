//! Laws that hold for any link and any motion.

use proptest::prelude::*;

use super::{
    Smooth, accelerated, displaced, link, peak, plan_of, samples, sine, solved, torque_at,
    torque_difference, uniform, whole_band,
};
use flexlink::csv::read_motion_table;
use flexlink::inverse::{Analysis, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment, Taper};

/// What padding and wrap-around may cost two torques together: some tolerances of the peak.
const PADDING: f64 = 1e-5;

/// A link of one uniform segment with a hub and a point payload, hysteretic.
fn any_link() -> impl Strategy<Value = Link> {
    (0.4..2.0, 1.0..20.0, 0.2..1.0, 0.0..0.3, 0.0..0.2, 0.01..0.05).prop_map(
        |(length_m, ei, mass, hub, payload, ratio): (f64, f64, f64, f64, f64, f64)| {
            link(|parts| {
                parts.segments[0].length_m = length_m;
                parts.segments[0].bending_stiffness_n_m2 = Taper::constant(ei);
                parts.segments[0].mass_per_length_kg_m = Taper::constant(mass);
                parts.hub.inertia_kg_m2 = hub;
                parts.payload.mass_kg = payload;
                parts.damping = Damping::Hysteretic { ratio };
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 24,
        failure_persistence: None,
        ..Default::default()
    })]

    #[test]
    fn the_torque_is_linear_in_the_motion(
        link in any_link(),
        (a, b) in (-2.0..2.0_f64, -2.0..2.0_f64),
    ) {
        // Two motions over the same time, one smooth and one with kinks.
        let kinked = sine(0.3, 1.0, 256);
        let time_s = Smooth::MOVE.time_s();
        let forcing = |k: usize| (2.0 * std::f64::consts::PI * time_s[k]).sin();
        let sum = Smooth::MOVE.acceleration_m_s2();
        let scale = 2.0 * std::f64::consts::PI * 0.3;
        let sum = (0..sum.len()).map(|k| a * sum[k] + b * scale * forcing(k)).collect();
        let (first, second) = (solved(&link, 6, &Smooth::MOVE.motion()), solved(&link, 6, &kinked));
        let both = solved(&link, 6, &accelerated(time_s.clone(), sum));
        let allowed = a.abs() * peak(&first.hub().torque_n_m) + b.abs() * peak(&second.hub().torque_n_m);
        let all = [&first, &second, &both].map(samples);
        let from = all.iter().map(|s| s.start).min().unwrap();
        let until = all.iter().map(|s| s.end).max().unwrap();
        for k in from..until {
            let expected = a * torque_at(&first, k) + b * torque_at(&second, k);
            prop_assert!((torque_at(&both, k) - expected).abs() <= PADDING * allowed);
        }
    }

    #[test]
    fn a_later_start_shifts_the_grid_and_nothing_else(link in any_link(), quarters in -40_i32..40) {
        // Quarters of a second and a step of 2⁻⁸ s: no time is rounded.
        let shift_s = 0.25 * f64::from(quarters);
        let later = Smooth::MOVE.time_s().iter().map(|time_s| time_s + shift_s).collect();
        let shifted = solved(&link, 6, &accelerated(later, Smooth::MOVE.acceleration_m_s2()));
        let first = solved(&link, 6, &Smooth::MOVE.motion());
        prop_assert_eq!(&shifted.hub().torque_n_m, &first.hub().torque_n_m);
        prop_assert_eq!(&shifted.hub().angle_rad, &first.hub().angle_rad);
        let later_s = shifted.grid.time_s(0) - first.grid.time_s(0);
        prop_assert!((later_s - shift_s).abs() < 1e-12);
    }

    #[test]
    fn more_rest_around_the_motion_changes_nothing(
        link in any_link(),
        before in 0_u32..1000,
        after in 0_u32..1000,
    ) {
        let rested = Smooth { rest: [before, after], ..Smooth::MOVE };
        let (bare, rested) =
            (solved(&link, 6, &Smooth::MOVE.motion()), solved(&link, 6, &rested.motion()));
        prop_assert!(torque_difference(&bare, &rested, before.into()) <= PADDING);
    }

    #[test]
    fn a_segment_cut_in_two_is_the_same_link(whole in any_link(), at in 1_usize..6) {
        let parts = |segments| LinkParts {
            segments,
            hub: *whole.hub(),
            payload: *whole.payload(),
            damping: whole.damping().clone(),
            ..uniform()
        };
        let segment = &whole.segments()[0];
        let piece = |share: f64| Segment { length_m: share * segment.length_m, ..segment.clone() };
        let share = at as f64 / 6.0;
        let cut = Link::new(parts(vec![piece(share), piece(1.0 - share)])).unwrap();
        let motion = Smooth::MOVE.motion();
        let (whole, cut) = (solved(&whole, 6, &motion), solved(&cut, 6, &motion));
        let nodes = whole.links[0].mesh().nodes_m().iter().zip(cut.links[0].mesh().nodes_m());
        for (a, b) in nodes {
            prop_assert!((a - b).abs() < 1e-14, "the nodes stand where they stood");
        }
        prop_assert!(torque_difference(&whole, &cut, 0) < 1e-10);
    }

    #[test]
    fn the_way_back_needs_the_opposite_torque(link in any_link()) {
        let back = Smooth { travel_m: -0.5, ..Smooth::MOVE };
        let there = solved(&link, 6, &Smooth::MOVE.motion());
        let back = solved(&link, 6, &back.motion());
        let opposite: Vec<f64> = back.hub().torque_n_m.iter().map(|t| -t).collect();
        prop_assert_eq!(&there.hub().torque_n_m, &opposite);
    }

    /// Without damping and friction nothing tells the past from the future: the torque that leads the
    /// motion is the one that follows it, run backwards.
    #[test]
    fn the_torque_of_an_undamped_link_runs_backwards_with_its_motion(
        damped in any_link(),
        (rise, fall) in (3..5_i32, 6..9_i32),
    ) {
        let undamped = Link::new(LinkParts {
            segments: damped.segments().to_vec(),
            hub: *damped.hub(),
            payload: *damped.payload(),
            damping: Damping::None,
            ..uniform()
        })
        .unwrap();
        // The derivative of a velocity (t/T)ᵐ(1 − t/T)ⁿ, skewed as m and n differ.
        let steps = 256;
        let acceleration = |k: i32| {
            let s = f64::from(k) / f64::from(steps);
            let (up, down) = (s.powi(rise - 1), (1.0 - s).powi(fall - 1));
            1e3 * up * down * (f64::from(rise) * (1.0 - s) - f64::from(fall) * s)
        };
        let time_s: Vec<f64> = (0..=steps).map(|k| f64::from(k) / f64::from(steps)).collect();
        let forward: Vec<f64> = (0..=steps).map(acceleration).collect();
        let backward = forward.iter().rev().copied().collect();
        let forward = solved(&undamped, 6, &accelerated(time_s.clone(), forward));
        let backward = solved(&undamped, 6, &accelerated(time_s, backward));
        let mirrored = |k: i64| i64::from(steps) - k;
        let peak = peak(&forward.hub().torque_n_m);
        for k in samples(&forward) {
            let difference = torque_at(&forward, k) - torque_at(&backward, mirrored(k));
            prop_assert!(difference.abs() <= PADDING * peak, "{difference:e} at {k}");
        }
        // The torque is not its own mirror image, so that the mirror is no formality.
        let skew = samples(&forward)
            .map(|k| torque_at(&forward, k).abs() - torque_at(&forward, mirrored(k)).abs());
        let skew = skew.fold(0.0_f64, |m, x| m.max(x.abs()));
        prop_assert!(skew > 0.05 * peak, "{skew:e} of {peak:e}");
    }

    #[test]
    fn friction_of_the_hub_adds_its_own_torque_and_no_other(link in any_link(), b in 0.0..0.5_f64) {
        let hub = Hub { viscous_friction_n_m_s_rad: b, ..*link.hub() };
        let rubbing = Link::new(LinkParts {
            segments: link.segments().to_vec(),
            hub,
            payload: *link.payload(),
            damping: link.damping().clone(),
            ..uniform()
        })
        .unwrap();
        let motion = Smooth::MOVE.motion();
        let (free, rubbing) = (solved(&link, 6, &motion), solved(&rubbing, 6, &motion));
        // Both periods are long enough; where they are equal the difference is round-off.
        let tolerance = if free.band == rubbing.band { 1e-12 } else { PADDING };
        for k in samples(&free) {
            let Ok(index) = usize::try_from(k - free.grid.first) else { continue };
            if !samples(&rubbing).contains(&k) {
                continue;
            }
            let expected = free.hub().torque_n_m[index] + b * free.hub().rate_rad_s[index];
            let error = (torque_at(&rubbing, k) - expected).abs();
            prop_assert!(error <= tolerance * peak(&rubbing.hub().torque_n_m), "{error:e} at {k}");
        }
    }
}

#[test]
fn displacements_alone_give_the_torque_of_the_accelerations() {
    let link = link(|_| ());
    let from_acceleration = solved(&link, 8, &Smooth::MOVE.motion());
    let samples = displaced(Smooth::MOVE.time_s(), Smooth::MOVE.displacement_m());
    let from_displacement = solved(&link, 8, &samples);
    let difference = torque_difference(&from_acceleration, &from_displacement, 0);
    assert!(difference < PADDING, "{difference:e}");
}

#[test]
fn the_units_of_the_file_do_not_matter() {
    let link = link(|_| ());
    let (time_s, acceleration) = (Smooth::MOVE.time_s(), Smooth::MOVE.acceleration_m_s2());
    let file = |header: &str, time: f64, unit: f64| {
        let rows = time_s.iter().zip(&acceleration);
        let rows: Vec<String> =
            rows.map(|(t, a)| format!("{:e},{:e}", t * time, a * unit)).collect();
        let text = format!("{header}\n{}\n", rows.join("\n"));
        read_motion_table("move.csv", text.as_bytes(), 1.5)
            .unwrap()
            .into_motion()
            .unwrap()
            .into_tip()
            .unwrap()
    };
    let si = solved(&link, 8, &file("time,acceleration", 1.0, 1.0));
    for (header, time, unit) in [
        ("time_s,tip_acceleration_m_s2", 1.0, 1.0),
        ("time [ms],acceleration [cm/s^2]", 1e3, 1e2),
        ("time [min], acceleration [mm/s^2]", 1.0 / 60.0, 1e3),
    ] {
        let other = solved(&link, 8, &file(header, time, unit));
        let difference = torque_difference(&si, &other, 0);
        assert!(difference < 1e-11, "{header}: {difference:e}");
    }
}

#[test]
fn an_angle_is_a_displacement_over_the_length() {
    let link = link(|parts| parts.payload = Payload { mass_kg: 0.1, ..Payload::default() });
    let (time_s, displacement) = (Smooth::MOVE.time_s(), Smooth::MOVE.displacement_m());
    let rows = time_s.iter().zip(&displacement);
    let degrees: Vec<String> =
        rows.map(|(t, v)| format!("{t:e},{:e}", (v / 1.5).to_degrees())).collect();
    let text = format!("time,angle [deg]\n{}\n", degrees.join("\n"));
    let table = read_motion_table("turn.csv", text.as_bytes(), link.length_m()).unwrap();
    let plan = plan_of(&link, 8);
    let turned = invert(
        &link,
        &plan,
        &table.into_motion().unwrap().into_tip().unwrap(),
        &whole_band(Analysis::default()),
    )
    .unwrap();
    let difference =
        torque_difference(&solved(&link, 8, &displaced(time_s, displacement)), &turned, 0);
    assert!(difference < 1e-8, "{difference:e}");
}
