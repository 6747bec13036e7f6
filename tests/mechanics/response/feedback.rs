//! Feedback at the hub around the motion that the inversion computed.

use std::f64::consts::{PI, TAU};

use super::super::dense::{assembly::Assembly, damping};
use super::{difference, link, plan_of, played, sine, smooth, solved, times, torque, torque_of};
use faer::{Mat, c64};
use flexlink::beam::{Mesh, hub_response};
use flexlink::inverse::Solution;
use flexlink::link::{Damping, Link, LinkParts, Taper};
use flexlink::modal::natural_frequencies;
use flexlink::motion::TipTarget;
use flexlink::numeric::root;
use flexlink::response::{Feedback, HubReference, Interpolation, LinkState, Play, State, Torque};
use flexlink::result::FollowedTarget;

/// Bayo's link with a viscous ratio in every mode.
fn damped(change: impl FnOnce(&mut LinkParts)) -> Link {
    link(|parts| {
        parts.damping = Damping::Modal { ratios: vec![0.02] };
        change(parts);
    })
}

/// Hysteretic damping belongs to the strain: with higher gains the tip comes to where the moved hub takes it, linear and
/// at large angles.
#[test]
fn a_hysteretic_link_in_a_stiff_loop_moves_as_on_the_moved_hub() {
    let link = link(|parts| parts.damping = Damping::Hysteretic { ratio: 0.02 });
    let plan = plan_of(&link, 10);
    let wanted = solved(&link, &plan, &smooth(220), 1e-8);
    let torque = torque_of(&wanted);
    let time_s: Vec<f64> = (0..wanted.grid.len).map(|k| wanted.grid.time_s(k)).collect();
    let rate = Some(wanted.hub().rate_rad_s.clone());
    let hub = HubReference::new(&time_s, wanted.hub().angle_rad.clone(), rate).unwrap();
    let until_s = Some(time_s[time_s.len() - 1] + 2.0);
    for is_large in [false, true] {
        let moved = Play { until_s, is_large, ..Play::turning(&hub) };
        let moved = played(&link, &plan, &moved).tip.swap_remove(0).displacement_m;
        let in_loop = |gains: Gains| {
            let feedback = around(&wanted, gains, true);
            let play = Play {
                feedback: std::slice::from_ref(&feedback),
                until_s,
                is_large,
                ..Play::of(&torque)
            };
            played(&link, &plan, &play)
        };
        let [stiff, stiffer, undamped] = [(2e3, 100.0), (2e5, 1e4), (2e5, 0.0)]
            .map(|gains| difference(&in_loop(gains).tip[0].displacement_m, &moved));
        assert!(
            stiff < 1e-3 && stiffer < 1e-5 && undamped < 1e-4,
            "{is_large}: {stiff:e}, {stiffer:e}, {undamped:e}"
        );
        // The damping of a loop of middle stiffness turns with the reference: what it takes is accounted for.
        let balances = in_loop((40.0, 0.5)).energy(20).balances;
        let most_j = balances.iter().map(|at| at.kinetic_j).fold(0.0, f64::max);
        for at in &balances {
            let off_j = (at.work_j - at.kinetic_j - at.strain_j - at.dissipated_j).abs();
            assert!(off_j < 1e-6 * most_j, "{is_large}: {off_j:e} J of {most_j} J");
        }
    }
}

/// Frequencies in rad/s and shapes of the modes with a spring at the hub, and damping ratios of the complex stiffness
/// `K(1 + 2iξ)` of the link beside it, from frame elements that are integrated here.
fn on_a_spring(link: &Link, nodes_m: &[f64], spring: f64) -> (Vec<f64>, Mat<f64>, Vec<f64>) {
    let Damping::Hysteretic { ratio } = *link.damping() else { panic!("no hysteretic link") };
    let [mass, stiffness] = Assembly::of_link(link, nodes_m).mass_and_stiffness();
    let size = mass.nrows();
    let mut with_spring = stiffness.clone();
    with_spring[(0, 0)] += spring;
    let (_, shapes) = damping::modes(&mass, &with_spring);
    // Exactly symmetric, as the shapes make the mass 1.
    let lossy = shapes.transpose() * &stiffness * &shapes;
    let elastic = shapes.transpose() * &with_spring * &shapes;
    let complex =
        Mat::from_fn(size, size, |i, j| c64::new(elastic[(i, j)], 2.0 * ratio * lossy[(i, j)]));
    let mut squares = complex.eigenvalues().unwrap();
    squares.sort_by(|a, b| a.re.total_cmp(&b.re));
    let of = |square: &c64| (square.sqrt().norm(), square.sqrt().im / square.sqrt().norm());
    let (omega_rad_s, ratios) = squares.iter().map(of).unzip();
    (omega_rad_s, shapes, ratios)
}

