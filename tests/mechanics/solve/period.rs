//! The period: how long it is, what is written of it, and what that costs.

use super::{
    Smooth, accelerated, link, plan_of, samples, sine, solved, torque_difference, whole_band,
};
use flexlink::inverse::{Analysis, Resources, Solution, Warning, invert};
use flexlink::link::Damping;

/// With viscous damping the torque decays exponentially on both sides, as the zeros say.
const VISCOUS: Damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 };

fn with_window(lead_s: Option<f64>, lag_s: Option<f64>) -> Solution {
    let link = link(|_| ());
    let analysis = whole_band(Analysis::new(1e-6, lead_s, lag_s).unwrap());
    invert(&link, &plan_of(&link, 16), &sine(0.5, 0.88, 440), &analysis).unwrap()
}

#[test]
fn a_trajectory_with_enough_rest_is_not_padded() {
    let link = link(|parts| parts.damping = VISCOUS);
    // ln(1e6)/z₁ is 1.2 s; the motion has 2 s of rest on both sides, in 1280 samples.
    let rested = Smooth { rest: [512, 511], ..Smooth::SHORT };
    let solution = solved(&link, 16, &rested.motion());
    assert_eq!(solution.band.fft_length, 1280);
    assert_eq!(samples(&solution), 0..1280);
    assert!(
        solution.hub().errors.torque.window <= 1e-6,
        "{:e}",
        solution.hub().errors.torque.window
    );
    assert!(solution.warnings.is_empty());
}

#[test]
fn what_rest_there_is_counts_for_the_padding() {
    let link = link(|parts| parts.damping = VISCOUS);
    let period = |rest: [u32; 2]| {
        let solution = solved(&link, 16, &Smooth { rest, ..Smooth::MOVE }.motion());
        assert!(solution.hub().errors.torque.window <= 1e-6, "{rest:?}");
        solution.band.fft_length
    };
    let bare = period([0, 0]);
    assert_eq!(period([200, 200]), bare, "the padding shrinks as the rest grows");
    for rest in [[200, 0], [0, 200]] {
        let lopsided = period(rest);
        assert!(lopsided >= bare && lopsided <= bare + 256, "{rest:?}: {lopsided}, {bare}");
    }
}

#[test]
fn the_edge_error_stays_below_the_tolerance() {
    for damping in [Damping::Hysteretic { ratio: 0.02 }, VISCOUS, Damping::None] {
        let link = link(|parts| parts.damping = damping.clone());
        let solution = solved(&link, 16, &sine(0.5, 0.88, 440));
        let edge = solution.hub().errors.torque.window;
        assert!(edge <= 1e-6, "{damping:?}: {edge:e}");
        assert!(edge > 1e-9, "{damping:?}: far more padding than needed, {edge:e}");
    }
}

#[test]
fn lead_and_lag_are_honoured_to_the_step() {
    let solution = with_window(Some(0.5), Some(0.25));
    assert_eq!(samples(&solution), -250..441 + 125);
    assert!((solution.grid.time_s(0) + 0.5).abs() < 1e-12);
    assert!((solution.grid.time_s(solution.grid.len - 1) - 1.13).abs() < 1e-12);
}

#[test]
fn a_long_lead_needs_no_long_lag() {
    let ahead = with_window(Some(12.0), Some(0.5));
    assert_eq!(samples(&ahead), -6000..441 + 250);
    let behind = with_window(Some(0.5), Some(12.0));
    assert_eq!(samples(&behind), -250..441 + 6000);
}

