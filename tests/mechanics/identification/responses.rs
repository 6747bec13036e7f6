//! Links fitted to frequency responses of the closed form, with noise.

use std::f64::consts::TAU;

use flexlink::fit::{FitOutcome, Gain, Measurements, Misfit, Response, Transfer};
use flexlink::link::Payload;
use num_complex::Complex64;

use super::synthetic::Random;
use super::{fitted, free_text};
use crate::theory::closed_form::UniformLink;

const RATIO: f64 = 0.02;

/// All values that a response in SI determines.
const ALL: [&str; 5] =
    ["segments.*.EI", "segments.*.mass_per_length", "hub.inertia", "payload.mass", "damping.ratio"];

fn truth() -> UniformLink {
    let payload = Payload { mass_kg: 0.3, inertia_kg_m2: 0.0, offset_m: 0.0 };
    UniformLink { payload, ..UniformLink::BAYO }
}

/// A transfer of the closed form: `a/T`, and `θ/T = −(θ/v)/(ω² T/a)` with its rate `iωθ/T`.
fn exact(transfer: Transfer, omega_rad_s: f64) -> Complex64 {
    let lambda = Complex64::from(omega_rad_s.powi(2)) / Complex64::new(1.0, 2.0 * RATIO);
    let link = truth();
    let exact = link.solve(lambda);
    let acceleration = exact.inertia_kg_m().inv();
    let angle = -exact.angle_rad_m() * acceleration / omega_rad_s.powi(2);
    match transfer {
        Transfer::HubAngle => angle,
        Transfer::HubRate => Complex64::new(0.0, omega_rad_s) * angle,
        Transfer::TipAcceleration => acceleration,
    }
}

/// A response of so many frequencies from 0.3 to 30 Hz, each value with noise of 2 %, taken for `transfer`.
fn response(
    measured: Transfer,
    (transfer, gain): (Transfer, Gain),
    scale: f64,
    points: i32,
) -> Measurements {
    let noise = 0.02;
    let mut random = Random(7);
    let hertz = |k: i32| 0.3 * 100_f64.powf(f64::from(k) / f64::from(points - 1));
    let frequencies: Vec<f64> = (0..points).map(hertz).collect();
    let values = frequencies.iter().map(|hertz| {
        let off = Complex64::new(random.normal(), random.normal()) * noise;
        exact(measured, TAU * hertz) * scale * (1.0 + off)
    });
    let rows = (frequencies.clone(), values.collect());
    let response = Response::new("frf.csv".into(), (transfer, gain), Some(noise), rows).unwrap();
    Measurements::new(Vec::new(), vec![response]).unwrap()
}

/// Fits from a file whose values are all wrong.
fn fit(measured: &Measurements, free: &[&str]) -> FitOutcome {
    let text = free_text([7.0, 0.6, 0.13, 0.2], 0.012);
    fitted(&text, measured, free).unwrap()
}

#[test]
fn a_response_in_si_determines_all_five_values() {
    for transfer in [Transfer::HubAngle, Transfer::HubRate, Transfer::TipAcceleration] {
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
    let measured = response(Transfer::HubAngle, (Transfer::HubAngle, Gain::Free), 40.0, 100);
    let found = fit(&measured, &ALL);
    assert_eq!(found.undetermined.len(), 1, "{found:?}");
    let powers = &found.undetermined[0].powers;
    let paths: Vec<&str> = powers.iter().map(|(path, _)| path.as_str()).collect();
    assert_eq!(paths, &ALL[..4]);
    let found = fit(&measured, &["segments.*.EI", "payload.mass", "hub.inertia", "damping.ratio"]);
    assert_eq!(found.undetermined.len(), 0, "{found:?}");
}

#[test]
fn a_response_of_another_transfer_is_no_fit() {
    let measured = response(Transfer::HubAngle, (Transfer::HubRate, Gain::Known), 1.0, 100);
    let found = fit(&measured, &ALL);
    assert!(matches!(found.misfit, Some(Misfit::Far { .. })), "{found:?}");
}
