//! Exit codes: 0 done, 1 different (in `compare`), 2 usage, 3 input refused, 4 not solvable, 5 cannot write.

use std::fs;
use std::process::Output;

use super::{Bench, LINK, MOTION, no_such_file, repository, stderr, stdout};

/// Runs `solve` of the paper's example with more arguments, which must fail with `code`; standard
/// output stays empty and no folder is left.
#[track_caller]
fn failed(bench: &Bench, arguments: &[&str], code: i32) -> String {
    let (link, motion) = (repository(LINK), repository(MOTION));
    refused(bench, &bench.run(&[&["solve", &link, &motion], arguments].concat()), code)
}

#[track_caller]
fn refused(bench: &Bench, output: &Output, code: i32) -> String {
    assert_eq!(output.status.code(), Some(code), "{}", stderr(output));
    assert_eq!(stdout(output), "");
    assert!(!bench.path("out").exists(), "nothing is left behind");
    let error = stderr(output);
    assert!(error.starts_with("error: "), "{error}");
    error
}

#[test]
fn zero_when_done() {
    assert_eq!(Bench::new().solve(&[]).status.code(), Some(0));
}

#[test]
fn two_for_wrong_usage() {
    let bench = Bench::new();
    for arguments in [
        &["--frobnicate"][..],
        &["--every", "0"],
        &["--every", "-1"],
        &["--digits", "18"],
        &["--threads", "0"],
        &["--nodes", "a"],
        &["--nodes", "11"],
        &["--json", "--quiet"],
        &["--set", "hub.inertia"],
        &["third"],
    ] {
        failed(&bench, arguments, 2);
    }
    assert_eq!(bench.run(&["solve"]).status.code(), Some(2));
    assert_eq!(bench.run(&["frobnicate"]).status.code(), Some(2));
}

#[test]
fn three_for_an_input_that_is_refused() {
    let bench = Bench::new();
    bench.write("bad.toml", "segments = [{ length = -1, EI = 5, mass_per_length = 0.8 }]");
    bench.write("bad.csv", "time,acceleration\n0,0\n1,NaN\n2,0\n3,0\n");
    bench.write("away.csv", "time,acceleration\n0,0\n1,1\n2,1\n3,0\n");
    let (link, motion) = (repository(LINK), repository(MOTION));
    let absent = |file| format!("error: {file}: cannot read: {}", no_such_file());
    for (link, motion, message) in [
        ("none.toml", motion.as_str(), absent("none.toml").as_str()),
        ("bad.toml", &motion, "error: bad.toml:1: segments.0.length = -1 m, but must be"),
        (&link, "none.csv", &absent("none.csv")),
        (&link, "bad.csv", "error: bad.csv:3: "),
        (&link, "away.csv", "error: away.csv: the motion ends with a velocity of"),
    ] {
        let error = refused(&bench, &bench.run(&["solve", link, motion]), 3);
        assert!(error.starts_with(message), "{error}");
    }
    let error = failed(&bench, &["--set", "damping.ratio=-0.02"], 3);
    let message = "damping.ratio = -0.02, but must lie in [0, 1)";
    assert!(
        error.starts_with(&format!("error: --set 'damping.ratio=-0.02': {message}")),
        "{error}"
    );
    let error = failed(&bench, &["--resample=-1"], 3);
    assert!(error.contains("must"), "{error}");
}

#[test]
fn four_for_what_has_no_answer() {
    let bench = Bench::new();
    let error = failed(&bench, &["--set", "analysis.lag=1e6"], 4);
    assert!(error.starts_with("error: the period = "), "{error}");
    assert!(error.contains("hint: use a longer step"), "{error}");
    let modes = "damping={ model = \"rayleigh\", modes = [1, 99], ratios = [0.02, 0.02] }";
    let error = failed(&bench, &["--set", modes], 4);
    assert!(error.starts_with("error: damping.modes asks for mode 99"), "{error}");
}

#[test]
fn five_for_a_folder_that_cannot_be_made_and_what_is_there_stays() {
    let bench = Bench::new();
    bench.write("taken", "a file");
    for folder in ["taken", "taken/results"] {
        let error = failed(&bench, &["-o", folder], 5);
        assert!(
            error.starts_with(&format!("error: {folder}: cannot create the folder")),
            "{error}"
        );
    }
    assert_eq!(bench.names("."), ["taken"]);
    assert_eq!(bench.read("taken"), "a file");
}

#[test]
fn five_for_a_file_that_cannot_take_its_name_and_the_files_before_stay_as_they_are() {
    let bench = Bench::new();
    bench.solve(&["-o", "results"]);
    fs::remove_file(bench.path("results/torque.csv")).unwrap();
    fs::create_dir(bench.path("results/torque.csv")).unwrap();
    let before = bench.read("results/summary.json") + &bench.read("results/tip.csv");
    let error = failed(&bench, &["-o", "results", "--set", "payload.mass=0.1"], 5);
    assert!(error.starts_with("error: results: cannot write torque.csv"), "{error}");
    assert!(before == bench.read("results/summary.json") + &bench.read("results/tip.csv"));
    let hidden = bench.names("results").into_iter().filter(|name| name.starts_with('.'));
    assert_eq!(hidden.count(), 0, "no temporary file is left");
}