/// Each mode of a loop has the damping of the link's share of its strain energy: soft loops, those of middle stiffness and
/// stiff ones.
#[test]
fn a_hysteretic_link_damps_the_modes_of_its_loop_by_their_strain() {
    let link = link(|parts| parts.damping = Damping::Hysteretic { ratio: 0.02 });
    let plan = plan_of(&link, 10);
    let mesh = Mesh::new(&link, &plan).unwrap();
    let nodes_m = mesh.nodes_m();
    let mut on_the_spring = 0;
    for spring in [1.0, 10.0, 40.0, 100.0, 300.0, 1e3, 1e4] {
        let (omega_rad_s, shapes, ratios) = on_a_spring(&link, nodes_m, spring);
        for mode in 0..3 {
            let of_node = |node: usize, part: usize| match (node, part) {
                (0, 0) => 0.0,
                (0, _) => 1e-4 * shapes[(0, mode)],
                _ => 1e-4 * shapes[(2 * node - 1 + part, mode)],
            };
            let along = |part| (0..nodes_m.len()).map(|node| of_node(node, part)).collect();
            let period_s = TAU / omega_rad_s[mode];
            let time_s = times(period_s / 50.0, 250);
            let none = torque(period_s / 50.0, 250, |_| 0.0);
            let still = HubReference::new(&time_s, vec![0.0; 251], None).unwrap();
            let feedback = Feedback::new(spring, 0.0, still).unwrap();
            // The elastica takes seconds.
            let ways = if spring.total_cmp(&40.0).is_eq() && mode == 1 { 2 } else { 1 };
            for is_large in [false, true].into_iter().take(ways) {
                let rest = || Some(vec![0.0; nodes_m.len()]);
                let link_state = LinkState {
                    time_s: 0.0,
                    x_m: nodes_m.to_vec(),
                    slope_rad: along(1),
                    slope_rate_rad_s: vec![0.0; nodes_m.len()],
                    displacement_m: (!is_large).then(|| along(0)),
                    velocity_m_s: rest().filter(|_| !is_large),
                    ..LinkState::default()
                };
                let state = State { links: vec![link_state], carriage: None };
                let play = Play {
                    feedback: std::slice::from_ref(&feedback),
                    state: Some(&state),
                    is_large,
                    ..Play::of(&none)
                };
                let tip = played(&link, &plan, &play).tip;
                let size = |k: usize| {
                    tip[0].displacement_m[k].hypot(tip[0].velocity_m_s[k] / omega_rad_s[mode])
                };
                let found = (size(0) / size(250)).ln() / (5.0 * TAU);
                let what = format!("{spring} N m/rad, mode {mode}, large: {is_large}");
                let off = found / ratios[mode] - 1.0;
                assert!(off.abs() < 0.03, "{what}: {found} is {off:e} off");
            }
            on_the_spring += usize::from((ratios[mode] / 0.02 - 1.0).abs() > 0.1);
        }
    }
    assert!(on_the_spring > 8, "{on_the_spring} modes store much energy in the spring");
}

/// Gains in N m/rad and N m s/rad.
type Gains = (f64, f64);

/// Feedback around the hub motion of a solution, its rate given or not.
fn around(solution: &Solution, (kp, kd): Gains, with_rate: bool) -> Feedback {
    let time_s: Vec<f64> = (0..solution.grid.len).map(|k| solution.grid.time_s(k)).collect();
    let rate = with_rate.then(|| solution.hub().rate_rad_s.clone());
    let reference = HubReference::new(&time_s, solution.hub().angle_rad.clone(), rate).unwrap();
    Feedback::new(kp, kd, reference).unwrap()
}

