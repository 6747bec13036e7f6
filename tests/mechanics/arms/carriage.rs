//! Arms on a carriage: their force and torques by other methods than those of the library.

use std::f64::consts::TAU;

use flexlink::beam::ElementCount;
use flexlink::elastica::SecondOrder;
use flexlink::inverse::{Analysis, InversionError, Resources, Solution, check_reach};
use flexlink::inverse::{JointMotion, invert_motion};
use flexlink::link::{Arm, ArmCarriage, ArmParts, Carriage, Damping, LinkParts};
use flexlink::motion::{ArmPath, Ends, Motion, PathColumn, PathColumns};

use super::inversion::{arm, column, largest, path, plans, sampled, solved};
use super::newton_euler::efforts;
use super::two_links;
use crate::elastica::Turn;

const GRAVITY: [f64; 2] = [0.0, -9.81];

/// A carriage on an oblique rail.
const OBLIQUE: ArmCarriage = ArmCarriage {
    carriage: Carriage { mass_kg: 12.0, viscous_friction_n_s_m: 20.0 },
    axis: [0.96, 0.28],
};

fn on_carriage(parts: &[LinkParts], gravity_m_s2: [f64; 2], carriage: ArmCarriage) -> Arm {
    let fixed = arm(parts, gravity_m_s2);
    let (links, elbow) = (fixed.links().to_vec(), fixed.elbow());
    let (title, carriage) = (String::new(), Some(carriage));
    Arm::new(ArmParts { title, links, gravity_m_s2, elbow, carriage }).expect("an arm")
}

fn along([ax, ay]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    ax * x + ay * y
}

/// The tip on a line while the carriage moves by `by_m`, 0.1 s ahead of it.
fn line(arm: &Arm, by_m: Option<f64>) -> ArmPath {
    let (time_s, shares) = sampled(1.5, 512);
    let ahead = Turn { from_rad: 0.0, by_rad: 1.0, duration_s: 1.5 };
    let ahead: Vec<f64> = time_s.iter().map(|t| ahead.at(t + 0.1)[0]).collect();
    let [ax, ay] = arm.carriage().map_or([0.0; 2], |own| own.axis);
    let by = by_m.unwrap_or(0.0);
    let mut tip = [column("x", &shares, 0.9, -0.4), column("y", &shares, -0.5, 1.3)];
    for (place, part) in tip.iter_mut().zip([ax, ay]) {
        place.values.iter_mut().zip(&shares).for_each(|(own, share)| *own += part * by * share);
    }
    let carriage = by_m.map(|by| column("carriage", &ahead, 0.0, by));
    path(arm, PathColumns { time_s, tip: Some(tip), angles: vec![], carriage })
}

