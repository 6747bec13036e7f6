//! Measured rigs.
//!
//! | rig | free | expected | accepted deviation |
//! |---|---|---|---|
//! | SLFR, R. Krauss, SIUE 2009 | EI, accelerometer | 94 % of the documented EI, 11.2 g, frequencies within 0.2 % | 0.5 %, 0.1 g |
//! | EPFL, big ruler | EI, hub inertia | 0.0390 N m² ± 3 %, 3.4e-6 kg m² ± 46 %, residuals to 7 % | 1 %, 4 %; the errors 2 points |
//! | EPFL, medium ruler | EI, hub inertia | 0.0178 N m² ± 3 %, 4.2e-6 kg m² ± 15 % | 1 %, 2 %; the errors 2 points |
//! | EPFL, small ruler | EI, hub inertia | one degree of freedom: 95 % within 12.7 standard errors | – |
//! | Boulder, ASEN 2003 | EI | twice the frequency's 5 % | – |
//! | Quanser at Kyoto, 2026 | length | 0.385 m, off by 0.5 % | 1 mm, 0.1 points |
//!
//! The inertia of the big ruler's hub is 3.47e-6 kg m² ± 45 % here: the sum of squares is flat there, and the
//! published value is rounded.

use super::{fitted, rig};
use flexlink::fit::FitOutcome;

fn factor(outcome: &FitOutcome, k: usize) -> f64 {
    outcome.values[k].factor
}

fn error(outcome: &FitOutcome, k: usize) -> f64 {
    outcome.values[k].relative_standard_error.unwrap()
}

fn largest(outcome: &FitOutcome) -> f64 {
    outcome.residuals.iter().map(|residual| residual.relative.abs()).fold(0.0, f64::max)
}

#[test]
fn the_slfr_has_94_percent_of_its_stiffness_and_a_heavier_accelerometer() {
    let (link, measured) = rig("krauss_slfr.toml");
    let found = fitted(&link, &measured, &["segments.*.EI", "masses.0.mass"]).unwrap();
    assert!((factor(&found, 0) - 0.94).abs() < 0.005, "{found:?}");
    assert!((7.7 * factor(&found, 1) - 11.2).abs() < 0.1, "{found:?}");
    assert!(largest(&found) < 0.002, "{found:?}");
    assert_eq!((found.misfit, found.undetermined), (None, Vec::new()));
}

/// As documented the model is +10.9, +6.0, +4.9 % off.
#[test]
fn the_slfr_as_documented_is_as_far_off_as_published() {
    let (link, measured) = rig("krauss_slfr.toml");
    let found = fitted(&link, &measured, &["damping.ratio"]).unwrap();
    for (residual, published) in found.residuals.iter().zip([0.109, 0.060, 0.049]) {
        assert!((residual.relative - published).abs() < 0.002, "{residual:?}");
    }
    let only: Vec<&str> = found.undetermined[0].powers.iter().map(|(p, _)| p.as_str()).collect();
    assert_eq!(only, ["damping.ratio"]);
}

#[test]
fn the_big_ruler_has_60_percent_of_its_stiffness() {
    let (link, measured) = rig("epfl_ruler_big.toml");
    let found = fitted(&link, &measured, &["segments.*.EI", "hub.inertia"]).unwrap();
    assert!((0.0648 * factor(&found, 0) / 0.0390 - 1.0).abs() < 0.01, "{found:?}");
    assert!((5.4 * factor(&found, 1) / 3.4 - 1.0).abs() < 0.04, "{found:?}");
    assert!((error(&found, 0) - 0.03).abs() < 0.01 && (error(&found, 1) - 0.46).abs() < 0.02);
    assert!((0.06..0.07).contains(&largest(&found)), "{found:?}");
    // The documented inertia is one standard error away.
    let away = -factor(&found, 1).ln() / error(&found, 1);
    assert!((away - 1.0).abs() < 0.1, "{away}");
}

