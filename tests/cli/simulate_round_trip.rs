//! The torque of `solve`, read back by `simulate`, moves the tip as was wanted.

use super::{Bench, simulated};

/// Largest tip error over the travel when the torque of one law is played on the same link, all
/// through files at the default digits.
fn tip_error(law: &str) -> f64 {
    let bench = Bench::new();
    bench.solve(&format!("-q --nodes 0 --set {law} --set analysis.tolerance=1e-9"));
    simulated(&bench, &format!("out/torque.csv --target out/tip.csv --nodes 0 --set {law}"));
    bench.number("simulated", "tip_error/share")
}

#[test]
fn laws_with_an_equation_in_time_bring_the_tip_back_to_seven_digits() {
    for law in [
        "damping.model=modal",
        "damping={model=\"modal\",ratios=[0.01,0.02,0.03]}",
        "damping={model=\"rayleigh\",modes=[1,3],ratios=[0.02,0.02]}",
        "damping={model=\"none\"}",
    ] {
        let error = tip_error(law);
        assert!(error < 1e-7, "{law}: {error:e}");
    }
}

/// What is played instead is viscous.
#[test]
fn hysteretic_damping_brings_it_back_to_three_thousandths() {
    let error = tip_error("damping.ratio=0.02");
    assert!((0.0025..0.0035).contains(&error), "{error:e}");
}
