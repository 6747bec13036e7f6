//! The program as its users run it: files, options, streams and exit codes.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod arm_fit;
mod arm_modes;
mod arm_paths;
mod arm_report;
mod arm_simulate;
mod arm_sweep;
mod arms;
mod bench;
mod colours;
mod compare;
mod compare_folders;
mod compare_tolerances;
mod damping;
mod ends;
mod exits;
mod files;
mod fit;
mod fit_answers;
mod fit_decay;
mod fit_files;
mod fit_page;
mod fit_record;
mod fit_response;
mod golden_folder;
mod gravity;
mod help;
mod line_ends;
mod model_end;
mod modes;
mod motor;
mod options;
mod paths;
mod reading;
mod repeat;
mod report;
mod rigs;
mod simulate;
mod simulate_recorded;
mod simulate_refusals;
mod simulate_round_trip;
mod simulate_summary;
mod start;
mod streams;
mod summary;
mod sweep;
mod sweep_record;
mod sweep_shards;
mod torque_table;
mod trajectory;
mod verify;
mod warnings;

use std::fmt::Debug;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use bench::Bench;

const LINK: &str = "specs/bayo1987_example1.toml";
const MOTION: &str = "trajectories/sine_0.88s.csv";

impl Bench {
    /// Names in a folder of the bench, in order.
    fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn program(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flexlink"));
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        plain(&mut command);
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.program(arguments).output().unwrap()
    }

    /// Runs the program with this on standard input.
    fn fed(&self, input: impl AsRef<[u8]>, arguments: &[&str]) -> Output {
        let mut program = self.program(arguments);
        program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = program.spawn().unwrap();
        // A program that refuses its arguments does not read.
        let _ = child.stdin.take().unwrap().write_all(input.as_ref());
        child.wait_with_output().unwrap()
    }

    /// Runs the program, which must end with this code.
    #[track_caller]
    fn ends(&self, code: i32, arguments: &[&str]) -> Output {
        let output = self.run(arguments);
        let told = format!("{arguments:?}: {}{}", stdout(&output), stderr(&output));
        assert_eq!(output.status.code(), Some(code), "{told}");
        output
    }

    /// Runs the program, which must succeed.
    #[track_caller]
    fn done(&self, arguments: &[&str]) -> Output {
        self.ends(0, arguments)
    }

    /// Runs the program, which must succeed without a word on standard error.
    #[track_caller]
    fn silent(&self, arguments: &[&str]) -> Output {
        let output = self.done(arguments);
        assert_eq!(stderr(&output), "", "{arguments:?}");
        output
    }

    /// Runs the program, which must end with this code and these words on standard error.
    #[track_caller]
    fn refuses(&self, code: i32, arguments: &[&str], words: &str) {
        refusal(code, self.ends(code, arguments), words);
    }

    /// Runs the program, which must end with this code and begin standard error with these words.
    #[track_caller]
    fn refuses_first(&self, code: i32, arguments: &[&str], words: &str) {
        let error = stderr(&self.ends(code, arguments));
        assert!(error.starts_with(words), "{arguments:?}: {words}: {error}");
    }

    /// `solve` of the paper's first example with more arguments; must succeed.
    #[track_caller]
    fn solve(&self, arguments: &[&str]) -> Output {
        self.done(&[&["solve", &repository(LINK), &repository(MOTION)], arguments].concat())
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// The content of all files of a folder.
    fn contents(&self, folder: &str) -> Vec<(String, String)> {
        let read = |name: String| {
            let text = self.read(&format!("{folder}/{name}"));
            (name, text)
        };
        self.names(folder).into_iter().map(read).collect()
    }
}

/// What the machine at hand says of locale and terminal does not count.
fn plain(command: &mut Command) {
    for name in ["LC_CTYPE", "NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "COLUMNS"] {
        command.env_remove(name);
    }
    command.env("LC_ALL", "C.UTF-8");
}

/// `simulate` with the paper's first link and more arguments; must succeed.
#[track_caller]
fn simulated(bench: &Bench, arguments: &[&str]) -> Output {
    bench.done(&[&["simulate", &repository(LINK)], arguments].concat())
}

/// An output whose program must have ended with this code.
#[track_caller]
fn ended(code: i32, output: Output) -> Output {
    assert_eq!(output.status.code(), Some(code), "{}{}", stdout(&output), stderr(&output));
    output
}

/// An output whose program must have succeeded.
#[track_caller]
fn succeeded(output: Output) -> Output {
    ended(0, output)
}

/// An output that must have this code and these words on standard error.
#[track_caller]
fn refusal(code: i32, output: Output, words: &str) {
    let error = stderr(&ended(code, output));
    assert!(error.contains(words), "{words}: {error}");
}

/// The JSON on the standard output of a program.
fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The column of this name.
#[track_caller]
fn column(bench: &Bench, file: &str, name: &str) -> Vec<f64> {
    let found = bench.table(file).into_iter().find(|(heading, _)| heading == name);
    found.unwrap_or_else(|| panic!("{file} has no {name}")).1
}

/// What the system says of a failure; other systems have other words.
#[track_caller]
fn said<T: Debug>(failure: io::Result<T>) -> String {
    let text = failure.unwrap_err().to_string();
    text.split(" (os error").next().unwrap().to_owned()
}

/// What the system says of a file that is not there.
fn no_such_file() -> String {
    said(fs::read("none"))
}

/// Names of the entries of a JSON object.
fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// A file of this repository, from wherever the program runs.
fn repository(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name).to_str().unwrap().to_owned()
}

/// The link files of this repository.
fn link_files() -> Vec<String> {
    let entries = std::fs::read_dir(repository("specs")).unwrap().map(|entry| entry.unwrap());
    let files = entries.filter(|entry| entry.file_type().unwrap().is_file());
    let mut paths: Vec<String> =
        files.map(|file| file.path().to_str().unwrap().to_owned()).collect();
    paths.sort();
    assert!(paths.len() >= 8, "{paths:?}");
    paths
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}
