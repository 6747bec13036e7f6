//! `flexlink simulate` beside a recording: a hub angle as input, and channels compared.

use super::{Bench, column, simulated, stderr, stdout};

const MODAL: [&str; 2] = ["--set", "damping.model=modal"];
const TURNED: [&str; 3] = ["out/hub_angle.csv", "--input", "hub-angle"];

fn solved(arguments: &[&str]) -> Bench {
    let bench = Bench::new();
    bench.solve(&[&["-q"], arguments].concat());
    bench
}

#[test]
fn the_hub_angle_of_solve_is_read_as_it_is_and_brings_back_tip_and_torque() {
    let bench = solved(&MODAL);
    let output = simulated(&bench, &[&TURNED[..], &MODAL, &["--target", "out/tip.csv"]].concat());
    assert_eq!(stderr(&output), "");
    let text = stdout(&output);
    let input = "\ninput    hub angle, -1.053 … 1.987 s at 0.00100 s, quintic spline\n";
    assert!(text.contains(input) && text.contains("as the hub's motion takes it\n"), "{text}");
    let summary = bench.json("simulated/summary.json");
    let share = summary["tip_error"]["share"].as_f64().unwrap();
    assert!(share < 1e-6, "{share:e}");
    let torques =
        ["out", "simulated"].map(|run| column(&bench, &format!("{run}/torque.csv"), "torque_n_m"));
    let pairs = torques[0].iter().zip(&torques[1]);
    let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-4, "{worst:e} N m of 1.36");
    assert_eq!(summary["inputs"]["hub_angle"]["name"], "hub_angle.csv");
    assert_eq!(summary["inputs"].get("torque"), None);
    assert_eq!(summary["hub_angle"]["samples"], 3041);
    assert_eq!(summary.get("torque"), None);
    let arguments = [&MODAL[..], &["--input", "hub-angle"]].concat();
    assert_eq!(summary["inputs"]["arguments"], serde_json::json!(arguments));
    // The folder is a run like others.
    bench.done(&["report", "simulated"]);
}

#[test]
fn a_recorded_angle_takes_the_options_of_a_measured_table() {
    let bench = solved(&[]);
    let times = column(&bench, "out/hub_angle.csv", "time_s");
    let angles = column(&bench, "out/hub_angle.csv", "hub_angle_rad");
    let rows = times.iter().zip(&angles);
    let row = |(t, angle): (&f64, &f64)| format!("{:.0};7;{}", 1e3 * t, angle.to_degrees());
    let rows: Vec<String> = rows.map(row).collect();
    bench.write("encoder.csv", &format!("from the rig\n{}\n", rows.join("\n")));
    let read =
        ["--skip", "1", "--columns", "time=1,hub_angle=3", "--time-unit", "ms", "--unit", "deg"];
    let options = ["--digits", "full", "-q"];
    simulated(&bench, &[&TURNED[..], &options].concat());
    let expected = column(&bench, "simulated/tip.csv", "tip_displacement_m");
    simulated(&bench, &[&["encoder.csv", "--input", "hub-angle"], &read[..], &options].concat());
    let found = column(&bench, "simulated/tip.csv", "tip_displacement_m");
    let worst = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-9, "{worst:e}");
}

/// The simulation of `out/torque.csv` as an instrument would write it, every third row, 4 ms late.
fn recording(bench: &Bench) -> String {
    let of = |file: &str, name: &str| column(bench, &format!("simulated/{file}"), name);
    let (time, tip) = (of("tip.csv", "time_s"), of("tip.csv", "tip_displacement_m"));
    let (hub, rate) = (of("hub_angle.csv", "hub_angle_rad"), of("hub_angle.csv", "hub_rate_rad_s"));
    let rows = (0..time.len()).step_by(3).map(|k| {
        let t = 1e3 * time[k] + 4.0;
        let deflection = tip[k] - 1.5 * hub[k];
        format!("{t:.1},{},{},{},{deflection},0\n", hub[k].to_degrees(), rate[k], 1.02e3 * tip[k])
    });
    let head = "Time (ms),Hub angle (deg),hub_rate,tip [mm],tip_deflection_m,strain\n";
    head.to_owned() + &rows.collect::<String>()
}

#[test]
fn channels_are_compared_at_the_recordings_times_and_recorded_in_the_summary() {
    let bench = solved(&[]);
    simulated(&bench, &["out/torque.csv", "-q"]);
    bench.write("rig.csv", &recording(&bench));
    let output = simulated(&bench, &["out/torque.csv", "--measured", "rig.csv"]);
    let told = stderr(&output);
    assert!(told.contains("remark: rig.csv: columns not read: 6 \"strain\"\n"), "{told}");
    let text = stdout(&output);
    let head = "measured 2744 times, -3.672 … 4.557 s; 1 outside the simulation is left out\n";
    assert!(text.contains(head), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let summary = bench.json("simulated/summary.json");
    assert_eq!(summary["inputs"]["measured"]["name"], "rig.csv");
    let channels = summary["measured"]["channels"].as_array().unwrap();
    let names: Vec<_> =
        channels.iter().map(|channel| channel["channel"].as_str().unwrap()).collect();
    assert_eq!(names, ["hub_angle", "hub_rate", "tip", "tip_deflection"]);
    for (channel, gain) in channels.iter().zip([1.0, 1.0, 1.02, 1.0]) {
        let fit = |key: &str| channel["fit"][key].as_f64().unwrap();
        assert!((fit("delay_s") - 0.004).abs() < 1e-6, "{channel}");
        assert!((fit("gain") - gain).abs() < 1e-6 && fit("left") < 1e-5, "{channel}");
        let share = channel["share"].as_f64().unwrap();
        assert!((1e-3..0.1).contains(&share), "{channel}");
    }
    bench.done(&["report", "simulated"]);
}

#[test]
fn a_constant_channel_says_so_in_place_of_a_delay() {
    let bench = solved(&[]);
    let rows: Vec<String> = (0..200).map(|k| format!("{},0.4,{k}", 0.01 * f64::from(k))).collect();
    bench.write("rig.csv", &format!("time,torque,hub_angle\n{}\n", rows.join("\n")));
    let output = simulated(&bench, &["out/torque.csv", "--measured", "rig.csv"]);
    let text = stdout(&output);
    let of = |channel: &str| text.lines().rfind(|line| line.starts_with(channel)).unwrap();
    assert!(of("torque   ").ends_with("-  recording is constant"), "{text}");
    assert!(!of("hub_angle").contains("constant"), "{text}");
    let channels = &bench.json("simulated/summary.json")["measured"]["channels"];
    assert_eq!(channels[1]["no_fit"], "constant_recording");
}
