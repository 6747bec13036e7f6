//! Links fitted to recorded histories: Fourier sums of the closed form over a long period, with noise.

use std::f64::consts::TAU;

use flexlink::fit::{Channel, FitOutcome, Gain, Measurements, Misfit, Motor, Record, RecordInput};
use flexlink::model::Sensor;
use flexlink::response::Interpolation;
use num_complex::Complex64;

use super::{fitted, free_text};
use crate::recordings::Random;

/// Damping in proportion to stiffness: 3 % in the first mode.
const BETA_S: f64 = 0.006;

/// The period, in which every vibration decays to 1e-6, and the record at its beginning.
const PERIOD_S: f64 = 60.0;
const STEP_S: f64 = 0.01;
const SAMPLES: usize = 1000;

/// Harmonics up to 8 Hz.
const HARMONICS: usize = 480;

const MECHANICAL: [&str; 4] =
    ["segments.*.EI", "segments.*.mass_per_length", "hub.inertia", "payload.mass"];

/// A transfer of the closed form per torque, with viscous stiffness.
fn per_torque(sensor: Sensor, omega: f64) -> Complex64 {
    super::per_torque(sensor, omega, Complex64::new(1.0, omega * BETA_S))
}

/// Amplitude of the torque, the second derivative of a Gaussian 1 s after the beginning: neither its impulse
/// nor its first moment moves the hub for good.
fn torque(omega: f64) -> Complex64 {
    let sigma = 0.09;
    let width = sigma * TAU.sqrt() / PERIOD_S;
    let size = -(omega * sigma).powi(2) * (-0.5 * (omega * sigma).powi(2)).exp();
    Complex64::from_polar(6.0 * width * size, -omega)
}

/// The history of an amplitude from `late_s` after the beginning of the period.
fn history(amplitude: impl Fn(f64) -> Complex64, late_s: f64) -> Vec<f64> {
    let terms: Vec<(f64, Complex64)> = (1..=HARMONICS)
        .map(|k| TAU * k as f64 / PERIOD_S)
        .map(|omega| (omega, amplitude(omega)))
        .collect();
    let at = |time_s: f64| {
        terms.iter().map(|(omega, a)| 2.0 * (a * Complex64::cis(omega * time_s)).re).sum()
    };
    (0..SAMPLES).map(|k| at(STEP_S * k as f64 - late_s)).collect()
}

/// What a sensor records with noise of a share of its size: `gain · exact + offset`.
fn channel(
    sensor: Sensor,
    (gain, offset): (f64, f64),
    late_s: f64,
    random: &mut Random,
) -> Channel {
    let mut exact = history(|omega| torque(omega) * per_torque(sensor, omega), late_s);
    // The sum leaves the mean open: it is that of a link at rest before.
    let rest = exact[0];
    for x in &mut exact {
        *x -= rest;
    }
    let rms = (exact.iter().map(|x| x * x).sum::<f64>() / exact.len() as f64).sqrt();
    let noise = 0.02 * gain.abs() * rms;
    let samples = exact.iter().map(|x| gain * x + offset + noise * random.box_muller());
    let is_si = (gain - 1.0).abs() < f64::EPSILON;
    Channel {
        sensor,
        gain: if is_si { Gain::Known } else { Gain::Free },
        has_offset: offset != 0.0,
        uncertainty: Some(noise),
        unit: 1.0,
        samples: samples.collect(),
    }
}

fn measured(input: RecordInput, channels: Vec<Channel>, is_delay_free: bool) -> Measurements {
    let record = Record::new("r.csv".into(), STEP_S, input, channels, is_delay_free).unwrap();
    Measurements::new(vec![], vec![], vec![record]).unwrap()
}

fn torque_input() -> RecordInput {
    RecordInput::Torque(history(torque, 0.0), Interpolation::Cubic)
}

/// Fits from a file whose free values are all wrong.
fn fit(measured: &Measurements, free: &[&str]) -> FitOutcome {
    let beta_s = if free.contains(&"damping.beta") { 0.0036 } else { BETA_S };
    let damping = format!("model = 'rayleigh'\nbeta = {beta_s}");
    fitted(&free_text([7.0, 0.6, 0.13, 0.2], &damping), measured, free).unwrap()
}

/// The true factors lie within three standard errors, which are below 3 %.
fn check(found: &FitOutcome) {
    assert_eq!((&found.misfit, found.undetermined.len()), (&None, 0), "{found:?}");
    for value in &found.values {
        let exact = match value.path.as_str() {
            "segments.*.EI" => 5.0 / 7.0,
            "segments.*.mass_per_length" => 0.8 / 0.6,
            "hub.inertia" => 0.1 / 0.13,
            "payload.mass" => 0.3 / 0.2,
            _ => BETA_S / 0.0036,
        };
        let error = value.relative_standard_error.unwrap();
        assert!(error < 0.03, "{value:?}");
        assert!((value.factor / exact).ln().abs() < 3.0 * error, "{value:?}, not {exact}");
    }
}

