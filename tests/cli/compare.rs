//! `compare`: two tables, or two folders of them, column by column.

use std::fs;
use std::process::Output;

use serde_json::Value;

use super::{Bench, stderr, stdout};

pub(super) const EXPECTED: &str =
    "time_s,torque_n_m,angle_rad\n0.0,1.0,0\n0.1,-4.0,1\n0.2,2.0,0.5\n";

/// A bench with the table above as `e.csv` and another as `a.csv`.
pub(super) fn bench(actual: &str) -> Bench {
    let bench = Bench::new();
    bench.write("e.csv", EXPECTED);
    bench.write("a.csv", actual);
    bench
}

pub(super) fn files(bench: &Bench, more: &[&str]) -> Output {
    bench.run(&[&["compare", "e.csv", "a.csv"], more].concat())
}

/// The files are different: exit code 1, nothing on standard error.
#[track_caller]
pub(super) fn different(output: &Output) -> String {
    assert_eq!((output.status.code(), stderr(output).as_str()), (Some(1), ""));
    stdout(output)
}

#[track_caller]
pub(super) fn equal(output: &Output) -> String {
    let told = (output.status.code(), stderr(output));
    assert_eq!(told, (Some(0), String::new()), "{}", stdout(output));
    stdout(output)
}

#[track_caller]
pub(super) fn refused(output: &Output, code: i32, message: &str) {
    assert_eq!(stderr(output), message);
    assert_eq!((output.status.code(), stdout(output).as_str()), (Some(code), ""));
}

fn json(bench: &Bench, more: &[&str]) -> Value {
    serde_json::from_str(&stdout(&files(bench, &[more, &["--json"]].concat()))).unwrap()
}

#[test]
fn the_worst_row_of_every_failing_column_is_told() {
    let bench = bench("time_s,torque_n_m,angle_rad\n0.0,1.0,0\n0.1,-4.2,1\n0.2,2.1,0.9\n");
    let told = different(&files(&bench, &[]));
    assert_eq!(
        told,
        "\
differs  e.csv: 3 columns, 3 rows
  column        worst  of peak  allowed   rows    line     time_s
  angle_rad    4.0e-1   4.0e-1   1.0e-9      1       4        0.2
  torque_n_m   2.0e-1   5.0e-2   4.0e-9      2       3        0.1
result   1 different
"
    );
    assert_eq!(told.lines().map(|line| line.chars().count()).max(), Some(65));
}

#[test]
fn form_does_not_matter() {
    let other = "\u{feff}# made elsewhere\r\n\"angle_rad\", torque_n_m ,time_s\r\n\r\n\
                 0,1,0\r\n1.0,-4e0,.1\r\n# half way\r\n5E-1,+2,0.2\r\n";
    let told = equal(&files(&bench(other), &["--rtol", "0"]));
    assert_eq!(told, "equal    e.csv: 3 columns, 3 rows\nresult   1 equal\n");
}

#[test]
fn columns_of_one_side_are_named_and_the_rest_is_compared() {
    let bench = bench("time_s,torque_n_m,rate,power\n0.0,1,0,0\n0.1,-4,0,0\n0.2,3,0,0\n");
    let told = different(&files(&bench, &[]));
    assert!(told.contains("  torque_n_m    1.0e0   2.5e-1 "), "{told}");
    let only = "  only in EXPECTED: angle_rad\n  only in ACTUAL: rate, power\nresult";
    assert!(told.contains(only), "{told}");
}

#[test]
fn rows_are_matched_by_their_time() {
    let bench =
        bench("time_s,torque_n_m,angle_rad\n0.100000001,-4,1\n0.2,2,0.5\n0.3,9,9\n0.4,9,9\n");
    let told = different(&files(&bench, &["--rtol", "1e-6"]));
    assert_eq!(
        told,
        "\
differs  e.csv: 3 columns, 2 rows
  1 row only in EXPECTED: time_s = 0.0, line 2
  2 rows only in ACTUAL, the first: time_s = 0.3, line 4
result   1 different
"
    );
    bench.write("a.csv", &format!("{EXPECTED}0.3,0,0\n"));
    let told = different(&files(&bench, &[]));
    assert!(told.contains("\n  1 row only in ACTUAL: time_s = 0.3, line 5\n"), "{told}");
}

