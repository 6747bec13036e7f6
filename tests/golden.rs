//! Compares the answers of tests/golden with those of this build.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs the program in the repository's folder.
fn flexlink(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flexlink"));
    command.args(arguments).current_dir(repository()).output().unwrap()
}

/// The cases of cases.txt: the folder of each, and the arguments of `solve`.
fn cases() -> Vec<(String, Vec<String>)> {
    let list = fs::read_to_string(repository().join("tests/golden/cases.txt")).unwrap();
    let lines = list.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let words = lines.map(|line| line.split_whitespace().map(str::to_owned));
    words.map(|mut words| (words.next().unwrap(), words.collect())).collect()
}

/// A folder with the answers to all cases, solved now.
fn solved() -> TempDir {
    let out = tempfile::tempdir().unwrap();
    for (name, arguments) in cases() {
        let folder = out.path().join(&name);
        let arguments = arguments.iter().map(String::as_str);
        let into = ["-o", folder.to_str().unwrap(), "--quiet"];
        let all: Vec<&str> = ["solve"].into_iter().chain(arguments).chain(into).collect();
        let output = flexlink(&all);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
    out
}

/// Exit code and table of `compare tests/golden` with a folder.
fn compared(folder: &Path) -> (Option<i32>, String) {
    let output = flexlink(&["compare", "tests/golden", folder.to_str().unwrap()]);
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "", "no tolerance is idle");
    (output.status.code(), String::from_utf8(output.stdout).unwrap())
}

/// Multiplies the torque of largest size in the first column by `factor` and returns its line, counted from 1.
fn plant(file: &Path, golden: &str, factor: f64) -> usize {
    let mut lines: Vec<String> = golden.lines().map(str::to_owned).collect();
    let torque = |line: &String| line.split(',').nth(1).unwrap().parse::<f64>().unwrap();
    let size = |k: &usize| torque(&lines[*k]).abs();
    let row = (1..lines.len()).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap();
    let planted = format!("{:.14}", torque(&lines[row]) * factor);
    let mut fields: Vec<&str> = lines[row].split(',').collect();
    assert_ne!(planted, fields[1], "the file has the digits to show it");
    fields[1] = &planted;
    lines[row] = fields.join(",");
    fs::write(file, lines.join("\n") + "\n").unwrap();
    row + 1
}

#[test]
fn the_answers_are_as_they_were() {
    let out = solved();
    let (code, table) = compared(out.path());
    assert_eq!(code, Some(0), "{table}");
}

#[test]
fn a_torque_changed_by_a_millionth_is_found_and_a_last_bit_is_not() {
    let out = solved();
    for (name, _) in cases() {
        let (file, column) = if name.starts_with("arm") {
            ("torques.csv", "torque1_n_m")
        } else {
            ("torque.csv", "torque_n_m")
        };
        let golden = repository().join("tests/golden").join(&name).join(file);
        let golden = fs::read_to_string(golden).unwrap();
        let torque: PathBuf = out.path().join(&name).join(file);
        let line = plant(&torque, &golden, 1.0 + 1e-6);
        let (code, table) = compared(out.path());
        assert_eq!(code, Some(1), "{table}");
        let told = format!("differs  {name}/{file}: ");
        assert!(table.contains(&told), "{table}");
        assert!(table.contains("result   ") && table.contains(" 1 different;"), "{table}");
        let column = table.lines().find(|line| line.trim_start().starts_with(column)).unwrap();
        let fields: Vec<&str> = column.split_whitespace().collect();
        assert_eq!((fields[2], fields[5]), ("1.0e-6", line.to_string().as_str()), "{table}");

        plant(&torque, &golden, 1.0 + 1e-13);
        let (code, table) = compared(out.path());
        assert_eq!(code, Some(0), "{table}");
        assert!(table.contains(&format!("equal    {name}/{file}: ")), "{table}");
    }
}

#[test]
fn every_golden_file_belongs_to_a_case() {
    let entries = fs::read_dir(repository().join("tests/golden")).unwrap().map(Result::unwrap);
    let folders = entries.filter(|entry| entry.path().is_dir());
    let mut found: Vec<String> =
        folders.map(|entry| entry.file_name().into_string().unwrap()).collect();
    let mut expected: Vec<String> = cases().into_iter().map(|(name, _)| name).collect();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
    assert_eq!(expected.len(), 6);
}
