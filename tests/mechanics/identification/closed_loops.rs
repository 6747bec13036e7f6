//! Zeros in the dips of closed loops around the hub of a link of the closed form.

use std::f64::consts::TAU;

use flexlink::fit::{Gain, HubEnd, Measured, Measurements, Observable, Response};
use flexlink::model::Sensor;
use num_complex::Complex64;

use super::synthetic::Truth;
use super::{fitted, free_text, per_torque};
use crate::recordings::Random;

const RATIO: f64 = 0.01;
const LAW: Complex64 = Complex64::new(1.0, 2.0 * RATIO);

/// The controller that a rig may have: proportional and derivative gain, a lag of 2 ms, a delay of 1 ms.
fn controller(omega: f64) -> Complex64 {
    let s = Complex64::new(0.0, omega);
    (20.0 + 4.0 * s) / (1.0 + 0.002 * s) * (-0.001 * s).exp()
}

/// Reference of the hub's angle → `sensor`, from 0.3 to 15 Hz: the next dip is shallow.
fn closed_loop(sensor: Sensor, points: i32) -> (Vec<f64>, Vec<Complex64>) {
    let hertz = |k: i32| 0.3 * 50_f64.powf(f64::from(k) / f64::from(points - 1));
    let frequencies: Vec<f64> = (0..points).map(hertz).collect();
    let value = |hertz: &f64| {
        let (omega, c) = (TAU * hertz, controller(TAU * hertz));
        let angle = per_torque(Sensor::HubAngle, omega, LAW);
        c * per_torque(sensor, omega, LAW) / (1.0 + c * angle)
    };
    let values = frequencies.iter().map(value).collect();
    (frequencies, values)
}

/// The zeros that are read from a loop with noise.
fn zeros(
    (frequencies, values): &(Vec<f64>, Vec<Complex64>),
    noise: f64,
    seed: u64,
) -> Vec<Measured> {
    let mut random = Random(seed);
    let mut factor = || 1.0 + Complex64::new(random.box_muller(), random.box_muller()) * noise;
    let values = values.iter().map(|value| value * factor()).collect();
    let kind = (Sensor::HubAngle, Gain::Known);
    let rows = (frequencies.clone(), values);
    Response::new("loop.csv".into(), kind, Some(noise), rows).unwrap().zeros(1)
}

/// Frequencies of the clamped link below 15 Hz, for the stiffness whose damped zeros have this magnitude.
fn exact() -> Vec<f64> {
    let truth = Truth {
        length: 1.5,
        stiffness: 5.0 * LAW.norm(),
        mass_per_length: 0.8,
        hub: 0.1,
        payload: 0.3,
    };
    let all = truth.frequencies(HubEnd::Held, 10);
    all.into_iter().filter(|hertz| *hertz > 0.3 && *hertz < 15.0).collect()
}

#[test]
fn zeros_of_noisy_loops_lie_within_their_uncertainties() {
    let exact = exact();
    for (points, noise) in [(300, 0.02), (300, 0.05), (1000, 0.1)] {
        let (mut within, mut all) = (0, 0);
        let closed_loop = closed_loop(Sensor::HubAngle, points);
        for seed in 0..100 {
            let zeros = zeros(&closed_loop, noise, seed);
            assert_eq!(zeros.len(), exact.len(), "{points} {noise} {seed}: {zeros:?}");
            for (k, (zero, exact)) in zeros.iter().zip(&exact).enumerate() {
                assert_eq!(zero.observable, Observable::Zero { zero: k + 1 });
                let uncertainty = zero.uncertainty.unwrap();
                assert!(uncertainty < 0.3 * noise * exact, "{zero:?}");
                within += i32::from((zero.value - exact).abs() < 2.0 * uncertainty);
                all += 1;
            }
        }
        let share = f64::from(within) / f64::from(all);
        assert!((0.90..0.99).contains(&share), "{points} {noise}: {share}");
    }
}

#[test]
fn the_fit_of_a_closed_loop_finds_the_stiffness() {
    let zeros = zeros(&closed_loop(Sensor::HubRate, 500), 0.02, 3);
    let measured = Measurements::new(zeros, vec![], vec![]).unwrap();
    let text = free_text([7.0, 0.8, 0.1, 0.2], "ratio = 0.01");
    let found = fitted(&text, &measured, &["segments.*.EI", "payload.mass"]).unwrap();
    assert_eq!(found.misfit, None, "{found:?}");
    for (value, exact) in found.values.iter().zip([5.0 / 7.0 * LAW.norm(), 1.5]) {
        let error = value.relative_standard_error.unwrap();
        assert!(error < 0.003, "{value:?}");
        assert!((value.factor / exact).ln().abs() < 3.0 * error, "{value:?}, not {exact}");
    }
}

/// The deflection of the tip has valleys between its poles, but no zeros in them.
#[test]
fn valleys_without_a_rising_phase_are_no_zeros() {
    let valleys = closed_loop(Sensor::TipAcceleration, 300);
    for seed in 0..20 {
        assert_eq!(zeros(&valleys, 0.02, seed), [], "{seed}");
    }
}
