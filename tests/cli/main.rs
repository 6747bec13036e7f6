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
mod carriage;
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
mod fit_record;
mod fit_response;
mod golden_folder;
mod gravity;
mod help;
mod learn;
mod line_ends;
mod model_end;
mod modes;
mod motor;
mod options;
mod pages;
mod paths;
mod reading;
mod repeat;
mod report;
mod rigs;
mod robust;
mod robust_edges;
mod robust_report;
mod set_points;
mod shape;
mod simulate;
mod simulate_recorded;
mod simulate_refusals;
mod simulate_round_trip;
mod simulate_summary;
mod start;
mod streams;
mod summary;
mod sweep;
mod sweep_plays;
mod sweep_record;
mod sweep_shards;
mod torque_table;
mod trajectory;
mod verify;
mod warnings;
mod words;

use std::fmt::Debug;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use bench::Bench;
use words::Words;

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

    /// The program in the folder of the bench; inputs of this repository are called as they are there.
    fn program(&self, arguments: &(impl Words + ?Sized)) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flexlink"));
        command.args(arguments.words().iter().map(|word| {
            let is_of_repository = ["specs/", "trajectories/", "measurements/"]
                .iter()
                .any(|own| word.starts_with(own));
            if is_of_repository { repository(word) } else { word.to_owned() }
        }));
        command.current_dir(self.folder.path()).stdin(Stdio::null());
        plain(&mut command);
        command
    }

    fn run(&self, arguments: &(impl Words + ?Sized)) -> Output {
        self.program(arguments).output().unwrap()
    }

    /// Runs the program with this on standard input.
    fn fed(&self, input: impl AsRef<[u8]>, arguments: &(impl Words + ?Sized)) -> Output {
        let mut program = self.program(arguments);
        program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = program.spawn().unwrap();
        // A program that refuses its arguments does not read.
        let _ = child.stdin.take().unwrap().write_all(input.as_ref());
        child.wait_with_output().unwrap()
    }

    /// Runs the program, which must end with this code. Lines that people read fit a terminal.
    #[track_caller]
    fn ends(&self, code: i32, arguments: &(impl Words + ?Sized)) -> Output {
        let output = self.run(arguments);
        let words = arguments.words();
        let told = format!("{words:?}: {}{}", stdout(&output), stderr(&output));
        assert_eq!(output.status.code(), Some(code), "{told}");
        let is_read = ["solve", "simulate", "verify", "modes", "robust", "learn"]
            .contains(&words[0].as_str())
            && !words.iter().any(|word| word == "-" || word == "--json");
        // Longer are rows of `verify` that fail, and two lines with many digits.
        let longer = ["tip off at the rows", "held from sample to sample"];
        let fits = |line: &str| {
            let line = line.strip_suffix("  FAILS").unwrap_or(line);
            let is_longer = longer.iter().any(|words| line.contains(words));
            (is_longer || line.chars().count() <= 80) && line.trim_end() == line
        };
        assert!(!is_read || stdout(&output).lines().all(fits), "{told}");
        output
    }

    /// Runs the program, which must succeed.
    #[track_caller]
    fn done(&self, arguments: &(impl Words + ?Sized)) -> Output {
        self.ends(0, arguments)
    }

    /// What the program prints, which must succeed.
    #[track_caller]
    fn printed(&self, arguments: &(impl Words + ?Sized)) -> String {
        stdout(&self.done(arguments))
    }

    /// What the program tells on standard error, which must succeed.
    #[track_caller]
    fn told(&self, arguments: &(impl Words + ?Sized)) -> String {
        stderr(&self.done(arguments))
    }

    /// What the program, which must end with this code, tells on standard error.
    #[track_caller]
    fn error(&self, code: i32, arguments: &(impl Words + ?Sized)) -> String {
        stderr(&self.ends(code, arguments))
    }

    /// The JSON that the program prints, which must succeed.
    #[track_caller]
    fn reply(&self, arguments: &(impl Words + ?Sized)) -> Value {
        json_of(&self.done(arguments))
    }

    /// Runs the program, which must succeed without a word on standard error.
    #[track_caller]
    fn silent(&self, arguments: &(impl Words + ?Sized)) -> String {
        let output = self.done(arguments);
        assert_eq!(stderr(&output), "", "{:?}", arguments.words());
        stdout(&output)
    }

    /// Runs the program, which must end with this code and these words on standard error.
    #[track_caller]
    fn refuses(&self, code: i32, arguments: &(impl Words + ?Sized), words: &str) {
        refusal(code, self.ends(code, arguments), words);
    }

    /// Runs the program, which must end with this code and begin standard error with these words.
    #[track_caller]
    fn refuses_first(&self, code: i32, arguments: &(impl Words + ?Sized), words: &str) {
        let error = self.error(code, arguments);
        assert!(error.starts_with(words), "{:?}: {words}: {error}", arguments.words());
    }

    /// `solve` of the paper's first example with more arguments; must succeed.
    #[track_caller]
    fn solve(&self, arguments: &(impl Words + ?Sized)) -> Output {
        self.done(&with(&["solve", LINK, MOTION], arguments))
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// The number at this place of the summary of a folder.
    #[track_caller]
    fn number(&self, folder: &str, place: &str) -> f64 {
        number(&self.json(&format!("{folder}/summary.json")), place)
    }

    /// The content of all files of a folder.
    fn contents(&self, folder: &str) -> Vec<(String, String)> {
        let read = |name: String| {
            let text = self.read(&format!("{folder}/{name}"));
            (name, text)
        };
        self.names(folder).into_iter().map(read).collect()
    }

    /// The rows of a table, as fields of text; commas in quotes part none.
    fn rows(&self, name: &str) -> Vec<Vec<String>> {
        let text = self.read(name);
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        let fields = |row: csv::StringRecord| row.iter().map(str::to_owned).collect();
        reader.records().map(|row| fields(row.unwrap())).collect()
    }

    /// The cells of the column of this name of a table, which may be empty.
    #[track_caller]
    fn cells(&self, table: &str, name: &str) -> Vec<String> {
        let rows = self.rows(table);
        let place = rows[0].iter().position(|heading| heading == name);
        let place = place.unwrap_or_else(|| panic!("{table} has no {name}: {:?}", rows[0]));
        rows[1..].iter().map(|row| row[place].clone()).collect()
    }

    /// The numbers of the column of this name of a table, NaN where a cell is empty.
    #[track_caller]
    fn numbers(&self, table: &str, name: &str) -> Vec<f64> {
        let of = |cell: &String| if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
        self.cells(table, name).iter().map(of).collect()
    }

    /// Writes a table with a row of numbers for each of these row numbers.
    fn sampled<const N: usize>(
        &self,
        name: &str,
        heading: &str,
        rows: impl IntoIterator<Item = i32>,
        row: impl Fn(f64) -> [f64; N],
    ) {
        let line = |k: i32| row(f64::from(k)).map(|number| number.to_string()).join(",") + "\n";
        let lines: String = rows.into_iter().map(line).collect();
        self.write(name, &format!("{heading}\n{lines}"));
    }
}