fn range(history: &[f64]) -> f64 {
    let most = history.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - history.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Largest difference of two histories over the range of the first.
fn apart(own: &[f64], other: &[f64]) -> f64 {
    assert!(own.len() == other.len());
    largest(own.iter().zip(other).map(|(a, b)| a - b)) / range(own)
}

fn order(second_order: SecondOrder) -> Analysis {
    Analysis::default().with_second_order(second_order)
}

#[test]
fn a_carriage_at_rest_changes_no_torque_and_holds_the_arm() {
    let (fixed, arm) = (arm(&two_links(), GRAVITY), on_carriage(&two_links(), GRAVITY, OBLIQUE));
    let count = ElementCount::Total(6);
    for second_order in [SecondOrder::None, SecondOrder::Full] {
        let analysis = order(second_order);
        let [own, held] =
            [&fixed, &arm].map(|arm| solved(arm, &line(&fixed, None), count, &analysis));
        assert_eq!((own.joints.len(), held.joints.len()), (2, 3));
        for (a, b) in own.joints.iter().zip(&held.joints) {
            assert!(a == b, "a held carriage changes a joint");
        }
        let JointMotion { force_n: Some([x_n, y_n]), .. } = &own.joints[0] else { panic!() };
        let weight_n = 12.0 * along(OBLIQUE.axis, GRAVITY);
        for (k, force_n) in held.joints[2].torque_n_m.iter().enumerate() {
            let expected_n = along(OBLIQUE.axis, [x_n[k], y_n[k]]) - weight_n;
            assert!(
                (force_n - expected_n).abs() < 1e-12 * weight_n.abs(),
                "{force_n} {expected_n}"
            );
        }
        // A carriage that stands elsewhere moves arm and path.
        let (time_s, shares) = sampled(1.5, 512);
        let [ax, ay] = OBLIQUE.axis.map(|part| 0.4 * part);
        let tip = [column("x", &shares, 0.9 + ax, -0.4), column("y", &shares, -0.5 + ay, 1.3)];
        let carriage = Some(column("carriage", &shares, 0.4, 0.0));
        let there = PathColumns { time_s, tip: Some(tip), angles: vec![], carriage };
        let there = solved(&arm, &path(&arm, there), count, &analysis);
        for (a, b) in held.joints.iter().zip(&there.joints) {
            assert!(apart(&a.torque_n_m, &b.torque_n_m) < 1e-8);
        }
        assert!(there.joints[2].angle_rad.iter().all(|at_m| (at_m - 0.4).abs() < 1e-15));
    }
}

#[test]
fn stiff_links_take_the_efforts_of_newton_and_euler() {
    let mut parts = two_links().to_vec();
    parts[0].hub.viscous_friction_n_m_s_rad = 0.3;
    let arm = on_carriage(&parts, GRAVITY, OBLIQUE);
    let turn = |from_rad, by_rad| Turn { from_rad, by_rad, duration_s: 1.0 };
    let turns = [turn(-0.6, 1.1), turn(0.5, -0.7)];
    let rail = turn(0.2, 0.9);
    let (time_s, _) = sampled(1.0, 512);
    let sampled = |name: &str, turn: &Turn| PathColumn {
        name: name.to_owned(),
        values: time_s.iter().map(|t| turn.at(*t)[0]).collect(),
        recording: flexlink::motion::Recording::default(),
    };
    let angles = vec![Some(sampled("angle1", &turns[0])), Some(sampled("angle2", &turns[1]))];
    let carriage = Some(sampled("carriage", &rail));
    let columns = PathColumns { time_s: time_s.clone(), tip: None, angles, carriage };
    let moving = path(&arm, columns);
    for part in &mut parts {
        part.segments[0].bending_stiffness_n_m2 =
            part.segments[0].bending_stiffness_n_m2.scaled(1e7);
        part.damping = Damping::None;
    }
    let stiff = on_carriage(&parts, GRAVITY, OBLIQUE);
    let exact = Analysis::default().with_tip_tolerance(1e-9).expect("an analysis");
    let count = ElementCount::Total(2);
    let found = solved(&stiff, &moving, count, &exact.with_second_order(SecondOrder::None));
    let axis = OBLIQUE.axis;
    let expected = |k: usize| {
        let t = found.grid.time_s(k);
        let [_, rate, acceleration] = rail.at(t);
        let felt = [0, 1].map(|part: usize| GRAVITY[part] - acceleration * axis[part]);
        let (mut all, root_n) = efforts(&parts, &turns, felt, t);
        let carried = 12.0 * (acceleration - along(axis, GRAVITY)) + 20.0 * rate;
        all.push(carried + along(axis, root_n));
        all
    };
    let expected: Vec<Vec<f64>> = (0..found.grid.len).map(expected).collect();
    for (joint, own) in found.joints.iter().enumerate() {
        let expected: Vec<f64> = expected.iter().map(|all| all[joint]).collect();
        let [rigid, bent] =
            [&own.rigid_torque_n_m, &own.torque_n_m].map(|own| apart(&expected, own));
        assert!(rigid < 1e-6 && bent < 2e-6, "{joint}: {rigid:e} {bent:e}");
    }
}

/// Momentum along the rail of a solution's links at each sample, over time: Σ m x, by Boole's rule over the elements.
fn moment_kg_m(found: &Solution, axis: [f64; 2]) -> Vec<f64> {
    let at = |k: usize| {
        let links = found.shapes().zip(&found.links).map(|(shape, link)| {
            let place = |node: usize| {
                along(axis, [0, 1].map(|part: usize| shape.positions_m[node][part][k]))
            };
            let (last, link) = (shape.positions_m.len() - 1, link.link());
            let weights = [7.0, 32.0, 12.0, 32.0];
            let mut sum = 0.0;
            for node in 0..=last {
                let weight = if node == 0 || node == last { 7.0 } else { weights[node % 4] };
                let weight = if node % 4 == 0 && node > 0 && node < last { 14.0 } else { weight };
                sum += weight * place(node);
            }
            let step_m = link.length_m() / last as f64;
            let per_m = link.segments()[0].mass_per_length_kg_m.mean();
            per_m * sum * 2.0 * step_m / 45.0 + link.payload().mass_kg * place(last)
        });
        links.sum()
    };
    (0..found.grid.len).map(at).collect()
}

#[test]
fn the_force_changes_the_momentum_along_the_rail() {
    let arm = on_carriage(&two_links(), GRAVITY, OBLIQUE);
    let tight = order(SecondOrder::Full).with_tip_tolerance(1e-8).expect("an analysis");
    let found = solved(&arm, &line(&arm, Some(0.3)), ElementCount::Total(24), &tight);
    let (axis, step_s) = (OBLIQUE.axis, found.grid.step_s);
    let moment = moment_kg_m(&found, axis);
    let own = &found.joints[2];
    let masses_kg: f64 = arm.links().iter().map(|own| own.link.mass_kg()).sum();
    let weight_n = (12.0 + masses_kg) * along(axis, GRAVITY);
    let mut off: f64 = 0.0;
    for k in 4..moment.len() - 4 {
        // Central differences of the eighth order.
        let weights = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];
        let pairs = (1..).zip(weights).map(|(n, w)| w * (moment[k + n] + moment[k - n]));
        let second = (pairs.sum::<f64>() - 205.0 / 72.0 * moment[k]) / (step_s * step_s);
        let carriage = 12.0 * own.acceleration_rad_s2.as_ref().expect("a table")[k];
        let force_n = second + carriage - weight_n + 20.0 * own.rate_rad_s[k];
        off = off.max((force_n - own.torque_n_m[k]).abs());
    }
    let share = off / range(&own.torque_n_m);
    assert!(share < 2e-7, "{share:e}");
}

