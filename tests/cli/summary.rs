//! summary.json: what a script may rely on.

use serde_json::Value;

use super::{Bench, LINK, MOTION, keys, repository};

fn summary(bench: &Bench, arguments: &[&str]) -> Value {
    bench.solve(arguments);
    bench.json("out/summary.json")
}

/// All texts in a value, however deep.
fn texts(value: &Value) -> Vec<&str> {
    match value {
        Value::String(text) => vec![text],
        Value::Array(items) => items.iter().flat_map(texts).collect(),
        Value::Object(entries) => entries.values().flat_map(texts).collect(),
        _ => vec![],
    }
}

#[test]
fn every_documented_key_is_there() {
    let summary = summary(&Bench::new(), &[]);
    let whole = "analysis command drive errors files flexlink format inputs link mesh \
                 modal_damping_ratios motion natural_frequencies_hz periods_s remarks results title \
                 verification warnings zeros_per_s";
    for (path, expected) in [
        ("", whole),
        ("/inputs/link", "name sha256"),
        ("/inputs/motion", "name sha256"),
        ("/link", "damping hub length_m masses payload rigid_inertia_kg_m2 segments"),
        (
            "/results",
            "lag_s lead_s peak_deflection_m peak_hub_angle_rad peak_hub_rate_rad_s peak_power_w \
             peak_rigid_torque_n_m peak_root_moment_n_m peak_torque_n_m peak_torque_time_s \
             rms_power_w rms_torque_n_m torque_ratio",
        ),
        (
            "/errors",
            "displacement hub_acceleration hub_angle hub_rate motor_rate motor_torque tip tip_model \
             torque",
        ),
        ("/errors/torque", "input mesh model window"),
        ("/errors/displacement", "input mesh model window"),
    ] {
        let mut found = keys(summary.pointer(path).unwrap());
        found.sort_unstable();
        assert_eq!(found.join(" "), expected, "{path}");
    }
    for key in ["period_s", "fft_length", "highest_frequency_hz", "tolerance", "rows"] {
        assert!(summary["analysis"][key].is_number(), "{key}");
    }
}

#[test]
fn inputs_are_named_without_their_folders_and_fingerprinted() {
    let bench = Bench::new();
    let summary = summary(&bench, &[]);
    assert_eq!(summary["inputs"]["link"]["name"], "bayo1987_example1.toml");
    assert_eq!(summary["inputs"]["motion"]["name"], "sine_0.88s.csv");
    for input in ["link", "motion"] {
        let fingerprint = summary["inputs"][input]["sha256"].as_str().unwrap();
        assert!(fingerprint.len() == 64 && fingerprint.chars().all(|c| c.is_ascii_hexdigit()));
    }
    let folder = bench.folder.path().to_str().unwrap().to_owned();
    for text in texts(&summary) {
        assert!(!text.contains(&folder) && !text.starts_with('/'), "{text}");
    }
    assert_eq!(summary["flexlink"], env!("CARGO_PKG_VERSION"));
}

#[test]
fn the_files_named_are_the_files_there_the_summary_last() {
    let bench = Bench::new();
    let summary = summary(&bench, &["--moments"]);
    let mut named: Vec<&str> =
        summary["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert_eq!(named.last(), Some(&"summary.json"));
    named.sort_unstable();
    assert_eq!(bench.names("out"), named);
}

#[test]
fn numbers_are_those_of_the_tables() {
    let bench = Bench::new();
    let summary = summary(&bench, &[]);
    let number = |path: &str| summary.pointer(path).unwrap().as_f64().unwrap();
    let torque = bench.table("out/torque.csv");
    let peak = torque[1].1.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    // Peaks are those between the rows, too.
    let above = number("/results/peak_torque_n_m") / peak - 1.0;
    assert!((-1e-9..1e-5).contains(&above), "{above}");
    assert!((number("/analysis/window_start_s") - torque[0].1[0]).abs() < 1e-12);
    assert!((number("/analysis/rows") - torque[0].1.len() as f64).abs() < 0.5);
    assert!((number("/periods_s/0") * number("/natural_frequencies_hz/0") - 1.0).abs() < 1e-12);
    assert!((number("/link/rigid_inertia_kg_m2") - 1.0).abs() < 1e-14);
    // The torque's first crossing of 2 % of its peak, on the straight line between two rows; the tip
    // starts at 0 s.
    let (times, torques) = (&torque[0].1, &torque[1].1);
    let level = 0.02 * number("/results/peak_torque_n_m");
    let next = torques.iter().position(|t| t.abs() > level).unwrap();
    let [(t0, a), (t1, b)] = [next - 1, next].map(|k| (times[k], torques[k].abs()));
    let crossing = t0 + (t1 - t0) * (level - a) / (b - a);
    assert!((number("/results/lead_s") + crossing).abs() < 1e-9, "{crossing}");
}

#[test]
fn warnings_are_recorded_with_their_kind_and_remedy() {
    let summary = summary(&Bench::new(), &["--set", "analysis.lead=0.1"]);
    let [warning] = &summary["warnings"].as_array().unwrap()[..] else {
        panic!("{}", summary["warnings"]);
    };
    assert_eq!(warning["kind"], "torque_cut");
    assert!(warning["message"].as_str().unwrap().starts_with("the torque outside the written"));
    assert!(warning["hint"].as_str().unwrap().contains("analysis.lead"));
}

#[test]
fn the_same_inputs_from_elsewhere_give_the_same_bytes() {
    let (here, there) = (Bench::new(), Bench::new());
    here.solve(&[]);
    for name in [LINK, MOTION] {
        let own = std::path::Path::new(name).file_name().unwrap().to_str().unwrap();
        std::fs::copy(repository(name), there.path(own)).unwrap();
    }
    there.done(&[
        "solve",
        "bayo1987_example1.toml",
        "sine_0.88s.csv",
        "-o",
        "deep/down/results",
        "-q",
    ]);
    assert!(here.contents("out") == there.contents("deep/down/results"));
}