/// Two lists of arguments as one.
fn with(first: &(impl Words + ?Sized), more: &(impl Words + ?Sized)) -> Vec<String> {
    [first.words(), more.words()].concat()
}

/// The number at a place of a JSON value.
#[track_caller]
fn number(value: &Value, place: &str) -> f64 {
    let number = value.pointer(&format!("/{place}")).and_then(Value::as_f64);
    number.unwrap_or_else(|| panic!("no number {place} in {value}"))
}

/// Motions from 0 to 1 with two, three and four derivatives at rest at the ends.
fn min_jerk(u: f64) -> f64 {
    u.powi(3) * (10.0 - u * (15.0 - 6.0 * u))
}

fn septic(u: f64) -> f64 {
    u.powi(4) * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u)))
}

fn ninth(u: f64) -> f64 {
    u.powi(5) * (126.0 - u * (420.0 - u * (540.0 - u * (315.0 - 70.0 * u))))
}

/// Largest absolute value.
fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |most, sample| most.max(sample.abs()))
}

/// Largest difference of two columns of the same length.
#[track_caller]
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    assert!(differences.iter().all(|difference| !difference.is_nan()));
    peak(&differences)
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
fn simulated(bench: &Bench, arguments: &(impl Words + ?Sized)) -> Output {
    bench.done(&with(&["simulate", LINK], arguments))
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
