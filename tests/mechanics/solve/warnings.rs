//! Every warning, provoked; and none where there is nothing to warn about.

use super::{Smooth, accelerated, displaced, link, plan_of, sine, solved, whole_band};
use flexlink::inverse::{Analysis, Quantity, ShareOf, Solution, Warning, invert};
use flexlink::link::{Damping, Link, LumpedMass, Payload};
use flexlink::motion::{Shortfall, TipMotion};
use flexlink::numeric::largest;

/// The only warning of a kind.
#[track_caller]
fn of_kind<'a>(solution: &'a Solution, kind: &str) -> &'a Warning {
    let mut found = solution.warnings.iter().filter(|warning| warning.kind() == kind);
    let only = found.next().unwrap_or_else(|| panic!("no {kind} in {:?}", solution.warnings));
    assert_eq!(found.count(), 0);
    &only.warning
}

fn with_payload_inertia(damping: Damping) -> Link {
    link(|parts| {
        parts.payload = Payload { mass_kg: 0.1, inertia_kg_m2: 0.01, offset_m: 0.0 };
        parts.damping = damping;
    })
}

/// Full acceleration, then full braking: jumps at both ends and in the middle.
fn bang_bang(steps: u32) -> TipMotion {
    let time_s = (0..=steps).map(|k| f64::from(k) / f64::from(steps)).collect();
    let sign = |k: u32| match (2 * k).cmp(&steps) {
        std::cmp::Ordering::Less => 1.0,
        std::cmp::Ordering::Equal => 0.0,
        std::cmp::Ordering::Greater => -1.0,
    };
    accelerated(time_s, (0..=steps).map(sign).collect())
}

#[test]
fn every_warning_reads_as_in_the_snapshot() {
    let (quantity, share, tolerance) = (Quantity::Torque, 0.0123, 1e-6);
    let of = ShareOf::Peak;
    let shortfalls = [Shortfall::Step(0.002), Shortfall::Noise];
    let missed = shortfalls.map(|shortfall| Warning::TipMissed { share, tolerance, shortfall });
    let others = [
        Warning::EndVelocityCorrected { velocity_m_s: 0.00123, share },
        Warning::InexactWindow { of, quantity, share, tolerance },
        Warning::InexactWindow { of: ShareOf::Range, quantity, share, tolerance },
        Warning::CoarseStep { of, quantity, share },
        Warning::UnsettledTorque { quantity, peak_n_m: 1.234_567, looser_n_m: 1.2 },
        Warning::UncertainInput { of, share: 0.123 },
        Warning::TorqueCut { of, share, tolerance },
        Warning::WrapAround { of, share, tolerance, period_s: 12.5 },
        Warning::LongWindow { rows: 12_345, times: 12.3 },
        Warning::BlockedTip { frequency_hz: 12.345_678, share },
        Warning::NearNyquist { share, nyquist_hz: 500.0 },
        Warning::AboveMesh { share, resolved_hz: 123.456_78 },
        Warning::InexactModel { torque: 0.0567, tip: share },
        Warning::ThickLink { share },
        Warning::SlowIteration { contraction: 0.789 },
        Warning::InexactIteration { of: ShareOf::Range, quantity, share, tolerance },
        Warning::SecondOrderLeftOut { share: Some(share) },
        Warning::SecondOrderLeftOut { share: Some(1.23) },
        Warning::SecondOrderLeftOut { share: None },
        Warning::CoarseMesh { of, quantity, error: share },
        Warning::FewModes { quantity, error: share },
    ];
    let all = missed.iter().chain(&others);
    let words = |warning: &Warning| {
        format!("{}\nwarning: {warning}\nhint: {}\n", warning.kind(), warning.hint())
    };
    let found = all.map(words).collect::<Vec<_>>().join("\n");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/refusals/warnings.txt");
    if std::env::var_os("TRYCMD").is_some_and(|action| action == "overwrite") {
        std::fs::write(path, &found).unwrap();
    }
    assert_eq!(found, std::fs::read_to_string(path).unwrap());
}

#[test]
fn a_smooth_motion_of_a_damped_link_gives_none() {
    let solution = solved(&link(|_| ()), 10, &Smooth::SHORT.motion());
    assert!(solution.warnings.is_empty(), "{:?}", solution.warnings);
}

#[test]
fn an_end_velocity_of_few_digits_is_corrected() {
    let exact = Smooth::SHORT.acceleration_m_s2();
    let mut rounded: Vec<f64> = exact.iter().map(|a| (1e3 * a).round() / 1e3).collect();
    // Without this the rounding errors of the two halves would cancel.
    rounded[100] += 0.02;
    let velocity = rounded.iter().sum::<f64>() / 256.0;
    let solution = solved(&link(|_| ()), 10, &accelerated(Smooth::SHORT.time_s(), rounded));
    let warning = of_kind(&solution, "end_velocity_corrected");
    let Warning::EndVelocityCorrected { velocity_m_s, share } = *warning else {
        panic!("{warning}");
    };
    assert!((velocity_m_s - velocity).abs() < 1e-12 && share > 1e-9, "{warning}");
    assert_eq!(solution.warnings.len(), 1, "{:?}", solution.warnings);
}

