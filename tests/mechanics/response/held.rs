//! A hub that moves as prescribed: against the inversion, closed forms, an independent integrator and the
//! balance of energy.

use std::f64::consts::{PI, TAU};

use super::{difference, link, loaded, plan_of, played, simulate, smooth, solved};
use crate::common::peak;
use crate::recordings::ninth;
use flexlink::beam::{Mesh, MeshPlan};
use flexlink::inverse::Solution;
use flexlink::link::{Damping, Link};
use flexlink::modal::held_frequencies;
use flexlink::response::{HubReference, Play, Played, SimulationWarning};

fn hub_of(wanted: &Solution, every: usize) -> HubReference {
    let grid = &wanted.grid;
    let samples = (0..grid.len).step_by(every);
    let (time_s, angle): (Vec<f64>, Vec<f64>) =
        samples.map(|k| (grid.time_s(k), wanted.hub().angle_rad[k])).unzip();
    HubReference::new(&time_s, angle, None).unwrap()
}

fn turned(link: &Link, plan: &MeshPlan, hub: &HubReference) -> Played {
    played(link, plan, &Play::turning(hub))
}

/// The hub angle of the inversion moves the tip as was wanted, by the torque of the inversion.
#[test]
fn the_hub_of_a_solution_brings_back_its_tip_and_its_torque_under_every_law() {
    let laws = [
        Damping::None,
        Damping::RayleighThroughModes { modes: [1, 3], ratios: [0.02; 2] },
        Damping::Modal { ratios: vec![0.02] },
        Damping::Modal { ratios: vec![0.01, 0.05, 0.02] },
        Damping::Caughey { modes: vec![1, 2], ratios: vec![0.02; 2] },
    ];
    for law in laws {
        let link = loaded(law.clone());
        let plan = plan_of(&link, 10);
        let wanted = solved(&link, &plan, &smooth(880), 1e-10);
        let found = turned(&link, &plan, &hub_of(&wanted, 1));
        let errors = [
            difference(&found.tip[0].displacement_m, &wanted.tip[0].displacement_m),
            difference(&found.tip[0].acceleration_m_s2, &wanted.tip[0].acceleration_m_s2),
            difference(&found.hub().angle_rad, &wanted.hub().angle_rad),
            difference(&found.hub().torque_n_m, &wanted.hub().torque_n_m),
        ];
        println!("{law:?}: {errors:?}");
        assert!(errors.iter().all(|error| *error < 1e-7), "{law:?}: {errors:?}");
        assert!(
            found.modes().unwrap().residual.unwrap().share < 1e-6,
            "{law:?}: {:e}",
            found.modes().unwrap().residual.unwrap().share
        );
        let is_of_hub = |warning: &SimulationWarning| warning.kind().starts_with("hub");
        assert!(!found.warnings.iter().any(is_of_hub), "{:?}", found.warnings);
    }
}

/// The acceleration of the quintic spline has an error of fourth order.
#[test]
fn the_torque_follows_with_the_fourth_power_of_the_step() {
    let link = loaded(Damping::Modal { ratios: vec![0.02] });
    let plan = plan_of(&link, 10);
    let wanted = solved(&link, &plan, &smooth(880), 1e-10);
    let error = |every: usize| {
        let found = turned(&link, &plan, &hub_of(&wanted, every));
        let kept = wanted.hub().torque_n_m.iter().step_by(every);
        difference(&found.hub().torque_n_m, &kept.copied().collect::<Vec<_>>())
    };
    let errors = [10, 20, 40].map(error);
    println!("{errors:?}");
    assert!((errors[1] / errors[0]).log2() > 3.5 && (errors[2] / errors[1]).log2() > 3.5);
}

