//! Paths of any kind, standard input and output by every name they have.

use std::fs;
use std::path::Path;
use std::process::Output;

use super::{Bench, LINK, MOTION, ended, plain, repository, stderr, stdout, succeeded};

#[test]
fn every_command_reads_the_link_from_standard_input() {
    let bench = Bench::new();
    let link = fs::read(repository(LINK)).unwrap();
    bench.solve("-q");
    for arguments in [
        &format!("solve - {MOTION} -o new -q"),
        "simulate - out/torque.csv -q",
        &format!("verify - {MOTION}"),
        "modes -",
        "frf - --points 2",
        "trajectory sine --distance 0.5 --step 0.01 --link - --fit-limit torque=5",
    ] {
        succeeded(bench.fed(&link, arguments));
    }
    assert!(bench.read("new/torque.csv") == bench.read("out/torque.csv"));
    assert_eq!(bench.json("new/summary.json")["inputs"]["link"]["name"], "-");
}

#[test]
fn a_dash_is_standard_output_where_one_file_is_written() {
    let bench = Bench::new();
    for arguments in [
        &format!("frf {LINK} --points 3"),
        "trajectory sine --distance 0.5 --duration 1 --step 0.1",
        "schema",
    ] {
        let plain = bench.printed(arguments);
        let dash = bench.printed(&format!("{arguments} -o -"));
        assert!(dash == plain && !plain.is_empty());
        assert_eq!(bench.names("."), [""; 0]);
    }
}

#[test]
fn results_do_not_replace_what_they_are_made_from() {
    let bench = Bench::new();
    bench.solve("-q");
    let tip = bench.read("out/tip.csv");
    let message = "error: --output = out, but must be another folder than that of out/tip.csv\n";
    bench.refuses_first(2, &format!("solve {LINK} out/tip.csv"), message);
    let again = format!("solve {LINK} out/tip.csv -o ./out/../out");
    bench.refuses_first(2, &again, "error: --output = ");
    assert!(bench.read("out/tip.csv") == tip);
    fs::copy(repository(LINK), bench.path("link.toml")).unwrap();
    fs::copy(repository(MOTION), bench.path("move.csv")).unwrap();
    for (command, output) in [
        ("frf link.toml", "link.toml"),
        ("frf link.toml", "./link.toml"),
        ("sweep link.toml move.csv --vary payload.mass=0,0.01", "move.csv"),
    ] {
        let message = format!("error: --output = {output}, but must not be a file that is read\n");
        bench.refuses_first(2, &format!("{command} -o {output}"), &message);
    }
    // No run would write these names.
    bench.done("solve link.toml move.csv -o . -q");
    bench.done("solve link.toml out/tip.csv -o again -q");
}

#[test]
fn paths_have_blanks_and_foreign_letters_and_begin_with_a_dash() {
    let bench = Bench::new();
    for folder in ["a b", "ü 橋", "-d"] {
        let at = |name: &str| format!("{folder}/{name}");
        bench.done(&["init", "--", folder]);
        let (link, motion) = (&at("link.toml"), &at("motion.csv"));
        let option = |name: &str, file: &str| format!("--{name}={}", at(file));
        bench.done(&["solve", "-q", &option("output", "o t"), "--", link, motion]);
        let torque = &at("o t/torque.csv");
        let target = option("target", "o t/tip.csv");
        bench.done(&["simulate", "-q", &target, &option("output", "s t"), "--", link, torque]);
        bench.done(&["modes", &option("output", "m s"), "--", link]);
        bench.done(&["frf", "--points", "2", &option("output", "f r.csv"), "--", link]);
        bench.done(&["schema", &option("output", "s c.json")]);
        bench.done(&["man", &option("output", "man 1")]);
        let names = "f r.csv|link.schema.json|link.toml|m s|man 1|motion.csv|o t|s c.json|s t";
        assert_eq!(bench.names(folder).join("|"), names);
        assert_eq!(
            bench.error(3, &["modes", "--", &at("no such.toml")]),
            format!("error: {folder}/no such.toml: cannot read: No such file or directory\n")
        );
    }
}

