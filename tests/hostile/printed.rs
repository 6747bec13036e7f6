//! Paths, commands and headers that the program prints or writes: a path stays on its line, a shell takes the command, and a
//! compiler tells two headers apart.
#![cfg(unix)]

use std::fs;

use super::{Bench, SOLVE};

#[test]
fn a_path_makes_no_line_of_its_own_on_standard_output() {
    let bench = Bench::new();
    bench.write("m.toml", "[[frequency]]\nmode = 1\nvalue = 2.0\n");
    bench.write("t.csv", "time,torque\n0,0\n0.1,1\n0.2,-1\n0.3,0\n");
    // In each `a/` a path goes on in another line.
    for arguments in [
        "solve link.toml motion.csv -o a/ --report",
        "solve link.toml motion.csv --write a/.csv",
        "solve --repeat a/",
        "simulate link.toml t.csv -o a/simulated",
        "report a/",
        "report a/ --svg a/figures",
        "sweep link.toml motion.csv --vary payload.mass=0,0.1 -o a/.csv",
        "fit link.toml m.toml --free hub.inertia --report=a/p.html",
        "compare a/golden a/ --bless",
        "compare a/golden a/ --bless",
        "compare a/.csv a/.csv",
        "init a/init",
    ] {
        let forged = |word: &str| word.replace("a/", "a\nwritten  all");
        let arguments: Vec<String> = arguments.split(' ').map(forged).collect();
        let printed = bench.done(&arguments);
        let is_forged = printed.lines().any(|line| line.starts_with("written  all"));
        assert!(!is_forged && !printed.contains("a\n"), "{arguments:?}: {printed}");
    }
}

#[test]
fn a_file_that_is_called_as_an_option_is_no_option_in_a_printed_command() {
    let bench = Bench::new();
    fs::rename(bench.path("motion.csv"), bench.path("-rf.csv")).unwrap();
    bench.done("solve link.toml ./-rf.csv -q -o ./-run --write torque.h");
    let header = bench.read("torque.h");
    let command = "flexlink solve link.toml ./-rf.csv --write torque.h";
    assert!(header.contains(command), "{header:.900}");
    bench.write("-run/torque.csv", bench.read("-run/torque.csv").replacen("0,", "1,", 1));
    let told = bench.told(&["solve", "--repeat", "./-run", "-o", "a b"]);
    assert!(told.contains("flexlink compare ./-run 'a b' says by how much"), "{told}");
}

#[test]
fn two_headers_of_one_name_are_not_taken_for_one() {
    let bench = Bench::new();
    for (folder, scale) in [("a", "1"), ("b", "2")] {
        fs::create_dir(bench.path(folder)).unwrap();
        let table = format!("--set hub.inertia*={scale} --write {folder}/torque.h");
        bench.done(&format!("{SOLVE} -q {table}"));
    }
    let compiles = |source: &str| {
        bench.write("main.c", format!("{source}int main(void) {{ return 0; }}\n"));
        let cc = bench.command("cc", "-fsyntax-only main.c").output();
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
    bench.done(&format!("{SOLVE} -q -o run"));
    bench.done("compare golden run --bless");
    let files = || {
        let entries = fs::read_dir(bench.path("golden")).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let whole = files();
    bench.write("golden/.flexlink.lock", "");
    fs::create_dir(bench.path("golden/.flexlink.run-killed")).unwrap();
    let printed = bench.done("compare golden run --bless");
    assert!(printed.contains("blessed  nothing"), "{printed}");
    assert_eq!(files(), whole);
}
