//! Links and pipes where a run expects its own files, and inputs that would forge what it prints.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::{Bench, PROGRAM, REFUSED, link, text};

const CANNOT_WRITE: i32 = 5;
const VARY: [&str; 7] =
    ["sweep", "link.toml", "motion.csv", "--vary", "segments.*.EI*=1,2", "-o", "sweep.csv"];

impl Bench {
    /// With a run in `out`.
    fn solved() -> Self {
        let bench = Self::new();
        let output = bench.run(&["solve", "link.toml", "motion.csv", "-q"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        bench
    }

    /// The program must refuse in a moment: what it must not wait for has no end.
    #[track_caller]
    fn refuses_soon(&self, arguments: &[&str], code: i32, message: &str) {
        let mut command = self.command(PROGRAM, arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let has_ended = (0..3000).any(|_| {
            sleep(Duration::from_millis(10));
            child.try_wait().unwrap().is_some()
        });
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        assert!(has_ended, "{arguments:?} does not end");
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
    bench.refuses_soon(&VARY, CANNOT_WRITE, "sweep.csv.part: it is a symbolic link");
    assert_eq!(fs::read_to_string(bench.path("victim")).unwrap(), "of value");
}

#[test]
fn a_link_in_the_place_of_a_cases_folder_is_not_followed() {
    let bench = Bench::new();
    for folder in ["all", "elsewhere"] {
        fs::create_dir(bench.path(folder)).unwrap();
    }
    bench.write("elsewhere/report.html", "of value");
    symlink("../elsewhere", bench.path("all/1")).unwrap();
    let outputs = [&VARY[..], &["--outputs", "all"]].concat();
    bench.refuses_soon(&outputs, CANNOT_WRITE, "all/1: is a symbolic link, but must be a folder");
    let names: Vec<_> = fs::read_dir(bench.path("elsewhere")).unwrap().collect();
    assert_eq!(names.len(), 1);
    // One that the command line names is meant.
    symlink("elsewhere", bench.path("out")).unwrap();
    let output = bench.run(&["solve", "link.toml", "motion.csv", "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(bench.path("elsewhere/summary.json").exists());
}

#[test]
fn a_link_at_a_name_that_nobody_typed_is_replaced_and_what_it_leads_to_stays() {
    let fit = ["fit", "link.toml", "measured.toml", "--free", "hub.inertia", "--report"];
    let measured = "[[frequency]]\nmode = 1\nvalue = 2.0\n";
    for (arguments, name) in [
        (&["report", "out", "-q"][..], "out/report.html"),
        (&["report", "sweep.csv", "-q"], "sweep.html"),
        (&VARY[..VARY.len() - 2], "sweep.csv"),
        (&VARY, "sweep.json"),
        (&fit, "fit.html"),
        (&[&fit[..], &["-o", "fitted.toml"]].concat(), "fitted.html"),
    ] {
        let bench = Bench::solved();
        bench.write("measured.toml", measured);
        // The record of another sweep, so that it may be replaced at all.
        let other = [&VARY[..4], &["segments.*.EI*=1,3"], &VARY[5..]].concat();
        assert_eq!(bench.run(&other).status.code(), Some(0));
        let victim = fs::read_to_string(bench.path("sweep.json")).unwrap();
        fs::create_dir(bench.path("home")).unwrap();
        bench.write("home/victim", &victim);
        let place = bench.path(name);
        let _ = fs::remove_file(&place);
        symlink(bench.path("home/victim"), &place).unwrap();
        let output = bench.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", text(&output.stderr));
        assert_eq!(fs::read_to_string(bench.path("home/victim")).unwrap(), victim, "{name}");
        let kind = fs::symlink_metadata(&place).unwrap();
        assert!(kind.is_file(), "{name}");
        assert_ne!(fs::read_to_string(&place).unwrap(), victim, "{name}");
        assert_eq!(fs::read_dir(bench.path("home")).unwrap().count(), 1, "{name}");
    }
}

#[test]
fn a_link_that_is_typed_is_followed_and_a_circle_of_links_is_refused() {
    let bench = Bench::solved();
    bench.write("page.html", "old");
    symlink("page.html", bench.path("typed.html")).unwrap();
    let output = bench.run(&["report", "out", "-q", "-o", "typed.html"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(bench.path("typed.html").is_symlink());
    assert!(fs::read_to_string(bench.path("page.html")).unwrap().starts_with("<!DOCTYPE"));
    for [name, target] in [["a", "b"], ["b", "a"], ["own", "own"]] {
        symlink(target, bench.path(name)).unwrap();
    }
    for path in ["a", "own"] {
        let message = format!("cannot write {path}: Too many levels of symbolic links");
        bench.refuses_soon(&["report", "out", "-q", "-o", path], CANNOT_WRITE, &message);
        let frf = ["frf", "link.toml", "--points", "5", "-o", path];
        bench.refuses_soon(&frf, CANNOT_WRITE, &message);
        let sweep = [&VARY[..6], &[path]].concat();
        bench.refuses_soon(&sweep, CANNOT_WRITE, &message);
        assert!(bench.path(path).is_symlink());
        assert!(!bench.path(&format!("{path}.part")).exists());
    }
}

#[test]
fn a_lock_that_leads_nowhere_is_told() {
    let bench = Bench::new();
    fs::create_dir(bench.path("out")).unwrap();
    symlink("nowhere", bench.path("out/.flexlink.lock")).unwrap();
    let message = ".flexlink.lock in it is a link that leads nowhere";
    bench.refuses_soon(&["solve", "link.toml", "motion.csv"], CANNOT_WRITE, message);
}

#[test]
fn a_device_or_a_pipe_in_a_folder_is_not_waited_for() {
    let repeat = ["solve", "--repeat", "out"];
    for (name, arguments, message) in [
        ("torque.csv", &repeat[..], "out/torque.csv: cannot read: it is no file"),
        ("summary.json", &repeat[..], "out: summary.json = a device or a pipe, but must be a file"),
        ("torque.csv", &["report", "out"], "out: torque.csv = a device or a pipe"),
        ("torque.csv", &["compare", "out", "out2"], "out/torque.csv: cannot read: it is a device"),
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
    let solve = ["solve", "link.toml", "motion.csv"];
    let printed = text(&bench.run(&solve).stdout);
    assert!(printed.starts_with("arm\\nwarning: all is well\\u{9b}31m\n"), "{printed}");
    let printed = text(&bench.run(&[&solve[..], &["--json"]].concat()).stdout);
    assert!(!printed.contains(|c: char| c.is_control() && c != '\n'), "{printed}");
    assert!(printed.contains(r#""arm\nwarning: all is well\u009b31m""#), "{printed}");
}

#[test]
fn a_title_does_not_turn_the_direction_of_writing() {
    let bench = Bench::new();
    let title = "title = \"arm \u{202e}2.0\u{2066}\"";
    bench.write("link.toml", format!("{title}\n{}", link("")));
    let solve = ["solve", "link.toml", "motion.csv"];
    let printed = text(&bench.run(&solve).stdout);
    assert!(printed.starts_with("arm \\u{202e}2.0\\u{2066}\n"), "{printed}");
    let printed = text(&bench.run(&[&solve[..], &["--json"]].concat()).stdout);
    assert!(printed.contains(r#""arm \u202e2.0\u2066""#), "{printed}");
    for arguments in [
        ["solve", "\u{202e}lmot.knil", "motion.csv"],
        ["solve", "link.toml", "--every=\u{202e}1"],
        ["modes", "link.toml", "--set=hub.\u{202e}ai=1"],
    ] {
        let told = text(&bench.run(&arguments).stderr);
        assert!(told.starts_with("error: ") && !told.contains('\u{202e}'), "{told}");
    }
}

#[test]
fn a_message_quotes_sixty_characters_of_an_input() {
    let bench = Bench::new();
    let long = "x".repeat(100_000);
    let refuse = |told: String| {
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
        refuse(text(&bench.run(&["modes", "wrong.toml"]).stderr));
    }
    for set in [
        format!("{long}=1"),
        format!("segments.{long}.EI=1"),
        format!("segments.0.EI*={long}"),
        format!("segments.0.{long}*=2"),
        long.clone(),
    ] {
        refuse(text(&bench.run(&["modes", "link.toml", "--set", &set]).stderr));
    }
    let value = |k: usize| format!("segments.{long}.EI*=1{}", [":2", ",1", ",'x", ":2:3", ",2"][k]);
    let mut sweeps: Vec<String> = (0..5).map(value).collect();
    sweeps.extend([format!("title={0},{0}", &long[..50_000]), format!("hub.inertia=0{long}:1:2")]);
    sweeps.extend([format!("distance={long}"), format!("{long}=1")]);
    for vary in &sweeps {
        refuse(text(&bench.run(&["sweep", "link.toml", "motion.csv", "--vary", vary]).stderr));
    }
    let fit = ["trajectory", "sine", "--distance", "1", "--step", "0.1", "--link", "link.toml"];
    for limit in [long.clone(), format!("{long}=1"), format!("torque={long}")] {
        refuse(text(&bench.run(&[&fit[..], &["--fit-limit", &limit]].concat()).stderr));
    }
    for [command, option] in [
        ["sweep", "--shard"],
        ["frf", "--points"],
        ["solve", "--nodes"],
        ["solve", "--digits"],
        ["solve", "--resample"],
        ["solve", "--columns"],
        ["solve", "--unit"],
        ["simulate", "--scale"],
        ["simulate", "--feedback"],
        ["modes", "--nothing"],
    ] {
        refuse(text(&bench.run(&[command, "link.toml", "motion.csv", option, &long]).stderr));
        refuse(text(&bench.run(&[command, &format!("{option}={long}")]).stderr));
    }
    refuse(text(&bench.run(&["trajectory", &long]).stderr));
    refuse(text(&bench.run(&[&format!("--{long}")]).stderr));
    bench.write("t.toml", format!("[[columns]]\ncolumn = '{long}'\nrtol = 1\n"));
    let compare = ["compare", "motion.csv", "motion.csv", "-q", "--tolerances", "t.toml"];
    let told = text(&bench.run(&compare).stderr);
    assert!(told.starts_with("warning: t.toml:1: column = ") && told.len() < 700, "{told}");
    for table in [format!("{long},a\n"), format!("time,acceleration\n0,{long}\n")] {
        bench.write("wrong.csv", &table);
        refuse(text(&bench.run(&["solve", "link.toml", "wrong.csv"]).stderr));
    }
}

#[test]
fn a_message_quotes_sixty_characters_of_a_record() {
    let bench = Bench::solved();
    let summary = fs::read_to_string(bench.path("out/summary.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let long = serde_json::Value::from("x".repeat(100_000));
    for (pointer, value) in [
        ("/flexlink", &long),
        ("/command", &long),
        ("/format", &long),
        ("/files/0", &long),
        ("/inputs/link/sha256", &long),
        ("/inputs/link/name", &long),
        ("/inputs/arguments", &serde_json::json!([long.clone()])),
        ("/inputs/arguments", &serde_json::json!(["--nodes", long.clone()])),
        ("/link", &long),
        ("/motion/moves_from_s", &long),
    ] {
        let mut forged = record.clone();
        *forged.pointer_mut(pointer).unwrap() = value.clone();
        bench.write("out/summary.json", serde_json::to_string_pretty(&forged).unwrap());
        for arguments in [&["solve", "--repeat", "out", "-q"][..], &["report", "out", "-q"]] {
            let told = text(&bench.run(arguments).stderr);
            assert!(told.len() < 900, "{pointer}: {} bytes", told.len());
        }
    }
    let mut old = record.clone();
    old["format"] = 1.into();
    old["flexlink"] = long;
    bench.write("out/summary.json", old.to_string());
    assert!(text(&bench.run(&["report", "out"]).stderr).len() < 700);
}

#[test]
fn damage_of_a_record_is_told_by_key_and_in_plain_words() {
    let bench = Bench::solved();
    let summary = fs::read_to_string(bench.path("out/summary.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&summary).unwrap();
    for (key, value, words) in [
        ("link", serde_json::json!(1), "link = integer `1`, but must be an object"),
        ("format", "x".into(), "format = string \"x\", but must be a whole number"),
        ("files", "x".into(), "files = string \"x\", but must be a list"),
        ("title", 1.into(), "title = integer `1`, but must be a text"),
        ("warnings", serde_json::Value::Null, "warnings = null, but must be a list"),
    ] {
        for pretty in [true, false] {
            let mut forged = record.clone();
            forged[key] = value.clone();
            let forged = if pretty { format!("{forged:#}") } else { forged.to_string() };
            bench.write("out/summary.json", forged);
            bench.refuses_soon(&["report", "out"], REFUSED, words);
        }
    }
    let mut forged = record;
    forged.as_object_mut().unwrap().remove("title");
    bench.write("out/summary.json", forged.to_string());
    bench.refuses_soon(&["report", "out"], REFUSED, "title is missing");
}

#[test]
fn a_page_does_not_turn_the_direction_of_writing() {
    let bench = Bench::new();
    bench.write("link.toml", format!("title = \"a\u{202e}b\\u009bc\"\n{}", link("")));
    let solve = ["solve", "link.toml", "motion.csv", "-q", "--report"];
    assert_eq!(bench.run(&solve).status.code(), Some(0));
    let page = fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(page.contains("<h1>a\\u{202e}b\\u{9b}c</h1>"));
    assert!(
        !page.contains(|c: char| c == '\u{202e}' || c.is_control() && !matches!(c, '\n' | '\t'))
    );
}

#[test]
fn what_is_no_text_is_refused_by_report_with_what_to_do() {
    let bench = Bench::new();
    let output = bench.run(&["report", "/dev/zero"]);
    let told = text(&output.stderr);
    assert!(told.ends_with("\nhint: save the file as text in UTF-8\n"), "{told}");
}

#[test]
fn a_record_forges_no_line_of_what_a_repetition_prints() {
    let bench = Bench::solved();
    let summary = fs::read_to_string(bench.path("out/summary.json")).unwrap();
    let forged = summary.replace(r#""torque.csv""#, r#""x\nsame     7 files of out""#);
    assert_ne!(forged, summary);
    bench.write("out/summary.json", forged);
    let message = "files = \"x\\nsame     7 files of out\", but must be names, without folders or";
    bench.refuses_soon(&["solve", "--repeat", "out"], REFUSED, message);
    let foreign = summary.replace(r#""arguments": []"#, r#""arguments": ["--set", "foo=1"]"#);
    assert_ne!(foreign, summary);
    bench.write("out/summary.json", foreign);
    let message = "out/summary.json: inputs.arguments: --set 'foo=1'";
    bench.refuses_soon(&["solve", "--repeat", "out"], REFUSED, message);
}

#[test]
fn a_path_that_ends_as_a_folders_does_names_no_file() {
    let bench = Bench::new();
    let good = fs::read_to_string(bench.path("link.toml")).unwrap();
    for path in ["link.toml/", "link.toml/.", "new/", "new/.."] {
        let frf = ["frf", "link.toml", "--points", "5", "-o", path];
        bench.refuses(&frf, CANNOT_WRITE, "the path names no file");
    }
    assert_eq!(fs::read_to_string(bench.path("link.toml")).unwrap(), good);
    assert!(!bench.path("new").exists());
}

#[test]
fn a_file_where_the_cases_folders_are_to_be_is_told_before_any_is_solved() {
    let bench = Bench::new();
    let outputs = [&VARY[..], &["--outputs", "link.toml"]].concat();
    bench.refuses(&outputs, 2, "--outputs = link.toml, but must be a folder");
}
