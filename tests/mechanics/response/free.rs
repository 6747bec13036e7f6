//! Torques whose answer is a closed form.

use std::f64::consts::{PI, TAU};

use super::assembly::Assembly;
use super::{damping, link, plan_of, played, times, torque};
use flexlink::beam::{Mesh, MeshPlan};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment};
use flexlink::modal::natural_frequencies;
use flexlink::response::{Interpolation, Play, Played, Torque};

/// Two bodies, hub and payload, on a beam without mass: one flexible mode.
///
/// ```text
/// ẅ + ω² w = −L T/I_H,  ω² = 3EI/L³ (1/m + L²/I_H),  v = LΘ + w I_H/I,  Θ̈ = T/I,  I = I_H + mL²
/// ```
struct TwoBodies {
    link: Link,
    plan: MeshPlan,
}

impl TwoBodies {
    const LENGTH_M: f64 = 1.2;
    const HUB_KG_M2: f64 = 0.3;
    const MASS_KG: f64 = 0.25;
    const STIFFNESS_N_M2: f64 = 6.0;
    const INERTIA_KG_M2: f64 = Self::HUB_KG_M2 + Self::MASS_KG * Self::LENGTH_M * Self::LENGTH_M;

    fn new() -> Self {
        Self::with_hub(Self::HUB_KG_M2)
    }

    fn with_hub(inertia_kg_m2: f64) -> Self {
        let beam = Segment::uniform(Self::LENGTH_M, Self::STIFFNESS_N_M2, 0.0);
        let link = Link::new(LinkParts {
            segments: vec![beam],
            hub: Hub { inertia_kg_m2, ..Hub::default() },
            payload: Payload { mass_kg: Self::MASS_KG, ..Payload::default() },
            ..LinkParts::default()
        })
        .unwrap();
        let plan = plan_of(&link, 3);
        Self { link, plan }
    }

    fn omega_rad_s() -> f64 {
        let spring = 3.0 * Self::STIFFNESS_N_M2 / Self::LENGTH_M.powi(3);
        (spring * (Self::MASS_KG.recip() + Self::LENGTH_M.powi(2) / Self::HUB_KG_M2)).sqrt()
    }

    /// So many steps in a period of the mode.
    fn step_s(steps: u32) -> f64 {
        TAU / Self::omega_rad_s() / f64::from(steps)
    }

    /// Excursion of the tip beside the rigid rotation that a torque of 1 N m holds.
    fn static_m() -> f64 {
        Self::LENGTH_M / (Self::INERTIA_KG_M2 * Self::omega_rad_s().powi(2))
    }

    fn played(&self, step_s: f64, torque: Vec<f64>, interpolation: Interpolation) -> Played {
        let steps = u32::try_from(torque.len() - 1).unwrap();
        let torque = Torque::new(&times(step_s, steps), torque).unwrap();
        let until_s = Some(2.0 * torque.grid().end_s());
        played(&self.link, &self.plan, &Play { interpolation, until_s, ..Play::of(&torque) })
    }
}