#[cfg(unix)]
#[test]
fn a_message_stays_in_its_line_whatever_a_file_is_called() {
    let output = Bench::new().run(&["modes", "two\nlines\u{1b}[31m.toml"]);
    assert_eq!(
        stderr(&output),
        "error: two\u{fffd}lines\u{fffd}[31m.toml: cannot read: No such file or directory\n"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_name_that_is_no_utf8_is_kept() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    let bench = Bench::new();
    let name = Path::new(OsStr::from_bytes(b"n\xff.csv"));
    let folder = Path::new(OsStr::from_bytes(b"d\xfe"));
    fs::create_dir(bench.folder.path().join(folder)).unwrap();
    let link = folder.join("link.toml");
    fs::copy(repository(LINK), bench.folder.path().join(&link)).unwrap();
    let mut program = bench.program(&["frf", "--points", "2"]);
    succeeded(program.arg(&link).arg("-o").arg(folder.join(name)).output().unwrap());
    assert!(bench.folder.path().join(folder).join(name).is_file());
    let missing = bench.program(&["modes"]).arg(name).output().unwrap();
    assert!(stderr(&missing).starts_with("error: n\u{fffd}.csv: cannot read: "));
}

#[cfg(unix)]
fn shell(bench: &Bench, script: &str) -> Output {
    // With a blank: folders have the name, too.
    let script = script.replace("flexlink ", &format!("'{}' ", env!("CARGO_BIN_EXE_flexlink")));
    let mut shell = std::process::Command::new("bash");
    plain(&mut shell);
    shell.args(["-c", &script]).current_dir(bench.folder.path()).output().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_or_a_pipe_is_written_to_and_not_replaced() {
    let bench = Bench::new();
    // Nothing but the file is printed.
    let make = "flexlink trajectory sine --distance 1 --duration 1 --step 0.1";
    let plain = stdout(&shell(&bench, make));
    let framed = format!("a\n{plain}b\n");
    for script in [
        // The first, so that no device is touched where this fails.
        format!("mkfifo p; cat p & {{ echo a; {make} -o p; echo b; }} > p; wait; test -p p"),
        format!("{{ echo a; {make} -o /dev/stdout; echo b; }} > f; cat f"),
        format!("{{ echo a; {make} -o /dev/stdout; echo b; }} | cat"),
        format!("{{ echo a; {make} -o /dev/fd/3; echo b; }} 3>&1 | cat"),
        format!("rm f; {{ echo a; {make} -o /dev/stderr; echo b; }} >> f 2>&1; cat f"),
    ] {
        let output = shell(&bench, &script);
        assert_eq!(stdout(&output), framed, "{script}: {}", stderr(&output));
    }
    assert_eq!(stdout(&shell(&bench, &format!("{make} -o >(cat) | cat"))), plain);
    assert_eq!(shell(&bench, &format!("{make} -o >(true)")).status.code(), Some(0));
    succeeded(shell(&bench, &format!("{make} -o /dev/null && test -c /dev/null")));
    let full = ended(5, shell(&bench, &format!("{make} -o /dev/full")));
    assert_eq!(
        stderr(&full),
        "error: /dev: cannot write full: No space left on device\n\
         hint: free some space, or write to another disk\n"
    );
}

#[cfg(unix)]
#[test]
fn a_link_to_a_file_stays_a_link() {
    let bench = Bench::new();
    std::os::unix::fs::symlink("real.csv", bench.path("link.csv")).unwrap();
    let arguments = ["frf", &repository(LINK), "--points", "2", "-o", "link.csv"];
    bench.write("real.csv", "old");
    bench.done(&arguments);
    assert!(bench.path("link.csv").is_symlink());
    assert_eq!(bench.read("real.csv").lines().count(), 3);
}
