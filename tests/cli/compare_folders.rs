//! `compare` of folders, and `--bless`.

use std::fs;
use std::process::Output;

use serde_json::Value;

use super::Bench;
use super::compare::{EXPECTED, different, equal, refused};

/// Two folders with the files given, `golden` and `out`.
pub(super) fn folders(golden: &[(&str, &str)], out: &[(&str, &str)]) -> Bench {
    let bench = Bench::new();
    for (folder, files) in [("golden", golden), ("out", out)] {
        fs::create_dir(bench.path(folder)).unwrap();
        for (name, text) in files {
            let path = bench.path(folder).join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
    }
    bench
}

pub(super) fn compared(bench: &Bench, more: &[&str]) -> Output {
    bench.run(&[&["compare", "golden", "out"], more].concat())
}

#[test]
fn folders_are_compared_file_by_file() {
    let golden = [
        ("same.csv", EXPECTED),
        ("b c/deep.csv", EXPECTED),
        ("gone.csv", EXPECTED),
        ("summary.json", "1"),
    ];
    let changed = EXPECTED.replace("-4.0", "-4.1");
    let out = [
        ("same.csv", EXPECTED),
        ("b c/deep.csv", &changed),
        ("more.csv", EXPECTED),
        ("summary.json", "2"),
        ("log", ""),
    ];
    let told = different(&compared(&folders(&golden, &out), &[]));
    assert_eq!(
        told,
        "\
differs  b c/deep.csv: 3 columns, 3 rows
  column        worst  of peak  allowed   rows    line     time_s
  torque_n_m   1.0e-1   2.5e-2   4.0e-9      1       3        0.1
missing  gone.csv: only in EXPECTED
new      more.csv: only in ACTUAL
equal    same.csv: 3 columns, 3 rows
result   1 equal, 1 different, 1 missing, 1 new; not compared: 2 files, neither table nor results
"
    );
}

#[test]
fn a_folder_without_tables_proves_nothing() {
    let bench = folders(&[("a.csv", EXPECTED)], &[]);
    assert!(different(&compared(&bench, &[])).starts_with("missing  a.csv: only in EXPECTED\n"));
    let message = "error: out: the folder holds no CSV files\n";
    refused(&compared(&bench, &["--bless"]), 3, message);
    assert_eq!(bench.names("golden"), ["a.csv"]);
}

#[test]
fn blessing_takes_over_what_differs_and_touches_nothing_else() {
    let near = EXPECTED.replace("-4.0", "-4.000000001");
    let changed = EXPECTED.replace("-4.0", "-4.1");
    let golden = [
        ("tolerances.toml", "rtol = 1e-9"),
        ("notes.txt", "mine"),
        ("near.csv", EXPECTED),
        ("a/b.csv", EXPECTED),
        ("a/gone.csv", EXPECTED),
    ];
    let out = [
        ("near.csv", near.as_str()),
        ("a/b.csv", &changed),
        ("new/c.csv", EXPECTED),
        ("summary.json", ""),
    ];
    let bench = folders(&golden, &out);
    let told = equal(&compared(&bench, &["--bless"]));
    assert!(told.contains("differs  a/b.csv"), "{told}");
    assert!(told.ends_with("blessed  golden: 2 files written, 1 removed\n"), "{told}");
    assert_eq!(bench.names("golden"), ["a", "near.csv", "new", "notes.txt", "tolerances.toml"]);
    assert_eq!(
        (bench.names("golden/a"), bench.names("golden/new")),
        (vec!["b.csv".into()], vec!["c.csv".into()])
    );
    assert_eq!(bench.read("golden/near.csv"), EXPECTED);
    assert_eq!(bench.read("golden/a/b.csv"), changed);
    assert_eq!(bench.read("golden/new/c.csv"), EXPECTED);
    let again = equal(&compared(&bench, &["--bless"]));
    assert!(again.ends_with("blessed  nothing: golden is as it was\n"), "{again}");
}

#[test]
fn an_old_summary_does_not_stay_beside_new_tables() {
    let changed = EXPECTED.replace("-4.0", "-4.1");
    let run = "{\"flexlink\": \"0.0.1\"}";
    let golden = [("a.csv", EXPECTED), ("summary.json", run), ("b/a.csv", EXPECTED)];
    let foreign = [("b/summary.json", "{}"), ("b/c/a.csv", EXPECTED), ("b/c/summary.json", run)];
    let out = [("a.csv", changed.as_str()), ("b/a.csv", &changed), ("b/c/a.csv", EXPECTED)];
    let bench = folders(&[golden, foreign].concat(), &out);
    let told = equal(&compared(&bench, &["--bless"]));
    assert!(told.ends_with("blessed  golden: 2 files written, 1 removed\n"), "{told}");
    assert_eq!(bench.names("golden"), ["a.csv", "b"]);
    assert_eq!(bench.read("golden/b/summary.json"), "{}", "of another program");
    assert_eq!(bench.read("golden/b/c/summary.json"), run, "its tables are as they were");
}

#[test]
fn results_of_runs_are_compared_and_renewed_with_their_tables() {
    let summary = |title: &str, peak: f64, nodes: &str| {
        format!(
            "{{\n\"flexlink\": \"0.1.0\", \"command\": \"solve\", \"title\": \"{title}\",\n\"results\": {{\"peak_n_m\": {peak}, \
             \"joints\": [{{\"rms\": 2.0}}, {{\"rms\": null}}], \"limit\": \"{nodes}\"}}\n}}\n"
        )
    };
    let [own, same, other] = [
        summary("old", 4.0, "torque"),
        summary("new", 4.000_000_001, "torque"),
        summary("new", 4.1, "rate"),
    ];
    let run = |summary: &str| {
        let golden = [("run/a.csv", EXPECTED), ("run/summary.json", own.as_str())];
        folders(&golden, &[("run/a.csv", EXPECTED), ("run/summary.json", summary)])
    };
    let bench = run(&same);
    let told = equal(&compared(&bench, &["--bless"]));
    assert!(told.contains("equal    run/summary.json: 5 columns, 1 row"), "{told}");
    assert_eq!(bench.read("golden/run/summary.json"), own, "within tolerance it stays");

    let bench = run(&other);
    let told = different(&compared(&bench, &[]));
    assert_eq!(
        told,
        "\
equal    run/a.csv: 3 columns, 3 rows
differs  run/summary.json: 5 columns, 1 row
  column              worst  of peak  allowed   rows    line
  results.limit       not \"torque\" but \"rate\"      1       3
  results.peak_n_m   1.0e-1   2.5e-2   4.0e-9      1       3
result   1 equal, 1 different
"
    );
    let told = equal(&compared(&bench, &["--bless"]));
    assert!(told.ends_with("blessed  golden: 1 file written, 0 removed\n"), "{told}");
    assert_eq!(bench.read("golden/run/summary.json"), other);
    let one = ["compare", "golden/run/summary.json", "out/run/summary.json"];
    equal(&bench.run(&one));

    let bench = run("garbage");
    let message = "error: out/run/summary.json: the summary holds no results of a run\n";
    refused(&compared(&bench, &[]), 3, message);
    let golden = [("run/a.csv", EXPECTED), ("run/summary.json", own.as_str())];
    let bench = folders(&golden, &[("run/a.csv", EXPECTED)]);
    let told = different(&compared(&bench, &[]));
    assert!(told.contains("missing  run/summary.json: only in EXPECTED\n"), "{told}");
    let told = equal(&compared(&bench, &["--bless"]));
    assert!(told.ends_with("blessed  golden: 0 files written, 1 removed\n"), "{told}");
}

#[test]
fn a_new_warning_is_a_difference_and_inputs_that_differ_are_named() {
    let summary = |hash: &str, arguments: &str, warnings: &str| {
        format!(
            r#"{{"flexlink": "0.1.0", "command": "solve", "inputs": {{"link": {{"name": "a.toml",
            "sha256": "{hash}"}}, "arguments": [{arguments}]}},
            "results": {{"peak": 1.0}}, "warnings": [{warnings}]}}"#
        )
    };
    let warning = r#"{"kind": "short lead", "message": "lead = 0.1 s", "hint": ""}"#;
    let told = |expected: &str, actual: &str, tolerances: &str| {
        let golden =
            [("a.csv", EXPECTED), ("summary.json", expected), ("tolerances.toml", tolerances)];
        compared(&folders(&golden, &[("a.csv", EXPECTED), ("summary.json", actual)]), &[])
    };
    let golden = summary("12", "", "");
    let warned = summary("34", r#""--set", "payload.mass=1""#, warning);
    let output = told(&golden, &warned, "");
    assert!(
        different(&output).contains(
            "\
differs  summary.json: 2 columns, 1 row
  only in ACTUAL: warnings.short lead
  arguments: none in EXPECTED, --set payload.mass=1 in ACTUAL
  link: a.toml with other content
"
        ),
        "{output:?}"
    );
    let ignored = "[[columns]]\nfile = \"summary.json\"\ncolumn = \"warnings.*\"\nignore = true\n";
    let output = told(&golden, &warned, ignored);
    assert!(!equal(&output).contains("a.toml"), "other inputs alone are no difference");
    let [one, two] = ["1", "2"].map(|mass| {
        let long = format!("\"--set\", \"{}\"", "segments.*.EI*=1".repeat(9));
        summary("12", &format!("{long}, \"--set\", \"payload.mass={mass}\""), "")
    });
    let none = two.replace("\"link\":", "\"reference\": null, \"link\":").replace("1.0", "2.0");
    let told_of = different(&told(&one, &none, ""));
    let arguments = "  arguments: payload.mass=1 in EXPECTED, payload.mass=2 in ACTUAL\n";
    assert!(told_of.contains(arguments) && !told_of.contains("reference"), "{told_of}");
    let other = warned.replace("0.1 s", "0.2 s");
    equal(&told(&warned, &other, ""));
}

