//! The same inputs give the same bytes on any number of threads and on every processor.
//!
//! Other processors are emulated: `tests/processors/run` brings what the ignored tests need.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A name and the arguments of a run; `-o DIR` is added.
type Run = (&'static str, &'static str);

/// Every digit of runs of all kinds: damping laws, tables, wide and narrow bands, other lengths than
/// powers of two, profiles, sweeps.
const RUNS: [Run; 15] = [
    (
        "hysteretic",
        "solve specs/bayo1987_example1.toml trajectories/sine_0.88s.csv --resample 0.004 \
         --digits full --deflections --moments",
    ),
    (
        "default_digits",
        "solve specs/bayo1987_example2.toml trajectories/min_jerk_1s.csv --resample 0.005 --verify",
    ),
    (
        "undamped",
        "solve specs/bayo1987_example1.toml trajectories/sine_0.88s.csv --resample 0.004 \
         --digits full --set damping={model=\"none\"} --set analysis.tolerance=1e-2",
    ),
    (
        "modal",
        "solve specs/bayo1987_example2.toml trajectories/min_jerk_1s.csv --resample 0.005 \
         --digits full --set damping.model=modal --set damping.ratios=[0.01,0.02,0.04]",
    ),
    (
        "caughey",
        "solve specs/gu_petkov.toml trajectories/sine_0.88s_displacement.csv --resample 0.004 \
         --digits full --set damping.model=caughey --set damping.ratios=[0.01,0.02,0.03,0.04]",
    ),
    (
        "rayleigh",
        "solve specs/rome_link.toml trajectories/sine_cm.csv --digits full \
         --set damping.model=rayleigh --set damping.modes=[1,3] --set damping.ratios=[0.01,0.02]",
    ),
    (
        "automatic",
        "solve specs/bayo1987_example1.toml trajectories/sine_0.88s.csv --resample 0.004 \
         --digits full --set mesh.elements=auto --set mesh.tolerance=1e-3 --nodes 0,3",
    ),
    ("narrow", "solve specs/bayo1987_example1.toml SMOOTH --digits full --every 7"),
    ("simulate", "simulate specs/bayo1987_example1.toml TORQUE --digits full --until 2"),
    ("modes", "modes specs/rome_link.toml --count 12"),
    ("frf", "frf specs/bayo1987_example1.toml --points 300"),
    (
        "sweep",
        "sweep specs/bayo1987_example1.toml trajectories/sine_0.88s.csv --resample 0.004 \
         --vary segments.*.EI*=0.5:8:7:log",
    ),
    ("sine", "trajectory sine --distance 0.3 --duration 1.1 --step 0.01"),
    ("gaussian", "trajectory gaussian --distance 0.3 --duration 1.1 --step 0.01"),
    ("versine", "trajectory versine --distance 0.3 --duration 1.1 --step 0.01"),
];

/// All files that the runs of `program` write, by name, and what they print.
fn bytes_of(program: &[&str], more: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let out = tempfile::tempdir().unwrap();
    let [smooth, torque] = ["smooth.csv", "torque.csv"].map(|name| out.path().join(name));
    fs::write(&smooth, smooth_motion()).unwrap();
    fs::write(&torque, "time,torque\n0,0\n0.1,0.5\n0.2,-0.5\n0.3,0.1\n0.4,0\n").unwrap();
    let mut bytes = BTreeMap::new();
    for (name, arguments) in RUNS {
        let target = out.path().join(name);
        let words = arguments.split_whitespace().map(|word| match word {
            "SMOOTH" => smooth.to_str().unwrap(),
            "TORQUE" => torque.to_str().unwrap(),
            word => word,
        });
        let has_threads = ["solve", "sweep"].iter().any(|command| arguments.starts_with(command));
        let more = if has_threads { more } else { &[] };
        let output = Command::new(program[0])
            .args(&program[1..])
            .args(words)
            .args(["-o", target.to_str().unwrap()])
            .args(more)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name} by {program:?}: {words}");
        let printed = String::from_utf8(output.stdout).unwrap();
        let printed = printed.replace(out.path().to_str().unwrap(), "");
        bytes.insert(format!("{name}/printed"), printed.into_bytes());
        add_files(&target, name, &mut bytes);
    }
    bytes
}

/// A file, or the files of a folder.
fn add_files(path: &Path, name: &str, bytes: &mut BTreeMap<String, Vec<u8>>) {
    if path.is_file() {
        bytes.insert(name.to_owned(), fs::read(path).unwrap());
        return;
    }
    for entry in fs::read_dir(path).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{name}/{}", entry.file_name().to_str().unwrap());
        bytes.insert(name, fs::read(entry.path()).unwrap());
    }
}

/// A motion whose band is narrow: its nodes are transformed over fewer samples than are written.
fn smooth_motion() -> String {
    let row = |k: u32| {
        let share = (f64::from(k) - 2000.0) / 250.0;
        format!("{},{:.17}", f64::from(k) / 1000.0, -share * (-share * share).exp())
    };
    let rows: Vec<String> = (0..4000).map(row).collect();
    format!("time,acceleration\n{}\n", rows.join("\n"))
}

#[track_caller]
fn assert_same(found: &BTreeMap<String, Vec<u8>>, native: &BTreeMap<String, Vec<u8>>, by: &str) {
    assert!(found.keys().eq(native.keys()), "other files {by}");
    let differing: Vec<_> = native.iter().filter(|(name, bytes)| found[*name] != **bytes).collect();
    let names: Vec<_> = differing.iter().map(|(name, _)| name).collect();
    assert!(names.is_empty(), "{names:?} differ {by}");
}

const NATIVE: [&str; 1] = [env!("CARGO_BIN_EXE_flexlink")];

#[test]
fn one_two_and_seven_threads_give_the_same_bytes() {
    let alone = bytes_of(&NATIVE, &["--threads", "1"]);
    assert!(alone.len() > 60, "{} files", alone.len());
    for threads in ["2", "7"] {
        let found = bytes_of(&NATIVE, &["--threads", threads]);
        assert_same(&found, &alone, &format!("on {threads} threads"));
    }
}

#[test]
#[ignore = "needs qemu-x86_64 on the path and a processor of its kind"]
fn processors_without_wide_vectors_give_the_same_bytes() {
    let native = bytes_of(&NATIVE, &[]);
    for processor in ["Nehalem", "Haswell"] {
        let emulated = ["qemu-x86_64", "-cpu", processor, NATIVE[0]];
        assert_same(&bytes_of(&emulated, &[]), &native, &format!("on {processor}"));
    }
}

#[test]
#[ignore = "needs the program for another kind of processor, built by tests/processors/run"]
fn another_kind_of_processor_gives_the_same_bytes() {
    let command = env::var("FLEXLINK_ELSEWHERE").unwrap();
    let elsewhere: Vec<&str> = command.split_whitespace().collect();
    assert_same(&bytes_of(&elsewhere, &[]), &bytes_of(&NATIVE, &[]), &format!("by {command}"));
}