#[test]
fn a_torque_and_two_sensors_in_si_determine_all_five_values() {
    let mut random = Random(31);
    let sensors = [Sensor::HubAngle, Sensor::TipAcceleration];
    let channels = sensors.map(|sensor| channel(sensor, (1.0, 0.0), 0.0, &mut random));
    let measured = measured(torque_input(), channels.to_vec(), false);
    check(&fit(&measured, &[&MECHANICAL[..], &["damping.beta"]].concat()));
}

#[test]
fn gain_sign_offset_and_delay_are_found_beside_the_values() {
    for late_s in [0.0, 0.0234, -0.016, -0.05, 0.31] {
        late_by(late_s);
    }
}

fn late_by(late_s: f64) {
    let mut random = Random(32);
    let channels = vec![
        channel(Sensor::HubAngle, (1.0, 0.4), late_s, &mut random),
        channel(Sensor::RootStrain, (-37.0, 2.0), late_s, &mut random),
    ];
    let found = fit(&measured(torque_input(), channels, true), &MECHANICAL);
    check(&found);
    let record = &found.records[0];
    let error_s = record.delay_standard_error_s.unwrap();
    assert!(error_s < 1e-3, "{record:?}");
    assert!((record.delay_s.unwrap() - late_s).abs() < 3.5 * error_s, "{record:?}");
    assert!((record.channels[1].gain.unwrap() / -37.0 - 1.0).abs() < 0.02, "{record:?}");
    assert!((record.channels[1].offset.unwrap() - 2.0).abs() < 0.02, "{record:?}");
    assert!((record.channels[0].offset.unwrap() - 0.4).abs() < 0.02, "{record:?}");
}

/// `V = T/k + N k_t θ̇` with `k = N k_t/R`.
#[test]
fn a_voltage_drives_the_link_through_its_motor() {
    let (constant, resistance, gear) = (0.042, 8.4, 30.0);
    let motor = Motor::new(constant, resistance, gear).unwrap();
    let voltage = |omega| {
        let back = gear * constant * per_torque(Sensor::HubRate, omega);
        torque(omega) * (resistance / (gear * constant) + back)
    };
    let input = RecordInput::Voltage(history(voltage, 0.0), Interpolation::Cubic, motor);
    let mut random = Random(33);
    let sensors = [Sensor::HubAngle, Sensor::TipDeflection];
    let channels = sensors.map(|sensor| channel(sensor, (1.0, 0.0), 0.0, &mut random));
    check(&fit(&measured(input, channels.to_vec(), false), &MECHANICAL));
}

#[test]
fn a_recorded_hub_says_nothing_of_its_inertia() {
    let angle = history(|omega| torque(omega) * per_torque(Sensor::HubAngle, omega), 0.0);
    let mut random = Random(34);
    let sensors = [Sensor::TipDeflection, Sensor::TipAcceleration];
    let channels = sensors.map(|sensor| channel(sensor, (1.0, 0.0), 0.0, &mut random));
    let measured = measured(RecordInput::HubAngle(angle), channels.to_vec(), false);
    let found = fit(&measured, &["segments.*.EI", "hub.inertia", "damping.beta"]);
    let powers: Vec<&str> = found
        .undetermined
        .iter()
        .flat_map(|of| &of.powers)
        .map(|(path, _)| path.as_str())
        .collect();
    assert_eq!(powers, ["hub.inertia"], "{found:?}");
    let found = fitted(
        &free_text([7.0, 0.8, 0.1, 0.3], "model = 'rayleigh'\nbeta = 0.0036"),
        &measured,
        &["segments.*.EI", "damping.beta"],
    );
    check(&found.unwrap());
}

#[test]
fn a_record_of_another_sensor_is_no_fit() {
    let mut random = Random(35);
    let mut wrong = channel(Sensor::HubAngle, (1.0, 0.0), 0.0, &mut random);
    wrong.sensor = Sensor::TipDeflection;
    let found = fit(&measured(torque_input(), vec![wrong], false), &MECHANICAL);
    assert!(matches!(found.misfit, Some(Misfit::Far { .. })), "{found:?}");
}

/// What is not compared at the end of a record with a free delay does not matter.
#[test]
fn a_disturbed_end_is_no_reason_for_an_early_sensor() {
    let mut random = Random(36);
    let mut own = channel(Sensor::HubAngle, (1.0, 0.0), 0.0, &mut random);
    for (k, sample) in own.samples[920..].iter_mut().enumerate() {
        *sample += 0.01 * k as f64;
    }
    let link = free_text([7.0, 0.8, 0.1, 0.3], &format!("model = 'rayleigh'\nbeta = {BETA_S}"));
    let found = fitted(&link, &measured(torque_input(), vec![own], true), &["segments.*.EI"]);
    let found = found.unwrap();
    let record = &found.records[0];
    assert!(record.delay_s.unwrap().abs() < 0.1 * STEP_S, "{record:?}");
}

