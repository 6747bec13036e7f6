//! Curves of an arm's tip against closed forms and plain quadrature, and the law of their arc length.

use std::f64::consts::{PI, TAU};

use flexlink::motion::{Curve, CurveError, Profile};

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn a_line_is_straight_to_the_last_digits_and_gone_along_by_the_law() {
    let (from, to) = ([0.9, -0.5], [0.5, 0.8]);
    let curve = Curve::through(&[from, to]).unwrap();
    let places = curve.sampled(&Profile::MinJerk.into(), 250, [3, 2]).unwrap();
    assert_eq!(places.len(), 3 + 251 + 2);
    assert!(places[..=3].iter().all(|place| apart(*place, from) == 0.0));
    assert!(places[253..].iter().all(|place| apart(*place, to) == 0.0));
    for (k, place) in (0..=250_u32).zip(&places[3..]) {
        let u = f64::from(k) / 250.0;
        // Without cancellation: of the half that is left.
        let half = |u: f64| u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
        let share = if u > 0.5 { 1.0 - half(f64::from(250 - k) / 250.0) } else { half(u) };
        let exact = [0, 1].map(|axis: usize| from[axis] + share * (to[axis] - from[axis]));
        assert!(apart(*place, exact) < 4e-16, "at {u}: {place:?} is not {exact:?}");
    }
    let held = Curve::through(&[[0.3, 0.1], [0.3, 0.7]]).unwrap();
    let places = held.sampled(&Profile::Sine.into(), 77, [0, 0]).unwrap();
    assert!(
        places.iter().all(|place| place[0].total_cmp(&0.3).is_eq()),
        "what does not move is held exactly"
    );
}