#[test]
fn the_medium_ruler_has_its_hub_inertia_to_15_percent() {
    let (link, measured) = rig("epfl_ruler_medium.toml");
    let found = fitted(&link, &measured, &["segments.*.EI", "hub.inertia"]).unwrap();
    assert!((0.0144 * factor(&found, 0) / 0.0178 - 1.0).abs() < 0.01, "{found:?}");
    assert!((5.4 * factor(&found, 1) / 4.2 - 1.0).abs() < 0.02, "{found:?}");
    assert!((error(&found, 0) - 0.03).abs() < 0.01 && (error(&found, 1) - 0.15).abs() < 0.02);
    let away = -factor(&found, 1).ln() / error(&found, 1);
    assert!((away - 1.7).abs() < 0.1, "{away}");
}

#[test]
fn frequencies_alone_do_not_give_the_rulers_mass() {
    let (link, measured) = rig("epfl_ruler_big.toml");
    let free = ["segments.*.EI", "hub.inertia", "segments.*.mass_per_length"];
    let found = fitted(&link, &measured, &free).unwrap();
    assert_eq!(found.undetermined.len(), 1);
    let text = found.undetermined[0].to_string();
    assert!(text.starts_with("the data do not determine "), "{text}");
    for (path, power) in &found.undetermined[0].powers {
        assert!((power - 1.0).abs() < 1e-5, "{path}: {power}");
    }
}

/// The hand-out's values are 15 and 16 % off. Length, stiffness and mass per length act on the zeros through
/// EI/(m̄L⁴) alone; the hub's inertia does not act on them.
#[test]
fn a_shorter_strip_explains_both_zeros_of_kyoto() {
    let (link, measured) = rig("kyoto_quanser.toml");
    let found = fitted(&link, &measured, &["segments.*.length"]).unwrap();
    assert!((0.419 * factor(&found, 0) - 0.385).abs() < 0.001, "{found:?}");
    assert!((largest(&found) - 0.005).abs() < 0.001, "{found:?}");
    for (path, power) in [("segments.*.EI", -4.0), ("segments.*.mass_per_length", 4.0)] {
        let other = fitted(&link, &measured, &[path]).unwrap();
        let expected = factor(&found, 0).powf(power);
        assert!((factor(&other, 0) / expected - 1.0).abs() < 1e-6, "{path}: {other:?}");
    }
    let hub = fitted(&link, &measured, &["hub.inertia"]).unwrap();
    assert!((largest(&hub) - 0.16).abs() < 0.01, "{hub:?}");
    assert_eq!(hub.undetermined.len(), 1);
}

/// Three frequencies for two values: the standard errors are small, and 95 % lie within 12.7 of them.
#[test]
fn the_small_ruler_has_one_frequency_too_few_to_say() {
    let (link, measured) = rig("epfl_ruler_small.toml");
    let found = fitted(&link, &measured, &["segments.*.EI", "hub.inertia"]).unwrap();
    assert_eq!((found.degrees_of_freedom, &found.misfit), (1, &None));
    assert!(largest(&found) < 0.003, "{found:?}");
    for value in &found.values {
        let [low, high] = value.relative_interval_95.unwrap();
        let error = value.relative_standard_error.unwrap();
        assert!((high.ln() / error - 12.706).abs() < 0.001, "{value:?}");
        assert!((low * high - 1.0).abs() < 1e-12, "{value:?}");
    }
    // The big ruler of the same section has 0.0390 N m².
    assert!(error(&found, 0) < 0.005 && 0.0648 * factor(&found, 0) < 0.75 * 0.0390, "{found:?}");
    assert!(error(&found, 1) < 0.03 && (0.7..0.76).contains(&factor(&found, 1)), "{found:?}");
}

/// 1.65 to 1.96 Hz of several units are worth a stiffness to 10 %, by f ∝ √EI.
#[test]
fn a_single_frequency_is_worth_its_uncertainty() {
    let (link, measured) = rig("boulder_asen2003.toml");
    let found = fitted(&link, &measured, &["segments.*.EI"]).unwrap();
    assert!((error(&found, 0) - 2.0 * 0.09 / 1.805).abs() < 1e-6, "{found:?}");
    let [low, high] = found.values[0].relative_interval_95.unwrap();
    assert!((high.ln() / error(&found, 0) - 1.959_964).abs() < 1e-6, "{low} {high}");
    let warnings = found.warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].kind, "unchecked");
}
