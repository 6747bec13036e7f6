//! What `flexlink simulate` refuses and warns of; most words of refusals are in tests/refusals.

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
fn a_refusal_leaves_nothing_behind() {
    let bench = bench();
    bench.write("huge.csv", "time,torque\n0,0\n0.01,1e308\n0.02,1e308\n0.03,0\n");
    failed(&bench, &["torque.csv", "--until", "0.02"], 2);
    failed(&bench, &["huge.csv"], 4);
    let absent = format!("error: none.csv: cannot read: {}\n", no_such_file());
    for options in [&["--target"][..], &["--feedback", "1,1", "--reference"]] {
        let arguments = [&["torque.csv"], options, &["none.csv"]].concat();
        assert_eq!(failed(&bench, &arguments, 3), absent);
    }
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
}

#[test]
fn jumps_at_the_ends_a_coarse_step_and_a_late_target_are_told() {
    let bench = bench();
    let jump = "hint: a torque of solve begins and ends at zero, unless its window is cut or its \
                tip does not rest";
    bench.write("step.csv", "time,torque\n0,1\n0.01,-2\n0.02,1\n0.03,0.5\n");
    let output = simulated(&bench, &["step.csv"]);
    let expected = format!(
        "warning: the torque begins with 1.0 N m, 50.0 % of its peak: it acts on the resting link \
         as a jump\n{jump}\nwarning: the torque ends with 0.5 N m, 25.0 % of its peak: it drops to \
         zero there\n{jump}\nwarning: mesh and modes make the tip wrong by "
    );
    assert!(stderr(&output).starts_with(&expected), "{}", stderr(&output));
    bench.write("coarse.csv", "time,torque\n0,0\n0.1,0.01\n0.2,0.01\n0.3,0\n");
    let output = simulated(&bench, &["coarse.csv"]);
    let expected = "warning: the step = 0.1 s leaves 5.3 steps to a period of the first mode, \
                    0.5264 s: the rows do not show its vibration\n\
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

#[test]
fn an_undamped_link_and_arm_that_are_let_go_are_played_or_damping_is_named() {
    let bench = Bench::new();
    let link = "segments = [{ length = 1.0, EI = 1.5, mass_per_length = 0.3 }]\n";
    bench.write("pinned.toml", &format!("gravity = [0, -9.81]\nstart_angle = 0.0\n{link}"));
    let short = "segments = [{ length = 0.5, EI = 10.0, mass_per_length = 0.4 }]\n";
    let links = format!("[[links]]\nname = 'a'\n{short}[[links]]\nname = 'b'\n{short}");
    bench.write("double.toml", &format!("gravity = [0, -9.81]\n{links}"));
    let rows = ["0", "0,0"].map(|zeros: &str| {
        let rows = (0..40).map(|k| format!("{},{zeros}\n", 0.001 * f64::from(k)));
        rows.collect::<Vec<_>>().concat()
    });
    bench.write("torque.csv", &format!("time,torque\n{}", rows[0]));
    bench.write("torques.csv", &format!("time,torque1,torque2\n{}", rows[1]));
    let damped = "damping={ model = \"rayleigh\", beta = 2e-3 }";
    let arm = ["double.toml", "torques.csv", "--at", "0,0"];
    for (inputs, sets) in [
        (&["pinned.toml", "torque.csv"][..], &[damped.to_owned()][..]),
        (&arm, &["a", "b"].map(|own| format!("links.{own}.{damped}"))),
    ] {
        let free = bench.run(&[&["simulate"], inputs, &["-o", "free"]].concat());
        let told = stderr(&free);
        assert!(free.status.success() || told.contains("hint: damping"), "{told}");
        assert!(free.status.success() || told.contains("beta"), "{told}");
        let sets: Vec<&str> = sets.iter().flat_map(|own| ["--set", own]).collect();
        let played = bench.run(&[&["simulate"], inputs, &sets, &["-o", "damped"]].concat());
        assert!(played.status.success(), "{}", stderr(&played));
    }
}
