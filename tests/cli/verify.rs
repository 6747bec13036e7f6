//! `verify`, and `solve --verify`: the table, its JSON, and how the program ends.

use std::process::Output;

use serde_json::Value;

use super::{Bench, LINK, MOTION, ended, json_of, keys, stderr, stdout, succeeded};

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

fn verify(arguments: &str) -> Output {
    Bench::new().run(&format!("verify {LINK} {MOTION} {arguments}"))
}

#[test]
fn every_line_is_a_number_against_what_it_may_be() {
    let output = succeeded(verify(""));
    assert_eq!(stderr(&output), "");
    let text = stdout(&output);
    let mut lines = text.lines();
    assert!(lines.next().unwrap().starts_with("check "), "{text}");
    for line in lines {
        let words = line[34..].replace('<', " ");
        let numbers: Vec<f64> =
            words.split_whitespace().take(2).map(|word| word.parse().expect(line)).collect();
        assert!(numbers[0] <= numbers[1], "{line}");
    }
}

#[test]
fn json_lists_the_checks_and_quiet_prints_nothing() {
    let json = json_of(&verify("--json"));
    let checks = json.as_array().unwrap();
    let names: Vec<&str> = checks.iter().map(|check| check["name"].as_str().unwrap()).collect();
    assert_eq!(names, NAMES);
    for check in checks {
        let mut keys = keys(check);
        keys.sort_unstable();
        assert_eq!(keys, ["bound", "found", "name", "of", "passes", "reason", "what"]);
        assert_eq!(check["reason"], Value::Null);
    }
    let quiet = verify("--quiet");
    assert_eq!((stdout(&quiet), stderr(&quiet)), (String::new(), String::new()));
}

#[test]
fn a_number_out_of_its_bound_ends_the_program_with_four() {
    let output = ended(4, verify("--set analysis.lead=0.2"));
    assert_eq!(stdout(&output).matches("  FAILS").count(), 3, "{}", stdout(&output));
    let failed = "error: out of bounds: tip, the link's own damping; tip, viscous damping, as \
                  predicted; torque at the window's edge\n\
                  hint: use a tighter analysis.tolerance or more --digits, or leave analysis.lead and analysis.lag out\n";
    assert!(stderr(&output).ends_with(failed), "{}", stderr(&output));
}

#[test]
fn a_limit_that_the_torque_and_its_error_exceed_fails() {
    // Peak 1.35817 N m; the mesh may have 4.4e-5 of it wrong.
    let kept = stdout(&succeeded(verify("--set limits.torque=1.3595")));
    let row = "limits.torque                          1.0e0       1.0e0   the limit\n";
    assert!(kept.ends_with(row), "{kept}");
    let exceeded = ended(4, verify("--set limits.torque=1.3582"));
    assert!(stdout(&exceeded).ends_with("1.0e0   the limit  FAILS\n"), "{}", stdout(&exceeded));
    assert!(stderr(&exceeded).contains("out of bounds: limits.torque\n"), "{}", stderr(&exceeded));
}

#[test]
fn few_digits_are_found_at_the_tip() {
    let json = json_of(&ended(4, verify("--digits 2 --json")));
    assert_eq!((&json[0]["name"], &json[0]["passes"]), (&NAMES[0].into(), &false.into()));
}

#[test]
fn what_is_not_measured_says_why() {
    let set = "--set segments.root.elements=20 --set segments.beam.elements=190";
    let text = stdout(&verify(set));
    let reason = "not made: 210 elements, more than the 200 that are factorised";
    assert!(text.contains(reason), "{text}");
    let json = json_of(&verify(&format!("{set} --json")));
    assert_eq!((&json[6]["found"], &json[6]["passes"]), (&Value::Null, &true.into()));
}

#[test]
fn solve_keeps_the_table_in_its_summary_and_its_results_whatever_it_says() {
    let bench = Bench::new();
    let printed = stdout(&bench.solve("--verify"));
    assert!(printed.ends_with(&stdout(&verify(""))), "{printed}");
    let checks =
        |folder: &str| bench.json(&format!("{folder}/summary.json"))["verification"].clone();
    assert_eq!(checks("out").as_array().unwrap().len(), NAMES.len());
    bench.ends(4, &format!("solve {LINK} {MOTION} --verify --set analysis.lead=0.2 -o cut"));
    assert_eq!(checks("cut")[0]["passes"], false);
    assert!(bench.path("cut/torque.csv").exists());
    bench.solve("-o plain");
    assert_eq!(checks("plain"), Value::Null);
}

#[test]
fn the_shortest_motion_is_measured_too() {
    let bench = Bench::new();
    bench.write("four.csv", "time,acceleration\n0,1\n0.5,1\n1,-1\n1.5,-1\n");
    let cut = "--set analysis.lead=0 --set analysis.lag=0";
    let text = stdout(&bench.ends(4, &format!("verify {LINK} four.csv {cut}")));
    assert_eq!(text.lines().count(), 1 + NAMES.len(), "{text}");
}