/// The right torque on the right link needs no feedback, whatever the gains: 3e-10 of the travel
/// with and without.
#[test]
fn feedback_has_nothing_to_do_on_the_right_link() {
    let link = damped(|_| ());
    let plan = plan_of(&link, 10);
    for (motion, tolerance) in [(sine(0.5, 0.88, 880), 1e-9), (smooth(880), 1e-10)] {
        let wanted = solved(&link, &plan, &motion, tolerance);
        let torque = torque_of(&wanted);
        for gains in [(20.0, 2.0), (1000.0, 20.0), (5.0, 0.0), (0.0, 1.0)] {
            let feedback = around(&wanted, gains, true);
            let play = Play { feedback: std::slice::from_ref(&feedback), ..Play::of(&torque) };
            let found = played(&link, &plan, &play);
            let error = difference(&found.tip[0].displacement_m, &wanted.tip[0].displacement_m);
            assert!(error < 1e-9, "{gains:?}: {error:e}");
        }
    }
}

#[test]
fn a_reference_without_rates_has_those_of_a_spline_through_it() {
    let link = damped(|_| ());
    let plan = plan_of(&link, 10);
    let wanted = solved(&link, &plan, &smooth(880), 1e-8);
    let torque = torque_of(&wanted);
    let [given, drawn] = [true, false].map(|with_rate| {
        let feedback = around(&wanted, (20.0, 5.0), with_rate);
        played(
            &link,
            &plan,
            &Play { feedback: std::slice::from_ref(&feedback), ..Play::of(&torque) },
        )
    });
    let error = difference(&drawn.tip[0].displacement_m, &given.tip[0].displacement_m);
    assert!(error < 1e-9, "{error:e}");
}

/// What the link does with a wrong payload, to 12 s: largest tip error over the travel, and the tip's
/// distance from its goal at the end in m.
fn astray(payload_kg: f64, gains: Option<Gains>) -> (f64, f64) {
    let nominal = damped(|_| ());
    let plan = plan_of(&nominal, 10);
    let wanted = solved(&nominal, &plan, &sine(0.5, 0.88, 880), 1e-6);
    let torque = torque_of(&wanted);
    let feedback = gains.map(|gains| around(&wanted, gains, true));
    let play = Play { feedback: feedback.as_slice(), until_s: Some(12.0), ..Play::of(&torque) };
    let found = played(&damped(|parts| parts.payload.mass_kg = payload_kg), &plan, &play);
    // Where it is to stay once there.
    let mut displacement_m = wanted.tip[0].displacement_m.clone();
    displacement_m.resize(found.grid.len, 0.5);
    let error = FollowedTarget::of(&found, &(&TipTarget::new(found.grid, displacement_m)).into())
        .unwrap()
        .tip_error;
    (error.share, error.final_m.abs())
}

/// Measured in % of the travel, and in mm 12 s after the motion began:
///
/// | payload | no feedback | 5 N m/rad, 1 N m s/rad | 10, 5 |
/// |---|---|---|---|
/// | +0.05 kg | 11.03 %, 51 mm | 7.29 %, 1.4 mm | 7.11 %, 0.002 mm |
/// | +0.1 kg | 20.14 %, 92 mm | 13.67 %, 3.0 mm | 13.31 %, 0.003 mm |
#[test]
fn feedback_brings_a_link_with_a_wrong_payload_nearer_and_to_its_goal() {
    let rows: [(f64, Option<Gains>, f64, std::ops::Range<f64>); 6] = [
        (0.05, None, 11.03, 50e-3..52e-3),
        (0.05, Some((5.0, 1.0)), 7.29, 1.2e-3..1.6e-3),
        (0.05, Some((10.0, 5.0)), 7.11, 0.0..1e-5),
        (0.1, None, 20.14, 91e-3..93e-3),
        (0.1, Some((5.0, 1.0)), 13.67, 2.8e-3..3.2e-3),
        (0.1, Some((10.0, 5.0)), 13.31, 0.0..1e-5),
    ];
    for (payload_kg, gains, percent, off_m) in rows {
        let (share, final_m) = astray(payload_kg, gains);
        let what = format!("{payload_kg} kg, {gains:?}");
        assert!((100.0 * share - percent).abs() < 0.03, "{what}: {:.3} %", 100.0 * share);
        assert!(off_m.contains(&final_m), "{what}: {final_m} m");
    }
}

/// A pulse that ends long before nothing moves.
fn pulse(step_s: f64, steps: u32) -> Torque {
    torque(step_s, steps, |t| (PI * t / (step_s * f64::from(steps))).sin().powi(4))
}

