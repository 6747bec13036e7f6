//! Free decays: sums of damped vibrations with noise, whose frequencies and damping ratios are known.

use std::f64::consts::TAU;

use flexlink::fit::{Decay, DecayError, DecaySamples, DecayValues, HubEnd, Observable};

use crate::recordings::Random;

/// Natural frequency in Hz, damping ratio, amplitude, phase in rad.
type Vibration = [f64; 4];

const ANY: [f64; 2] = [0.0, f64::INFINITY];

fn mode(number: usize, within_hz: [f64; 2]) -> (Observable, [f64; 2]) {
    (Observable::Frequency { mode: number, hub: HubEnd::Held }, within_hz)
}

fn at(vibrations: &[Vibration], time_s: f64) -> f64 {
    let value = |[hertz, ratio, amplitude, phase]: &Vibration| {
        let omega = TAU * hertz;
        let damped = omega * (1.0 - ratio * ratio).sqrt();
        amplitude * (-ratio * omega * time_s).exp() * (damped * time_s + phase).cos()
    };
    vibrations.iter().map(value).sum()
}

fn sampled(step_s: f64, count: usize, at: impl FnMut(f64) -> f64) -> DecaySamples {
    let samples = (0..count).map(|k| step_s * k as f64).map(at).collect();
    let [name, column] = ["pluck.csv", "tip"].map(str::to_owned);
    DecaySamples { name, column, start_s: 0.0, step_s, samples }
}

fn identified(given: DecaySamples, modes: &[(Observable, [f64; 2])]) -> Result<Decay, DecayError> {
    Decay::of(given, modes, DecayValues::Both)
}

#[test]
fn exact_decays_are_found_exactly() {
    let exact = [[2.3286, 0.012, 1.0, 0.3], [14.6, 0.05, 0.2, 1.0], [31.0, 0.004, 0.03, 2.0]];
    let given = sampled(0.004, 1500, |t| 40.0 - 0.2 * t + at(&exact, t));
    let modes = [mode(1, [0.0, 6.0]), mode(2, [6.0, 20.0]), mode(3, [20.0, f64::INFINITY])];
    let decay = identified(given, &modes).unwrap();
    for (mode, [hertz, ratio, ..]) in decay.modes.iter().zip(exact) {
        assert!((mode.frequency.value / hertz - 1.0).abs() < 1e-9, "{mode:?}");
        assert!((mode.ratio.value / ratio - 1.0).abs() < 1e-7, "{mode:?}");
        assert_eq!(mode.bent, None);
    }
    assert!(decay.rms < 1e-7 && decay.others_hz.is_empty(), "{decay:?}");
}

/// Two modes about an offset with a drift, under white noise, rounded, and under slow noise: of the intervals of twice
/// two values in 50 decays each, 90 to 99 of 100 hold the true value.
#[test]
fn the_intervals_hold_as_many_true_values_as_they_say() {
    let exact: [Vibration; 2] = [[2.3286, 0.012, 1.0, 0.3], [14.6, 0.02, 0.2, 1.0]];
    let modes = [mode(1, [0.0, 6.0]), mode(2, [6.0, 40.0])];
    let mut random = Random(7);
    for kind in ["white", "rounded", "slow"] {
        let (mut held, mut count) = (0, 0);
        for seed in 0..50 {
            let mut vibrations = exact;
            vibrations[0][3] = 0.1 * f64::from(seed);
            let mut slow = 0.0;
            let given = sampled(0.005, 1000, |t| {
                let clean = 0.7 + 0.01 * t + at(&vibrations, t);
                slow = 0.8 * slow + random.box_muller();
                match kind {
                    "white" => clean + 0.02 * random.box_muller(),
                    "rounded" => (clean / 0.01).round() * 0.01,
                    _ => clean + 0.01 * slow,
                }
            });
            let decay = identified(given, &modes).unwrap();
            for (mode, [hertz, ratio, ..]) in decay.modes.iter().zip(exact) {
                assert_eq!(mode.bent, None, "{kind} {seed}");
                for (found, exact) in [(&mode.frequency, hertz), (&mode.ratio, ratio)] {
                    let error = found.value - exact;
                    held += usize::from(error.abs() < 1.96 * found.uncertainty.unwrap());
                    count += 1;
                }
            }
        }
        assert_eq!(count, 200);
        assert!((180..=198).contains(&held), "{kind}: {held} of {count}");
    }
}

/// A mass on a spring with dry friction: in each half period a cosine about a place beside the rest, exactly.
#[test]
fn dry_friction_and_drag_bend_the_logarithm() {
    let dry = |t: f64| {
        let (omega, friction) = (TAU * 2.0, 0.02);
        let half = (omega * t / (0.5 * TAU)).floor();
        let amplitude = 1.0 - (2.0 * half + 1.0) * friction;
        let side = if half.rem_euclid(2.0) < 0.5 { friction } else { -friction };
        amplitude * (omega * t).cos() + side
    };
    let ratios = |at: &dyn Fn(f64) -> f64| {
        let decay = identified(sampled(0.01, 500, at), &[mode(1, ANY)]).unwrap();
        let mode = decay.modes[0].clone();
        (mode.bent, mode.ratio)
    };
    let (bent, ratio) = ratios(&dry);
    let [first, last] = bent.unwrap();
    // The amplitude falls by 4 × 0.02 in a period: the ratio is 0.0127 over the amplitude.
    assert!(first < 0.9 * ratio.value && last > 1.3 * ratio.value, "{first}, {ratio:?}, {last}");
    let drag = |t: f64| (TAU * 2.0 * t).cos() / (1.0 + 0.5 * t);
    let (bent, ratio) = ratios(&drag);
    let [first, last] = bent.unwrap();
    assert!(first > 1.3 * ratio.value && last < 0.9 * ratio.value, "{first}, {ratio:?}, {last}");
    let viscous = |t: f64| at(&[[2.0, 0.02, 1.0, 0.0]], t);
    assert_eq!(ratios(&viscous).0, None);
}

#[test]
fn what_a_decay_does_not_show_is_refused() {
    let one: [Vibration; 1] = [[3.0, 0.02, 1.0, 0.0]];
    let mut random = Random(3);
    let mut refused = |count, modes: &[(Observable, [f64; 2])], noise: f64, of: Vibration| {
        let given = sampled(0.01, count, |t| at(&[of], t) + noise * random.box_muller());
        identified(given, modes).unwrap_err().to_string()
    };
    let elsewhere = "frequency 2, hub held: no vibration between 8.00 and 30.0 Hz stands out of the noise; the \
                     strongest is at 3.00";
    let found = refused(600, &[mode(2, [8.0, 30.0])], 0.01, one[0]);
    assert!(found.starts_with(elsewhere), "{found}");
    let found = refused(12, &[mode(1, ANY)], 0.0, one[0]);
    assert_eq!(found, "samples = 12, but must be 24 or more");
    let found = refused(50, &[mode(1, ANY)], 0.0, one[0]);
    assert!(found.starts_with("frequency 1, hub held: periods = 1.5, but must be 2"), "{found}");
    let found = refused(200, &[mode(1, ANY)], 0.3, [3.0, 0.001, 1.0, 0.0]);
    assert!(found.contains("its uncertainty must be below half of it"), "{found}");
    let still = sampled(0.01, 100, |_| 1.5);
    let found = identified(still, &[mode(1, ANY)]).unwrap_err().to_string();
    assert_eq!(found, "tip is the same in all samples, but must vibrate");
}
