//! Links and pipes where a run expects its own files, and inputs that would forge what it prints.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::{Value, json};

use super::words::Words;
use super::{Bench, PROGRAM, REFUSED, SOLVE, link, text};

const CANNOT_WRITE: i32 = 5;

const VARY: &str = "sweep link.toml motion.csv --vary segments.*.EI*=1,2 -o sweep.csv";

impl Bench {
    /// With a run in `out`.
    fn solved() -> Self {
        let bench = Self::new();
        bench.done("solve link.toml motion.csv -q");
        bench
    }

    /// The program must refuse in a moment: what it must not wait for has no end.
    #[track_caller]
    fn refuses_soon(&self, arguments: &(impl Words + ?Sized), code: i32, message: &str) {
        let mut command = self.command(PROGRAM, arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let has_ended = (0..3000).any(|_| {
            sleep(Duration::from_millis(10));
            child.try_wait().unwrap().is_some()
        });
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        assert!(has_ended, "{:?} does not end", arguments.words());
        let error = text(&output.stderr);
        assert!(error.starts_with("error: ") && error.contains(message), "{message}: {error}");
        assert_eq!(output.status.code(), Some(code), "{error}");
    }
}

#[test]
fn a_link_in_the_place_of_a_sweeps_unfinished_rows_is_not_followed() {
    let bench = Bench::new();
    bench.write("victim", "of value");
    symlink("victim", bench.path("sweep.csv.part")).unwrap();
    bench.refuses_soon(VARY, CANNOT_WRITE, "sweep.csv.part: it is a symbolic link");
    assert_eq!(bench.read("victim"), "of value");
}

#[test]
fn a_link_in_the_place_of_a_cases_folder_is_not_followed() {
    let bench = Bench::new();
    for folder in ["all", "elsewhere"] {
        fs::create_dir(bench.path(folder)).unwrap();
    }
    bench.write("elsewhere/report.html", "of value");
    symlink("../elsewhere", bench.path("all/1")).unwrap();
    let message = "all/1: is a symbolic link, but must be a folder";
    bench.refuses_soon(&format!("{VARY} --outputs all"), CANNOT_WRITE, message);
    assert_eq!(fs::read_dir(bench.path("elsewhere")).unwrap().count(), 1);
    // One that the command line names is meant.
    symlink("elsewhere", bench.path("out")).unwrap();
    bench.done(SOLVE);
    assert!(bench.path("elsewhere/summary.json").exists());
}

#[test]
fn a_link_at_a_name_that_nobody_typed_is_replaced_and_what_it_leads_to_stays() {
    let fit = "fit link.toml measured.toml --free hub.inertia --report";
    for (arguments, name) in [
        ("report out -q", "out/report.html"),
        ("report sweep.csv -q", "sweep.html"),
        (VARY.strip_suffix(" -o sweep.csv").unwrap(), "sweep.csv"),
        (VARY, "sweep.json"),
        (fit, "fit.html"),
        (&format!("{fit} -o fitted.toml"), "fitted.html"),
    ] {
        let bench = Bench::solved();
        bench.write("measured.toml", "[[frequency]]\nmode = 1\nvalue = 2.0\n");
        // The record of another sweep, so that it may be replaced at all.
        bench.done(&VARY.replace("1,2", "1,3"));
        let victim = bench.read("sweep.json");
        fs::create_dir(bench.path("home")).unwrap();
        bench.write("home/victim", &victim);
        let place = bench.path(name);
        let _ = fs::remove_file(&place);
        symlink(bench.path("home/victim"), &place).unwrap();
        bench.done(arguments);
        assert_eq!(bench.read("home/victim"), victim, "{name}");
        assert!(fs::symlink_metadata(&place).unwrap().is_file(), "{name}");
        assert_ne!(bench.read(name), victim, "{name}");
        assert_eq!(fs::read_dir(bench.path("home")).unwrap().count(), 1, "{name}");
    }
}

#[test]
fn a_link_that_is_typed_is_followed_and_a_circle_of_links_is_refused() {
    let bench = Bench::solved();
    bench.write("page.html", "old");
    symlink("page.html", bench.path("typed.html")).unwrap();
    bench.done("report out -q -o typed.html");
    assert!(bench.path("typed.html").is_symlink());
    assert!(bench.read("page.html").starts_with("<!DOCTYPE"));
    for [name, target] in [["a", "b"], ["b", "a"], ["own", "own"]] {
        symlink(target, bench.path(name)).unwrap();
    }
    for path in ["a", "own"] {
        let message = format!("cannot write {path}: Too many levels of symbolic links");
        let sweep = VARY.strip_suffix("sweep.csv").unwrap();
        for arguments in ["report out -q -o ", "frf link.toml --points 5 -o ", sweep] {
            bench.refuses_soon(&format!("{arguments}{path}"), CANNOT_WRITE, &message);
        }
        assert!(bench.path(path).is_symlink());
        assert!(!bench.path(&format!("{path}.part")).exists());
    }
}

#[test]
fn a_lock_that_leads_nowhere_is_told() {
    let bench = Bench::new();
    fs::create_dir(bench.path("out")).unwrap();
    symlink("nowhere", bench.path("out/.flexlink.lock")).unwrap();
    bench.refuses_soon(SOLVE, CANNOT_WRITE, ".flexlink.lock in it is a link that leads nowhere");
}

#[test]
fn a_device_or_a_pipe_in_a_folder_is_not_waited_for() {
    let summary = "out: summary.json = a device or a pipe, but must be a file";
    for (name, arguments, message) in [
        ("torque.csv", "solve --repeat out", "out/torque.csv: cannot read: it is no file"),
        ("summary.json", "solve --repeat out", summary),
        ("torque.csv", "report out", "out: torque.csv = a device or a pipe"),
        ("torque.csv", "compare out out2", "out/torque.csv: cannot read: it is a device"),
    ] {
        for is_pipe in [false, true] {
            let bench = Bench::solved();
            let path = bench.path("out").join(name);
            fs::remove_file(&path).unwrap();
            if is_pipe {
                assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
            } else {
                symlink("/dev/zero", &path).unwrap();
            }
            fs::create_dir(bench.path("out2")).unwrap();
            bench.refuses_soon(arguments, REFUSED, message);
        }
    }
}

#[test]
fn a_title_makes_no_line_of_its_own_and_no_control_character() {
    let bench = Bench::new();
    let title = r#"title = "arm\nwarning: all is well\u009b31m""#;
    bench.write("link.toml", format!("{title}\n{}", link("")));
    let printed = bench.done(SOLVE);
    assert!(printed.starts_with("arm\\nwarning: all is well\\u{9b}31m\n"), "{printed}");
    let printed = bench.done(&format!("{SOLVE} --json"));
    assert!(!printed.contains(|c: char| c.is_control() && c != '\n'), "{printed}");
    assert!(printed.contains(r#""arm\nwarning: all is well\u009b31m""#), "{printed}");
}

#[test]
fn a_title_does_not_turn_the_direction_of_writing() {
    let bench = Bench::new();
    let title = "title = \"arm \u{202e}2.0\u{2066}\"";
    bench.write("link.toml", format!("{title}\n{}", link("")));
    let printed = bench.done(SOLVE);
    assert!(printed.starts_with("arm \\u{202e}2.0\\u{2066}\n"), "{printed}");
    let printed = bench.done(&format!("{SOLVE} --json"));
    assert!(printed.contains(r#""arm \u202e2.0\u2066""#), "{printed}");
    for arguments in [
        "solve \u{202e}lmot.knil motion.csv",
        "solve link.toml --every=\u{202e}1",
        "modes link.toml --set=hub.\u{202e}ai=1",
    ] {
        let told = bench.told(arguments);
        assert!(told.starts_with("error: ") && !told.contains('\u{202e}'), "{told}");
    }
    // Nor does that of a page.
    bench.write("link.toml", format!("title = \"a\u{202e}b\\u009bc\"\n{}", link("")));
    bench.done(&format!("{SOLVE} -q --report"));
    let page = bench.read("out/report.html");
    assert!(page.contains("<h1>a\\u{202e}b\\u{9b}c</h1>"));
    let turns = |c: char| c == '\u{202e}' || c.is_control() && !matches!(c, '\n' | '\t');
    assert!(!page.contains(turns));
}

#[test]
fn a_message_quotes_sixty_characters_of_an_input() {
    let bench = Bench::new();
    let long = "x".repeat(100_000);
    let refuse = |arguments: &[&str]| {
        let told = bench.told(arguments);
        assert!(told.starts_with("error: ") && told.len() < 700, "{} bytes", told.len());
    };
    for wrong in [
        format!("{long} = 1"),
        format!("hub.inertia = \"1 {long}\""),
        format!("hub.inertia = \"{long}\""),
        format!("hub.{long}.{long} = 1"),
        format!("payload = \"{long}\""),
        format!("payload = [{}1]", "1, ".repeat(10_000)),
        format!("damping.model = \"{long}\""),
        format!("title = 1\n{long} = 1\n{long} = 2"),
    ] {
        bench.write("wrong.toml", format!("{wrong}\n{}", link("")));
        refuse(&["modes", "wrong.toml"]);
    }
    for set in [
        format!("{long}=1"),
        format!("segments.{long}.EI=1"),
        format!("segments.0.EI*={long}"),
        format!("segments.0.{long}*=2"),
        long.clone(),
    ] {
        refuse(&["modes", "link.toml", "--set", &set]);
    }
    let value = |end: &str| format!("segments.{long}.EI*=1{end}");
    let sweeps = [":2", ",1", ",'x", ":2:3", ",2"].map(value).into_iter().chain([
        format!("title={0},{0}", &long[..50_000]),
        format!("hub.inertia=0{long}:1:2"),
        format!("distance={long}"),
        format!("{long}=1"),
    ]);
    for vary in sweeps {
        refuse(&["sweep", "link.toml", "motion.csv", "--vary", &vary]);
    }
    let fit = ["trajectory", "sine", "--distance", "1", "--step", "0.1", "--link", "link.toml"];
    for limit in [long.clone(), format!("{long}=1"), format!("torque={long}")] {
        refuse(&[&fit[..], &["--fit-limit", &limit]].concat());
    }
    for command in [
        "sweep --shard",
        "frf --points",
        "solve --nodes",
        "solve --digits",
        "solve --resample",
        "solve --columns",
        "solve --unit",
        "simulate --scale",
        "simulate --feedback",
        "modes --nothing",
    ] {
        let (command, option) = command.split_once(' ').unwrap();
        refuse(&[command, "link.toml", "motion.csv", option, &long]);
        refuse(&[command, &format!("{option}={long}")]);
    }
    refuse(&["trajectory", &long]);
    refuse(&[&format!("--{long}")]);
    bench.write("t.toml", format!("[[columns]]\ncolumn = '{long}'\nrtol = 1\n"));
    let told = bench.told("compare motion.csv motion.csv -q --tolerances t.toml");
    assert!(told.starts_with("warning: t.toml:1: column = ") && told.len() < 700, "{told}");
    for table in [format!("{long},a\n"), format!("time,acceleration\n0,{long}\n")] {
        bench.write("wrong.csv", &table);
        refuse(&["solve", "link.toml", "wrong.csv"]);
    }
}

/// The summary of the run in `out` as JSON.
fn record(bench: &Bench) -> Value {
    serde_json::from_str(&bench.read("out/summary.json")).unwrap()
}

#[test]
fn a_message_quotes_sixty_characters_of_a_record() {
    let bench = Bench::solved();
    let record = record(&bench);
    let long = Value::from("x".repeat(100_000));
    for (pointer, value) in [
        ("/flexlink", &long),
        ("/command", &long),
        ("/format", &long),
        ("/files/0", &long),
        ("/inputs/link/sha256", &long),
        ("/inputs/link/name", &long),
        ("/inputs/arguments", &json!([long.clone()])),
        ("/inputs/arguments", &json!(["--nodes", long.clone()])),
        ("/link", &long),
        ("/motion/moves_from_s", &long),
    ] {
        let mut forged = record.clone();
        *forged.pointer_mut(pointer).unwrap() = value.clone();
        bench.write("out/summary.json", format!("{forged:#}"));
        for arguments in ["solve --repeat out -q", "report out -q"] {
            let told = bench.told(arguments);
            assert!(told.len() < 900, "{pointer}: {} bytes", told.len());
        }
    }
    let mut old = record;
    old["format"] = 1.into();
    old["flexlink"] = long;
    bench.write("out/summary.json", old.to_string());
    assert!(bench.told("report out").len() < 700);
}

#[test]
fn damage_of_a_record_is_told_by_key_and_in_plain_words() {
    let bench = Bench::solved();
    let record = record(&bench);
    for (key, value, words) in [
        ("link", json!(1), "link = integer `1`, but must be an object"),
        ("format", json!("x"), "format = string \"x\", but must be a whole number"),
        ("files", json!("x"), "files = string \"x\", but must be a list"),
        ("title", json!(1), "title = integer `1`, but must be a text"),
        ("warnings", Value::Null, "warnings = null, but must be a list"),
    ] {
        let mut forged = record.clone();
        forged[key] = value;
        for forged in [format!("{forged:#}"), forged.to_string()] {
            bench.write("out/summary.json", forged);
            bench.refuses_soon("report out", REFUSED, words);
        }
    }
    let mut forged = record;
    forged.as_object_mut().unwrap().remove("title");
    bench.write("out/summary.json", forged.to_string());
    bench.refuses_soon("report out", REFUSED, "title is missing");
}

#[test]
fn what_is_no_text_is_refused_by_report_with_what_to_do() {
    let told = Bench::new().told("report /dev/zero");
    assert!(told.ends_with("\nhint: save the file as text in UTF-8\n"), "{told}");
}

#[test]
fn a_record_forges_no_line_of_what_a_repetition_prints() {
    let bench = Bench::solved();
    let summary = bench.read("out/summary.json");
    for (from, to, message) in [
        (
            r#""torque.csv""#,
            r#""x\nsame     7 files of out""#,
            "files = \"x\\nsame     7 files of out\", but must be names, without folders or",
        ),
        (
            r#""arguments": []"#,
            r#""arguments": ["--set", "foo=1"]"#,
            "out/summary.json: inputs.arguments: --set 'foo=1'",
        ),
    ] {
        assert!(summary.contains(from), "{from}");
        bench.write("out/summary.json", summary.replace(from, to));
        bench.refuses_soon("solve --repeat out", REFUSED, message);
    }
}

#[test]
fn a_path_that_ends_as_a_folders_does_names_no_file() {
    let bench = Bench::new();
    let good = bench.read("link.toml");
    for path in ["link.toml/", "link.toml/.", "new/", "new/.."] {
        let frf = format!("frf link.toml --points 5 -o {path}");
        bench.refuses(&frf, CANNOT_WRITE, "the path names no file");
    }
    assert_eq!(bench.read("link.toml"), good);
    assert!(!bench.path("new").exists());
}

#[test]
fn a_file_where_the_cases_folders_are_to_be_is_told_before_any_is_solved() {
    let message = "--outputs = link.toml, but must be a folder";
    Bench::new().refuses(&format!("{VARY} --outputs link.toml"), 2, message);
}
