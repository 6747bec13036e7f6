//! What `flexlink simulate` refuses, in which words, and what it warns of.

use std::io::Write as _;
use std::process::Stdio;

use super::{Bench, LINK, no_such_file, repository, said, simulated, stderr, stdout};

const TORQUE: &str = "time,torque\n0,0\n0.01,1\n0.02,1\n0.03,0\n";

/// A bench with a torque of four samples, a target and a hub motion at its times.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("torque.csv", TORQUE);
    bench.write("tip.csv", "time,displacement\n0,0\n0.01,0\n0.02,0.001\n0.03,0.002\n");
    bench.write("hub.csv", "time,hub_angle\n0,0\n0.01,0\n0.02,0.001\n0.03,0.001\n");
    bench
}

/// Plays, which must fail with `code`; nothing is printed or written. Error and hint.
#[track_caller]
fn failed(bench: &Bench, arguments: &[&str], code: i32) -> String {
    let output = bench.run(&[&["simulate", &repository(LINK)], arguments].concat());
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    assert_eq!(stdout(&output), "");
    assert!(!bench.path("simulated").exists(), "nothing is left behind");
    stderr(&output)
}

#[test]
fn two_for_options_that_do_not_go_together() {
    let bench = bench();
    for (arguments, expected) in [
        (
            &["--until", "0.02"][..],
            "--until = 0.02 s, but must not be before the torque's last sample, 0.03 s\n\
             hint: the simulation goes on to the torque's end by itself",
        ),
        (
            &["--until", "-1"],
            "--until = -1 s, but must not be before the torque's last sample, 0.03 s\n\
             hint: the simulation goes on to the torque's end by itself",
        ),
        (
            &["--until", "1e9"],
            "--until = 1000000000 s, 1.000e11 samples, but must be at most 16777216 samples\n\
             hint: an earlier end, or a torque with a longer step",
        ),
        (
            &["--feedback", "-1,2", "--reference", "hub.csv"],
            "--feedback: KP = -1 N m/rad, but must be finite and at least 0",
        ),
        (
            &["--feedback", "1,nan", "--reference", "hub.csv"],
            "--feedback: KD = NaN N m s/rad, but must be finite and at least 0",
        ),
        (
            &["--nodes", "11"],
            "--nodes = 11, but must name nodes of the mesh, 0 to 10\n\
             hint: nodes.csv lists them",
        ),
        (
            &["-o", "."],
            "--output = ., but must be another folder than that of torque.csv\n\
             hint: a folder holds one run: the results would replace those read",
        ),
        (
            &["--target", "-", "--feedback", "1,1", "--reference", "-"],
            "standard input = several files, but must be one",
        ),
    ] {
        let error = failed(&bench, &[&["torque.csv"], arguments].concat(), 2);
        assert_eq!(error, format!("error: {expected}\n"));
    }
    bench.write("long.csv", "time,displacement\n0,0\n0.1,0.1\n0.2,0.2\n0.3,0.3\n");
    let until = ["torque.csv", "--target", "long.csv", "--until", "0.1"];
    let expected = "error: --until 0.1: the target ends at 0.3 s, but must not go on after the \
                    simulation, which ends at 0.1 s\nhint: simulate longer, or cut the target\n";
    assert_eq!(failed(&bench, &until, 2), expected);
}

