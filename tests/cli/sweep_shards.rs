//! A sweep in parts: interrupted and resumed, shared among machines and joined.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::sweep::{sweep, swept};
use super::{Bench, LINK, MOTION, repository, stderr, stdout};

const VARY: [&str; 2] = ["--vary", "segments.*.EI*=0.5:8:200:log"];

/// A sweep in the background that has written some rows.
fn begun(bench: &Bench) -> Child {
    begun_with(bench, &["--default-signal=INT,TERM,HUP"])
}

/// The same with what `env` makes of the signals: those of the tests themselves may be ignored, as
/// under nohup or in a script's background.
fn begun_with(bench: &Bench, signals: &[&str]) -> Child {
    let (link, motion) = (repository(LINK), repository(MOTION));
    let arguments = [&["sweep", &link, &motion, "--threads", "1"], &VARY[..]].concat();
    let mut program = with_signals(signals, bench.program(&arguments));
    let child = program.stderr(Stdio::piped()).spawn().unwrap();
    wait_for_rows(bench, 6);
    child
}

fn wait_for_rows(bench: &Bench, rows: usize) {
    let written = || fs::read_to_string(bench.path("sweep.csv.part")).unwrap_or_default();
    let are_there = |_| {
        sleep(Duration::from_millis(5));
        written().lines().count() >= rows
    };
    assert!((0..6000).any(are_there), "no {rows} rows within 30 s");
}

fn with_signals(signals: &[&str], program: Command) -> Command {
    if !cfg!(target_os = "linux") {
        return program;
    }
    let mut command = Command::new("env");
    command.args(signals).arg(program.get_program()).args(program.get_args());
    command.current_dir(program.get_current_dir().unwrap()).stdin(Stdio::null());
    for (name, value) in program.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command
}

#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

