//! What `flexlink simulate` tells: summary.json and the lines that are printed.

use serde_json::Value;

use super::{Bench, column, keys, repository, simulated, stderr, stdout};

const PLAYED: [&str; 3] = ["out/torque.csv", "--target", "out/tip.csv"];

fn solved() -> Bench {
    let bench = Bench::new();
    bench.solve(&["-q"]);
    bench
}

fn number(summary: &Value, path: &str) -> f64 {
    summary.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}"))
}

fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |m, x| m.max(x.abs()))
}

#[test]
fn every_documented_key_is_there() {
    let bench = solved();
    let feedback = ["--feedback", "20,2", "--reference", "out/hub_angle.csv"];
    simulated(&bench, &[&PLAYED[..], &feedback].concat());
    let summary = bench.json("simulated/summary.json");
    let whole = "command errors feedback files flexlink format inputs link mesh modes periods_s residual \
                 results tip_error title torque viscous_damping_ratios warnings";
    for (path, expected) in [
        ("", whole),
        ("/inputs", "arguments link reference target torque"),
        ("/inputs/torque", "name sha256"),
        ("/torque", "end_s interpolation samples simulated_until_s start_s step_s"),
        ("/feedback", "damping_n_m_s_rad stiffness_n_m_rad"),
        ("/modes", "highest_hz kept of_mesh torque_band_hz"),
        (
            "/results",
            "farthest_m final_tip_velocity_m_s peak_deflection_m peak_hub_angle_rad \
             peak_hub_rate_rad_s peak_power_w peak_torque_n_m travel_m",
        ),
        ("/errors", "deflection hub_angle tip"),
        ("/errors/tip", "mesh model"),
        ("/errors/deflection", "model"),
        ("/errors/hub_angle", "mesh"),
        ("/residual", "amplitude_m decay_s frequency_hz share"),
        ("/tip_error", "final_m rms_m share time_s worst_m"),
    ] {
        let mut found = keys(summary.pointer(path).unwrap());
        found.sort_unstable();
        assert_eq!(found.join(" "), expected, "{path}");
    }
    assert_eq!(summary["command"], "simulate");
    assert_eq!(summary["files"].as_array().unwrap().len(), 7);
}

#[test]
fn what_was_not_given_is_null_and_arguments_are_recorded() {
    let bench = solved();
    let options =
        ["--set", "payload.mass=0.05", "--column", "torque_n_m", "--until", "5", "--linear"];
    let thinned = ["--nodes", "10", "--every", "7", "--digits", "full"];
    simulated(&bench, &[&["out/torque.csv"], &options[..], &thinned, &["--no-sync"]].concat());
    let summary = bench.json("simulated/summary.json");
    for path in ["/inputs/target", "/inputs/reference", "/feedback", "/tip_error"] {
        assert_eq!(summary.pointer(path), Some(&Value::Null), "{path}");
    }
    let arguments = [&options[..], &thinned].concat();
    assert_eq!(summary["inputs"]["arguments"], serde_json::json!(arguments));
    assert_eq!(summary["torque"]["interpolation"], "linear");
    assert_eq!(summary["inputs"]["torque"]["name"], "torque.csv");
}

#[test]
fn feedback_is_recorded_as_it_is_given() {
    let bench = solved();
    let feedback = ["--feedback", "20,2", "--reference", "out/hub_angle.csv", "--until", "5"];
    simulated(&bench, &[&["out/torque.csv"], &feedback[..]].concat());
    let arguments = &bench.json("simulated/summary.json")["inputs"]["arguments"];
    assert_eq!(*arguments, serde_json::json!(["--until", "5", "--feedback", "20,2"]));
}

#[test]
fn numbers_are_those_of_the_tables() {
    let bench = solved();
    simulated(&bench, &PLAYED);
    let summary = bench.json("simulated/summary.json");
    let of = |file: &str, name: &str| column(&bench, &format!("simulated/{file}"), name);
    let (tip, wanted) =
        (of("tip.csv", "tip_displacement_m"), column(&bench, "out/tip.csv", "tip_displacement_m"));
    let errors: Vec<f64> = tip.iter().zip(&wanted).map(|(a, b)| a - b).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    let given = column(&bench, "out/torque.csv", "torque_n_m");
    let (angle, rate) =
        (of("hub_angle.csv", "hub_angle_rad"), of("hub_angle.csv", "hub_rate_rad_s"));
    let power: Vec<f64> = given.iter().zip(&rate).map(|(t, w)| t * w).collect();
    let deflection: Vec<f64> = tip.iter().zip(&angle).map(|(v, a)| v - 1.5 * a).collect();
    let last = tip.len() - 1;
    let velocity = of("tip.csv", "tip_velocity_m_s")[last];
    for (path, expected) in [
        ("/results/peak_torque_n_m", peak(&given)),
        ("/results/farthest_m", peak(&tip)),
        ("/results/travel_m", tip[last]),
        ("/results/final_tip_velocity_m_s", velocity),
        ("/results/peak_hub_angle_rad", peak(&angle)),
        ("/results/peak_hub_rate_rad_s", peak(&rate)),
        ("/results/peak_power_w", peak(&power)),
        ("/results/peak_deflection_m", peak(&deflection)),
        ("/tip_error/worst_m", peak(&errors)),
        ("/tip_error/share", peak(&errors) / peak(&wanted)),
        ("/tip_error/rms_m", rms),
        ("/tip_error/final_m", errors[last]),
        ("/torque/start_s", -3.676),
        ("/torque/simulated_until_s", 4.557),
        ("/torque/samples", given.len() as f64),
        ("/viscous_damping_ratios/0", 0.02),
    ] {
        let found = number(&summary, path);
        assert!((found - expected).abs() < 2e-9, "{path}: {found} is not {expected}");
    }
    let first = 1.0 / number(&summary, "/periods_s/0");
    let vibrates = number(&summary, "/residual/frequency_hz");
    assert!((vibrates / first - 1.0).abs() < 1e-3, "{vibrates} Hz in the first mode");
}