/// Far below a resonance hysteretic damping lags by 2ξ of the deflection, a fifth of the length here, and the
/// viscous one that is played hardly at all: physics, not error.
#[test]
fn a_hysteretic_link_strays_by_a_share_of_its_deflection() {
    let link = loaded(Damping::Hysteretic { ratio: 0.02 });
    let plan = plan_of(&link, 10);
    let wanted = solved(&link, &plan, &smooth(880), 1e-10);
    let found = turned(&link, &plan, &hub_of(&wanted, 1));
    let tip = difference(&found.tip[0].displacement_m, &wanted.tip[0].displacement_m);
    assert!((0.01..0.02).contains(&tip), "{tip:e}");
}

/// A quarter turn by a smooth step within 0.5 s, then rest.
fn quick_turn(end_s: f64, step_s: f64) -> HubReference {
    let count = (end_s / step_s).round();
    let time_s: Vec<f64> =
        (0_i32..=100_000).map(f64::from).take_while(|k| *k <= count).map(|k| k * step_s).collect();
    let angle = time_s.iter().map(|t| angle_rad(*t)).collect();
    HubReference::new(&time_s, angle, None).unwrap()
}

fn angle_rad(t: f64) -> f64 {
    0.5 * PI * 0.05 * ninth(t / 0.5)[0]
}

/// θ̈ of that step.
fn acceleration_rad_s2(t: f64) -> f64 {
    0.5 * PI * 0.05 * ninth(t / 0.5)[2] / 0.25
}

/// A uniform cantilever, EI 5 N m², 0.8 kg/m, 1.5 m: `cos β cosh β = −1`.
const ROOTS: [f64; 4] =
    [1.875_104_068_711_961, 4.694_091_132_974_175, 7.854_757_438_237_613, 10.995_540_734_875_467];

fn cantilever(ratio: f64, hub_kg_m2: f64) -> Link {
    link(|parts| {
        parts.segments.remove(0);
        parts.segments[0].length_m = 1.5;
        parts.hub.inertia_kg_m2 = hub_kg_m2;
        parts.damping = Damping::Hysteretic { ratio };
    })
}

fn cantilever_rad_s(root: f64) -> f64 {
    root * root / 2.25 * (5.0_f64 / 0.8).sqrt()
}

/// ∫ φ x dx of a mode with unit `∫ φ² dx` over the length 1, and its value at the tip: 2/β², ±2.
fn participation(mode: usize) -> (f64, f64) {
    (2.0 / ROOTS[mode].powi(2), if mode.is_multiple_of(2) { 2.0 } else { -2.0 })
}

/// Modes of the cantilever, each integrated by Duhamel's integral with small steps: nothing of this program.
#[test]
fn a_turned_cantilever_is_the_sum_of_its_modes() {
    let ratio = 0.01;
    let hub = quick_turn(3.0, 0.002);
    for hub_kg_m2 in [0.003, 0.1, 5.0] {
        let beam = cantilever(ratio, hub_kg_m2);
        let found = turned(&beam, &plan_of(&beam, 24), &hub);
        let mut exact: Vec<f64> =
            (0..=1500).map(|k| 1.5 * angle_rad(0.002 * f64::from(k))).collect();
        for (mode, root) in ROOTS.iter().enumerate() {
            let (moment, tip) = participation(mode);
            let omega = cantilever_rad_s(*root);
            // m L² (∫ φ x) over m L, times the tip.
            let eta = oscillator(omega, ratio, 1500, 20);
            for (v, eta) in exact.iter_mut().zip(eta) {
                *v -= 1.5 * moment * tip * eta;
            }
        }
        let bent = found.tip_deflection_m();
        let error = difference(&found.tip[0].displacement_m, &exact);
        println!("hub {hub_kg_m2}: {error:e}, deflection {:e}", flexlink::numeric::largest(&bent));
        assert!(error < 1e-5, "hub {hub_kg_m2}: {error:e}");
    }
}

