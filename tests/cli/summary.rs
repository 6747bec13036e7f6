//! summary.json: what a script may rely on.

use serde_json::Value;

use super::{Bench, column, keys, number, peak};

fn summary(bench: &Bench, arguments: &str) -> Value {
    bench.solve(arguments);
    bench.json("out/summary.json")
}

/// The names of the entries at these places, in the order of the alphabet.
#[track_caller]
pub(super) fn assert_keys(summary: &Value, expected: &[(&str, &str)]) {
    for (path, expected) in expected {
        let mut found = keys(summary.pointer(path).unwrap());
        found.sort_unstable();
        assert_eq!(found.join(" "), *expected, "{path}");
    }
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
    let summary = summary(&Bench::new(), "");
    let whole = "analysis command drive errors files flexlink format inputs link mesh \
                 modal_damping_ratios motion natural_frequencies_hz periods_s remarks results title \
                 verification warnings zeros_per_s";
    assert_keys(
        &summary,
        &[
            ("", whole),
            ("/inputs/link", "name sha256"),
            ("/inputs/motion", "name sha256"),
            ("/link", "damping hub length_m masses payload rigid_inertia_kg_m2 segments"),
            (
                "/results",
                "lag_s lead_s peak_deflection_m peak_hub_acceleration_rad_s2 peak_hub_angle_rad \
                 peak_hub_rate_rad_s peak_power_w \
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
        ],
    );
    for key in ["period_s", "fft_length", "highest_frequency_hz", "tolerance", "rows"] {
        assert!(summary["analysis"][key].is_number(), "{key}");
    }
}

#[test]
fn inputs_are_named_without_their_folders_and_fingerprinted() {
    let bench = Bench::new();
    let summary = summary(&bench, "--moments");
    for (input, name) in [("link", "bayo1987_example1.toml"), ("motion", "sine_0.88s.csv")] {
        assert_eq!(summary["inputs"][input]["name"], name);
        let fingerprint = summary["inputs"][input]["sha256"].as_str().unwrap();
        assert!(fingerprint.len() == 64 && fingerprint.chars().all(|c| c.is_ascii_hexdigit()));
    }
    let folder = bench.folder.path().to_str().unwrap().to_owned();
    for text in texts(&summary) {
        assert!(!text.contains(&folder) && !text.starts_with('/'), "{text}");
    }
    assert_eq!(summary["flexlink"], env!("CARGO_PKG_VERSION"));
    // The files named are the files there, the summary last.
    let mut named = texts(&summary["files"]);
    assert_eq!(named.last(), Some(&"summary.json"));
    named.sort_unstable();
    assert_eq!(bench.names("out"), named);
}

#[test]
fn numbers_are_those_of_the_tables() {
    let bench = Bench::new();
    let summary = summary(&bench, "");
    let number = |path: &str| number(&summary, path);
    let [times, torques] =
        ["time_s", "torque_n_m"].map(|name| column(&bench, "out/torque.csv", name));
    // Peaks are those between the rows, too.
    let above = number("results/peak_torque_n_m") / peak(&torques) - 1.0;
    assert!((-1e-9..1e-5).contains(&above), "{above}");
    assert!((number("analysis/window_start_s") - times[0]).abs() < 1e-12);
    assert!((number("analysis/rows") - times.len() as f64).abs() < 0.5);
    assert!((number("periods_s/0") * number("natural_frequencies_hz/0") - 1.0).abs() < 1e-12);
    assert!((number("link/rigid_inertia_kg_m2") - 1.0).abs() < 1e-14);
    // The torque's first crossing of 2 % of its peak, on the straight line between two rows; the tip
    // starts at 0 s.
    let level = 0.02 * number("results/peak_torque_n_m");
    let next = torques.iter().position(|t| t.abs() > level).unwrap();
    let [(t0, a), (t1, b)] = [next - 1, next].map(|k| (times[k], torques[k].abs()));
    let crossing = t0 + (t1 - t0) * (level - a) / (b - a);
    assert!((number("results/lead_s") + crossing).abs() < 1e-9, "{crossing}");
}

#[test]
fn warnings_are_recorded_with_their_kind_and_remedy() {
    let summary = summary(&Bench::new(), "--set analysis.lead=0.1");
    let [warning] = &summary["warnings"].as_array().unwrap()[..] else {
        panic!("{}", summary["warnings"]);
    };
    assert_eq!(warning["kind"], "torque_cut");
    assert!(warning["message"].as_str().unwrap().starts_with("the torque outside the written"));
    assert!(warning["hint"].as_str().unwrap().contains("analysis.lead"));
}
