//! Exit codes: 0 done, 1 different (in `compare`), 2 usage, 3 input refused, 4 not solvable, 5 cannot write.

use std::fs;

use super::{Bench, LINK, MOTION, repository, stderr, stdout};

/// Runs `solve` of the paper's example with more arguments, which must fail with `code`; standard
/// output stays empty and no folder is left.
#[track_caller]
fn failed(bench: &Bench, arguments: &[&str], code: i32) -> String {
    let (link, motion) = (repository(LINK), repository(MOTION));
    let output = bench.run(&[&["solve", &link, &motion], arguments].concat());
    let error = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{error}");
    assert_eq!(stdout(&output), "");
    assert!(!bench.path("out").exists(), "nothing is left behind");
    assert!(error.starts_with("error: "), "{error}");
    error
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