#[test]
fn blessing_makes_golden_files_that_are_not_there_yet() {
    let bench = folders(&[], &[("a.csv", EXPECTED), ("b/c.csv", EXPECTED)]);
    equal(&bench.run(&["compare", "tests/golden", "out", "--bless", "--quiet"]));
    equal(&bench.run(&["compare", "tests/golden", "out"]));
    equal(&bench.run(&["compare", "one.csv", "out/a.csv", "--bless"]));
    assert_eq!(bench.read("one.csv"), EXPECTED);
    #[cfg(unix)]
    std::os::unix::fs::symlink("golden/two.csv", bench.path("two.csv")).unwrap();
    bench.write("golden/two.csv", "time_s\n1\n");
    equal(&bench.run(&["compare", "two.csv", "out/a.csv", "--bless"]));
    #[cfg(unix)]
    assert_eq!(bench.read("golden/two.csv"), EXPECTED, "a link that is named is followed");
    bench.write("out/a.csv", "time_s\n0\n");
    let told = equal(&bench.run(&["compare", "one.csv", "out/a.csv", "--bless", "--json"]));
    let told: Value = serde_json::from_str(&told).unwrap();
    let blessed = serde_json::json!({"written": ["one.csv"], "removed": []});
    assert_eq!((&told["equal"], &told["blessed"]), (&false.into(), &blessed));
    assert_eq!(bench.read("one.csv"), "time_s\n0\n");
}

#[test]
fn a_table_that_is_refused_is_not_blessed() {
    let bench = folders(&[("a.csv", EXPECTED)], &[("a.csv", EXPECTED), ("b.csv", "x,y\n1\n")]);
    assert_eq!(compared(&bench, &["--bless"]).status.code(), Some(3));
    assert_eq!(bench.names("golden"), ["a.csv"]);
}
