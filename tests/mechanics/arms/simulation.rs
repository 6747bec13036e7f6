//! Torques played on arms by Lagrange's equations: where the inversion's torques lead, against rigid pendulums, from states.

use flexlink::beam::ElementCount;
use flexlink::elastica::SecondOrder;
use flexlink::inverse::{Analysis, JointMotion, Solution};
use flexlink::link::{Arm, Damping, Link, LinkParts, LumpedMass, Payload, Segment};
use flexlink::motion::{ArmPath, PathColumns};
use flexlink::response::{
    Feedback, HubReference, Input, Interpolation, Play, Played, Start, State, Torque, simulate,
};

use super::inversion::{arm, column, largest, path, plans, sampled, solved};
use super::two_links;

fn times_s(found: &Solution) -> Vec<f64> {
    (0..found.grid.len).map(|k| found.grid.time_s(k)).collect()
}

/// Feedback of every joint around its angle and rate as solved.
fn feedback(found: &Solution, (kp, kd): (f64, f64)) -> Vec<Feedback> {
    let of = |joint: &JointMotion| {
        let JointMotion { angle_rad: angle, rate_rad_s: rate, .. } = joint;
        let reference = HubReference::new(&times_s(found), angle.clone(), Some(rate.clone()));
        Feedback::new(kp, kd, reference.expect("a reference")).expect("gains")
    };
    found.joints.iter().map(of).collect()
}

fn torques(found: &Solution) -> Vec<Torque> {
    let of = |joint: &JointMotion| {
        Torque::new(&times_s(found), joint.torque_n_m.clone()).expect("a torque")
    };
    found.joints.iter().map(of).collect()
}