#[test]
fn an_arc_keeps_its_radius_over_more_than_a_turn_either_way() {
    let (from, center) = ([0.9, 0.2], [0.4, 0.1]);
    let radius = apart(from, center);
    for angle in [0.25 * PI, -0.5 * PI, TAU, -7.5] {
        let curve = Curve::arc(from, center, angle).unwrap();
        assert!((curve.length_m() - radius * f64::abs(angle)).abs() < 1e-15 * 10.0);
        let places = curve.sampled(&Profile::Sine.into(), 400, [0, 0]).unwrap();
        assert!(apart(places[0], from) == 0.0);
        let mut turned = 0.0;
        for (k, pair) in (1..=400_u32).zip(places.windows(2)) {
            assert!((apart(pair[1], center) - radius).abs() < 4e-16, "{angle} at {k}");
            let [a, b] =
                [0, 1].map(|end: usize| [0, 1].map(|axis: usize| pair[end][axis] - center[axis]));
            turned += (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
            let u = f64::from(k) / 400.0;
            let exact = angle * (u - (TAU * u).sin() / TAU);
            assert!((turned - exact).abs() < 1e-13, "{angle} at {k}: {turned} is not {exact}");
        }
    }
}

/// Curvature of a corner that turns by `turn` over a length, at a share of it: the law of the rounding.
fn curvature(turn: f64, length_m: f64, share: f64) -> f64 {
    let within = if (0.0..=1.0).contains(&share) { share * (1.0 - share) } else { 0.0 };
    140.0 * turn * within.powi(3) / length_m
}

#[test]
fn a_rounded_corner_turns_by_its_law_and_stays_within_its_reach() {
    let (corner, reach) = ([0.7, 0.4], 0.1);
    for turn in [0.5 * PI, -0.5 * PI, 0.1, 2.0, -3.0] {
        let (before, after) = (0.6, 0.8);
        let from = [corner[0] - before, corner[1]];
        let to = [corner[0] + after * f64::cos(turn), corner[1] + after * f64::sin(turn)];
        let curve = Curve::rounded(&[from, corner, to], reach).unwrap();
        let rounding = curve.length_m() - (before + after - 2.0 * reach);
        let starts = before - reach;
        // Plain quadrature of the direction, from the curvature's law.
        let panels = 4000_u32;
        let step = rounding / f64::from(panels);
        let angle = |share: f64| {
            turn * share.powi(4) * (35.0 - share * (84.0 - share * (70.0 - 20.0 * share)))
        };
        let mut place = [corner[0] - reach, corner[1]];
        let mut nearest = f64::INFINITY;
        for k in 0..panels {
            let at = |part: f64| angle((f64::from(k) + part) / f64::from(panels));
            let simpson =
                |of: fn(f64) -> f64| (of(at(0.0)) + 4.0 * of(at(0.5)) + of(at(1.0))) / 6.0;
            place = [place[0] + step * simpson(f64::cos), place[1] + step * simpson(f64::sin)];
            let found = curve.at(starts + f64::from(k + 1) * step);
            assert!(apart(found, place) < 1e-12, "turn {turn} at {k}: {found:?} is not {place:?}");
            assert!(apart(found, corner) < reach * (1.0 + 1e-12));
            nearest = nearest.min(apart(found, corner));
        }
        let end = [corner[0] + reach * turn.cos(), corner[1] + reach * turn.sin()];
        assert!(apart(place, end) < 1e-12, "turn {turn}: the corner ends {reach} m after it");
        let middle = apart(curve.at(starts + 0.5 * rounding), corner);
        assert!((nearest - middle).abs() < 1e-12 && middle < reach, "nearest in the middle");
    }
}

#[test]
fn curvature_and_its_rate_go_on_from_the_legs_into_the_corner() {
    let (turn, reach) = (0.5 * PI, 0.1);
    let curve = Curve::rounded(&[[0.0, 0.0], [0.5, 0.0], [0.5, 0.5]], reach).unwrap();
    let rounding = curve.length_m() - 0.8;
    let step = 2e-4;
    // From three places a step apart: the curvature of the circle through them.
    let found = |arc: f64| {
        let [a, b, c] = [-step, 0.0, step].map(|by| curve.at(arc + by));
        let cross = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
        2.0 * cross / (apart(a, b) * apart(b, c) * apart(a, c))
    };
    let largest = curvature(turn, rounding, 0.5);
    let first = 0.4 - 0.01;
    let mut before: Option<[f64; 2]> = None;
    for k in 0..2000_u32 {
        let arc = first + f64::from(k) * 1e-4;
        let exact = curvature(turn, rounding, (arc - 0.4) / rounding);
        let own = found(arc);
        assert!((own - exact).abs() < 1e-5 * largest, "at {arc}: {own} is not {exact}");
        let rate = (found(arc + 1e-3) - own) / 1e-3;
        if let Some([curvature, other]) = before {
            assert!((own - curvature).abs() < 5e-3 * largest, "curvature jumps at {arc}");
            assert!((rate - other).abs() < 2e-2 * largest / rounding, "its rate jumps at {arc}");
        }
        before = Some([own, rate]);
    }
}

#[test]
fn arc_length_is_the_way_that_the_tip_has_gone() {
    let corners = [[0.4, 0.3], [0.7, 0.3], [0.7, 0.6], [0.4, 0.6]];
    let curve = Curve::rounded(&corners, 0.15).unwrap();
    let places = curve.sampled(&Profile::Septic.into(), 4000, [0, 0]).unwrap();
    let mut way = 0.0;
    for (k, pair) in (1..=4000_u32).zip(places.windows(2)) {
        way += apart(pair[0], pair[1]);
        let share = Profile::Septic.share(f64::from(k) / 4000.0);
        // Chords are shorter than the curve by the square of the step.
        assert!((way - curve.length_m() * share).abs() < 1e-6, "at {k}: {way}");
    }
    assert!(apart(places[0], corners[0]) + apart(places[4000], corners[3]) == 0.0);
}

#[test]
fn the_tip_stops_at_each_place_and_is_as_fast_on_each_leg() {
    let points = [[0.3, 0.2], [0.9, 0.2], [0.9, 0.5], [0.5, 0.2]];
    let curve = Curve::through(&points).unwrap();
    let places = curve.sampled(&Profile::MinJerk.into(), 1400, [0, 0]).unwrap();
    // Legs of 0.6, 0.3 and 0.5 m share 1400 steps.
    let stops = [0, 600, 900, 1400];
    let speeds: Vec<f64> = places.windows(2).map(|pair| apart(pair[0], pair[1])).collect();
    let peak =
        |leg: usize| speeds[stops[leg]..stops[leg + 1]].iter().fold(0.0, |a: f64, b| a.max(*b));
    for (leg, (stop, point)) in stops.iter().zip(points).enumerate() {
        assert!(apart(places[*stop], point) == 0.0);
        if (1..3).contains(&leg) {
            assert!(speeds[stop - 1].max(speeds[*stop]) < 1e-4 * peak(0), "it stops at {point:?}");
        }
    }
    assert!((peak(1) / peak(0) - 1.0).abs() < 1e-4 && (peak(2) / peak(0) - 1.0).abs() < 1e-4);
}

#[test]
fn what_is_no_curve_is_refused() {
    let square = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.3], [0.0, 0.3]];
    assert!(Curve::rounded(&square, 0.15).is_ok());
    let overlap = Curve::rounded(&square, 0.1501).unwrap_err();
    assert!(matches!(overlap, CurveError::Overlap { number: 2, .. }), "{overlap}");
    let long = Curve::rounded(&square[..3], 0.31).unwrap_err();
    assert!(matches!(long, CurveError::Overlap { number: 1, .. }), "{long}");
    let back = [[0.0, 0.0], [0.3, 0.0], [0.1, 0.0]];
    assert!(Curve::through(&back).is_ok());
    assert!(matches!(Curve::rounded(&back, 0.01), Err(CurveError::TurnsBack { number: 2, .. })));
    let same = Curve::through(&[[0.0, 1.0], [0.0, 1.0]]).unwrap_err();
    assert!(matches!(same, CurveError::Same { number: 1 }), "{same}");
    let nan = Curve::through(&[[0.0, f64::NAN], [0.0, 1.0]]).unwrap_err();
    assert!(matches!(nan, CurveError::Range { .. }), "{nan}");
    for (center, angle) in [([1.0, 0.0], 1.0), ([0.0, 0.0], 0.0)] {
        let none = Curve::arc([1.0, 0.0], center, angle).unwrap_err();
        assert!(matches!(none, CurveError::NoArc { .. }), "{none}");
    }
    let short = Curve::through(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.01]]).unwrap();
    let few = short.sampled(&Profile::Sine.into(), 200, [0, 0]).unwrap_err();
    assert!(matches!(few, CurveError::FewSteps { number: 2, steps: 2, all: 200 }), "{few}");
    // A place on the straight way is no corner.
    let straight = Curve::rounded(&[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]], 0.1).unwrap();
    assert!((straight.length_m() - 1.0).abs() < 1e-15 && straight.stops_m().len() == 1);
}
