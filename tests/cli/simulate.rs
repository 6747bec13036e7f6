//! `flexlink simulate`: files, columns and numbers.

use super::{Bench, LINK, column, repository, simulated, stderr, stdout};

const ALWAYS: [&str; 6] = [
    "hub_angle.csv",
    "nodal_displacements.csv",
    "nodes.csv",
    "summary.json",
    "tip.csv",
    "torque.csv",
];
const FEEDBACK: [&str; 4] = ["--feedback", "20,2", "--reference", "out/hub_angle.csv"];

/// The torque of the paper's first example in `out`, ready to be played.
fn solved() -> Bench {
    let bench = Bench::new();
    bench.solve(&["-q"]);
    bench
}

fn headings(bench: &Bench, name: &str) -> Vec<String> {
    bench.table(name).into_iter().map(|(heading, _)| heading).collect()
}

fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |m, x| m.max(x.abs()))
}

#[test]
fn every_file_appears_in_the_default_folder_with_its_columns() {
    let bench = solved();
    simulated(&bench, &["out/torque.csv"]);
    assert_eq!(bench.names("simulated"), ALWAYS);
    let displacements: Vec<String> = (0..=10).map(|k| format!("v{k}_m")).collect();
    for (name, expected) in [
        ("torque.csv", "torque_n_m"),
        ("tip.csv", "tip_displacement_m,tip_velocity_m_s,tip_acceleration_m_s2"),
        ("hub_angle.csv", "hub_angle_rad,hub_rate_rad_s,hub_acceleration_rad_s2"),
        ("nodal_displacements.csv", &displacements.join(",")),
    ] {
        let found = headings(&bench, &format!("simulated/{name}")).join(",");
        assert_eq!(found, format!("time_s,{expected}"));
    }
    assert_eq!(bench.read("simulated/nodes.csv"), bench.read("out/nodes.csv"));
}

#[test]
fn the_torque_written_is_that_played_and_zero_after_its_end() {
    let bench = solved();
    let rigid = ["out/rigid_torque.csv", "--column", "rigid_torque_n_m", "--until", "5"];
    let friction = ["--set", "hub.viscous_friction=0.3", "--digits", "full"];
    simulated(&bench, &[&rigid[..], &friction].concat());
    let given = column(&bench, "out/rigid_torque.csv", "rigid_torque_n_m");
    let played = column(&bench, "simulated/torque.csv", "torque_n_m");
    assert_eq!(played.len(), column(&bench, "simulated/tip.csv", "time_s").len());
    assert_eq!(played[..given.len()], given[..]);
    let after = &played[given.len()..];
    assert!(after.len() == 443 && after.iter().all(|torque| *torque == 0.0), "{}", after.len());
}

#[test]
fn a_run_removes_the_page_of_the_run_before_and_nothing_of_the_users() {
    let bench = solved();
    simulated(&bench, &["out/torque.csv"]);
    for folder in ["out", "simulated"] {
        bench.write(&format!("{folder}/report.html"), "<!doctype html>");
        bench.write(&format!("{folder}/notes.html"), "mine");
    }
    simulated(&bench, &["out/torque.csv"]);
    assert!(
        !bench.path("simulated/report.html").exists() && bench.path("out/report.html").exists()
    );
    bench.solve(&["-q"]);
    assert!(!bench.path("out/report.html").exists());
    for folder in ["out", "simulated"] {
        assert_eq!(bench.read(&format!("{folder}/notes.html")), "mine");
    }
}

/// `u = T + k_p (θ_ref − θ) + k_d (θ̇_ref − θ̇)`
#[test]
fn the_torque_with_feedback_is_that_of_its_law() {
    let bench = solved();
    let options = ["--set", "payload.mass=0.05", "--digits", "full"];
    simulated(&bench, &[&["out/torque.csv"], &FEEDBACK[..], &options[..]].concat());
    let given = column(&bench, "out/torque.csv", "torque_n_m");
    let motor = column(&bench, "simulated/torque.csv", "torque_n_m");
    let of = |folder: &str, name: &str| column(&bench, &format!("{folder}/hub_angle.csv"), name);
    let (wanted, wanted_rate) = (of("out", "hub_angle_rad"), of("out", "hub_rate_rad_s"));
    let (angle, rate) = (of("simulated", "hub_angle_rad"), of("simulated", "hub_rate_rad_s"));
    let mut largest = 0.0_f64;
    for k in 0..given.len() {
        let feedback = 20.0 * (wanted[k] - angle[k]) + 2.0 * (wanted_rate[k] - rate[k]);
        assert!((motor[k] - given[k] - feedback).abs() < 1e-9, "row {k}");
        largest = largest.max(feedback.abs());
    }
    assert!(largest > 0.1, "the payload calls for it: {largest} N m");
}

