//! `compare`: how far numbers may be apart, and where that is written.

use super::compare::{EXPECTED, bench, different, equal, files};
use super::compare_folders::{compared, folders};
use super::{stderr, succeeded};

#[test]
fn tolerances_beside_the_golden_files_hold_for_single_columns() {
    let changed = "time_s,torque_n_m,angle_rad\n0.0,1.0,0.4\n0.1,-4.2,1.6\n0.2,2.0,0.5\n";
    let bench = folders(&[("a/t.csv", EXPECTED)], &[("a/t.csv", changed)]);
    let with = |text: &str| {
        bench.write("golden/tolerances.toml", text);
        compared(&bench, &[])
    };
    different(&with("rtol = 0.5"));
    equal(&with("rtol = 0.7"));
    equal(&with("rtol = 0.7\natol = 0"));
    let angle = "[[columns]]\ncolumn = 'angle_*'\natol = 0.61\n";
    assert!(!different(&with(angle)).contains("angle_rad"));
    let told = equal(&with(&format!(
        "{angle}[[columns]]\nfile = 't.csv'\ncolumn = 'torque_?_m'\nignore = true"
    )));
    assert!(
        told.starts_with("equal    a/t.csv: 2 columns, 3 rows, 1 ignored, to 6.0e-1 of"),
        "{told}"
    );
    assert!(told.ends_with("result   1 equal\n"), "tolerances.toml is none of the files: {told}");
    // The last entry holds; the command line speaks for the rest only.
    different(&with(&format!("{angle}[[columns]]\ncolumn = '*'\nrtol = 1e-9")));
    bench.write("golden/tolerances.toml", angle);
    equal(&compared(&bench, &["--rtol", "0.06"]));
    bench.write("golden/tolerances.toml", &angle.replace("0.61", "0.59"));
    different(&compared(&bench, &["--atol", "9"]));
    bench.write("other.toml", "atol = 9");
    equal(&compared(&bench, &["--tolerances", "other.toml"]));
}

#[test]
fn a_single_file_has_its_tolerances_beside_it() {
    let bench = bench("time_s,torque_n_m,angle_rad\n0.0,1.5,0\n0.1,-4,1\n0.2,2,0.5\n");
    different(&files(&bench, &[]));
    bench.write("tolerances.toml", "[[columns]]\nfile = 'e.csv'\ncolumn = 'torque_n_m'\natol = 1");
    equal(&files(&bench, &[]));
}

#[test]
fn an_ignored_column_need_not_be_there_nor_match_rows() {
    let bench = bench("run,torque_n_m\n7,1\n8,-4\n9,2\n");
    bench.write("tolerances.toml", "[[columns]]\ncolumn = 'time_s'\nignore = true\n\
                [[columns]]\ncolumn = 'angle*'\nignore = true\n[[columns]]\ncolumn = 'run'\nignore = true");
    let told = equal(&files(&bench, &[]));
    assert!(told.contains("1 column, 3 rows, 3 ignored"), "{told}");
}

#[test]
fn a_tolerance_that_names_no_column_is_told() {
    let bench = bench(EXPECTED);
    bench.write(
        "tolerances.toml",
        "[[columns]]\ncolumn = 'torqe_*'\nrtol = 1\n\
                [[columns]]\nfile = 'e.csv'\ncolumn = 'times'\nrtol = 1\n\
                [[columns]]\nfile = 'x.csv'\ncolumn = 'of another file'\nrtol = 1",
    );
    let output = succeeded(files(&bench, &[]));
    let hint = "hint: `*` stands for any text, `?` for one character\n";
    let none = "but no column is called that";
    assert_eq!(
        stderr(&output),
        format!(
            "warning: tolerances.toml:1: column = \"torqe_*\", {none}\n{hint}\
             warning: tolerances.toml:4: column = \"times\" of a file \"e.csv\", {none}\n{hint}"
        )
    );
    let bench = folders(&[("a/t.csv", EXPECTED)], &[("a/t.csv", EXPECTED)]);
    bench.write("golden/a/tolerances.toml", "rtol = 1");
    let told = stderr(&compared(&bench, &[]));
    assert!(told.starts_with("warning: golden/a/tolerances.toml: is not read\n"), "{told}");
}

#[test]
fn a_difference_is_measured_against_the_peak_of_the_expected_column() {
    let bench = bench("time_s,torque_n_m,angle_rad\n0.0,1.0004,0\n0.1,-4.0,1\n0.2,2.0,0.5\n");
    different(&files(&bench, &["--rtol", "0.99e-4"]));
    equal(&files(&bench, &["--rtol", "1.01e-4"]));
    different(&files(&bench, &["--rtol", "0", "--atol", "3.99e-4"]));
    equal(&files(&bench, &["--rtol", "0", "--atol", "4.01e-4"]));
    equal(&files(&bench, &["--rtol", "0.5e-4", "--atol", "2.1e-4"]));
}

#[test]
fn without_a_word_a_billionth_of_the_peak_is_allowed() {
    let with = |torque: &str| bench(&EXPECTED.replace("1.0,0\n", &format!("{torque},0\n")));
    equal(&files(&with("1.0000000039"), &[]));
    different(&files(&with("1.0000000041"), &[]));
}

#[test]
fn an_ignored_first_column_matches_no_rows() {
    let bench = bench(&EXPECTED.replace("0.1,", "0.17,"));
    assert!(different(&files(&bench, &[])).contains("1 row only in EXPECTED: time_s = 0.1"));
    bench.write("tolerances.toml", "[[columns]]\ncolumn = 'time_s'\nignore = true");
    equal(&files(&bench, &[]));
}

#[test]
fn of_a_table_that_is_ignored_the_rows_are_too() {
    let bench = bench("time_s,torque_n_m,angle_rad\n");
    assert!(
        different(&files(&bench, &[]))
            .contains("  3 rows only in EXPECTED, the first: time_s = 0.0, line 2\n")
    );
    bench.write("tolerances.toml", "[[columns]]\ncolumn = '*'\nignore = true");
    let told = equal(&files(&bench, &[]));
    assert_eq!(told, "equal    e.csv: 0 columns, 0 rows, 3 ignored\nresult   1 equal\n");
}

#[test]
fn a_tolerance_of_a_column_of_one_side_is_not_idle() {
    let bench = bench(&EXPECTED.replace("angle_rad", "angle_deg"));
    let text =
        "[[columns]]\ncolumn = 'angle_deg'\nrtol = 1\n[[columns]]\ncolumn = 'angle_rad'\nrtol = 1";
    bench.write("tolerances.toml", text);
    different(&files(&bench, &[]));
    let ignoring = "[[columns]]\ncolumn = 'angle_*'\nignore = true\n";
    bench.write("tolerances.toml", &format!("{ignoring}{}", ignoring.replace('*', "deg")));
    equal(&files(&bench, &[]));
}
