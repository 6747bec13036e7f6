//! A system that has no thread to spare, as a full one, or one that limits them. A thread whose
//! stack would be larger than any memory stands for it.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::{Bench, NOT_SOLVABLE, PROGRAM, SOLVE, succeeded, text};

impl Bench {
    fn command_alone(&self, arguments: &str) -> Command {
        let mut command = self.command(PROGRAM, arguments);
        command.env("RUST_MIN_STACK", (1_u64 << 60).to_string());
        command
    }
}

/// Files below a path with their bytes, by their names; the path itself is removed.
fn taken(path: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let of = |entry: walkdir::DirEntry| {
        let name = entry.path().strip_prefix(path).unwrap().to_owned();
        entry.file_type().is_file().then(|| (name, fs::read(entry.path()).unwrap()))
    };
    let entries = walkdir::WalkDir::new(path).sort_by_file_name().into_iter();
    let files = entries.filter_map(|entry| of(entry.ok()?)).collect();
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    files
}

#[test]
fn one_thread_does_the_work_of_all_where_there_is_no_other() {
    let bench = Bench::new();
    bench.done(&format!("{SOLVE} -o solved"));
    for arguments in [
        "solve link.toml motion.csv --json -o OUT",
        "verify link.toml motion.csv",
        "simulate link.toml solved/torque.csv -o OUT",
        "modes link.toml -o OUT",
        "frf link.toml --to 10 -o OUT",
        "trajectory min-jerk --distance 1 --duration 1 --step 0.01",
        "compare solved solved",
        "report solved -o OUT",
    ] {
        let [many, alone] = ["many", "alone"].map(|folder| {
            let arguments = arguments.replace("OUT", folder);
            let mut command = match folder {
                "alone" => bench.command_alone(&arguments),
                _ => bench.command(PROGRAM, &arguments),
            };
            let printed = succeeded(&arguments, &command.output().unwrap());
            let files = taken(&bench.path(folder));
            assert_eq!(files.is_empty(), !arguments.contains("-o "), "{arguments}");
            (printed.replace(folder, "OUT"), files)
        });
        assert_eq!(many.0, alone.0, "{arguments:?}");
        assert!(many.1 == alone.1, "{arguments:?}");
    }
}

#[test]
fn threads_that_were_asked_for_and_those_of_a_sweep_are_missed() {
    let bench = Bench::new();
    let sweep = "sweep link.toml motion.csv --vary hub.inertia=0.1,0.2";
    for arguments in [&format!("{SOLVE} --threads 2"), sweep] {
        let output = bench.command_alone(arguments).output().unwrap();
        bench.is_refusal(&output, NOT_SOLVABLE, "error: cannot start threads: ");
        assert!(text(&output.stderr).contains("\nhint: "));
    }
}

#[test]
fn a_run_that_no_thread_listens_for_is_ended_by_its_signal() {
    let bench = Bench::new();
    let mut command = bench.command_alone("solve link.toml -");
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    // A pipe that is full has been read from: the program listens by then.
    let mut input = child.stdin.take().unwrap();
    input.write_all(&b"0,0\n".repeat(1 << 16)).unwrap();
    let sent = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().signal(), Some(15));
}