fn played(
    arm: &Arm,
    torques: &[Torque],
    feedback: &[Feedback],
    (start, tolerance): (Start<'_>, f64),
) -> Played {
    let play = Play {
        feedback,
        start: Some(start),
        tolerance: Some(tolerance),
        ..Play::with(Input::Torques(torques))
    };
    simulate(arm, &plans(arm, ElementCount::Total(4)), &play, &|_| {}).expect("a motion")
}

/// Largest distance of the tip from that which was solved, over the tip's way.
fn strays(found: &Solution, played: &Played) -> f64 {
    let off = |k: usize| {
        let [x, y] = [0, 1].map(|axis: usize| {
            played.tip[axis].displacement_m[k] - found.tip[axis].displacement_m[k]
        });
        (x * x + y * y).sqrt()
    };
    largest((0..found.grid.len).map(off)) / found.tip_travel_m()
}

fn start(found: &Solution) -> Vec<f64> {
    found.joints.iter().map(|joint| joint.angle_rad[0]).collect()
}

/// Hub radii, a mass on each link, friction, a payload with offset and inertia.
fn loaded() -> [LinkParts; 2] {
    two_links().map(|mut parts| {
        parts.hub.radius_m = 0.05;
        parts.hub.viscous_friction_n_m_s_rad = 0.2;
        parts.payload.inertia_kg_m2 = 1e-4;
        parts.payload.offset_m = 0.03;
        parts.masses = vec![LumpedMass { at_m: 0.35, mass_kg: 0.2, inertia_kg_m2: 1e-4 }];
        parts
    })
}

fn three_links() -> Vec<LinkParts> {
    let [upper, fore] = two_links();
    let mut hand = fore.clone();
    hand.segments = vec![Segment::uniform(0.25, 6.0, 0.3)];
    hand.payload = Payload { mass_kg: 0.1, ..Payload::default() };
    vec![upper, fore, hand]
}

/// A line of the tip in 1.5 s.
fn line(arm: &Arm) -> ArmPath {
    let (time_s, shares) = sampled(1.5, 256);
    let tip = [column("x", &shares, 0.9, -0.4), column("y", &shares, -0.5, 1.3)];
    path(arm, PathColumns { time_s, tip: Some(tip), angles: vec![], carriage: None })
}

/// The same of three links, with the third one's direction.
fn wave(arm: &Arm) -> ArmPath {
    let (time_s, shares) = sampled(1.5, 256);
    let tip = [column("x", &shares, 0.95, -0.4), column("y", &shares, -0.4, 1.1)];
    path(arm, PathColumns { time_s, tip: Some(tip), angles: third(&shares), carriage: None })
}

fn third(shares: &[f64]) -> Vec<Option<flexlink::motion::PathColumn>> {
    vec![None, None, Some(column("angle3", shares, 0.2, 0.9))]
}

#[test]
fn torques_as_solved_lead_the_tip_along_its_path() {
    // Torques of the default tolerance, 1e-6 of the travel, leave open loop that much.
    let analysis = Analysis::default().with_tip_tolerance(1e-8).expect("a tolerance");
    let paths =
        [(arm(&two_links(), [0.0; 2]), None), (arm(&loaded(), [-3.0, -9.0]), Some((50.0, 1.0)))]
            .map(|(arm, gains)| (line(&arm), arm, gains));
    let three = arm(&three_links(), [0.0, -9.81]);
    let three = (wave(&three), three, Some((50.0, 1.0)));
    for (path, arm, gains) in paths.into_iter().chain([three]) {
        let found = solved(&arm, &path, ElementCount::Auto, &analysis);
        let feedback = gains.map_or(Vec::new(), |gains| feedback(&found, gains));
        let start = start(&found);
        let played = played(&arm, &torques(&found), &feedback, (Start::Joints(&start), 1e-7));
        let off = strays(&found, &played);
        assert!(off < 1e-6, "{off:e} {:?} {:?}", played.change(), played.warnings);
        assert!(played.warnings.is_empty(), "{:?}", played.warnings);
        assert!(played.imbalance() < 1e-8, "{:e}", played.imbalance());
    }
}

/// The line in 1.5 s without gravity.
#[test]
fn what_a_level_leaves_out_is_what_the_tip_strays_by() {
    let arm = arm(&two_links(), [0.0; 2]);
    let strays = [SecondOrder::None, SecondOrder::First, SecondOrder::Full].map(|order| {
        let analysis = Analysis::default().with_second_order(order);
        let found = solved(&arm, &line(&arm), ElementCount::Auto, &analysis);
        let start = start(&found);
        strays(&found, &played(&arm, &torques(&found), &[], (Start::Joints(&start), 1e-7)))
    });
    assert!(
        strays[2] < 2e-6 && strays[1] > 1e-3 && strays[0] > 1.5 * strays[1] && strays[0] < 0.01,
        "{strays:?}"
    );
}

#[test]
fn an_arm_goes_on_from_a_state_as_if_it_had_not_stopped() {
    let arm = arm(&loaded(), [0.0, -9.81]);
    let time_s: Vec<f64> = (0..81).map(|k| f64::from(k) / 100.0).collect();
    let torque = |size: f64, until: usize, from: usize| {
        let values = time_s[from..=until].iter().map(|t| size * (3.0 * t).sin()).collect();
        Torque::new(&time_s[from..=until], values).expect("a torque")
    };
    let parts = |from: usize, until: usize| [torque(4.0, until, from), torque(-1.5, until, from)];
    let chords = Start::Chords(&[-1.2, 0.3]);
    let play = |torques: &[Torque], state: Option<&State>| {
        let play = Play {
            interpolation: Interpolation::Linear,
            start: Some(chords),
            state,
            ..Play::with(Input::Torques(torques))
        };
        simulate(&arm, &plans(&arm, ElementCount::Total(4)), &play, &|_| {}).expect("a motion")
    };
    let whole = play(&parts(0, 80), None);
    let half = play(&parts(0, 40), None);
    let rest = play(&parts(40, 80), Some(&half.state()));
    for (axis, (all, own)) in whole.tip.iter().zip(&rest.tip).enumerate() {
        let orders = [(&all.displacement_m, &own.displacement_m, 1.0)];
        let rates = [(&all.velocity_m_s, &own.velocity_m_s, 30.0)];
        for (all, own, size) in orders.into_iter().chain(rates) {
            let off = largest(all[40..].iter().zip(own).map(|(a, b)| a - b));
            assert!(off < 1e-6 * size, "{off:e} of axis {axis}, {size}");
        }
    }
    let chords_rad = &whole.bent().expect("bent links").chords_rad;
    assert!((chords_rad[0][0] + 1.2).abs() < 1e-10 && (chords_rad[1][0] - 0.3).abs() < 1e-10);
}

/// Two rods of mass 1 kg and 0.5 kg that hardly bend, let go: the double pendulum's equations by Runge and Kutta.
#[test]
fn rods_that_hardly_bend_fall_as_a_double_pendulum() {
    let lengths_m = [0.8, 0.5];
    let rod = |length_m: f64, mass_kg_m: f64| {
        let link = Link::builder().segment(Segment::uniform(length_m, 3e5, mass_kg_m));
        LinkParts { damping: Damping::None, ..LinkParts::from(link.build().expect("a link")) }
    };
    let arm = arm(&[rod(lengths_m[0], 1.25), rod(lengths_m[1], 1.0)], [0.0, -9.81]);
    let time_s: Vec<f64> = (0..201).map(|k| f64::from(k) / 200.0).collect();
    let none = || Torque::new(&time_s, vec![0.0; 201]).expect("a torque");
    let starts = [-0.6, -2.0];
    let played = played(&arm, &[none(), none()], &[], (Start::Chords(&starts), 1e-5));
    assert_eq!(played.warnings.len(), 2, "nothing holds it: {:?}", played.warnings);

    let masses = [1.0, 0.5];
    let [l1, l2] = lengths_m;
    let rates = |[a, b, u, v]: [f64; 4]| {
        let inertia = [masses[0] * l1 * l1 / 3.0 + masses[1] * l1 * l1, masses[1] * l2 * l2 / 3.0];
        let coupled = masses[1] * l1 * l2 / 2.0;
        let (c, s) = ((a - b).cos(), (a - b).sin());
        let g = 9.81;
        let f1 = -coupled * s * v * v - g * (masses[0] * l1 / 2.0 + masses[1] * l1) * a.cos();
        let f2 = coupled * s * u * u - g * masses[1] * l2 / 2.0 * b.cos();
        let off = coupled * c;
        let determinant = inertia[0] * inertia[1] - off * off;
        let turned = [(f1 * inertia[1] - f2 * off), (f2 * inertia[0] - f1 * off)];
        [u, v, turned[0] / determinant, turned[1] / determinant]
    };
    let mut at = [starts[0], starts[1], 0.0, 0.0];
    let (mut worst, parts) = (0.0_f64, 40);
    for k in 0..201 {
        let tip = [l1 * at[0].cos() + l2 * at[1].cos(), l1 * at[0].sin() + l2 * at[1].sin()];
        let off = [0, 1].map(|axis: usize| played.tip[axis].displacement_m[k] - tip[axis]);
        worst = worst.max(largest(off.into_iter()));
        for _ in 0..parts {
            let h = 1.0 / 200.0 / f64::from(parts);
            let add = |k: [f64; 4], by: f64| [0, 1, 2, 3].map(|i: usize| at[i] + by * k[i]);
            let k1 = rates(at);
            let k2 = rates(add(k1, 0.5 * h));
            let k3 = rates(add(k2, 0.5 * h));
            let k4 = rates(add(k3, h));
            at = [0, 1, 2, 3]
                .map(|i: usize| at[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
    }
    // Rods of 3e5 N m² bend by some 1e-6 m; their tips' errors fall with that.
    assert!(worst < 3e-5, "{worst:e}");
    assert!(played.imbalance() < 1e-5, "{:e}", played.imbalance());
}