#[test]
fn feedback_alone_drives_the_link_too() {
    let bench = solved();
    let text = bench.read("out/torque.csv");
    let nought = |row: &str| format!("{},0\n", row.split(',').next().unwrap());
    let rows: String = text.lines().skip(1).map(nought).collect();
    bench.write("nought.csv", &format!("time,torque\n{rows}"));
    let arguments = ["nought.csv", "--target", "out/tip.csv", "-q"];
    simulated(&bench, &[&arguments, &FEEDBACK[..]].concat());
    let travel = bench.json("simulated/summary.json")["results"]["farthest_m"].as_f64().unwrap();
    assert!((0.5..1.0).contains(&travel), "{travel} m");
}

#[test]
fn all_histories_stand_on_the_torques_times() {
    let bench = solved();
    simulated(&bench, &["out/torque.csv"]);
    let time = column(&bench, "out/torque.csv", "time_s");
    for name in ["torque.csv", "tip.csv", "hub_angle.csv", "nodal_displacements.csv"] {
        assert_eq!(column(&bench, &format!("simulated/{name}"), "time_s"), time, "{name}");
    }
}

#[test]
fn the_time_goes_on_as_far_as_asked_for_and_as_the_target_does() {
    let bench = solved();
    let end = |arguments: &[&str]| {
        simulated(&bench, arguments);
        *column(&bench, "simulated/tip.csv", "time_s").last().unwrap()
    };
    assert!((end(&["out/rigid_torque.csv", "--column", "rigid_torque_n_m"]) - 4.557).abs() < 1e-9);
    assert!((end(&["out/torque.csv", "--until", "6.5"]) - 6.5).abs() < 1e-9);
    assert!((end(&["out/torque.csv", "--until", "4.5575"]) - 4.558).abs() < 1e-9, "a whole step");
    let early: String =
        bench.read("out/torque.csv").lines().take(3600).collect::<Vec<_>>().join("\n");
    bench.write("early.csv", &early);
    assert!((end(&["early.csv", "--until", "-0.05"]) + 0.05).abs() < 1e-9, "before zero");
    assert!((end(&["early.csv", "--target", "out/tip.csv"]) - 4.557).abs() < 1e-9);
}

#[test]
fn a_target_may_have_a_step_and_times_of_its_own() {
    let bench = solved();
    let share = |target: &str| {
        simulated(&bench, &["out/torque.csv", "--target", target]);
        bench.json("simulated/summary.json")["tip_error"]["share"].as_f64().unwrap()
    };
    let expected = share("out/tip.csv");
    let text = bench.read("out/tip.csv");
    let rows: Vec<&str> = text.lines().skip(1).collect();
    let with = |rows: &[&str]| format!("{}\n{}\n", text.lines().next().unwrap(), rows.join("\n"));
    let fifth: Vec<&str> = rows.iter().skip(2).step_by(5).copied().collect();
    bench.write("fifth.csv", &with(&fifth));
    let before = ["-3.678,0,0,0", "-3.677,0,0,0"];
    bench.write("early.csv", &with(&[&before[..], &rows].concat()));
    bench.write("short.csv", &with(&rows[3000..5000]));
    for target in ["fifth.csv", "early.csv", "short.csv"] {
        let found = share(target);
        assert!((found / expected - 1.0).abs() < 1e-3, "{target}: {found} is not {expected}");
    }
}

#[test]
fn the_tip_of_the_table_is_that_of_the_last_node() {
    let bench = solved();
    simulated(&bench, &["out/torque.csv"]);
    let tip = column(&bench, "simulated/tip.csv", "tip_displacement_m");
    let last = column(&bench, "simulated/nodal_displacements.csv", "v10_m");
    assert!(tip.iter().zip(&last).all(|(a, b)| (a - b).abs() < 1e-9));
    assert!((tip[tip.len() - 1] - 0.5).abs() < 1e-4);
}

