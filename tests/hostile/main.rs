//! Hostile inputs: what the program makes of files that are damaged, foreign, extreme or endless.
//!
//! Each has a sensible answer, a refusal that says what to do, or a warning with a number; never a
//! panic, nor an infinity or none-number in what is written or printed.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod content;
mod links;
mod memory;
mod motions;
mod places;
mod printed;
mod rights;
mod threads;
#[path = "../cli/words.rs"]
mod words;

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

use words::Words;

const REFUSED: i32 = 3;
const NOT_SOLVABLE: i32 = 4;

/// A working folder of its own, in which the program runs.
struct Bench {
    folder: TempDir,
}

impl Bench {
    /// With link.toml and motion.csv, which are good.
    fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        bench.write("link.toml", link(""));
        bench.write("motion.csv", motion(|k| (0.01 * f64::from(k)).to_string(), |a| a.to_string()));
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn command(&self, program: &str, arguments: &(impl Words + ?Sized)) -> Command {
        let mut command = Command::new(program);
        command.args(arguments.words()).current_dir(self.folder.path()).stdin(Stdio::null());
        command.env("LC_ALL", "C.UTF-8");
        command
    }

    fn run(&self, arguments: &(impl Words + ?Sized)) -> Output {
        self.command(PROGRAM, arguments).output().unwrap()
    }

    /// What the program prints, which must succeed.
    #[track_caller]
    fn done(&self, arguments: &(impl Words + ?Sized)) -> String {
        succeeded(&arguments.words(), &self.run(arguments))
    }

    /// What the program tells on standard error, however it ends.
    fn told(&self, arguments: &(impl Words + ?Sized)) -> String {
        text(&self.run(arguments).stderr)
    }

    /// The program must refuse with this code and this message, and leave nothing behind.
    #[track_caller]
    fn refuses(&self, arguments: &(impl Words + ?Sized), code: i32, message: &str) {
        self.is_refusal(&self.run(arguments), code, message);
    }

    #[track_caller]
    fn is_refusal(&self, output: &Output, code: i32, message: &str) {
        let error = text(&output.stderr);
        assert!(error.starts_with("error: ") && error.contains(message), "{message}: {error}");
        assert!(error.len() < 1000, "{error}");
        assert_eq!(output.status.code(), Some(code), "{error}");
        assert_eq!(text(&output.stdout), "");
        let results = "out simulated sweep.csv sweep.json sweep.csv.part merged.csv report.html";
        for result in results.split(' ') {
            assert!(!self.path(result).exists(), "{result} is left behind");
        }
    }

    /// `solve` must succeed, with every number that it writes and prints a finite one; returns what
    /// it warns of.
    #[track_caller]
    fn solves(&self, arguments: &(impl Words + ?Sized)) -> String {
        let output = self.run(&[SOLVE.words(), arguments.words()].concat());
        let warnings = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{warnings}");
        assert_finite("the summary", &text(&output.stdout));
        assert_finite("the warnings", &warnings);
        // Remarks on unusual numbers, each with its hint, are no warnings.
        let mut is_remark = false;
        let is_warning = |line: &&str| {
            is_remark = line.starts_with("remark:") || is_remark && line.starts_with("hint:");
            !is_remark
        };
        let warnings: String = warnings.split_inclusive('\n').filter(is_warning).collect();
        for entry in fs::read_dir(self.path("out")).unwrap() {
            let path = entry.unwrap().path();
            assert_finite(&path.display().to_string(), &fs::read_to_string(&path).unwrap());
        }
        warnings
    }
}

const PROGRAM: &str = env!("CARGO_BIN_EXE_flexlink");
const SOLVE: &str = "solve link.toml motion.csv";
const LARGE: &str =
    "large deflections and centrifugal stiffening, which the linear model leaves out";

/// What a program printed that must have succeeded.
#[track_caller]
fn succeeded(what: &dyn std::fmt::Debug, output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{what:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[track_caller]
fn assert_finite(place: &str, text: &str) {
    let words = text.split(|c: char| !c.is_alphanumeric());
    let bad = words.filter(|word| ["nan", "inf", "infinity"].contains(&&*word.to_lowercase()));
    assert_eq!(bad.count(), 0, "{place}: {text}");
}

/// A link of 1.5 m on 10 elements, and what is changed of it.
fn link(rest: &str) -> String {
    "segments = [{ name = 'beam', length = 1.5, EI = 5, mass_per_length = 0.8 }]\n\
     hub.inertia = 0.1\nmesh.elements = 10\ndamping = { model = 'hysteretic', ratio = 0.02 }\n"
        .to_owned()
        + rest
}

/// One sine of the acceleration, of 100 steps, each time and acceleration written by its function.
fn motion(time: impl Fn(i32) -> String, acceleration: impl Fn(f64) -> String) -> String {
    let row = |k: i32| {
        let value = (TAU * f64::from(k) / 100.0).sin();
        format!("{},{}\n", time(k), acceleration(value))
    };
    "time,acceleration\n".to_owned() + &(0..=100).map(row).collect::<String>()
}