#[test]
fn all_work_from_rest_to_rest_is_lost_in_friction() {
    let mut parts = two_links();
    for part in &mut parts {
        part.damping = Damping::None;
    }
    let arm = on_carriage(&parts, [0.0; 2], OBLIQUE);
    let found =
        solved(&arm, &line(&arm, Some(0.3)), ElementCount::Total(8), &order(SecondOrder::Full));
    let power = |joint: &JointMotion, k: usize| joint.torque_n_m[k] * joint.rate_rad_s[k];
    let samples = || 0..found.grid.len;
    let work: f64 =
        samples().map(|k| found.joints.iter().map(|own| power(own, k)).sum::<f64>()).sum();
    let lost: f64 = found.joints[2].rate_rad_s.iter().map(|rate| 20.0 * rate * rate).sum();
    let size: f64 = samples().map(|k| power(&found.joints[2], k).abs()).sum();
    assert!((work - lost).abs() < 1e-6 * size, "{work} {lost} {size}");
    assert!(lost > 0.1 * size);
}

#[test]
fn the_moved_carriage_takes_the_force_and_leads_the_tip() {
    let arm = on_carriage(&two_links(), GRAVITY, OBLIQUE);
    // A cycle settles within 400 rounds.
    let mut parts = two_links();
    for part in &mut parts {
        part.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 5e-3 };
    }
    let damped = on_carriage(&parts, GRAVITY, OBLIQUE);
    let time_s: Vec<f64> = (0..300).map(|k| f64::from(k) / 200.0).collect();
    let wave = |name: &str, mean: f64, size: f64, phase: f64| PathColumn {
        name: name.to_owned(),
        values: time_s.iter().map(|t| mean + size * (TAU * t / 1.5 + phase).sin()).collect(),
        recording: flexlink::motion::Recording::default(),
    };
    let columns = PathColumns {
        time_s: time_s.clone(),
        tip: Some([wave("x", 0.8, 0.2, 0.0), wave("y", -0.3, 0.1, 1.0)]),
        angles: vec![],
        carriage: Some(wave("carriage", 0.0, 0.3, 0.5)),
    };
    let cycle = ArmPath::with_ends(columns, &arm.lengths_m(), Ends::Periodic).expect("a cycle");
    for (arm, path) in [(&arm, line(&arm, Some(0.3))), (&damped, cycle)] {
        let motion = Motion::Path(path.clone());
        let plans = plans(arm, ElementCount::Auto);
        let analysis = Analysis::default();
        let found = invert_motion(arm, &plans, &motion, &analysis, &Resources::default());
        let found = found.expect("a solution");
        let moved = found.moved().expect("a motion");
        assert!(found.tip_error_of(&moved, &path) < 2e-5);
        assert!(moved.imbalance() < 1e-7, "{:e}", moved.imbalance());
        for (joint, (own, other)) in found.joints.iter().zip(&moved.joints).enumerate() {
            let off = apart(&own.torque_n_m, &other.torque_n_m);
            assert!(off < 2e-5, "{joint}: {off:e}");
        }
    }
}

#[test]
fn a_path_needs_a_carriage_and_the_carriage_carries_the_reach() {
    let fixed = arm(&two_links(), GRAVITY);
    let arm = on_carriage(&two_links(), GRAVITY, OBLIQUE);
    let refused = check_reach(&fixed, &line(&arm, Some(0.3))).err();
    assert_eq!(refused, Some(InversionError::NoCarriage));
    assert!(check_reach(&arm, &line(&arm, Some(0.3))).is_ok());
    let far = line(&arm, Some(-6.0));
    let Some(InversionError::OutOfReach { .. }) = check_reach(&arm, &far).err() else {
        panic!("the tip is 0.1 s behind a fast carriage")
    };
    let unset = ArmCarriage { axis: [0.0; 2], ..OBLIQUE };
    let links = fixed.links().to_vec();
    let parts = ArmParts { links, carriage: Some(unset), ..ArmParts::default() };
    let error = Arm::new(parts).unwrap_err().to_string();
    assert!(error.starts_with("carriage.axis = [0, 0], but must be a direction"), "{error}");
    let long = ArmCarriage { axis: [96.0, 28.0], ..OBLIQUE };
    let arm = on_carriage(&two_links(), GRAVITY, long);
    assert!(
        largest(arm.carriage().unwrap().axis.iter().zip(OBLIQUE.axis).map(|(a, b)| a - b)) < 1e-15
    );
}
