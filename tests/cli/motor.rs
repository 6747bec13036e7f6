//! The motor's side of the drive: its numbers in every result, and its limits.

use flexlink::text::significant;

use super::{Bench, LINK, MOTION, column, ended, keys, repository, stderr, stdout, succeeded};

/// A rotor of 2 kg cm² behind a gear of 100, on the spring of a joint.
const DRIVE: &str = "drive={joint_stiffness=100.0, rotor_inertia='2 kg cm^2', gear_ratio=100.0}";

const KEYS: [&str; 5] = [
    "peak_motor_torque_n_m",
    "peak_motor_torque_time_s",
    "rms_motor_torque_n_m",
    "peak_motor_rate_rad_s",
    "peak_motor_power_w",
];

/// Largest absolute value, and its place.
fn peak(samples: &[f64]) -> (f64, usize) {
    let larger = |best: (f64, usize), (k, sample): (usize, &f64)| {
        if sample.abs() > best.0 { (sample.abs(), k) } else { best }
    };
    samples.iter().enumerate().fold((0.0, 0), larger)
}

#[test]
fn the_motors_numbers_are_those_of_its_table() {
    let bench = Bench::new();
    let output = bench.solve(&["--set", DRIVE]);
    let summary = bench.json("out/summary.json");
    let found = KEYS.map(|key| summary["results"][key].as_f64().unwrap());
    let of = |name: &str| column(&bench, "out/motor.csv", name);
    let torque = of("motor_torque_n_m");
    let (highest, at) = peak(&torque);
    let acts = |t: &f64| t.abs() > 0.02 * highest;
    let [first, last] = [torque.iter().position(acts), torque.iter().rposition(acts)];
    let acting = &torque[first.unwrap()..=last.unwrap()];
    let rms = (acting.iter().map(|t| t * t).sum::<f64>() / acting.len() as f64).sqrt();
    let [rate, power] = ["motor_rate_rad_s", "motor_power_w"].map(|name| peak(&of(name)).0);
    let expected = [highest, of("time_s")[at], rms, rate, power];
    for ((found, expected), key) in found.iter().zip(expected).zip(KEYS) {
        // Peaks are those between the rows, too; the time of one is within half a step.
        let is_time = key.ends_with("time_s");
        let above = if is_time { (found - expected).abs() } else { found / expected - 1.0 };
        let allowed = if is_time || key.contains("power") { 1e-3 } else { 1e-5 };
        assert!((-1e-9..allowed).contains(&above), "{key}: {found} is not {expected}");
    }
    let text = stdout(&output);
    let line = text.lines().find(|line| line.starts_with("motor ")).unwrap();
    assert!(line.chars().count() <= 80, "{line}");
    let after = text.lines().position(|line| line.starts_with("hub ")).unwrap() + 1;
    assert_eq!(text.lines().nth(after), Some(line));
    let numbers: Vec<f64> = line.split([' ', ',', ';']).filter_map(|w| w.parse().ok()).collect();
    for (shown, found) in numbers.iter().zip(found) {
        assert!((shown / found - 1.0).abs() < 6e-3, "{line}: {found}");
    }
    assert_eq!(numbers.len(), found.len(), "{line}");
}

#[test]
fn without_a_drive_no_motor_is_told_of() {
    let bench = Bench::new();
    let output = bench.solve(&[]);
    let summary = bench.json("out/summary.json");
    assert!(keys(&summary["results"]).iter().all(|key| !key.contains("motor")));
    assert!(!stdout(&output).contains("motor"));
    let arguments = ["sweep", &repository(LINK), &repository(MOTION), "--vary", "hub.inertia=0.1"];
    bench.done(&arguments);
    assert!(!bench.read("sweep.csv").contains("motor"));
}

#[test]
fn a_sweep_over_gears_tells_the_motors_numbers_and_its_page_shows_them() {
    let bench = Bench::new();
    let (link, motion) = (repository(LINK), repository(MOTION));
    let arguments = ["sweep", &link, &motion, "--set", DRIVE, "--vary", "drive.gear_ratio=10,50"];
    bench.done(&arguments);
    let sweep = bench.read("sweep.csv");
    let mut rows = sweep.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let told: Vec<&str> = header.iter().copied().filter(|name| name.contains("motor")).collect();
    assert_eq!(told, [KEYS[0], KEYS[2], KEYS[3], KEYS[4]]);
    for row in rows {
        let gear = format!("drive.gear_ratio={}", row[0]);
        bench.solve(&["--set", DRIVE, "--set", &gear]);
        let summary = bench.json("out/summary.json");
        for name in &told {
            let at = header.iter().position(|heading| heading == name).unwrap();
            let found: f64 = row[at].parse().unwrap();
            let expected = summary["results"][name].as_f64().unwrap();
            assert!((found / expected - 1.0).abs() < 1e-11, "{name}: {found} is not {expected}");
        }
    }
    bench.done(&["report", "sweep.csv", "-o", "page.html"]);
    assert!(bench.read("page.html").contains("Peak torque of the motor"));
}

#[test]
fn the_page_of_a_run_shows_the_motors_numbers() {
    let bench = Bench::new();
    bench.solve(&["--set", DRIVE, "--report"]);
    let page = bench.read("out/report.html");
    for words in ["peak motor torque", "rms motor torque", "peak motor rate", "peak motor power"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn limits_of_the_motor_are_held_beside_the_hubs() {
    let bench = Bench::new();
    let (link, motion) = (repository(LINK), repository(MOTION));
    let strict = |limits: &str| {
        let limits = format!("limits={{{limits}}}");
        let set = ["--set", DRIVE, "--set", &limits, "--strict", "-q"];
        bench.run(&[&["solve", &link, &motion], &set[..]].concat())
    };
    bench.solve(&["--set", DRIVE]);
    let results = &bench.json("out/summary.json")["results"];
    for (key, of) in [
        ("motor_torque", KEYS[0]),
        ("motor_rms_torque", KEYS[2]),
        ("motor_rate", KEYS[3]),
        ("motor_power", KEYS[4]),
    ] {
        let found = results[of].as_f64().unwrap();
        succeeded(strict(&format!("{key}={:?}", 1.01 * found)));
        let exceeded = ended(4, strict(&format!("{key}={:?}", 0.99 * found)));
        let error = stderr(&exceeded);
        assert!(error.contains(&format!("error: limits.{key} = ")), "{error}");
        assert!(error.contains(&format!("is exceeded: {} ", significant(found, 5))), "{error}");
    }
    // The torque of the limit without a name is the hub's, 100 times as much as the motor's.
    let hub = results["peak_torque_n_m"].as_f64().unwrap();
    assert!(strict(&format!("torque={:?}", 1.01 * hub)).status.success());
}
