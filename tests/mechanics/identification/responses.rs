//! Links fitted to frequency responses of the closed form, with noise.

use std::f64::consts::TAU;

use flexlink::fit::{FitOutcome, Gain, Measurements, Misfit, Motor, Response};
use flexlink::model::Sensor;
use num_complex::Complex64;

use super::{fitted, free_text, per_torque};
use crate::recordings::Random;

const RATIO: f64 = 0.02;

const SENSORS: [Sensor; 5] = [
    Sensor::HubAngle,
    Sensor::HubRate,
    Sensor::TipDeflection,
    Sensor::TipAcceleration,
    Sensor::RootStrain,
];

/// All values that a response in SI determines.
const ALL: [&str; 5] =
    ["segments.*.EI", "segments.*.mass_per_length", "hub.inertia", "payload.mass", "damping.ratio"];

/// A response of so many frequencies from 0.3 to 30 Hz, each value with noise of 2 %, taken for `transfer`.
fn response(
    measured: Sensor,
    (transfer, gain): (Sensor, Gain),
    scale: f64,
    points: i32,
) -> Measurements {
    let noise = 0.02;
    let mut random = Random(7);
    let hertz = |k: i32| 0.3 * 100_f64.powf(f64::from(k) / f64::from(points - 1));
    let frequencies: Vec<f64> = (0..points).map(hertz).collect();
    let values = frequencies.iter().map(|hertz| {
        let off = Complex64::new(random.box_muller(), random.box_muller()) * noise;
        per_torque(measured, TAU * hertz, Complex64::new(1.0, 2.0 * RATIO)) * scale * (1.0 + off)
    });
    let rows = (frequencies.clone(), values.collect());
    let response = Response::new("frf.csv".into(), (transfer, gain), Some(noise), rows).unwrap();
    Measurements::new(vec![], vec![response], vec![]).unwrap()
}

/// Fits from a file whose values are all wrong.
fn fit(measured: &Measurements, free: &[&str]) -> FitOutcome {
    let text = free_text([7.0, 0.6, 0.13, 0.2], "ratio = 0.012");
    fitted(&text, measured, free).unwrap()
}

#[test]
fn a_response_in_si_determines_all_five_values() {
    for transfer in SENSORS {
        let found = fit(&response(transfer, (transfer, Gain::Known), 1.0, 300), &ALL);
        assert_eq!((&found.misfit, found.undetermined.len()), (&None, 0), "{found:?}");
        let exact = [5.0 / 7.0, 0.8 / 0.6, 0.1 / 0.13, 0.3 / 0.2, RATIO / 0.012];
        for (value, exact) in found.values.iter().zip(exact) {
            let error = value.relative_standard_error.unwrap();
            assert!(error < 0.02, "{value:?}");
            assert!((value.factor / exact).ln().abs() < 3.0 * error, "{value:?}, not {exact}");
        }
    }
}

#[test]
fn a_free_gain_leaves_the_scale_open() {
    let measured = response(Sensor::HubAngle, (Sensor::HubAngle, Gain::Free), 40.0, 100);
    let found = fit(&measured, &ALL);
    assert_eq!(found.undetermined.len(), 1, "{found:?}");
    let powers = &found.undetermined[0].powers;
    let paths: Vec<&str> = powers.iter().map(|(path, _)| path.as_str()).collect();
    assert_eq!(paths, &ALL[..4]);
    let found = fit(&measured, &["segments.*.EI", "payload.mass", "hub.inertia", "damping.ratio"]);
    assert_eq!(found.undetermined.len(), 0, "{found:?}");
    // The file's mass per length is 0.6 instead of 0.8: so is the whole link lighter.
    let gain = found.responses[0].gain.unwrap();
    assert!((gain / (40.0 * 0.6 / 0.8) - 1.0).abs() < 0.02, "{gain}");
}

#[test]
fn a_response_of_another_transfer_is_no_fit() {
    let measured = response(Sensor::HubAngle, (Sensor::HubRate, Gain::Known), 1.0, 100);
    let found = fit(&measured, &ALL);
    assert!(matches!(found.misfit, Some(Misfit::Far { .. })), "{found:?}");
}