/// The hub angle that [`holding`] holds.
const HELD_RAD: f64 = 0.3;

/// Feedback that holds the hub where it is.
fn holding((kp, kd): Gains, torque: &Torque) -> Feedback {
    let grid = torque.grid();
    let time_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
    let still = HubReference::new(&time_s, vec![HELD_RAD; grid.len], None).unwrap();
    Feedback::new(kp, kd, still).unwrap()
}

/// The frequency at which hub stiffness and apparent inertia cancel, `λ I(λ) = k_p`: from 0 with a
/// free hub to the clamped link's. Measured: 2.2e-6 at 1 N m/rad, where the watch is fewest periods
/// long, 1e-6 elsewhere.
#[test]
fn a_stiffly_held_hub_vibrates_as_a_clamped_one() {
    let link = link(|_| ());
    let plan = plan_of(&link, 10);
    let mesh = Mesh::new(&link, &plan).unwrap();
    let clamped = Mesh::new(&super::link(|parts| parts.hub.inertia_kg_m2 = 1e12), &plan).unwrap();
    let clamped_rad_s = natural_frequencies(&clamped, 2)[0];
    let held_rad_s = |kp: f64| {
        let surplus = |omega: f64| {
            let lambda = omega * omega;
            lambda * hub_response(&mesh, lambda).inertia_kg_m2 - kp
        };
        let high = (clamped_rad_s * (1.0 - 1e-14), f64::INFINITY);
        root((0.0, -kp), high, |places| places.map(surplus))
    };
    let torque = pulse(5e-3, 100);
    for kp in [1.0, 10.0, 100.0, 1e4, 1e6, 1e8] {
        let feedback = holding((kp, 0.0), &torque);
        let found = played(
            &link,
            &plan,
            &Play { feedback: std::slice::from_ref(&feedback), ..Play::of(&torque) },
        );
        let found_hz = found.modes().unwrap().residual.unwrap().frequency_hz.unwrap();
        let error = found_hz * TAU / held_rad_s(kp) - 1.0;
        assert!(error.abs() < 1e-5, "{kp} N m/rad: {found_hz} Hz is {error:e} off");
    }
    assert!((held_rad_s(1e8) / clamped_rad_s - 1.0).abs() < 2e-7);
}

/// `I θ̈ + (k_d + b) θ̇ + k_p θ = T` under a torque switched on. The bending left falls with the
/// stiffness, 8.3e-8 rad of 0.03 rad and a tenth of that.
#[test]
fn a_stiff_link_under_feedback_is_an_oscillator_of_one_degree() {
    let (kp, kd, friction) = (30.0, 2.0, 0.5);
    let torque = torque(2e-3, 1000, |_| 0.8);
    let feedback = holding((kp, kd), &torque);
    // I = 1 kg m².
    let omega = kp.sqrt();
    let ratio = (kd + friction) / (2.0 * omega);
    let turning = omega * (1.0 - ratio * ratio).sqrt();
    for (bending_stiffness_n_m2, tolerance) in [(5e6, 4e-7), (5e7, 4e-8)] {
        let link = link(|parts| {
            for segment in &mut parts.segments {
                segment.bending_stiffness_n_m2 = Taper::constant(bending_stiffness_n_m2);
            }
            parts.hub.viscous_friction_n_m_s_rad = friction;
        });
        let play = Play {
            feedback: std::slice::from_ref(&feedback),
            interpolation: Interpolation::Linear,
            initial_tip_m: HELD_RAD * link.length_m(),
            ..Play::of(&torque)
        };
        let found = played(&link, &plan_of(&link, 4), &play);
        for (k, theta) in found.hub().angle_rad.iter().enumerate() {
            let t = found.grid.time_s(k);
            let swing = (turning * t).cos() + ratio * omega / turning * (turning * t).sin();
            let expected = 0.8 / kp * (1.0 - (-ratio * omega * t).exp() * swing);
            let error = (theta - HELD_RAD - expected).abs();
            assert!(error < tolerance, "{bending_stiffness_n_m2} N m²: {error:e} rad at {t} s");
            // The motor gives torque and feedback; friction is the joint's.
            let motor = 0.8 - kp * (theta - HELD_RAD) - kd * found.hub().rate_rad_s[k];
            assert!((found.hub().torque_n_m[k] - motor).abs() < 1e-13, "at {t} s");
        }
    }
}
