//! A system that has no thread to spare, as a full one, or one that limits them. A thread whose
//! stack would be larger than any memory stands for it.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Command, Stdio};

use super::{Bench, NOT_SOLVABLE, PROGRAM, text};

impl Bench {
    fn command_alone(&self, arguments: &[&str]) -> Command {
        let mut command = self.command(PROGRAM, arguments);
        command.env("RUST_MIN_STACK", (1_u64 << 60).to_string());
        command
    }
}

#[test]
fn one_thread_does_the_work_of_all_where_there_is_no_other() {
    let bench = Bench::new();
    bench.run(&["solve", "link.toml", "motion.csv", "-o", "solved"]);
    for arguments in [
        &["solve", "link.toml", "motion.csv", "--json", "-o", "OUT"][..],
        &["verify", "link.toml", "motion.csv"],
        &["simulate", "link.toml", "solved/torque.csv", "-o", "OUT"],
        &["modes", "link.toml", "-o", "OUT"],
        &["frf", "link.toml", "--to", "10", "-o", "OUT"],
        &["trajectory", "min-jerk", "--distance", "1", "--duration", "1", "--step", "0.01"],
        &["compare", "solved", "solved"],
        &["report", "solved", "-o", "OUT"],
    ] {
        let told = ["many", "alone"].map(|folder| {
            let named = arguments.iter().map(|word| if *word == "OUT" { folder } else { word });
            let arguments: Vec<_> = named.collect();
            let mut command = match folder {
                "alone" => bench.command_alone(&arguments),
                _ => bench.command(PROGRAM, &arguments),
            };
            let output = command.output().unwrap();
            assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
            text(&output.stdout).replace(folder, "OUT")
        });
        assert_eq!(told[0], told[1], "{arguments:?}");
        bench.hold_together("many", "alone");
    }
}

impl Bench {
    /// Two results, files or folders, must have the same bytes; they are removed.
    fn hold_together(&self, one: &str, other: &str) {
        let [one, other] = [one, other].map(|name| self.path(name));
        if one.is_dir() {
            let names = |folder| {
                let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
                let mut names: Vec<_> = entries.collect();
                names.sort();
                names
            };
            assert_eq!(names(&one), names(&other));
            for name in names(&one) {
                assert!(fs::read(one.join(&name)).unwrap() == fs::read(other.join(&name)).unwrap());
            }
            for folder in [one, other] {
                fs::remove_dir_all(folder).unwrap();
            }
        } else if one.exists() {
            assert!(fs::read(&one).unwrap() == fs::read(&other).unwrap());
            for file in [one, other] {
                fs::remove_file(file).unwrap();
            }
        }
    }
}

#[test]
fn threads_that_were_asked_for_and_those_of_a_sweep_are_missed() {
    let bench = Bench::new();
    let solve = ["solve", "link.toml", "motion.csv", "--threads", "2"];
    let sweep = ["sweep", "link.toml", "motion.csv", "--vary", "hub.inertia=0.1,0.2"];
    for arguments in [&solve[..], &sweep] {
        let output = bench.command_alone(arguments).output().unwrap();
        bench.is_refusal(&output, NOT_SOLVABLE, "error: cannot start threads: ");
        assert!(text(&output.stderr).contains("\nhint: "));
    }
}

#[test]
fn a_run_that_no_thread_listens_for_is_ended_by_its_signal() {
    let bench = Bench::new();
    let mut command = bench.command_alone(&["solve", "link.toml", "-"]);
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    // A pipe that is full has been read from: the program listens by then.
    let mut input = child.stdin.take().unwrap();
    input.write_all(&b"0,0\n".repeat(1 << 16)).unwrap();
    let sent = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().signal(), Some(15));
}
