//! `flexlink simulate` beside a recording: a hub angle as input, and channels compared.

use super::{Bench, apart, column, number, simulated, stderr, stdout};

const TURNED: &str = "out/hub_angle.csv --input hub-angle";

fn solved(arguments: &str) -> Bench {
    let bench = Bench::new();
    bench.solve(&format!("-q {arguments}"));
    bench
}

#[test]
fn the_hub_angle_of_solve_is_read_as_it_is_and_brings_back_tip_and_torque() {
    let bench = solved("--set damping.model=modal");
    let turned = format!("{TURNED} --set damping.model=modal --target out/tip.csv");
    let output = simulated(&bench, &turned);
    assert_eq!(stderr(&output), "");
    let text = stdout(&output);
    let input = "\ninput    hub angle, -1.053 … 1.987 s at 0.00100 s, quintic spline\n";
    assert!(text.contains(input) && text.contains("as the hub's motion takes it\n"), "{text}");
    let summary = bench.json("simulated/summary.json");
    assert!(number(&summary, "tip_error/share") < 1e-6, "{}", summary["tip_error"]);
    let [own, solved] =
        ["simulated", "out"].map(|run| column(&bench, &format!("{run}/torque.csv"), "torque_n_m"));
    assert!(apart(&own, &solved) < 1e-4, "{:e} N m of 1.36", apart(&own, &solved));
    assert_eq!(summary["inputs"]["hub_angle"]["name"], "hub_angle.csv");
    assert_eq!(summary["inputs"].get("torque"), None);
    assert_eq!(summary["hub_angle"]["samples"], 3041);
    assert_eq!(summary.get("torque"), None);
    let arguments = ["--set", "damping.model=modal", "--input", "hub-angle"];
    assert_eq!(summary["inputs"]["arguments"], serde_json::json!(arguments));
    // The folder is a run like others.
    bench.done("report simulated");
}

#[test]
fn a_recorded_angle_takes_the_options_of_a_measured_table() {
    let bench = solved("");
    let [times, angles] =
        ["time_s", "hub_angle_rad"].map(|name| column(&bench, "out/hub_angle.csv", name));
    let rows = times.iter().zip(&angles);
    let rows = rows.map(|(t, angle)| format!("{:.0};7;{}\n", 1e3 * t, angle.to_degrees()));
    bench.write("encoder.csv", &format!("from the rig\n{}", rows.collect::<String>()));
    let read = "--skip 1 --columns time=1,hub_angle=3 --time-unit ms --unit deg";
    let tips = [TURNED, &format!("encoder.csv --input hub-angle {read}")].map(|arguments| {
        simulated(&bench, &format!("{arguments} --digits full -q"));
        column(&bench, "simulated/tip.csv", "tip_displacement_m")
    });
    assert!(apart(&tips[0], &tips[1]) < 1e-9);
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
    let bench = solved("");
    simulated(&bench, "out/torque.csv -q");
    bench.write("rig.csv", &recording(&bench));
    let output = simulated(&bench, "out/torque.csv --measured rig.csv");
    let told = stderr(&output);
    assert!(told.contains("remark: rig.csv: columns not read: 6 \"strain\"\n"), "{told}");
    let text = stdout(&output);
    let head = "measured 2744 times, -3.672 … 4.557 s; 1 outside the simulation is left out\n";
    assert!(text.contains(head), "{text}");
    let summary = bench.json("simulated/summary.json");
    assert_eq!(summary["inputs"]["measured"]["name"], "rig.csv");
    let channels = summary["measured"]["channels"].as_array().unwrap();
    let expected = [("hub_angle", 1.0), ("hub_rate", 1.0), ("tip", 1.02), ("tip_deflection", 1.0)];
    assert_eq!(channels.len(), expected.len());
    for (channel, (name, gain)) in channels.iter().zip(expected) {
        assert_eq!(channel["channel"], name);
        let fit = |key: &str| number(&channel["fit"], key);
        assert!((fit("delay_s") - 0.004).abs() < 1e-6, "{channel}");
        assert!((fit("gain") - gain).abs() < 1e-6 && fit("left") < 1e-5, "{channel}");
        assert!((1e-3..0.1).contains(&number(channel, "share")), "{channel}");
    }
    bench.done("report simulated");
}

#[test]
fn a_constant_channel_says_so_in_place_of_a_delay() {
    let bench = solved("");
    bench.sampled("rig.csv", "time,torque,hub_angle", 0..200, |k| [0.01 * k, 0.4, k]);
    let text = stdout(&simulated(&bench, "out/torque.csv --measured rig.csv"));
    let of = |channel: &str| text.lines().rfind(|line| line.starts_with(channel)).unwrap();
    assert!(of("torque   ").ends_with("-  recording is constant"), "{text}");
    assert!(!of("hub_angle").contains("constant"), "{text}");
    let channels = &bench.json("simulated/summary.json")["measured"]["channels"];
    assert_eq!(channels[1]["no_fit"], "constant_recording");
}