/// Round-off alone: the torque is straight between its samples, and a crest stands on a sample, for the
/// torque lasts an even number of fortieths of a period.
#[test]
fn a_torque_switched_on_and_off_swings_two_bodies_in_closed_form() {
    let (bodies, step_s, steps) = (TwoBodies::new(), TwoBodies::step_s(40), 14_u32);
    let found = bodies.played(step_s, vec![1.0; steps as usize + 1], Interpolation::Linear);
    assert_eq!(
        (found.modes().unwrap().selection.modes, found.modes().unwrap().selection.of),
        (1, 1)
    );
    let off_s = step_s * f64::from(steps);
    let omega = TwoBodies::omega_rad_s();
    let length_m = TwoBodies::LENGTH_M;
    let mut errors = [0.0_f64; 3];
    for (k, v) in found.tip[0].displacement_m.iter().enumerate() {
        let t = found.grid.time_s(k);
        let on = |t: f64| if t > 0.0 { 1.0 } else { 0.0 };
        let late = t - off_s;
        let square = |t: f64| 0.5 * t * t * on(t) / TwoBodies::INERTIA_KG_M2;
        let swing = |t: f64| (1.0 - (omega * t).cos()) * on(t);
        let turned = square(t) - square(late);
        let bent = -TwoBodies::static_m() * (swing(t) - swing(late));
        // w = bent · I/I_H, and θ = Θ − (mL/I) w.
        let hub = turned - TwoBodies::MASS_KG * length_m / TwoBodies::HUB_KG_M2 * bent;
        errors[0] = errors[0].max((v - (length_m * turned + bent)).abs());
        errors[1] = errors[1].max((found.hub().angle_rad[k] - hub).abs());
        errors[2] = errors[2].max(
            (v - length_m * found.hub().angle_rad[k]
                - bent * TwoBodies::INERTIA_KG_M2 / TwoBodies::HUB_KG_M2)
                .abs(),
        );
    }
    assert!(errors.iter().all(|error| *error < 1e-14), "{errors:?}");
    let amplitude = TwoBodies::static_m() * 2.0 * (0.5 * omega * off_s).sin().abs();
    let residual = found.modes().unwrap().residual.unwrap();
    assert!((residual.amplitude_m / amplitude - 1.0).abs() < 1e-12, "{residual:?}");
    assert!((residual.frequency_hz.unwrap() * TAU / omega - 1.0).abs() < 1e-6, "{residual:?}");
    assert_eq!(residual.decay_s, None, "an undamped link swings on");
}

/// Measured: 2.7e-10 with the fewest steps, the cubics' error.
#[test]
fn a_half_sine_leaves_two_bodies_swinging_in_closed_form() {
    let (bodies, step_s) = (TwoBodies::new(), TwoBodies::step_s(400));
    for steps in [150_u32, 320, 520] {
        let phase = |k: u32| PI * f64::from(k) / f64::from(steps);
        let torque = (0..=steps).map(|k| phase(k).sin()).collect();
        let found = bodies.played(step_s, torque, Interpolation::Cubic);
        // β = Ω/ω with Ω = π/duration: so many half periods of the mode in one of the torque.
        let beta = 200.0 / f64::from(steps);
        let factor = (2.0 * beta * (0.5 * PI / beta).cos() / (beta * beta - 1.0)).abs();
        let amplitude = TwoBodies::static_m() * factor;
        let error = found.modes().unwrap().residual.unwrap().amplitude_m / amplitude - 1.0;
        assert!(error.abs() < 1e-9, "{steps} steps: {error:e}");
        // ∫T dt = 2/π · duration turns the rigid link at a rate.
        let turned = found.grid.end_s() - 0.5 * step_s * f64::from(steps);
        let rate = 2.0 / PI * step_s * f64::from(steps) / TwoBodies::INERTIA_KG_M2;
        let last = found.tip[0].displacement_m.len() - 1;
        let momentum = TwoBodies::HUB_KG_M2 * found.hub().angle_rad[last]
            + TwoBodies::MASS_KG * TwoBodies::LENGTH_M * found.tip[0].displacement_m[last];
        let error = momentum / (TwoBodies::INERTIA_KG_M2 * rate * turned) - 1.0;
        assert!(error.abs() < 1e-9, "{steps} steps: {error:e}");
    }
}

/// Straight lines up and down again over two steps: an impulse T Δt, less the vibration that its
/// width costs.
#[test]
fn a_knock_leaves_its_impulse_in_the_rigid_link_and_in_its_mode() {
    let (bodies, step_s) = (TwoBodies::new(), TwoBodies::step_s(40));
    let found = bodies.played(step_s, vec![0.0, 0.0, 1.0, 0.0, 0.0], Interpolation::Linear);
    let omega = TwoBodies::omega_rad_s();
    let half = 0.5 * omega * step_s;
    let amplitude = TwoBodies::static_m() * omega * step_s * (half.sin() / half).powi(2);
    let error = found.modes().unwrap().residual.unwrap().amplitude_m / amplitude - 1.0;
    assert!(error.abs() < 1e-12, "{error:e}");
    let last = found.grid.len - 1;
    let momentum = TwoBodies::HUB_KG_M2 * found.hub().rate_rad_s[last]
        + TwoBodies::MASS_KG * TwoBodies::LENGTH_M * found.tip[0].velocity_m_s[last];
    assert!((momentum / step_s - 1.0).abs() < 1e-12, "{momentum}");
}