#[test]
fn nodes_and_rows_are_thinned_and_digits_chosen() {
    let bench = solved();
    simulated(&bench, &["out/torque.csv", "-o", "all"]);
    let options = ["--nodes", "0,5", "--every", "7", "--digits", "full", "-o", "few"];
    simulated(&bench, &[&["out/torque.csv"], &options[..]].concat());
    let few = "few/nodal_displacements.csv";
    assert_eq!(headings(&bench, few), ["time_s", "v0_m", "v5_m"]);
    let (all, few) =
        (column(&bench, "all/nodal_displacements.csv", "v5_m"), column(&bench, few, "v5_m"));
    assert_eq!(few.len(), all.len().div_ceil(7));
    assert!(all.iter().step_by(7).zip(&few).all(|(a, b)| (a - b).abs() < 1e-9));
    let told = bench.read("few/summary.json");
    let farthest = peak(&column(&bench, "few/tip.csv", "tip_displacement_m"));
    assert!(told.contains(&format!("\"farthest_m\": {farthest},")), "every bit of {farthest}");
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let bench = solved();
    let play = ["out/torque.csv", "--target", "out/tip.csv", "--threads"];
    for threads in ["1", "2", "3"] {
        simulated(&bench, &[&play[..], &[threads, "-o", threads]].concat());
    }
    for threads in ["2", "3"] {
        assert!(bench.contents(threads) == bench.contents("1"), "{threads} threads");
    }
}

#[test]
fn json_prints_the_summary_and_quiet_nothing() {
    let bench = solved();
    let output = simulated(&bench, &["out/torque.csv", "--json"]);
    assert_eq!(stdout(&output), bench.read("simulated/summary.json"));
    let output = simulated(&bench, &["out/torque.csv", "--quiet"]);
    assert_eq!((stdout(&output), stderr(&output)), (String::new(), String::new()));
}

#[test]
fn the_simulated_tip_reads_back_as_a_target_and_as_a_motion() {
    let bench = solved();
    simulated(&bench, &["out/torque.csv", "-o", "first"]);
    simulated(&bench, &["out/torque.csv", "--target", "first/tip.csv", "-o", "second"]);
    let share = bench.json("second/summary.json")["tip_error"]["share"].as_f64().unwrap();
    assert!(share < 1e-9, "{share:e}");
    // At rest at its end but for 1e-5 of its peak velocity, as the viscous law leaves it.
    bench.done(&["solve", &repository(LINK), "first/tip.csv", "-o", "again"]);
}

/// A column with its times under a heading of this name, moved by a constant.
fn moved(bench: &Bench, file: &str, from: &str, heading: &str, by: f64) -> String {
    let times = column(bench, file, "time_s");
    let rows = column(bench, file, from).into_iter().zip(times);
    let rows: Vec<String> = rows.map(|(x, t)| format!("{t:.3},{}", x + by)).collect();
    format!("time,{heading}\n{}\n", rows.join("\n"))
}

#[test]
fn a_link_starts_where_its_target_does_or_else_its_reference() {
    let bench = solved();
    let target = moved(&bench, "out/tip.csv", "tip_displacement_m", "displacement", 0.75);
    let reference = moved(&bench, "out/hub_angle.csv", "hub_angle_rad", "hub_angle", 0.5);
    bench.write("target.csv", &target);
    bench.write("reference.csv", &reference);
    for options in [
        &["--target", "target.csv"][..],
        &["--feedback", "20,2", "--reference", "reference.csv"],
        &["--target", "target.csv", "--feedback", "20,2", "--reference", "out/hub_angle.csv"],
    ] {
        simulated(&bench, &[&["out/torque.csv"], options].concat());
        let tip = column(&bench, "simulated/tip.csv", "tip_displacement_m");
        let hub = column(&bench, "simulated/hub_angle.csv", "hub_angle_rad");
        assert!((tip[0] - 0.75).abs() < 1e-4 && (hub[0] - 0.5).abs() < 1e-4, "{options:?}");
    }
}
