//! What `flexlink simulate` tells: summary.json and the lines that are printed.

use serde_json::Value;

use super::{Bench, MOTION, column, number, peak, repository, simulated, stderr, stdout};

const PLAYED: &str = "out/torque.csv --target out/tip.csv";

fn solved() -> Bench {
    let bench = Bench::new();
    bench.solve(&["-q"]);
    bench
}

#[test]
fn every_documented_key_is_there() {
    let bench = solved();
    let feedback = "--feedback 20,2 --reference out/hub_angle.csv";
    simulated(&bench, &format!("{PLAYED} {feedback}"));
    let summary = bench.json("simulated/summary.json");
    let whole = "command errors feedback files flexlink format inputs link mesh modes periods_s residual \
                 results tip_error title torque viscous_damping_ratios warnings";
    super::summary::assert_keys(
        &summary,
        &[
            ("", whole),
            ("/inputs", "arguments link reference target torque"),
            ("/inputs/torque", "name sha256"),
            ("/torque", "end_s interpolation samples simulated_until_s start_s step_s"),
            ("/feedback", "damping_n_m_s_rad stiffness_n_m_rad"),
            ("/modes", "highest_hz kept of_mesh torque_band_hz"),
            (
                "/results",
                "farthest_m final_tip_velocity_m_s peak_deflection_m \
                 peak_hub_acceleration_rad_s2 peak_hub_angle_rad \
                 peak_hub_rate_rad_s peak_power_w peak_torque_n_m travel_m",
            ),
            ("/errors", "deflection hub_angle tip"),
            ("/errors/tip", "mesh model"),
            ("/errors/deflection", "model"),
            ("/errors/hub_angle", "mesh"),
            ("/residual", "amplitude_m decay_s frequency_hz share"),
            ("/tip_error", "final_m rms_m share time_s worst_m"),
        ],
    );
    assert_eq!(summary["command"], "simulate");
    assert_eq!(summary["files"].as_array().unwrap().len(), 7);
    // Feedback is recorded as it is given.
    simulated(&bench, &format!("out/torque.csv {feedback} --until 5"));
    let arguments = &bench.json("simulated/summary.json")["inputs"]["arguments"];
    assert_eq!(*arguments, serde_json::json!(["--feedback", "20,2", "--until", "5"]));
}

#[test]
fn what_was_not_given_is_null_and_arguments_are_recorded() {
    let bench = solved();
    let options = "--set payload.mass=0.05 --column torque_n_m --linear --until 5 --nodes 10 --every 7 \
                   --digits full";
    simulated(&bench, &format!("out/torque.csv {options} --no-sync"));
    let summary = bench.json("simulated/summary.json");
    for path in ["/inputs/target", "/inputs/reference", "/feedback", "/tip_error"] {
        assert_eq!(summary.pointer(path), Some(&Value::Null), "{path}");
    }
    let arguments: Vec<&str> = options.split_whitespace().collect();
    assert_eq!(summary["inputs"]["arguments"], serde_json::json!(arguments));
    assert_eq!(summary["torque"]["interpolation"], "linear");
    assert_eq!(summary["inputs"]["torque"]["name"], "torque.csv");
}

#[test]
fn numbers_are_those_of_the_tables() {
    let bench = solved();
    simulated(&bench, PLAYED);
    let summary = bench.json("simulated/summary.json");
    let of = |file: &str, name: &str| column(&bench, &format!("simulated/{file}.csv"), name);
    let tip = of("tip", "tip_displacement_m");
    let wanted = column(&bench, "out/tip.csv", "tip_displacement_m");
    let errors: Vec<f64> = tip.iter().zip(&wanted).map(|(a, b)| a - b).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    let given = column(&bench, "out/torque.csv", "torque_n_m");
    let (angle, rate) = (of("hub_angle", "hub_angle_rad"), of("hub_angle", "hub_rate_rad_s"));
    let power: Vec<f64> = given.iter().zip(&rate).map(|(t, w)| t * w).collect();
    let deflection: Vec<f64> = tip.iter().zip(&angle).map(|(v, a)| v - 1.5 * a).collect();
    let last = tip.len() - 1;
    for (path, expected) in [
        ("results/peak_torque_n_m", peak(&given)),
        ("results/farthest_m", peak(&tip)),
        ("results/travel_m", tip[last]),
        ("results/final_tip_velocity_m_s", of("tip", "tip_velocity_m_s")[last]),
        ("results/peak_hub_angle_rad", peak(&angle)),
        ("results/peak_hub_rate_rad_s", peak(&rate)),
        ("results/peak_power_w", peak(&power)),
        ("results/peak_deflection_m", peak(&deflection)),
        ("tip_error/worst_m", peak(&errors)),
        ("tip_error/share", peak(&errors) / peak(&wanted)),
        ("tip_error/rms_m", rms),
        ("tip_error/final_m", errors[last]),
        ("torque/start_s", -3.676),
        ("torque/simulated_until_s", 4.557),
        ("torque/samples", given.len() as f64),
        ("viscous_damping_ratios/0", 0.02),
    ] {
        let found = number(&summary, path);
        assert!((found - expected).abs() < 2e-9, "{path}: {found} is not {expected}");
    }
    assert_first_mode(&summary);
}