#[test]
fn a_short_window_cuts_torque() {
    let link = link(|_| ());
    let analysis = whole_band(Analysis::new(1e-4, Some(0.05), Some(0.05)).unwrap());
    let solution = invert(&link, &plan_of(&link, 10), &Smooth::MOVE.motion(), &analysis).unwrap();
    let warning = of_kind(&solution, "torque_cut");
    let Warning::TorqueCut { share, .. } = *warning else { panic!("{warning}") };
    assert!((0.01..1.0).contains(&share), "{warning}");
}

#[test]
fn an_undamped_tip_that_is_blocked_rings_around_the_period() {
    let link = with_payload_inertia(Damping::None);
    let solution = solved(&link, 2, &sine(0.5, 1.0, 64));
    let warning = of_kind(&solution, "wrap_around");
    let Warning::WrapAround { share, tolerance, period_s, .. } = *warning else {
        panic!("{warning}");
    };
    assert!(share > tolerance, "{warning}");
    assert!(period_s > 1000.0, "the period was lengthened in vain: {period_s} s");
    assert!((solution.hub().errors.torque.window - share).abs() < 1e-15);
    let warning = of_kind(&solution, "long_window");
    let Warning::LongWindow { rows, times } = *warning else { panic!("{warning}") };
    assert_eq!(rows, solution.grid.len);
    assert!((times - rows as f64 / 65.0).abs() < 1e-9, "{warning}");
}

/// A generalised eigenvalue problem of the same link, solved apart, gives 3.5427 Hz.
#[test]
fn an_inertia_on_the_link_blocks_the_tip_too() {
    let mass = LumpedMass { at_m: 1.35, mass_kg: 0.1, inertia_kg_m2: 0.05 };
    let link = link(|parts| parts.masses.push(mass));
    let solution = solved(&link, 20, &sine(0.05, 0.3, 300));
    let Warning::BlockedTip { frequency_hz, .. } = *of_kind(&solution, "blocked_tip") else {
        panic!("{:?}", solution.warnings);
    };
    assert!((frequency_hz - 3.5427).abs() < 1e-4, "{frequency_hz} Hz");
}

/// sinh b + sin b = ε b³ (cosh b − cos b) at `ε = J_t/m̄L³`: b = 4.60714 for 0.01.
#[test]
fn a_blocked_tip_is_named_with_its_frequency() {
    let link = link(|parts| parts.payload.inertia_kg_m2 = 0.01 * 0.8 * 1.5_f64.powi(3));
    let solution = solved(&link, 40, &sine(0.5, 0.5, 500));
    let warning = of_kind(&solution, "blocked_tip");
    let Warning::BlockedTip { frequency_hz, share } = *warning else { panic!("{warning}") };
    let expected = 4.607_14_f64.powi(2) * (5.0 / 0.8_f64).sqrt() / 2.25 / std::f64::consts::TAU;
    assert!((frequency_hz / expected - 1.0).abs() < 1e-5, "{frequency_hz} Hz for {expected} Hz");
    // The spectrum of one period of a sine over x = fT.
    let amplitude = |x: f64| ((std::f64::consts::PI * x).sin() / (1.0 - x * x)).abs();
    let largest = (1..200).map(|k| amplitude(0.009 * f64::from(k))).fold(0.0, f64::max);
    let held = amplitude(0.5 * expected) / largest;
    assert!((share / held - 1.0).abs() < 0.15, "{share} is not {held}");
}

#[test]
fn a_slow_motion_does_not_reach_the_blocked_frequency() {
    let link = link(|parts| parts.payload.inertia_kg_m2 = 0.001 * 0.8 * 1.5_f64.powi(3));
    let slow = Smooth { duration_s: 4.0, steps: 1024, ..Smooth::MOVE };
    let solution = solved(&link, 20, &slow.motion());
    assert!(solution.warnings.is_empty(), "{:?}", solution.warnings);
}

#[test]
fn jumps_of_the_acceleration_reach_the_nyquist_frequency() {
    let solution = solved(&link(|_| ()), 20, &bang_bang(200));
    let warning = of_kind(&solution, "near_nyquist");
    let Warning::NearNyquist { share, nyquist_hz } = *warning else { panic!("{warning}") };
    assert!((nyquist_hz - 100.0).abs() < 1e-9 && share > 1e-3, "{warning}");
}

