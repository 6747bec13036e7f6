//! What of summary.json comes back: origin, readings, checks, warnings.

use serde_json::Value;

use super::{Bench, PAPER};

fn json(bench: &Bench, folder: &str) -> Value {
    serde_json::from_str(&bench.read(&format!("{folder}/summary.json"))).unwrap()
}

/// That the numbers of the readings are those of the summary under their keys.
#[track_caller]
fn assert_readings(found: &[(String, f64)], summary: &Value) {
    for (name, number) in found {
        let of = |part: &str, key: &str| summary[part].get(key).and_then(Value::as_f64);
        let of_motion =
            || of("motion", &name.strip_prefix("tip_").unwrap_or(name).replace("_tip", ""));
        let expected = of("results", name)
            .or_else(of_motion)
            .or_else(|| of("residual", name.strip_prefix("residual_")?))
            .or_else(|| of("tip_error", name.strip_prefix("tip_error_")?))
            .or_else(|| error_of(summary, name.strip_suffix("_error")?));
        assert_eq!(expected.map(f64::to_bits), Some(number.to_bits()), "{name}");
    }
}

/// The error of a name such as `tip` or `hub_angle_mesh`.
fn error_of(summary: &Value, name: &str) -> Option<f64> {
    let inner =
        || name.rsplit_once('_').and_then(|(of, kind)| summary["errors"][of][kind].as_f64());
    summary["errors"][name].as_f64().or_else(inner)
}

#[test]
fn a_verified_run_tells_its_origin_numbers_checks_and_warnings() {
    let bench = Bench::new();
    bench.solve(&format!("{PAPER} --set analysis.lead=0.1 --set limits.torque=0.5"));
    let run = bench.run_of("out");
    let summary = json(&bench, "out");
    assert_eq!(
        (run.origin.command.as_str(), run.origin.version.as_str()),
        ("solve", env!("CARGO_PKG_VERSION"))
    );
    assert_eq!(run.origin.title, "Bayo (1987), example 1: I = 0.25e-2 cm^4");
    let inputs: Vec<_> =
        run.origin.inputs.iter().map(|i| (i.role.as_str(), i.name.as_str())).collect();
    assert_eq!(inputs, [("link", "bayo1987_example1.toml"), ("motion", "sine_0.88s.csv")]);
    for input in &run.origin.inputs {
        assert_eq!(summary["inputs"][&input.role]["sha256"], input.sha256);
    }
    let arguments = summary["inputs"]["arguments"].as_array().unwrap();
    assert!(arguments.len() == 8 && arguments.iter().eq(&run.origin.arguments), "{arguments:?}");
    let names: Vec<&str> = run.readings.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[0], "peak_torque_n_m");
    let motion = ["tip_travel_m", "peak_tip_velocity_m_s", "peak_tip_acceleration_m_s2"];
    assert_eq!(names[14..17], motion);
    let expected = ["tip_error", "tip_model_error", "torque_mesh_error", "torque_window_error"];
    assert_eq!(names[17..21], expected, "of each quantity its errors, those that are there");
    assert_readings(&run.readings, &summary);
    let motion = |key: &str| summary["motion"][key].as_f64().unwrap();
    assert_eq!(run.moving_s, Some((motion("moves_from_s"), motion("moves_until_s"))));
    let warnings = summary["warnings"].as_array().unwrap();
    assert!(warnings.len() >= 2 && warnings.len() == run.warnings.len());
    for (found, expected) in run.warnings.iter().zip(warnings) {
        assert_eq!(expected["message"], found.message.as_str());
        assert_eq!(expected["hint"], found.hint.as_str());
    }
    assert!(run.checks.is_empty());
}

#[test]
fn checks_come_back_measured_or_with_the_reason() {
    let bench = Bench::new();
    bench.run(&format!("solve {PAPER} --verify --every 50"), "out");
    let checks = bench.run_of("out").checks;
    let summary = json(&bench, "out");
    let expected = summary["verification"].as_array().unwrap();
    assert!(checks.len() == 9 && expected.len() == 9);
    for (found, expected) in checks.iter().zip(expected) {
        assert_eq!(expected["what"], found.what.as_str());
        assert_eq!(expected["of"], found.of.as_str());
        let number = |key: &str| expected[key].as_f64().map(f64::to_bits);
        assert_eq!(found.found.map(f64::to_bits), number("found"));
        assert_eq!(found.bound.map(f64::to_bits), number("bound"));
        assert!(found.found.is_some() && found.bound.is_some() && found.passes);
    }
    let text = bench.read("out/summary.json");
    let (before, after) = text.split_once("\"found\": ").unwrap();
    let (_, after) = after.split_once("\"passes\": true").unwrap();
    let unmeasured = "null, \"bound\": null, \"reason\": \"no modes\", \"passes\": false";
    bench.write("out/summary.json", &format!("{before}\"found\": {unmeasured}{after}"));
    let check = bench.run_of("out").checks.swap_remove(0);
    assert_eq!((check.reason.as_deref(), check.passes), (Some("no modes"), false));
}

#[test]
fn the_numbers_of_a_simulation_are_named_by_what_they_are_of() {
    let bench = Bench::new();
    bench.solve(PAPER);
    let [torque, tip] = ["out/torque.csv", "out/tip.csv"].map(|name| bench.file(name));
    let link = PAPER.split(' ').next().unwrap();
    bench.run(&["simulate", link, &torque, "--target", &tip], "played");
    let run = bench.run_of("played");
    let names: Vec<&str> = run.readings.iter().map(|(name, _)| name.as_str()).collect();
    let expected = "peak_torque_n_m farthest_m travel_m final_tip_velocity_m_s peak_hub_angle_rad \
                    peak_hub_rate_rad_s peak_hub_acceleration_rad_s2 peak_power_w peak_deflection_m residual_amplitude_m residual_share \
                    residual_frequency_hz residual_decay_s tip_error_worst_m tip_error_share tip_error_time_s \
                    tip_error_rms_m tip_error_final_m tip_mesh_error tip_model_error hub_angle_mesh_error \
                    deflection_model_error";
    assert_eq!(names.join(" "), expected);
    assert_readings(&run.readings, &json(&bench, "played"));
}