/// The torque for a deflection w = sin⁶ cos, which leaves neither vibration nor rate. Measured: 6e-13
/// of the travel swings on, the travel itself is 5e-10 off.
#[test]
fn a_torque_from_rest_to_rest_leaves_nothing_swinging() {
    let (bodies, step_s, steps) = (TwoBodies::new(), TwoBodies::step_s(200), 400_u32);
    let (omega, duration_s) = (TwoBodies::omega_rad_s(), step_s * f64::from(steps));
    let per_s = PI / duration_s;
    let torque = (0..=steps).map(|k| {
        let x = per_s * step_s * f64::from(k);
        let (sin, cos) = x.sin_cos();
        let bent = sin.powi(6) * cos;
        // d²/dx² sin⁶ cos = (30 − 49 sin²) sin⁴ cos.
        let curved = (30.0 - 49.0 * sin * sin) * sin.powi(4) * cos * per_s * per_s;
        -TwoBodies::HUB_KG_M2 / TwoBodies::LENGTH_M * (curved + omega * omega * bent)
    });
    let found = bodies.played(step_s, torque.collect(), Interpolation::Cubic);
    assert!(
        found.modes().unwrap().residual.unwrap().share < 1e-11,
        "{:?}",
        found.modes().unwrap().residual.unwrap()
    );
    // ∬ w = t²/(7π²) ∫ sin⁷ = t²/(7π²) · 32/35.
    let turned = -TwoBodies::HUB_KG_M2 / (TwoBodies::LENGTH_M * TwoBodies::INERTIA_KG_M2)
        * omega
        * omega
        * duration_s.powi(2)
        / (7.0 * PI * PI)
        * 32.0
        / 35.0;
    let travel = found.tip[0].displacement_m[found.grid.len - 1];
    assert!((travel / (TwoBodies::LENGTH_M * turned) - 1.0).abs() < 1e-9);
}

/// q̈ + 2ζωq̇ + ω²q = p T from rest, T a step at t = 0.
fn step_answer(omega: f64, ratio: f64, t: f64) -> f64 {
    let damped = omega * (1.0 - ratio * ratio).sqrt();
    let decay = (-ratio * omega * t).exp();
    let swing = (damped * t).cos() + ratio * omega / damped * (damped * t).sin();
    (1.0 - decay * swing) / (omega * omega)
}

/// A hub too light to lag behind: the angle by which the beam is bent comes on top at once, and once.
/// What the only mode leaves over is round-off, more of it the lighter the hub.
#[test]
fn a_light_hub_turns_ahead_of_the_payload_by_what_the_beam_bends() {
    for inertia_kg_m2 in [1e-8, 1e-9, 1e-10, 1e-11] {
        let bodies = TwoBodies::with_hub(inertia_kg_m2);
        let torque: Vec<f64> =
            (0..=100).map(|k| (PI * f64::from(k) / 100.0).sin().powi(8)).collect();
        let found = bodies.played(1e-2, torque.clone(), Interpolation::Cubic);
        let length_m = TwoBodies::LENGTH_M;
        let per_torque = length_m / (3.0 * TwoBodies::STIFFNESS_N_M2);
        for (k, t) in torque.iter().enumerate() {
            let ahead = found.hub().angle_rad[k] - found.tip[0].displacement_m[k] / length_m;
            assert!((ahead / per_torque - t).abs() < 1e-6, "{inertia_kg_m2} kg m², sample {k}");
        }
    }
}

