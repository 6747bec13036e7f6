//! A sweep in parts: interrupted and resumed, shared among machines and joined.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::sweep::{sweep, swept};
use super::{Bench, LINK, MOTION, ended, refusal, stderr, stdout};

const VARY: &str = "--vary segments.*.EI*=0.5:8:200:log";

/// A sweep in the background that has written some rows.
fn begun(bench: &Bench) -> Child {
    begun_with(bench, &["--default-signal=INT,TERM,HUP"])
}

/// The same with what `env` makes of the signals: those of the tests themselves may be ignored, as
/// under nohup or in a script's background.
fn begun_with(bench: &Bench, signals: &[&str]) -> Child {
    let sweep = bench.program(&format!("sweep {LINK} {MOTION} --threads 1 {VARY}"));
    let child = with_signals(signals, sweep).stderr(Stdio::piped()).spawn().unwrap();
    wait_for_rows(bench, "sweep.csv", 6);
    child
}

fn wait_for_rows(bench: &Bench, table: &str, rows: usize) {
    let part = bench.path(&format!("{table}.part"));
    let are_there = |_| {
        sleep(Duration::from_millis(5));
        fs::read_to_string(&part).unwrap_or_default().lines().count() >= rows
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
    swept(&whole, VARY);
    let (whole, record) = (whole.read("sweep.csv"), whole.read("sweep.json"));
    for (signal, code) in [("-INT", Some(130)), ("-TERM", Some(130)), ("-KILL", None)] {
        let bench = Bench::new();
        let child = begun(&bench);
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        let told = stderr(&output);
        assert_eq!(output.status.code(), code, "{signal}: {}", output.status);
        assert_eq!(bench.names("."), ["sweep.csv.part"], "{signal}");
        let part = bench.read("sweep.csv.part");
        let (first, rows) = part.split_once('\n').unwrap();
        let (start, end) = ("# flexlink {\"format\":2,", ",\"shard\":\"1/1\",\"cases\":200}");
        assert!(first.starts_with(start) && first.ends_with(end), "{first}");
        // Without the check at the end of each.
        let plain = |row: &str| row.rsplit_once(',').unwrap().0.to_owned() + "\n";
        let plain: String = rows.lines().map(plain).collect();
        assert!(whole.starts_with(&plain) && plain.len() < whole.len(), "{signal}");
        let there = rows.lines().count() - 1;
        if code.is_some() {
            let error = format!(
                "error: interrupted after {there} of 200 cases, which are in sweep.csv.part\n\
                 hint: the same command with --resume goes on\n"
            );
            assert!(told.ends_with(&error), "{told}");
            let second = "\nfinishing the cases that have begun; a second signal ends";
            assert!(told.contains(second), "{told}");
        } else {
            let anew = Bench::new();
            anew.write("sweep.csv.part", &part);
            let told = stderr(&swept(&anew, VARY));
            let warning = format!("warning: sweep.csv.part held {there} rows");
            assert!(told.starts_with(&warning), "{told}");
        }
        let output = swept(&bench, &format!("{VARY} --resume"));
        assert_eq!(stdout(&output), "cases    200\nwritten  sweep.csv\n");
        assert!(bench.read("sweep.csv") == whole, "{signal}");
        assert_eq!(bench.names("."), ["sweep.csv", "sweep.json"]);
        assert!(bench.read("sweep.json") == record, "{signal}");
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
        wait_for_rows(&bench, "sweep.csv", 10);
        send(heard, &child);
        let told = stderr(&ended(130, child.wait_with_output().unwrap()));
        let words = "finishing the cases that have begun; a second signal ends at once";
        assert_eq!(told.matches(words).count(), 1, "{told}");
        assert_eq!(bench.names("."), ["sweep.csv.part"], "{heard}");
    }
}

#[cfg(unix)]
#[test]
fn another_sweep_does_not_go_on_with_its_rows() {
    let bench = Bench::new();
    let child = begun(&bench);
    // The one that is running has the file.
    refusal(5, sweep(&bench, VARY), "sweep.csv.part: another run is writing it");
    send("-INT", &child);
    child.wait_with_output().unwrap();
    let part = bench.read("sweep.csv.part");
    let words = "sweep.csv.part:1: inputs.arguments = \"\", but must be \"--set hub.inertia=0.2\"";
    refusal(3, sweep(&bench, &format!("{VARY} --resume --set hub.inertia=0.2")), words);
    assert!(bench.read("sweep.csv.part") == part);
}

#[test]
fn shards_join_to_the_table_of_one_machine_and_none_may_be_missing() {
    let bench = Bench::new();
    swept(&bench, VARY);
    for shard in ["1/3", "2/3", "3/3"] {
        swept(&bench, &format!("{VARY} --shard {shard}"));
    }
    let names = "sweep-3-of-3.csv sweep-1-of-3.csv sweep-2-of-3.csv";
    let merged = bench.printed(&format!("sweep --merge {names} -o merged.csv"));
    assert_eq!(merged, "cases    200, of 3 shards\nwritten  merged.csv\n");
    assert!(bench.read("merged.csv") == bench.read("sweep.csv"));
    let record = bench.read("merged.json").replace("merged.csv", "sweep.csv");
    assert!(record == bench.read("sweep.json"), "the record of one machine");
    let printed = bench.printed(&format!("sweep -o - --merge {names}"));
    assert!(printed == bench.read("sweep.csv"));

    let refusal = |files: &str| bench.error(3, &format!("sweep -o no.csv --merge {files}"));
    assert_eq!(
        refusal("sweep-3-of-3.csv sweep-1-of-3.csv"),
        "error: sweep-3-of-3.csv: shards = 2 of 3, but must be all: 2/3 is missing\n"
    );
    assert!(refusal("sweep.csv").contains("sweep.csv:1: first line = \"segments.*.EI*,"));
    let text = bench.read("sweep-2-of-3.csv");
    let cut = text.trim_end().rfind('\n').unwrap();
    bench.write("cut.csv", &text[..=cut]);
    assert_eq!(
        refusal("sweep-3-of-3.csv sweep-1-of-3.csv cut.csv"),
        "error: cut.csv: rows = 66, but must be 67\n\
         hint: finish it with --shard 2/3 --resume\n"
    );
    swept(&bench, "--vary segments.*.EI*=0.5:8:41:log --shard 2/3");
    let told = refusal(names);
    let words = "sweep-2-of-3.csv:1: inputs.vary = \"segments.*.EI*=0.5:8:41:log\", but must be";
    assert!(told.contains(words) && told.ends_with("\" as in sweep-3-of-3.csv\n"), "{told}");
    assert!(!bench.path("no.csv").exists() && !bench.path("no.json").exists());
}

#[test]
fn a_shard_of_failed_cases_is_a_shard_and_the_whole_tells_of_them() {
    let bench = Bench::new();
    for shard in ["1/3", "2/3", "3/3"] {
        swept(&bench, &format!("--vary damping.ratio=0.02,1.5,0.03 --shard {shard}"));
    }
    let merge = "sweep --merge sweep-1-of-3.csv";
    let told = bench.told(&format!("{merge} sweep-2-of-3.csv sweep-3-of-3.csv"));
    let warning = "warning: 1 of 3 cases failed, the first is case 2: --vary 'damping.ratio=1.5'";
    assert!(told.starts_with(warning), "{told}");
    let over = format!("{merge} -o sweep-1-of-3.csv");
    bench.refuses(2, &over, "must not be a file that is read");
}

#[test]
fn a_shard_that_is_complete_is_not_solved_again() {
    let bench = Bench::new();
    let shard = format!("{VARY} --shard 7/20 --resume");
    let written = || fs::metadata(bench.path("sweep-7-of-20.csv")).unwrap().modified().unwrap();
    swept(&bench, &shard);
    let before = written();
    let again = swept(&bench, &shard);
    assert_eq!(stdout(&again), "complete sweep-7-of-20.csv, 10 cases\n");
    assert_eq!(written(), before);
}

/// The text of a table with rows that `change` has changed; the first two lines stay.
fn with_rows<'a>(text: &'a str, change: impl Fn(&mut Vec<&'a str>)) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let mut rows = lines.split_off(2);
    change(&mut rows);
    [lines, rows].concat().join("\n") + "\n"
}

#[test]
fn rows_that_are_not_those_of_their_cases_are_neither_joined_nor_gone_on_with() {
    let bench = Bench::new();
    let vary = "--vary payload.mass=0,0.01,0.02,0.03,0.04,0.05";
    for shard in ["1/2", "2/2"] {
        swept(&bench, &format!("{vary} --shard {shard}"));
    }
    let text = bench.read("sweep-2-of-2.csv");
    let other = with_rows(&text, |rows| rows.truncate(1)).lines().last().unwrap().to_owned();
    let other = other.replacen("0.01,", "0.011,", 1);
    let number = text.lines().nth(2).unwrap().split(',').nth(3).unwrap();
    let damaged = text.replacen(number, "none", 1);
    let row = |line, found: &str, must: &str, case| {
        let column = format!("{line}: payload.mass = \"{found}\"");
        format!("{column}, but must be \"{must}\", the value of case {case}\n")
    };
    let less = with_rows(&text, |rows| rows.retain(|row| !row.starts_with("0.01,")));
    let merge = "sweep -o no.csv --merge sweep-1-of-2.csv";
    for (changed, words) in [
        (less, row(3, "0.03", "0.01", 2)),
        (with_rows(&text, |rows| rows[1] = rows[0]), row(4, "0.01", "0.03", 4)),
        (with_rows(&text, |rows| rows.swap(0, 2)), row(3, "0.05", "0.01", 2)),
        (with_rows(&text, |rows| rows[0] = &other), row(3, "0.011", "0.01", 2)),
        (damaged, "3: peak_torque_n_m = \"none\", but must be a finite number or nothing\n".into()),
    ] {
        bench.write("b.csv", &changed);
        let hint = "hint: a row was removed, doubled, moved or changed since it was written\n";
        let error = bench.error(3, &format!("{merge} b.csv"));
        assert_eq!(error, format!("error: b.csv:{words}{hint}"));
        bench.write("c.csv.part", &changed);
        let resumed = sweep(&bench, &format!("{vary} --shard 2/2 --resume -o c.csv"));
        let hint = "hint: remove the file, or leave --resume out to begin anew\n";
        let error = format!("error: c.csv.part:{words}{hint}");
        assert_eq!(stderr(&ended(3, resumed)), error);
        assert!(bench.read("c.csv.part") == changed);
    }
    // A number is no other case's; the check of its row tells of it.
    bench.write("sweep-2-of-2.csv", &text.replacen(number, "1.5", 1));
    let error = "error: sweep-2-of-2.csv:3: check = \"";
    bench.refuses_first(3, &format!("{merge} sweep-2-of-2.csv"), error);
    assert!(!bench.path("no.csv").exists());
}

/// The first request ends a sweep whose rows nobody takes: a pipe that is full, or one that is never opened.
#[cfg(target_os = "linux")]
#[test]
fn a_sweep_whose_output_is_blocked_ends_at_the_first_request() {
    for (signal, output) in [("-TERM", "-"), ("-INT", "-"), ("-HUP", "-"), ("-TERM", "fifo")] {
        let bench = Bench::new();
        assert!(Command::new("mkfifo").arg(bench.path("fifo")).status().unwrap().success());
        let vary = if output == "-" { "1:2:2000" } else { "1:2:3" };
        let sweep = bench
            .program(&format!("sweep {LINK} {MOTION} --vary segments.*.EI*={vary} -q -o {output}"));
        let mut program = with_signals(&["--default-signal=INT,TERM,HUP"], sweep);
        let mut child = program.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        if output == "fifo" {
            wait_for_rows(&bench, "fifo", 5);
        } else {
            // The rows fill the pipe, which holds 64 KiB; then no more processor time is taken.
            let taken = || {
                let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
                stat.split(' ').nth(13).unwrap().to_owned()
            };
            let mut before = taken();
            for _ in 0..60 {
                sleep(Duration::from_millis(1500));
                let now = taken();
                if now != "0" && now == before {
                    break;
                }
                before = now;
            }
        }
        send(signal, &child);
        let has_ended = (0..1500).any(|_| {
            sleep(Duration::from_millis(10));
            child.try_wait().unwrap().is_some()
        });
        let _ = child.kill();
        let _ = child.wait();
        assert!(has_ended, "{signal} {output}");
    }
}