#[test]
fn two_for_options_that_are_incomplete_or_no_numbers() {
    let bench = bench();
    for (arguments, part) in [
        (&["--feedback", "1,2"][..], "--reference <FILE>"),
        (&["--reference", "hub.csv"], "--feedback <KP,KD>"),
        (&["--feedback", "1", "--reference", "hub.csv"], "must be two numbers, KP,KD"),
        (&["--feedback", "1;2", "--reference", "hub.csv"], "must be two numbers, KP,KD"),
        (&["--until", "nan"], "'--until <T>': must be a finite number"),
        (&["--until", "inf"], "'--until <T>': must be a finite number"),
        (&["--json", "--quiet"], "cannot be used with"),
        (&["--every", "0"], "must be a whole number above 0"),
    ] {
        let error = failed(&bench, &[&["torque.csv"], arguments].concat(), 2);
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(bench.run(&["simulate", &repository(LINK)]).status.code(), Some(2));
}

#[test]
fn three_for_a_torque_that_is_refused() {
    let bench = bench();
    for (content, options, expected) in [
        (
            "time,torque\n0,0\n1,0\n2,0\n3,0\n",
            &[][..],
            "t.csv: the torque is zero in all samples, but must move the link",
        ),
        ("time,torque\n0,0\n1,1\n2,0\n", &[], "t.csv: samples = 3, but must be 4 or more"),
        (
            "time,torque\n0,0\n1,1\n3,1\n4,0\n",
            &[],
            "t.csv:4: time = 3 s, but must be 2 s: the samples before and after stand 1 s \
             apart\n\
             hint: write times with more decimals, or resample the file to a uniform step",
        ),
        (
            "time,torque\n0,0\n1,nan\n2,0\n3,0\n",
            &[],
            "t.csv:3: torque = nan, but must be a finite number",
        ),
        (
            "time,rigid_torque_n_m\n0,0\n1,1\n2,1\n3,0\n",
            &[],
            "t.csv:1: columns = \"time,rigid_torque_n_m\", but must include torque\n\
             hint: choose the torque with --column \"rigid_torque_n_m\"",
        ),
        (
            TORQUE,
            &["--column", "motor"],
            "t.csv:1: --column = \"motor\", but must be one of the columns \"time,torque\"",
        ),
        (
            TORQUE,
            &["--column", "Torque"],
            "t.csv:1: --column = \"Torque\", but must be one of the columns \"time,torque\"\n\
             hint: did you mean \"torque\"?",
        ),
        (
            TORQUE,
            &["--column", "time"],
            "t.csv:1: --column = \"time\", but must be a torque, not the time",
        ),
    ] {
        bench.write("t.csv", content);
        let error = failed(&bench, &[&["t.csv"], options].concat(), 3);
        assert_eq!(error, format!("error: {expected}\n"));
    }
    let missing = format!("error: none.csv: cannot read: {}\n", no_such_file());
    assert_eq!(failed(&bench, &["none.csv"], 3), missing);
}

#[test]
fn three_for_a_target_or_a_reference_that_is_refused() {
    let bench = bench();
    bench.write("still.csv", "time,displacement\n0,1\n1,1\n2,1\n3,1\n");
    bench.write("waves.csv", "time,acceleration\n0,0\n1,1\n2,-1\n3,0\n");
    bench.write("far.csv", "time,displacement\n0,0\n1e6,1\n2e6,2\n3e6,3\n");
    bench.write("late.csv", "time,hub_angle\n0.01,0\n0.02,0\n0.03,0.001\n0.04,0.001\n");
    let feedback = |file: &'static str| ["--feedback", "1,1", "--reference", file];
    let absent = format!("none.csv: cannot read: {}", no_such_file());
    for (options, expected) in [
        (&["--target", "none.csv"][..], absent.as_str()),
        (
            &["--target", "still.csv"],
            "still.csv: the target stands still in all samples, but must move",
        ),
        (
            &["--target", "waves.csv"],
            "waves.csv: displacement = nothing, but must be given of a target, as displacement \
             or angle\n\
             hint: an acceleration leaves open where the tip is; tip.csv of `flexlink solve` \
             holds the displacement",
        ),
        (
            &["--target", "far.csv"],
            "far.csv: the end = 3000000 s, 3.000e8 steps of the torque, but must be at most \
             16777216 steps\n\
             hint: an earlier end, or a torque with a longer step",
        ),
        (&feedback("none.csv"), &absent),
        (
            &feedback("tip.csv"),
            "tip.csv:1: columns = \"time,displacement\", but must include hub_angle\n\
             hint: hub_angle.csv of `flexlink solve` holds it",
        ),
        (
            &feedback("late.csv"),
            "late.csv: the reference = 4 samples from 0.01 s at 0.01 s, but must stand at the \
             torque's times: 4 samples from 0 s at 0.01 s\n\
             hint: take hub_angle.csv and torque.csv of one run of solve",
        ),
    ] {
        let error = failed(&bench, &[&["torque.csv"], options].concat(), 3);
        assert_eq!(error, format!("error: {expected}\n"));
    }
}

#[test]
fn four_for_what_has_no_answer_and_five_for_a_folder_that_cannot_be() {
    let bench = bench();
    bench.write("huge.csv", "time,torque\n0,0\n0.01,1e308\n0.02,1e308\n0.03,0\n");
    let expected = "error: the motion at 0.01 s = not a finite number, but must be one\n\
                    hint: the inputs are too large for double precision\n";
    assert_eq!(failed(&bench, &["huge.csv"], 4), expected);
    let modes = "damping={ model = \"caughey\", modes = [1, 2], ratios = [0.2, 0.03] }";
    let error = failed(&bench, &["torque.csv", "--set", modes], 4);
    assert!(error.starts_with("error: damping.ratios give mode 3 (13.3435 Hz) a ratio"), "{error}");
    let error = failed(&bench, &["torque.csv", "-o", "tip.csv"], 5);
    let exists = said(std::fs::create_dir(bench.path("tip.csv")));
    assert_eq!(error, format!("error: tip.csv: cannot create the folder: {exists}\n"));
}

#[test]
fn the_folder_of_an_input_is_refused_however_it_is_written() {
    let bench = bench();
    std::fs::create_dir(bench.path("run")).unwrap();
    bench.write("run/tip.csv", &bench.read("tip.csv"));
    for output in ["run", "./run/", "run/../run"] {
        let error = failed(&bench, &["torque.csv", "--target", "run/tip.csv", "-o", output], 2);
        let message = "but must be another folder than that of run/tip.csv\n";
        assert!(error.starts_with(&format!("error: --output = {output}, {message}")), "{error}");
    }
    assert_eq!(bench.names("run"), ["tip.csv"]);
}

#[test]
fn a_dash_reads_the_torque_from_standard_input() {
    let bench = bench();
    simulated(&bench, &["torque.csv", "-o", "file"]);
    let link = repository(LINK);
    let mut child = bench
        .program(&["simulate", &link, "-", "-o", "piped"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(TORQUE.as_bytes()).unwrap();
    assert!(child.wait_with_output().unwrap().status.success());
    assert!(bench.read("piped/tip.csv") == bench.read("file/tip.csv"));
    assert_eq!(bench.json("piped/summary.json")["inputs"]["torque"]["name"], "-");
    let error = failed(&bench, &["-"], 3);
    let must = "must hold a row of names and 4 samples or more";
    assert_eq!(error, format!("error: standard input: content = nothing, but {must}\n"));
}

#[test]
fn jumps_at_the_ends_a_coarse_step_and_a_late_target_are_told() {
    let bench = bench();
    let jump = "hint: a torque of solve begins and ends at zero unless analysis.lead or \
                analysis.lag cut it";
    bench.write("step.csv", "time,torque\n0,1\n0.01,-2\n0.02,1\n0.03,0.5\n");
    let output = simulated(&bench, &["step.csv"]);
    let expected = format!(
        "warning: the torque begins with 1.0 N m, 50.0 % of its peak: it acts on the resting link \
         as a jump\n{jump}\nwarning: the torque ends with 0.5 N m, 25.0 % of its peak: it drops to \
         zero there\n{jump}\nwarning: mesh and modes make the tip wrong by "
    );
    assert!(stderr(&output).starts_with(&expected), "{}", stderr(&output));
    bench.write("coarse.csv", "time,torque\n0,0\n0.1,1\n0.2,1\n0.3,0\n");
    let output = simulated(&bench, &["coarse.csv"]);
    let expected = "warning: the step = 0.1 s leaves 5.3 steps to a period of the first mode, \
                    0.5264 s: between the rows the link does what no row shows\n\
                    hint: a torque with a shorter step\n";
    assert_eq!(stderr(&output), expected);
    bench.write("late.csv", "time,displacement\n0.2,1e-3\n0.3,2e-3\n0.4,3e-3\n0.5,4e-3\n");
    let output = simulated(&bench, &["torque.csv", "--target", "late.csv"]);
    let error = stderr(&output);
    assert!(error.starts_with("warning: the target begins at 0.2 s, when the tip has moved by"));
    assert!(error.ends_with("hint: a target that begins before the tip moves\n"), "{error}");
    let warnings = &bench.json("simulated/summary.json")["warnings"];
    assert_eq!(warnings[0]["kind"], "late_target");
}