#[test]
fn rows_at_the_ends_do_not_count_where_common_rows_alone_do() {
    let moved = "time_s,torque_n_m,angle_rad\n0.1,-4.0,1\n0.2,2.0,0.5\n0.3,0,0\n";
    let bench = bench(moved);
    different(&files(&bench, &[]));
    let told = equal(&files(&bench, &["--common-rows"]));
    let aside = "3 columns, 2 rows and 2 at the ends that do not count";
    assert!(told.starts_with(&format!("equal    e.csv: {aside}\n")), "{told}");
    assert_eq!(json(&bench, &["--common-rows"])["files"][0]["table"]["rows_at_the_ends"], 2);
    bench.write("tolerances.toml", "common_rows = true\n");
    equal(&files(&bench, &[]));
    // What is between common rows counts, and so do their numbers, and tables that share none.
    bench.write("a.csv", &moved.replace("0.2,2.0,0.5\n", "0.15,2.0,0.5\n0.2,2.0,0.5\n"));
    assert!(different(&files(&bench, &[])).contains("1 row only in ACTUAL: time_s = 0.15, line 3"));
    bench.write("a.csv", &moved.replace("-4.0", "-4.1"));
    different(&files(&bench, &[]));
    bench.write("a.csv", "time_s,torque_n_m,angle_rad\n5.0,-4.0,1\n5.1,2.0,0.5\n");
    assert!(different(&files(&bench, &[])).contains("3 rows only in EXPECTED, the first"));
    // One row of three is no window that has moved.
    bench.write("a.csv", "time_s,torque_n_m,angle_rad\n0.2,2.0,0.5\n0.3,0,0\n0.4,0,0\n");
    assert!(different(&files(&bench, &[])).contains("2 rows only in EXPECTED, the first"));
}

#[test]
fn a_time_that_is_matched_is_still_compared() {
    let bench = bench(&EXPECTED.replace("0.1,", "0.100000001,"));
    let told = different(&files(&bench, &[]));
    assert!(told.contains("  time_s   1.0e-9   5.0e-9 "), "{told}");
}

#[test]
fn rows_without_an_increasing_column_are_matched_by_their_number() {
    let bench = Bench::new();
    bench.write("e.csv", "stiffness,payload,peak\n2,0,1\n2,1,2\n1,0,3\n");
    bench.write("a.csv", "stiffness,payload,peak\n2,0,1\n2,1,2.5\n");
    let told = different(&files(&bench, &[]));
    assert!(told.contains("  peak     5.0e-1   1.7e-1   3.0e-9      1       3\n"), "{told}");
    assert!(told.contains("  1 row only in EXPECTED: line 4\n"), "{told}");
    assert_eq!(json(&bench, &[])["files"][0]["table"]["matched_by"], Value::Null);
}

#[test]
fn words_nan_and_empty_fields_equal_only_their_like() {
    let bench = Bench::new();
    let rows = ["root,nan,inf,,1", "beam,nan,-inf,,2"].join("\n");
    bench.write("e.csv", &format!("segment,a,b,c,d\n{rows}\n"));
    bench.write("a.csv", &format!("segment,a,b,c,d\n{}\n", rows.replace("nan", "NaN")));
    equal(&files(&bench, &[]));
    for (from, to, told) in [
        ("root", "Root", "not \"root\" but \"Root\""),
        ("root", "", "not \"root\" but empty"),
        ("root", "0", "not \"root\" but 0.0"),
        ("nan", "0", "not NaN but 0.0"),
        ("-inf", "inf", "not -inf but inf"),
        ("inf", "1e308", "not inf but 1e308"),
        (",,1", ",0,1", "not empty but 0.0"),
        (",,1", ",nan,1", "not empty but NaN"),
        (",,2", ",,n/a", "not 2.0 but \"n/a\""),
    ] {
        bench.write("a.csv", &format!("segment,a,b,c,d\n{}\n", rows.replacen(from, to, 1)));
        let output = different(&files(&bench, &["--rtol", "1e9", "--atol", "1e9"]));
        assert!(output.contains(told), "{from} {to}: {output}");
    }
}

#[test]
fn a_table_without_names_has_columns_by_number() {
    let bench = Bench::new();
    bench.write("e.csv", "# time torque\n0,1\n1,2\n");
    bench.write("a.csv", "0,1\n1,2.5\n");
    let told = different(&files(&bench, &[]));
    assert!(
        told.contains("  column 2   5.0e-1   2.5e-1   2.0e-9      1       3        1.0"),
        "{told}"
    );
}

#[test]
fn either_side_may_be_standard_input() {
    let bench = bench(EXPECTED);
    for arguments in [["compare", "-", "a.csv"], ["compare", "e.csv", "-"]] {
        equal(&bench.fed(EXPECTED, &arguments));
    }
}

