//! `verify`, and `solve --verify`: the table, its JSON, and how the program ends.

use serde_json::Value;

use super::{Bench, LINK, MOTION, ended, json_of, repository, stderr, stdout, succeeded};

const NAMES: [&str; 9] = [
    "tip_error",
    "tip_error_viscous",
    "tip_solved",
    "mesh_halving",
    "step_halving",
    "wrap_around",
    "dense_transfer",
    "energy",
    "model",
];

fn verify(bench: &Bench, arguments: &[&str]) -> std::process::Output {
    let (link, motion) = (repository(LINK), repository(MOTION));
    bench.run(&[&["verify", &link, &motion], arguments].concat())
}

#[test]
fn every_line_is_a_number_against_what_it_may_be() {
    let output = succeeded(verify(&Bench::new(), &[]));
    assert_eq!(stderr(&output), "");
    let text = stdout(&output);
    let mut lines = text.lines();
    assert!(lines.next().unwrap().starts_with("check "), "{text}");
    for line in lines {
        let numbers: Vec<f64> = line[34..]
            .replace('<', " ")
            .split_whitespace()
            .take(2)
            .map(|word| word.parse().unwrap_or_else(|_| panic!("{line}")))
            .collect();
        assert!(numbers[0] <= numbers[1], "{line}");
    }
}

#[test]
fn json_lists_the_checks_and_quiet_prints_nothing() {
    let bench = Bench::new();
    let json: Value = serde_json::from_str(&stdout(&verify(&bench, &["--json"]))).unwrap();
    let checks = json.as_array().unwrap();
    let names: Vec<&str> = checks.iter().map(|check| check["name"].as_str().unwrap()).collect();
    assert_eq!(names, NAMES);
    for check in checks {
        let mut keys: Vec<&String> = check.as_object().unwrap().keys().collect();
        keys.sort();
        assert_eq!(keys, ["bound", "found", "name", "of", "passes", "reason", "what"]);
        assert_eq!(check["reason"], Value::Null);
    }
    let quiet = verify(&bench, &["--quiet"]);
    assert_eq!((stdout(&quiet), stderr(&quiet)), (String::new(), String::new()));
}

#[test]
fn a_number_out_of_its_bound_ends_the_program_with_four() {
    let output = ended(4, verify(&Bench::new(), &["--set", "analysis.lead=0.2"]));
    assert_eq!(stdout(&output).matches("  FAILS").count(), 3, "{}", stdout(&output));
    let failed = "error: out of bounds: tip, the link's own damping; tip, viscous damping, as \
                  predicted; torque at the window's edge\n\
                  hint: use a tighter analysis.tolerance or more --digits, or leave analysis.lead and analysis.lag out\n";
    assert!(stderr(&output).ends_with(failed), "{}", stderr(&output));
}

#[test]
fn a_limit_that_the_torque_and_its_error_exceed_fails() {
    let bench = Bench::new();
    // Peak 1.35817 N m; the mesh may have 4.4e-5 of it wrong.
    let with = |limit: &str| verify(&bench, &["--set", limit]);
    let kept = succeeded(with("limits.torque=1.3595"));
    assert!(
        stdout(&kept)
            .ends_with("limits.torque                          1.0e0       1.0e0   the limit\n")
    );
    let exceeded = ended(4, with("limits.torque=1.3582"));
    assert!(stdout(&exceeded).ends_with("1.0e0   the limit  FAILS\n"), "{}", stdout(&exceeded));
    assert!(stderr(&exceeded).contains("out of bounds: limits.torque\n"), "{}", stderr(&exceeded));
}

#[test]
fn few_digits_are_found_at_the_tip() {
    let output = ended(4, verify(&Bench::new(), &["--digits", "2", "--json"]));
    let json = json_of(&output);
    assert_eq!(
        (json[0]["name"].as_str(), json[0]["passes"].as_bool()),
        (Some(NAMES[0]), Some(false))
    );
}

#[test]
fn what_is_not_measured_says_why() {
    let set = ["--set", "segments.root.elements=20", "--set", "segments.beam.elements=190"];
    let output = verify(&Bench::new(), &set);
    let reason = "not made: 210 elements, more than the 200 that are factorised";
    assert!(stdout(&output).contains(reason), "{}", stdout(&output));
    let json = verify(&Bench::new(), &[&set[..], &["--json"]].concat());
    let json = json_of(&json);
    assert_eq!((&json[6]["found"], &json[6]["passes"]), (&Value::Null, &Value::Bool(true)));
}

#[test]
fn solve_keeps_the_table_in_its_summary_and_its_results_whatever_it_says() {
    let bench = Bench::new();
    let printed = bench.solve(&["--verify"]);
    assert!(stdout(&printed).ends_with(&stdout(&verify(&bench, &[]))));
    let summary = bench.json("out/summary.json");
    let checks = summary["verification"].as_array().unwrap();
    assert_eq!(checks.len(), NAMES.len());

    let (link, motion) = (repository(LINK), repository(MOTION));
    let arguments =
        ["solve", &link, &motion, "--verify", "--set", "analysis.lead=0.2", "-o", "cut"];
    bench.ends(4, &arguments);
    let summary = bench.json("cut/summary.json");
    assert_eq!(summary["verification"][0]["passes"], false);
    assert!(bench.names("cut").contains(&"torque.csv".to_owned()));

    bench.solve(&["-o", "plain"]);
    let summary = bench.json("plain/summary.json");
    assert_eq!(summary["verification"], Value::Null);
}

#[test]
fn the_shortest_motion_is_measured_too() {
    let bench = Bench::new();
    bench.write("four.csv", "time,acceleration\n0,1\n0.5,1\n1,-1\n1.5,-1\n");
    let link = repository(LINK);
    let cut = ["--set", "analysis.lead=0", "--set", "analysis.lag=0"];
    let output = bench.ends(4, &[&["verify", &link, "four.csv"], &cut[..]].concat());
    assert_eq!(stdout(&output).lines().count(), 1 + NAMES.len(), "{}", stdout(&output));
}
