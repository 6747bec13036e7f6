//! Paths, commands and headers that the program prints or writes: a path stays on its line, a shell takes the command, and a
//! compiler tells two headers apart.
#![cfg(unix)]

use std::fs;
use std::process::Command;

use super::{Bench, text};

#[test]
fn a_path_makes_no_line_of_its_own_on_standard_output() {
    let bench = Bench::new();
    bench.write("m.toml", "[[frequency]]\nmode = 1\nvalue = 2.0\n");
    bench.write("t.csv", "time,torque\n0,0\n0.1,1\n0.2,-1\n0.3,0\n");
    let bad = "a\nwritten  all";
    let file = "a\nwritten  all.csv";
    let solve = ["solve", "link.toml", "motion.csv"];
    for arguments in [
        &[&solve[..], &["-o", bad, "--report"]].concat()[..],
        &[&solve[..], &["--write", file]].concat(),
        &["solve", "--repeat", bad],
        &["simulate", "link.toml", "t.csv", "-o", "a\nwritten  simulated"],
        &["report", bad],
        &["report", bad, "--svg", "a\nwritten  figures"],
        &["sweep", "link.toml", "motion.csv", "--vary", "payload.mass=0,0.1", "-o", file],
        &["fit", "link.toml", "m.toml", "--free", "hub.inertia", "--report=a\nwritten  p.html"],
        &["compare", "a\nwritten  golden", bad, "--bless"],
        &["compare", "a\nwritten  golden", bad, "--bless"],
        &["compare", file, file],
        &["init", "a\nwritten  init"],
    ] {
        let output = bench.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
        let printed = text(&output.stdout);
        let is_forged = printed.lines().any(|line| line.starts_with("written  all"));
        assert!(!is_forged && !printed.contains("a\n"), "{arguments:?}: {printed}");
    }
}

#[test]
fn a_file_that_is_called_as_an_option_is_no_option_in_a_printed_command() {
    let bench = Bench::new();
    fs::rename(bench.path("motion.csv"), bench.path("-rf.csv")).unwrap();
    let solve = ["solve", "link.toml", "./-rf.csv", "-q", "-o", "./-run", "--write", "torque.h"];
    let output = bench.run(&solve);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let header = fs::read_to_string(bench.path("torque.h")).unwrap();
    assert!(
        header.contains("flexlink solve link.toml ./-rf.csv --write torque.h"),
        "{header:.900}"
    );
    let table = fs::read_to_string(bench.path("-run/torque.csv")).unwrap();
    fs::write(bench.path("-run/torque.csv"), table.replacen("0,", "1,", 1)).unwrap();
    let repeat = ["solve", "--repeat", "./-run", "-o", "a b"];
    let told = text(&bench.run(&repeat).stderr);
    assert!(told.contains("flexlink compare ./-run 'a b' says by how much"), "{told}");
}

#[test]
fn two_headers_of_one_name_are_not_taken_for_one() {
    let bench = Bench::new();
    for (folder, scale) in [("a", "1"), ("b", "2")] {
        fs::create_dir(bench.path(folder)).unwrap();
        let (table, set) = (format!("{folder}/torque.h"), format!("hub.inertia*={scale}"));
        let solve = ["solve", "link.toml", "motion.csv", "-q", "--set", &set, "--write", &table];
        assert_eq!(bench.run(&solve).status.code(), Some(0));
    }
    let compiles = |source: &str| {
        bench.write("main.c", format!("{source}int main(void) {{ return 0; }}\n"));
        let cc = bench.command("cc", &["-fsyntax-only", "main.c"]).output();
        cc.ok().map(|output| output.status.success())
    };
    let once = "#include \"a/torque.h\"\n";
    let Some(compiles_once) = compiles(once) else { return };
    assert!(compiles_once);
    assert_eq!(compiles(&format!("{once}{once}")), Some(true));
    assert_eq!(compiles(&format!("{once}#include \"b/torque.h\"\n")), Some(false));
}

#[test]
fn the_lock_of_a_run_that_was_killed_goes_with_the_next_blessing() {
    let bench = Bench::new();
    let solve = ["solve", "link.toml", "motion.csv", "-q", "-o", "run"];
    assert_eq!(bench.run(&solve).status.code(), Some(0));
    let bless = ["compare", "golden", "run", "--bless"];
    assert_eq!(bench.run(&bless).status.code(), Some(0));
    let files = || fs::read_dir(bench.path("golden")).unwrap().count();
    let whole = files();
    bench.write("golden/.flexlink.lock", "");
    fs::create_dir(bench.path("golden/.flexlink.run-killed")).unwrap();
    let output = bench.run(&bless);
    let printed = text(&output.stdout);
    assert!(printed.contains("blessed  nothing"), "{printed}");
    assert_eq!(files(), whole);
    let clean = Command::new("ls").arg("-A").arg(bench.path("golden")).output().unwrap();
    assert!(!text(&clean.stdout).contains(".flexlink"));
}