/// The residual vibration is that of the first mode.
#[track_caller]
fn assert_first_mode(summary: &Value) {
    let vibrates = number(summary, "residual/frequency_hz");
    assert!((vibrates * number(summary, "periods_s/0") - 1.0).abs() < 1e-3, "{vibrates} Hz");
}

#[test]
fn a_coarse_step_hides_the_vibration_in_the_rows_only() {
    let bench = Bench::new();
    bench.write("t.csv", "time_s,torque\n0,0\n0.5,1\n1,1\n1.5,0\n");
    let told = stderr(&simulated(&bench, "t.csv"));
    assert!(told.starts_with("warning: the step of 0.5 s leaves 1.1 steps"), "{told}");
    let summary = bench.json("simulated/summary.json");
    assert_first_mode(&summary);
    assert!(number(&summary, "residual/amplitude_m") > 0.001);
}

/// `done` of a bench holds every line to 80 columns.
#[test]
fn lines_have_at_most_eighty_columns() {
    let bench = solved();
    let feedback = "--feedback 1.2345e-7,98765.4321 --reference out/hub_angle.csv";
    for setting in [
        "hub.inertia=0.1234",
        "damping={model=\"rayleigh\",alpha=0.001234,beta=1.234e-5}",
        "damping={model=\"modal\",ratios=[0.01234,0.001234,1.234e-5,0.1,0.2]}",
        "damping={model=\"none\"}",
    ] {
        let options = format!("{PLAYED} --linear --set {setting} {feedback}");
        let text = stdout(&simulated(&bench, &options));
        assert!(text.lines().count() > 8, "{text}");
    }
}

#[test]
fn lines_about_tiny_and_huge_numbers_have_at_most_eighty_columns() {
    let bench = Bench::new();
    let segment = "{ length = 123.4e-6, EI = 1.234e-9, mass_per_length = 1.234e-6 }";
    bench.write("tiny.toml", &format!("segments = [{segment}]\ndamping.ratio = 0.02\n"));
    for (step, torque) in [(1.234e-6, 1.234e-8), (12345.678, -1.234e-12), (1.234e-6, 1.234e12)] {
        let time = |k: f64| step * (k - 100.0);
        let turn = |k: f64| torque * (std::f64::consts::TAU * k / 100.0).sin();
        bench.sampled("torque.csv", "time,torque", 0..=100, |k| [time(k), turn(k)]);
        let wanted = |k: f64| [time(k), -1.234e-9 * k * k];
        bench.sampled("target.csv", "time,displacement", 0..=100, wanted);
        let text = bench.printed("simulate tiny.toml torque.csv --target target.csv --linear");
        assert!(text.lines().count() > 8, "{text}");
    }
    let motion = |k: f64| [1.234e-6 * k, -1.234e-5 * super::min_jerk(k / 100.0)];
    bench.sampled("tiny.csv", "time,displacement", 0..=100, motion);
    bench.done("solve tiny.toml tiny.csv");
}

#[test]
fn the_same_inputs_from_elsewhere_give_the_same_bytes() {
    let (here, there) = (solved(), Bench::new());
    simulated(&here, PLAYED);
    let link = "bayo1987_example1.toml";
    std::fs::copy(repository(&format!("specs/{link}")), there.path(link)).unwrap();
    std::fs::copy(repository(MOTION), there.path("sine_0.88s.csv")).unwrap();
    for name in ["torque.csv", "tip.csv"] {
        std::fs::copy(here.path(&format!("out/{name}")), there.path(name)).unwrap();
    }
    there.done(&format!("simulate {link} torque.csv --target tip.csv -q -o deep/down"));
    assert!(here.contents("simulated") == there.contents("deep/down"));
    there.done(&format!("solve {link} sine_0.88s.csv -q -o deep/downer"));
    assert!(here.contents("out") == there.contents("deep/downer"));
}