#[test]
fn the_exit_code_alone_tells_when_quiet() {
    assert_eq!(different(&files(&bench("time_s\n0\n"), &["--quiet"])), "");
    assert_eq!(equal(&files(&bench(EXPECTED), &["-q"])), "");
}

#[test]
fn json_tells_every_column_of_every_file() {
    let bench = bench("time_s,torque_n_m,extra\n0.1,-4.2,1\n0.2,x,1\n0.3,0,1\n");
    let output = files(&bench, &["--json", "--rtol", "1e-3", "--atol", "1e-2"]);
    let found: Value = serde_json::from_str(&different(&output)).unwrap();
    assert_eq!((&found["equal"], &found["not_compared"]), (&false.into(), &0.into()));
    assert_eq!(found["blessed"], Value::Null);
    let file = &found["files"][0];
    assert_eq!((&file["file"], &file["outcome"]), (&"e.csv".into(), &"different".into()));
    let table = &file["table"];
    assert_eq!((&table["matched_by"], &table["rows"]), (&"time_s".into(), &2.into()));
    assert_eq!(table["columns_only_in_expected"], serde_json::json!(["angle_rad"]));
    assert_eq!(table["columns_only_in_actual"], serde_json::json!(["extra"]));
    let rows = serde_json::json!({"count": 1, "first": {"line": 2, "key": 0.0}});
    assert_eq!(table["rows_only_in_expected"], rows);
    assert_eq!(table["rows_only_in_actual"]["first"]["line"], 4);
    let [time, torque] = [0, 1].map(|k| &table["columns"][k]);
    assert_eq!((&time["outcome"], &time["worst"]), (&"within".into(), &Value::Null));
    assert_eq!((&torque["outcome"], &torque["rows_beyond"]), (&"beyond".into(), &2.into()));
    assert_eq!((&torque["peak"], &torque["allowed"]), (&4.0.into(), &0.014.into()));
    let worst = &torque["worst"];
    assert_eq!((&worst["difference"], &worst["actual_field"]), (&Value::Null, &"x".into()));
    assert_eq!((&worst["expected"]["line"], &worst["actual"]["line"]), (&4.into(), &3.into()));
}

#[cfg(unix)]
#[test]
fn a_golden_pipe_is_not_replaced_by_a_file() {
    use std::os::unix::fs::FileTypeExt as _;
    let bench = Bench::new();
    bench.write("a.csv", EXPECTED);
    let made = std::process::Command::new("mkfifo").arg(bench.path("pipe")).status().unwrap();
    assert!(made.success());
    bench.ends(2, &["compare", "pipe", "a.csv", "--bless"]);
    assert!(fs::metadata(bench.path("pipe")).unwrap().file_type().is_fifo());
}

#[test]
fn a_file_of_one_side_whose_columns_are_all_ignored_is_no_difference() {
    let bench = Bench::new();
    for folder in ["golden", "out"] {
        fs::create_dir(bench.path(folder)).unwrap();
        bench.write(&format!("{folder}/a.csv"), EXPECTED);
    }
    bench.write("out/log.csv", "x\n1\n");
    bench.write(
        "golden/tolerances.toml",
        "[[columns]]\nfile = 'log.csv'\ncolumn = '*'\nignore = true\n",
    );
    bench.done(&["compare", "golden", "out"]);
    // Of one file alone, what is said of others is no slip.
    let single = bench.run(&["compare", "golden/a.csv", "out/a.csv"]);
    assert_eq!((single.status.code(), stderr(&single).as_str()), (Some(0), ""));
}

/// Tables of other forms are for the commands that read them.
#[test]
fn tables_in_another_form_than_that_of_the_program_are_refused() {
    let bench = Bench::new();
    for (text, message) in [
        (&b"time;x\n0;1,5\n"[..], "a.csv:1: first row = \"time;x\", but must name columns"),
        (b"time\tx\n0\t1\n", "a.csv:1: first row = "),
        (b"t x\n0 1.5\n", "a.csv:2: row = \"0 1.5\", but must have commas between its fields"),
        (b"Pr\xfcfung,x\n0,1\n", "a.csv:1: text = byte 0xfc, but must be UTF-8"),
        (b"time,x\n0,1,5\n", "a.csv:2: fields = 3, but must be 2"),
    ] {
        std::fs::write(bench.path("a.csv"), text).unwrap();
        bench.write("b.csv", "time,x\n0,1\n");
        let found = bench.error(3, "compare a.csv b.csv");
        assert!(found.contains(message), "{found}");
        assert!(
            found.contains("hint: compare reads tables as this program writes them"),
            "{found}"
        );
    }
}