#[test]
fn a_short_record_has_a_short_delay() {
    let mut random = Random(37);
    let mut own = channel(Sensor::HubAngle, (1.0, 0.0), 0.0, &mut random);
    let mut torque = history(torque, 0.0);
    for samples in [4, 5, 50, 130] {
        own.samples.truncate(130);
        torque.truncate(130);
        let (from, own_samples) = (130 - samples, own.samples.clone());
        let short = Channel { samples: own_samples[from..].to_vec(), ..own.clone() };
        let input = RecordInput::Torque(torque[from..].to_vec(), Interpolation::Cubic);
        let record = Record::new("r.csv".into(), STEP_S, input, vec![short], true);
        let Ok(record) = record else { continue };
        let measured = Measurements::new(vec![], vec![], vec![record]).unwrap();
        let found = fit(&measured, &["segments.*.EI"]);
        let delay_s = found.records[0].delay_s.unwrap();
        assert!(delay_s.abs() <= (samples / 4) as f64 * STEP_S + 1e-9, "{samples}: {found:?}");
    }
}

/// Two sensors, one ten times as noisy: without uncertainties each has a noise of its own, and the standard errors
/// are those of known ones.
#[test]
fn sensors_without_uncertainties_weigh_by_what_they_show() {
    let mut random = Random(38);
    let quiet = channel(Sensor::HubAngle, (1.0, 0.0), 0.0, &mut random);
    let mut noisy = channel(Sensor::TipAcceleration, (1.0, 0.0), 0.0, &mut random);
    let deviation = 10.0 * noisy.uncertainty.unwrap();
    for sample in &mut noisy.samples {
        *sample += deviation * random.box_muller();
    }
    let errors = |uncertainties: [Option<f64>; 2]| -> Vec<f64> {
        let channels = [&quiet, &noisy].into_iter().zip(uncertainties);
        let channels = channels.map(|(own, uncertainty)| Channel { uncertainty, ..own.clone() });
        let found = fit(&measured(torque_input(), channels.collect(), false), &MECHANICAL);
        check(&found);
        found.values.iter().map(|value| value.relative_standard_error.unwrap()).collect()
    };
    let known = errors([quiet.uncertainty, Some(1.005 * deviation)]);
    for (shown, known) in errors([None, None]).iter().zip(known) {
        assert!((shown / known - 1.0).abs() < 0.1, "{shown} is not {known}");
    }
}

/// What a user must know of a record, and what makes it none to believe.
#[test]
fn lost_samples_large_uncertainties_and_clipped_sensors_are_told() {
    let warned = |found: &FitOutcome| -> Vec<String> {
        found.warnings().into_iter().map(|warning| warning.kind).collect()
    };
    let mut random = Random(39);
    let own = channel(Sensor::HubAngle, (1.0, 0.0), 0.0, &mut random);
    let of =
        |channel: Channel| fit(&measured(torque_input(), vec![channel], false), &["segments.*.EI"]);
    let true_link = |channel: Channel| {
        let link = free_text([7.0, 0.8, 0.1, 0.3], "model = 'rayleigh'\nbeta = 0.006");
        let measured = measured(torque_input(), vec![channel], false);
        fitted(&link, &measured, &["segments.*.EI"]).unwrap()
    };
    let clean = true_link(own.clone());
    assert_eq!(warned(&clean), Vec::<String>::new(), "{clean:?}");
    let mut lost = Channel { uncertainty: None, ..own.clone() };
    lost.samples[300] = 10.0 * lost.samples[120];
    assert_eq!(warned(&true_link(lost)), ["stray_sample"]);
    let large = Channel { uncertainty: own.uncertainty.map(|u| 10.0 * u), ..own.clone() };
    assert_eq!(warned(&true_link(large)), ["small_chi_squared"]);
    let limit = 0.3 * own.samples.iter().fold(0.0_f64, |m, sample| m.max(sample.abs()));
    let clipped = own.samples.iter().map(|sample| sample.clamp(-limit, limit)).collect();
    let clipped = Channel { uncertainty: None, samples: clipped, ..own };
    let found = of(clipped);
    assert!(matches!(found.misfit, Some(Misfit::Lacking { .. } | Misfit::Far { .. })), "{found:?}");
}

/// An encoder of 1024 counts as the input: its steps are no motion.
#[test]
fn a_hub_angle_of_few_counts_is_told() {
    let angle = history(|omega| torque(omega) * per_torque(Sensor::HubAngle, omega), 0.0);
    let mut random = Random(40);
    let own = channel(Sensor::TipAcceleration, (1.0, 0.0), 0.0, &mut random);
    let noise = |step: f64| {
        let angle = angle.iter().map(|x| if step > 0.0 { (x / step).round() * step } else { *x });
        let input = RecordInput::HubAngle(angle.collect());
        let found = fit(&measured(input, vec![own.clone()], false), &["segments.*.EI"]);
        found.records[0].input_noise
    };
    assert_eq!(noise(0.0), None);
    let share = noise(std::f64::consts::TAU / 1024.0).unwrap();
    assert!((1e-3..1e-1).contains(&share), "{share}");
}