#[test]
fn a_coarse_step_hides_the_vibration_in_the_rows_only() {
    let bench = Bench::new();
    bench.write("t.csv", "time,torque\n0,0\n0.5,1\n1,1\n1.5,0\n");
    let output = simulated(&bench, &["t.csv"]);
    assert!(stderr(&output).starts_with("warning: the step of 0.5 s leaves 1.1 steps"));
    let summary = bench.json("simulated/summary.json");
    let first = 1.0 / number(&summary, "/periods_s/0");
    let vibrates = number(&summary, "/residual/frequency_hz");
    assert!((vibrates / first - 1.0).abs() < 1e-3, "{vibrates} Hz in the first mode");
    assert!(number(&summary, "/residual/amplitude_m") > 0.001);
}

/// Lines fit a terminal of 80 columns and end with a word.
#[track_caller]
fn fits(text: &str) {
    assert!(text.lines().count() > 8, "{text}");
    for line in text.lines() {
        assert!(line.chars().count() <= 80 && line.trim_end() == line, "{line:?}");
    }
}

#[test]
fn lines_have_at_most_eighty_columns() {
    let bench = solved();
    let rayleigh = "damping={model=\"rayleigh\", alpha=0.001234, beta=1.234e-5}";
    let ratios = "damping={model=\"modal\", ratios=[0.01234, 0.001234, 1.234e-5, 0.1, 0.2]}";
    for setting in ["hub.inertia=0.1234", rayleigh, ratios, "damping={model=\"none\"}"] {
        let feedback = ["--feedback", "1.2345e-7,98765.4321", "--reference", "out/hub_angle.csv"];
        let options = [&PLAYED[..], &["--linear", "--set", setting], &feedback].concat();
        let output = simulated(&bench, &options);
        fits(&stdout(&output));
    }
}

#[test]
fn lines_about_tiny_and_huge_numbers_have_at_most_eighty_columns() {
    let bench = Bench::new();
    let segment = "{ length = 123.4e-6, EI = 1.234e-9, mass_per_length = 1.234e-6 }";
    bench.write("tiny.toml", &format!("segments = [{segment}]\ndamping.ratio = 0.02\n"));
    for (step, torque) in [(1.234e-6, 1.234e-8), (12345.678, -1.234e-12), (1.234e-6, 1.234e12)] {
        let row = |k: i32| {
            let u = f64::from(k) / 100.0;
            let turn = (std::f64::consts::TAU * u).sin();
            let (t, wanted) = (step * f64::from(k - 100), -1.234e-5 * u * u);
            (format!("{t:e},{:e}\n", torque * turn), format!("{t:e},{wanted:e}\n"))
        };
        let (torque, target): (String, String) = (0..=100).map(row).unzip();
        bench.write("torque.csv", &format!("time,torque\n{torque}"));
        bench.write("target.csv", &format!("time,displacement\n{target}"));
        let output = bench.done(&[
            "simulate",
            "tiny.toml",
            "torque.csv",
            "--target",
            "target.csv",
            "--linear",
        ]);
        fits(&stdout(&output));
    }
}

#[test]
fn the_same_inputs_from_elsewhere_give_the_same_bytes() {
    let (here, there) = (solved(), Bench::new());
    simulated(&here, &PLAYED);
    let link = "bayo1987_example1.toml";
    std::fs::copy(repository(&format!("specs/{link}")), there.path(link)).unwrap();
    for name in ["torque.csv", "tip.csv"] {
        std::fs::copy(here.path(&format!("out/{name}")), there.path(name)).unwrap();
    }
    let arguments = ["torque.csv", "--target", "tip.csv", "-o", "deep/down", "-q"];
    there.done(&[&["simulate", link], &arguments[..]].concat());
    assert!(here.contents("simulated") == there.contents("deep/down"));
}
