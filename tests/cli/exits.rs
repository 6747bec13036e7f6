//! Exit codes: 0 done, 1 different (in `compare`), 2 usage, 3 input refused, 4 not solvable, 5 cannot write.

use std::fs;

use super::{Bench, LINK, MOTION, stderr, stdout};

/// Runs `solve` of the paper's example with more arguments, which cannot be written; standard output stays empty and no
/// folder is left.
#[track_caller]
fn failed(bench: &Bench, more: &str) -> String {
    let output = bench.ends(5, &format!("solve {LINK} {MOTION} {more}"));
    assert_eq!(stdout(&output), "");
    assert!(!bench.path("out").exists(), "nothing is left behind");
    stderr(&output)
}

#[test]
fn five_for_a_folder_that_cannot_be_made_and_what_is_there_stays() {
    let bench = Bench::new();
    bench.write("taken", "a file");
    for folder in ["taken", "taken/results"] {
        let error = failed(&bench, &format!("-o {folder}"));
        let expected = format!("error: {folder}: cannot create the folder");
        assert!(error.starts_with(&expected), "{error}");
    }
    assert_eq!(bench.names("."), ["taken"]);
    assert_eq!(bench.read("taken"), "a file");
}

#[test]
fn five_for_a_file_that_cannot_take_its_name_and_the_files_before_stay_as_they_are() {
    let bench = Bench::new();
    bench.solve("-o results");
    fs::remove_file(bench.path("results/torque.csv")).unwrap();
    fs::create_dir(bench.path("results/torque.csv")).unwrap();
    let before = bench.read("results/summary.json") + &bench.read("results/tip.csv");
    let error = failed(&bench, "-o results --set payload.mass=0.1");
    assert!(error.starts_with("error: results: cannot write torque.csv"), "{error}");
    assert!(before == bench.read("results/summary.json") + &bench.read("results/tip.csv"));
    let is_hidden = |name: &String| name.starts_with('.');
    assert!(!bench.names("results").iter().any(is_hidden), "no temporary file is left");
}