/// Tip and hub angle turn by T t²/2I, and every mode swings around what T holds it bent to; modes
/// and shapes are those of assembled matrices. Measured: 2.7e-13 m.
#[test]
fn a_constant_torque_turns_the_rigid_link_and_swings_every_mode() {
    for ratio in [0.0, 0.02] {
        let link = link(|parts| parts.damping = Damping::Modal { ratios: vec![ratio] });
        let plan = plan_of(&link, 10);
        let torque = torque(1e-3, 1500, |_| 0.8);
        let found = played(&link, &plan, &Play::of(&torque));
        assert_eq!(
            found.modes().unwrap().selection.modes,
            found.modes().unwrap().selection.of,
            "all modes"
        );
        let mesh = Mesh::new(&link, &plan).unwrap();
        let [mass, stiffness] = Assembly::of_link(&link, mesh.nodes_m()).mass_and_stiffness();
        let (frequencies, shapes) = damping::modes(&mass, &stiffness);
        let tip = mass.nrows() - 2;
        let bent = |row: usize, t: f64| -> f64 {
            let modes = frequencies.iter().enumerate().skip(1);
            let shares = modes.map(|(k, omega)| {
                shapes[(row, k)] * shapes[(0, k)] * step_answer(*omega, ratio, t)
            });
            0.8 * shares.sum::<f64>()
        };
        let mut errors = [0.0_f64; 2];
        for (k, v) in found.tip[0].displacement_m.iter().enumerate() {
            let t = found.grid.time_s(k);
            // I = 1 kg m².
            let turned = 0.5 * 0.8 * t * t;
            errors[0] = errors[0].max((v - (1.5 * turned + bent(tip, t))).abs());
            errors[1] = errors[1].max((found.hub().angle_rad[k] - (turned + bent(0, t))).abs());
        }
        assert!(errors.iter().all(|error| *error < 2e-12), "{errors:?}");
    }
}

/// A smooth torque over two periods of the first mode and a half: the others hardly swing.
fn shoved(link: &Link) -> Played {
    let torque = torque(1e-3, 1300, |t| (PI * t / 1.3).sin().powi(4));
    played(link, &plan_of(link, 10), &Play::of(&torque))
}

/// Frequencies within 3e-6, where a fifth of the decay fits into a period 1.1e-4; the time is that
/// from a crest, so that it may lie half a period off.
#[test]
fn the_first_mode_decays_at_its_own_rate_and_frequency() {
    for (ratio, tolerance) in [(0.01, 2e-5), (0.02, 2e-5), (0.05, 2e-5), (0.1, 5e-4)] {
        let link = link(|parts| parts.damping = Damping::Modal { ratios: vec![ratio, 0.3] });
        let found = shoved(&link);
        let omega = natural_frequencies(found.mesh(), 1)[0];
        let damped_hz = omega / TAU * (1.0 - ratio * ratio).sqrt();
        let frequency_hz = found.modes().unwrap().residual.unwrap().frequency_hz.unwrap();
        assert!((frequency_hz / damped_hz - 1.0).abs() < tolerance, "{ratio}: {frequency_hz} Hz");
        let decay_s = found.modes().unwrap().residual.unwrap().decay_s.unwrap();
        let periods = (decay_s - 100.0_f64.ln() / (ratio * omega)) * damped_hz;
        assert!(periods.abs() < 0.5, "{ratio}: {periods} periods off at {decay_s} s");
    }
}

#[test]
fn an_undamped_link_swings_on_in_its_first_mode() {
    let found = shoved(&link(|_| ()));
    let first_hz = natural_frequencies(found.mesh(), 1)[0] / TAU;
    let residual = found.modes().unwrap().residual.unwrap();
    assert!((residual.frequency_hz.unwrap() / first_hz - 1.0).abs() < 5e-6, "{residual:?}");
    assert_eq!(residual.decay_s, None);
    assert!(residual.share > 0.01, "{residual:?}");
}

/// ln 100/(ζω) of the first mode: the others are gone by then.
#[test]
fn a_decay_over_hundreds_of_periods_is_told() {
    let link = link(|parts| parts.damping = Damping::Modal { ratios: vec![0.0025, 0.05] });
    let found = shoved(&link);
    let omega = found.links[0].natural_frequencies_rad_s[0];
    let expected = 100.0_f64.ln() / (0.0025 * omega);
    let decay_s = found.modes().unwrap().residual.unwrap().decay_s.unwrap();
    // The crests of a cosine stand half a period apart.
    assert!((decay_s - expected).abs() < TAU / omega, "{decay_s} s is not {expected} s");
}