/// η̈ + 2ζω η̇ + ω² η = θ̈ by Runge and Kutta's method, at every 2 ms.
fn oscillator(omega: f64, ratio: f64, steps: u32, parts: u32) -> Vec<f64> {
    let h = 0.002 / f64::from(parts);
    let slope = |t: f64, [x, v]: [f64; 2]| {
        [v, acceleration_rad_s2(t) - 2.0 * ratio * omega * v - omega * omega * x]
    };
    let mut state = [0.0; 2];
    let mut found = vec![0.0];
    for k in 0..steps * parts {
        let t = h * f64::from(k);
        let moved = |by: [f64; 2], h: f64| [state[0] + h * by[0], state[1] + h * by[1]];
        let a = slope(t, state);
        let b = slope(t + 0.5 * h, moved(a, 0.5 * h));
        let c = slope(t + 0.5 * h, moved(b, 0.5 * h));
        let d = slope(t + h, moved(c, h));
        let sum = |i: usize| h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
        state = [state[0] + sum(0), state[1] + sum(1)];
        if (k + 1) % parts == 0 {
            found.push(state[0]);
        }
    }
    found
}

#[test]
fn what_vibrates_after_the_hub_stopped_is_the_cantilever_with_its_own_decay() {
    let beam = cantilever(0.01, 0.003);
    let found = turned(&beam, &plan_of(&beam, 24), &quick_turn(0.5, 0.002));
    let hertz = cantilever_rad_s(ROOTS[0]) / TAU;
    let vibrates = found.modes().unwrap().residual.unwrap().frequency_hz.unwrap();
    assert!((vibrates / hertz - 1.0).abs() < 2e-3, "{vibrates} Hz is not {hertz} Hz");
    // e^(−ζωt) = 0.01
    let decays_s = 100.0_f64.ln() / (0.01 * cantilever_rad_s(ROOTS[0]));
    let decay_s = found.modes().unwrap().residual.unwrap().decay_s.unwrap();
    assert!((decay_s / decays_s - 1.0).abs() < 0.03, "{decay_s} s is not {decays_s} s");
}

#[test]
fn work_is_what_is_stored_and_lost_whatever_the_law() {
    let laws = [
        Damping::None,
        Damping::RayleighThroughModes { modes: [1, 3], ratios: [0.02; 2] },
        Damping::Modal { ratios: vec![0.01, 0.05, 0.02] },
        Damping::Hysteretic { ratio: 0.02 },
    ];
    for law in laws {
        let link = loaded(law.clone());
        let found = turned(&link, &plan_of(&link, 10), &quick_turn(2.0, 0.001));
        let account = found.energy(20);
        let whole = account.balances.iter().map(|b| b.kinetic_j + b.strain_j).fold(0.0, f64::max);
        for balance in &account.balances {
            let kept = balance.kinetic_j + balance.strain_j + balance.dissipated_j;
            let error = (balance.work_j - kept).abs() / whole;
            assert!(error < 1e-6, "{law:?} at {} s: {error:e}", balance.time_s);
        }
    }
}

#[test]
fn a_hub_that_moves_at_its_start_or_end_is_told_and_one_that_rests_is_refused() {
    let time_s: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
    let ramp = HubReference::new(&time_s, time_s.iter().map(|t| 0.1 * t).collect(), None).unwrap();
    let link = loaded(Damping::None);
    let plan = plan_of(&link, 10);
    let warnings = turned(&link, &plan, &ramp).warnings;
    let told: Vec<_> = warnings.iter().map(SimulationWarning::kind).collect();
    assert_eq!(told[0], "hub_begins_moving", "{told:?}");
    // It stops within the step after its last sample, of which a warning tells if the simulation goes on.
    assert!(!told.contains(&"hub_ends_moving"), "{told:?}");
    let play = Play { until_s: Some(4.0), ..Play::turning(&ramp) };
    let found = played(&link, &plan, &play);
    assert!(found.hub().angle_rad[199..].iter().all(|angle| (angle - 0.199).abs() < 1e-9));
    let told: Vec<_> = found.warnings.iter().map(SimulationWarning::kind).collect();
    assert_eq!(told[..2], ["hub_begins_moving", "hub_ends_moving"], "{told:?}");
    let still = HubReference::new(&time_s, vec![0.3; 200], None).unwrap();
    let error = simulate(&link, &plan, &Play::turning(&still)).unwrap_err();
    let expected = "the hub angle is the same in all samples, but must move the link";
    assert_eq!(error.to_string(), expected);
}