#[cfg(unix)]
#[test]
fn a_sweep_that_is_stopped_keeps_its_rows_and_goes_on_to_the_same_table() {
    let whole = Bench::new();
    swept(&whole, &VARY);
    let whole = whole.read("sweep.csv");
    for (signal, code) in [("-INT", Some(130)), ("-TERM", Some(130)), ("-KILL", None)] {
        let bench = Bench::new();
        let child = begun(&bench);
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), code, "{signal}: {}", output.status);
        assert_eq!(bench.names("."), ["sweep.csv.part"], "{signal}");
        let part = bench.read("sweep.csv.part");
        let (first, rows) = part.split_once('\n').unwrap();
        assert!(first.starts_with("# flexlink ") && first.ends_with(", shard 1/1 of 200 cases"));
        assert!(whole.starts_with(rows) && rows.len() < whole.len(), "{signal}");
        if code.is_some() {
            let there = rows.lines().count() - 1;
            let error = format!(
                "error: interrupted after {there} of 200 cases, which are in sweep.csv.part\n\
                 hint: the same command with --resume goes on\n"
            );
            assert!(stderr(&output).ends_with(&error), "{}", stderr(&output));
            assert!(
                stderr(&output).contains("\nfinishing the cases that have begun; once more ends")
            );
        }
        if signal == "-KILL" {
            let anew = Bench::new();
            anew.write("sweep.csv.part", &part);
            let output = swept(&anew, &VARY);
            let warning = format!("warning: sweep.csv.part held {} rows", rows.lines().count() - 1);
            assert!(stderr(&output).starts_with(&warning), "{}", stderr(&output));
        }
        let output = swept(&bench, &[&VARY[..], &["--resume"]].concat());
        assert_eq!(stdout(&output), "cases    200\nwritten  sweep.csv\n");
        assert!(bench.read("sweep.csv") == whole, "{signal}");
        assert_eq!(bench.names("."), ["sweep.csv"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_sweep_started_to_ignore_ctrl_c_and_hangup_goes_on_but_ends_when_the_system_asks() {
    for (ignored, heard) in [("INT,HUP", "-TERM"), ("TERM,HUP", "-INT"), ("INT,TERM", "-HUP")] {
        let bench = Bench::new();
        let others = format!("--default-signal={}", heard.trim_start_matches('-'));
        let child = begun_with(&bench, &[&others, &format!("--ignore-signal={ignored}")]);
        for signal in ignored.split(',') {
            send(&format!("-{signal}"), &child);
        }
        wait_for_rows(&bench, 10);
        send(heard, &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{heard}: {}", output.status);
        let words = "finishing the cases that have begun; once more ends at once";
        assert_eq!(stderr(&output).matches(words).count(), 1, "{}", stderr(&output));
        assert_eq!(bench.names("."), ["sweep.csv.part"], "{heard}");
    }
}

#[cfg(unix)]
#[test]
fn another_sweep_does_not_go_on_with_its_rows() {
    let bench = Bench::new();
    let child = begun(&bench);
    // The one that is running has the file.
    let second = sweep(&bench, &VARY);
    assert_eq!(second.status.code(), Some(5));
    assert!(stderr(&second).contains("sweep.csv.part: another run is writing it"));
    send("-INT", &child);
    child.wait_with_output().unwrap();
    let part = bench.read("sweep.csv.part");
    let other = [&VARY[..], &["--resume", "--set", "hub.inertia=0.2"]].concat();
    let other = sweep(&bench, &other);
    assert_eq!(other.status.code(), Some(3));
    assert!(stderr(&other).contains("sweep.csv.part:1: sweep = "), "{}", stderr(&other));
    assert!(bench.read("sweep.csv.part") == part);
}

#[test]
fn shards_join_to_the_table_of_one_machine_and_none_may_be_missing() {
    let bench = Bench::new();
    swept(&bench, &VARY);
    for shard in ["1/3", "2/3", "3/3"] {
        swept(&bench, &[&VARY[..], &["--shard", shard]].concat());
    }
    let names = ["sweep-3-of-3.csv", "sweep-1-of-3.csv", "sweep-2-of-3.csv"];
    let merged = bench.run(&[&["sweep", "--merge"], &names[..], &["-o", "merged.csv"]].concat());
    assert_eq!(stdout(&merged), "cases    200, of 3 shards\nwritten  merged.csv\n");
    assert!(bench.read("merged.csv") == bench.read("sweep.csv"));
    let printed = bench.run(&[&["sweep", "-o", "-", "--merge"], &names[..]].concat());
    assert!(stdout(&printed) == bench.read("sweep.csv"));

    let refusal = |files: &[&str]| {
        let output = bench.run(&[&["sweep", "-o", "no.csv", "--merge"], files].concat());
        assert_eq!(output.status.code(), Some(3));
        stderr(&output)
    };
    assert_eq!(
        refusal(&names[..2]),
        "error: sweep-3-of-3.csv: shards = 2 of 3, but must be all: 2/3 is missing\n"
    );
    assert!(refusal(&["sweep.csv"]).contains("sweep.csv:1: first line = \"segments.*.EI,"));
    let text = bench.read("sweep-2-of-3.csv");
    let cut = text.trim_end().rfind('\n').unwrap();
    bench.write("cut.csv", &text[..=cut]);
    assert_eq!(
        refusal(&[names[0], names[1], "cut.csv"]),
        "error: cut.csv: rows = 66, but must be 67\n\
         hint: finish it with --shard 2/3 --resume\n"
    );
    swept(&bench, &["--vary", "segments.*.EI*=0.5:8:41:log", "--shard", "2/3"]);
    assert!(refusal(&names).contains("must be a shard of the same sweep as sweep-3-of-3.csv"));
    assert!(!bench.path("no.csv").exists());
}

#[test]
fn a_shard_of_failed_cases_is_a_shard_and_the_whole_tells_of_them() {
    let bench = Bench::new();
    let vary = ["--vary", "damping.ratio=0.02,1.5,0.03"];
    for shard in ["1/3", "2/3", "3/3"] {
        swept(&bench, &[&vary[..], &["--shard", shard]].concat());
    }
    let names = ["sweep-1-of-3.csv", "sweep-2-of-3.csv", "sweep-3-of-3.csv"];
    let merged = bench.run(&[&["sweep", "--merge"], &names[..]].concat());
    assert_eq!(merged.status.code(), Some(0));
    let warning = "warning: 1 of 3 cases failed, the first is case 2: --vary 'damping.ratio=1.5'";
    assert!(stderr(&merged).starts_with(warning), "{}", stderr(&merged));
    let same = bench.run(&["sweep", "-o", names[0], "--merge", names[0]]);
    assert_eq!(same.status.code(), Some(2));
    assert!(stderr(&same).contains("must not be a file that is read"), "{}", stderr(&same));
}

#[test]
fn a_shard_that_is_complete_is_not_solved_again() {
    let bench = Bench::new();
    let shard = [&VARY[..], &["--shard", "7/20", "--resume"]].concat();
    swept(&bench, &shard);
    let written = fs::metadata(bench.path("sweep-7-of-20.csv")).unwrap().modified().unwrap();
    let again = swept(&bench, &shard);
    assert_eq!(stdout(&again), "complete sweep-7-of-20.csv, 10 cases\n");
    let now = fs::metadata(bench.path("sweep-7-of-20.csv")).unwrap().modified().unwrap();
    assert_eq!(written, now);
}