#[test]
fn a_cut_torque_is_warned_about_with_what_is_cut() {
    let whole = with_window(None, None);
    let cut = with_window(Some(0.1), Some(0.2));
    let [Warning::TorqueCut { share, tolerance, .. }] = of_the_window(&cut)[..] else {
        panic!("{:?}", cut.warnings);
    };
    assert!((tolerance - 1e-6).abs() < 1e-18);
    let peak = super::peak(&whole.hub().torque_n_m);
    let outside = samples(&whole).filter(|k| !samples(&cut).contains(k));
    let largest = outside.fold(0.0_f64, |m, k| m.max(super::torque_at(&whole, k).abs()));
    assert!((share / (largest / peak) - 1.0).abs() < 1e-3, "{share} of {}", largest / peak);
    assert!((cut.hub().errors.torque.window - share).abs() < 1e-15);
    // What is written is the same torque.
    for k in samples(&cut) {
        assert!((super::torque_at(&cut, k) - super::torque_at(&whole, k)).abs() < 1e-6 * peak);
    }
}

#[test]
fn a_window_longer_than_needed_is_no_reason_to_warn() {
    let solution = with_window(Some(9.0), Some(9.0));
    assert_eq!(samples(&solution), -4500..441 + 4500);
    assert!(of_the_window(&solution).is_empty(), "{:?}", solution.warnings);
}

/// Warnings but those of the step and of the model: the samples of the whole band do not hold the hub's acceleration, and the
/// link bends by a tenth of its length.
fn of_the_window(solution: &Solution) -> Vec<Warning> {
    let warnings = solution.warnings.iter().map(|own| own.warning);
    warnings.filter(|own| !["coarse_step", "inexact_model"].contains(&own.kind())).collect()
}

#[test]
fn a_period_of_half_the_length_gives_the_same_torque() {
    for damping in [Damping::Hysteretic { ratio: 0.02 }, VISCOUS] {
        let link = link(|parts| parts.damping = damping.clone());
        let solution = solved(&link, 16, &sine(0.5, 0.88, 440));
        let lag_s = Some(solution.band.period_s);
        let analysis = whole_band(Analysis::new(1e-6, None, lag_s).unwrap());
        let plan = plan_of(&link, 16);
        let longer = invert(&link, &plan, &sine(0.5, 0.88, 440), &analysis).unwrap();
        assert!(longer.band.period_s > 2.0 * solution.band.period_s);
        let difference = torque_difference(&solution, &longer, 0);
        assert!(difference < 4e-6, "{damping:?}: {difference:e}");
    }
}

#[test]
fn a_looser_tolerance_writes_a_shorter_window() {
    let link = link(|_| ());
    let rows = |tolerance: f64| {
        let analysis = whole_band(Analysis::new(tolerance, None, None).unwrap());
        let plan = plan_of(&link, 16);
        invert(&link, &plan, &sine(0.5, 0.88, 440), &analysis).unwrap().grid.len
    };
    assert!(rows(1e-2) < rows(1e-4) && rows(1e-4) < rows(1e-6));
}

#[test]
fn another_sampling_of_a_motion_asks_for_the_same_torque_over_the_same_window() {
    let link = link(|parts| parts.damping = VISCOUS);
    let late = |steps: u32| {
        let motion = Smooth { steps, ..Smooth::SHORT };
        let time_s = motion.time_s().into_iter().map(|t| 7.0 + t).collect();
        accelerated(time_s, motion.acceleration_m_s2())
    };
    let solution = solved(&link, 16, &late(256));
    let finer = solution.torques_over_window(&late(512), &Resources::default());
    let finer = finer.unwrap().unwrap().hub_n_m;
    assert_eq!(finer.len(), 2 * solution.grid.len - 1);
    let peak = super::peak(&solution.hub().torque_n_m);
    for (k, torque_n_m) in solution.hub().torque_n_m.iter().enumerate() {
        assert!((torque_n_m - finer[2 * k]).abs() < 4e-6 * peak, "sample {k}");
    }
}

#[test]
fn the_band_is_told_in_hertz_of_period_and_step() {
    let solution = solved(&link(|_| ()), 8, &Smooth::SHORT.motion());
    let band = solution.band;
    let close = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{band:?}");
    close(band.period_s, band.fft_length as f64 / 256.0);
    close(band.highest_hz, (band.frequencies - 1) as f64 / band.period_s);
    close(band.nyquist_hz, 128.0);
}