/// An encoder of 4096 counts a turn: the torque is noise, and is said to be; the tip is off by half a count.
#[test]
fn the_steps_of_an_encoder_are_in_the_torque_and_hardly_in_the_tip() {
    let link = loaded(Damping::Modal { ratios: vec![0.02] });
    let plan = plan_of(&link, 10);
    let exact = quick_turn(2.0, 0.001);
    let smooth = turned(&link, &plan, &exact);
    let count = TAU / 4096.0;
    let time_s: Vec<f64> = (0..exact.grid().len).map(|k| exact.grid().time_s(k)).collect();
    let counted = exact.angle_rad().iter().map(|angle| (angle / count).round() * count).collect();
    let rough = turned(&link, &plan, &HubReference::new(&time_s, counted, None).unwrap());
    let off = difference(&rough.tip[0].displacement_m, &smooth.tip[0].displacement_m);
    let travel = peak(&smooth.tip[0].displacement_m);
    assert!(off * travel < 2.0 * 0.5 * count * link.length_m(), "{off:e} of {travel} m");
    assert!(difference(&rough.hub().torque_n_m, &smooth.hub().torque_n_m) > 1.0);
    let kinds = |played: &Played| -> Vec<_> {
        played.warnings.iter().map(SimulationWarning::kind).collect()
    };
    assert!(kinds(&rough).contains(&"rough_torque"), "{:?}", rough.warnings);
    assert!(!kinds(&smooth).contains(&"rough_torque"), "{:?}", smooth.warnings);
}

/// After a recording that ends at rest only the link moves; an angle is an absolute one.
#[test]
fn the_hub_rests_after_a_rest_and_points_to_the_tip_before_its_first_sample() {
    let link = loaded(Damping::Hysteretic { ratio: 0.02 });
    let plan = plan_of(&link, 10);
    let hub = quick_turn(0.6, 0.001);
    let time_s: Vec<f64> = (0..hub.grid().len).map(|k| hub.grid().time_s(k)).collect();
    let offset = hub.angle_rad().iter().map(|angle| angle + 0.7).collect();
    let hub = HubReference::new(&time_s, offset, None).unwrap();
    let found = played(&link, &plan, &Play { until_s: Some(3.0), ..Play::turning(&hub) });
    assert!((found.hub().angle_rad[0] - 0.7).abs() < 1e-15);
    assert!((found.tip[0].displacement_m[0] - 0.7 * link.length_m()).abs() < 1e-15);
    let end = 0.7 + 0.025 * PI;
    let after = &found.hub().angle_rad[600..];
    assert!(after.iter().all(|angle| (angle - end).abs() < 1e-12), "{:e}", after[2000] - end);
    assert!(found.hub().rate_rad_s[600..].iter().all(|rate| rate.abs() < 1e-11));
    let torque = &found.hub().torque_n_m[700..];
    assert!(torque.iter().any(|torque| torque.abs() > 0.01), "the link still pulls");
    // The held frequency of the recursion.
    let mesh = Mesh::new(&link, &plan).unwrap();
    let hertz = held_frequencies(&mesh, f64::INFINITY, 1)[0] / TAU;
    let vibrates = found.modes().unwrap().residual.unwrap().frequency_hz.unwrap();
    assert!((vibrates / hertz - 1.0).abs() < 2e-3, "{vibrates} Hz is not {hertz} Hz");
}