/// `y/V = k (y/T)/(1 + iω f θ/T)` with `k = N k_t/R` and the friction `f = (N k_t)²/R`, the sign turned.
#[test]
fn a_response_per_volt_of_unknown_sign_is_that_of_the_driven_motor() {
    let (constant, resistance, gear) = (0.042, 8.4, 30.0);
    let motor = Motor::new(constant, resistance, gear).unwrap();
    let law = Complex64::new(1.0, 2.0 * RATIO);
    let noise = 0.02;
    let mut random = Random(8);
    let frequencies: Vec<f64> =
        (0..200).map(|k| 0.3 * 100_f64.powf(f64::from(k) / 199.0)).collect();
    let value = |hertz: &f64| {
        let omega = TAU * hertz;
        let friction = (gear * constant).powi(2) / resistance;
        let angle = per_torque(Sensor::HubAngle, omega, law);
        let driven = 1.0 + Complex64::new(0.0, omega * friction) * angle;
        let exact =
            gear * constant / resistance * per_torque(Sensor::RootStrain, omega, law) / driven;
        -exact * (1.0 + Complex64::new(random.box_muller(), random.box_muller()) * noise)
    };
    let values: Vec<Complex64> = frequencies.iter().map(value).collect();
    let fitted = |gain| {
        let rows = (frequencies.clone(), values.clone());
        let response =
            Response::new("frf.csv".into(), (Sensor::RootStrain, gain), Some(noise), rows);
        let response = response.unwrap().per_volt(&motor);
        fit(&Measurements::new(vec![], vec![response], vec![]).unwrap(), &ALL)
    };
    let found = fitted(Gain::Sign);
    assert_eq!((&found.misfit, found.undetermined.len()), (&None, 0), "{found:?}");
    let exact = [5.0 / 7.0, 0.8 / 0.6, 0.1 / 0.13, 0.3 / 0.2, RATIO / 0.012];
    for (value, exact) in found.values.iter().zip(exact) {
        let error = value.relative_standard_error.unwrap();
        assert!((value.factor / exact).ln().abs() < 3.0 * error, "{value:?}, not {exact}");
    }
    assert!(matches!(fitted(Gain::Known).misfit, Some(Misfit::Far { .. })));
}

/// The standard error of the stiffness, or of the damping ratio, alone is 1/√(Σ |∂H/∂x|²/σ²). Here the derivative of the
/// closed form is Cauchy's integral on a circle around its complex stiffness; the fit takes central differences of
/// fourth order. Measured: 1e-9.
#[test]
fn standard_errors_are_those_of_exact_derivatives() {
    let text = free_text([5.0, 0.8, 0.1, 0.3], &format!("ratio = {RATIO}"));
    let stiffness = Complex64::new(1.0, 2.0 * RATIO);
    let (noise, points, circle) = (0.02, 300, 32);
    let hertz: Vec<f64> = (0..points).map(|k| 0.3 * 100_f64.powf(f64::from(k) / 299.0)).collect();
    for sensor in SENSORS {
        let at = |hertz: &f64, stiffness| per_torque(sensor, TAU * hertz, stiffness);
        let values = hertz.iter().map(|hertz| at(hertz, stiffness)).collect();
        let rows = (hertz.clone(), values);
        let response =
            Response::new("frf.csv".into(), (sensor, Gain::Known), Some(noise), rows).unwrap();
        let measured = Measurements::new(vec![], vec![response], vec![]).unwrap();
        // Of each value over itself, per logarithm of the stiffness and of the ratio.
        let slopes = hertz.iter().map(|hertz| {
            let radius = 0.01;
            let around = (0..circle).map(|k| {
                let turned = Complex64::cis(TAU * f64::from(k) / f64::from(circle));
                at(hertz, stiffness + radius * turned) / turned
            });
            let slope = around.sum::<Complex64>() / (f64::from(circle) * radius);
            let of_ratio = Complex64::new(0.0, 2.0 * RATIO);
            [stiffness, of_ratio].map(|by| (slope * by / at(hertz, stiffness)).norm_sqr())
        });
        let sums = slopes.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        for (name, sum) in ["segments.*.EI", "damping.ratio"].into_iter().zip(sums) {
            let found = fitted(&text, &measured, &[name]).unwrap();
            let error = found.values[0].relative_standard_error.unwrap();
            let apart = error * sum.sqrt() / noise - 1.0;
            assert!(apart.abs() < 1e-8, "{sensor:?}, {name}: {error:e}, off by {apart:e}");
        }
    }
}