#[test]
fn a_quick_motion_on_two_elements_is_beyond_the_mesh() {
    let link = link(|_| ());
    let solution = solved(&link, 2, &Smooth { duration_s: 0.1, ..Smooth::MOVE }.motion());
    let warning = of_kind(&solution, "above_mesh");
    let Warning::AboveMesh { share, resolved_hz } = *warning else { panic!("{warning}") };
    assert!((0.01..=1.0).contains(&share), "{warning}");
    let hertz = solution.links[0].mesh().resolved_frequency_rad_s() / std::f64::consts::TAU;
    assert!((resolved_hz - hertz).abs() < 1e-12);

    let coarse = of_kind(&solution, "coarse_mesh");
    let Warning::CoarseMesh { error, .. } = *coarse else { panic!("{coarse}") };
    assert!((error - solution.hub().errors.torque.mesh).abs() < 1e-15 && error > 0.01);
}

#[test]
fn modes_that_are_too_few_are_told_with_the_error_that_was_measured() {
    let link = link(|_| ());
    let few = |modes| {
        let analysis = Analysis::default().keeping_modes(modes).unwrap();
        invert(&link, &plan_of(&link, 10), &Smooth::SHORT.motion(), &analysis).unwrap()
    };
    let solution = few(1);
    let warning = of_kind(&solution, "few_modes");
    let Warning::FewModes { error, .. } = *warning else { panic!("{warning}") };
    let (_, worst) = solution.hub().errors.of_kind(|errors| errors.modes.unwrap_or(0.0)).worst();
    assert!((error - worst).abs() < 1e-15 && error > 0.01, "{error}");
    assert!(few(8).warnings.is_empty(), "{:?}", few(8).warnings);
}

/// Displacements in six decimals: rounding moves the tip by what it is allowed to.
fn rounded_displacements(steps: u32) -> TipMotion {
    let finer = Smooth { steps, rest: [steps / 8; 2], ..Smooth::SHORT };
    let rounded = finer.displacement_m().iter().map(|d| (1e6 * d).round() / 1e6).collect();
    displaced(finer.time_s(), rounded)
}

#[test]
fn a_torque_that_the_tip_does_not_settle_is_told_with_the_peak_at_twice_the_tolerance() {
    let link = link(|_| ());
    let solve = |motion: &TipMotion, tip_tolerance| {
        let analysis = Analysis::default().with_tip_tolerance(tip_tolerance).unwrap();
        invert(&link, &plan_of(&link, 20), motion, &analysis).unwrap()
    };
    let motion = rounded_displacements(1024);
    // Half a digit is 2.5e-6 of the travel.
    let solution = solve(&motion, 2e-6);
    let warning = of_kind(&solution, "unsettled_torque");
    let Warning::UnsettledTorque { peak_n_m, looser_n_m, .. } = *warning else {
        panic!("{warning}")
    };
    let peak = |solution: &Solution| largest(&solution.hub().torque_n_m);
    assert!((peak_n_m / peak(&solution) - 1.0).abs() < 0.01, "{warning}");
    let looser = peak(&solve(&motion, 4e-6));
    assert!((looser_n_m / looser - 1.0).abs() < 0.05, "{warning}, {looser} N m if solved anew");
    assert!(looser_n_m < 0.5 * peak_n_m, "{warning}");
    // Above the rounding the torque is the same at every tolerance.
    let settled = solve(&motion, 2e-5);
    assert!(settled.warnings.is_empty(), "{:?}", settled.warnings);
}

#[test]
fn a_ripple_above_four_fifths_of_the_nyquist_frequency_is_told_and_one_below_is_not() {
    let rippled = |share: f64| {
        let ripple = |k: usize| {
            let rest = (k as f64 - 128.0) / 30.0;
            0.05 * (-rest * rest).exp() * (share * std::f64::consts::PI * (k as f64 - 128.0)).sin()
        };
        let acceleration = Smooth::SHORT.acceleration_m_s2();
        let sum = acceleration.iter().enumerate().map(|(k, a)| a + ripple(k));
        let solution =
            solved(&link(|_| ()), 40, &accelerated(Smooth::SHORT.time_s(), sum.collect()));
        solution.warnings.iter().any(|warning| warning.kind() == "near_nyquist")
    };
    assert!(rippled(0.87) && !rippled(0.7));
}

#[test]
fn a_blocked_tip_is_told_whatever_the_size_of_the_motion() {
    let link = with_payload_inertia(Damping::Hysteretic { ratio: 0.02 });
    let told = [5e-9, 5e-3, 0.5].map(|travel_m| {
        let solution = solved(&link, 20, &sine(travel_m, 0.5, 500));
        let Warning::BlockedTip { frequency_hz, share } = *of_kind(&solution, "blocked_tip") else {
            panic!("{:?}", solution.warnings);
        };
        (frequency_hz, share)
    });
    for (frequency_hz, share) in told {
        assert!(frequency_hz.to_bits() == told[0].0.to_bits(), "{told:?}");
        assert!((share / told[0].1 - 1.0).abs() < 1e-12, "{told:?}");
    }
}
