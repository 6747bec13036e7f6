//! "Did you mean": whatever a user names, a slip of it is asked about.

use super::{Bench, LINK, MOTION, repository, stderr};

#[track_caller]
fn asks(bench: &Bench, arguments: &[&str], expected: &str) {
    let output = bench.run(arguments);
    assert!(matches!(output.status.code(), Some(2 | 3)), "{}", stderr(&output));
    assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
}

#[test]
fn a_slip_on_the_command_line_is_asked_about() {
    let bench = Bench::new();
    let (link, motion) = (&repository(LINK), &repository(MOTION));
    bench.solve(&["-q"]);
    let sine = ["trajectory", "sine", "--distance", "0.5", "--step", "0.01"];
    for (arguments, expected) in [
        (&["slove"][..], "tip: a similar subcommand exists: 'solve'"),
        (&["solve", link, motion, "--dgits", "3"], "tip: a similar argument exists: '--digits'"),
        (&["completions", "bahs"], "tip: a similar value exists: 'bash'"),
        (
            &["trajectory", "septik", "--distance", "1", "--duration", "1", "--step", "0.1"],
            "tip: a similar value exists: 'septic'",
        ),
        (&["modes", link, "--set", "segmets.beam.EI=3"], "did you mean `segments`?"),
        (&["modes", link, "--set", "segments.baem.EI=3"], "did you mean `beam`?"),
        (&["modes", link, "--set", "segments.beam.EII=3"], "did you mean `EI`?"),
        (&["modes", link, "--set", "segments.beam.lenght*=3"], "did you mean `length`?"),
        (&["modes", link, "--set", "damping.model=modla"], "did you mean `modal`?"),
        (&["modes", link, "--set", "mesh.elements=atuo"], "or \"auto\""),
        (&["modes", link, "--set", "hub.inertia=1 kg cn^2"], "did you mean `cm`?"),
        (
            &["simulate", link, "out/torque.csv", "--column", "torqe_n_m"],
            "did you mean \"torque_n_m\"?",
        ),
        (
            &[&sine[..], &["--link", link, "--fit-limit", "trque=5"]].concat(),
            "error: --fit-limit 'trque=5': unknown key `trque` in limits\n\
             hint: did you mean `torque`?\n",
        ),
        (
            &[&sine[..], &["--link", link, "--fit-limit", "torque"]].concat(),
            "error: --fit-limit 'torque': has no `=`, but must read KEY=VALUE\n\
             hint: it reads like torque=5 or 'power=\"20 W\"'\n",
        ),
        (
            &[&sine[..], &["--link", link, "--fit-limit", "torque=-5"]].concat(),
            "error: --fit-limit 'torque=-5': limits.torque = -5 N m, but must be finite and above 0\n",
        ),
        (&["solve", motion, link], "hint: LINK, a TOML file, stands before MOTION or TORQUE"),
    ] {
        asks(&bench, arguments, expected);
    }
}

#[test]
fn a_slip_in_a_heading_is_asked_about() {
    let bench = Bench::new();
    let link = repository(LINK);
    bench.solve(&["-q"]);
    for (heading, expected) in [
        ("time,acceleratoin", "did you mean acceleration?"),
        ("tmie,acceleration", "did you mean time?"),
        ("time,acceleration [cn/s^2]", "did you mean `cm`?"),
        ("time [sec],acceleration", "did you mean `s`?"),
    ] {
        bench.write("m.csv", &format!("{heading}\n0,0\n"));
        asks(&bench, &["solve", &link, "m.csv"], expected);
    }
    for (heading, expected) in [
        ("tmie,torque", "did you mean time by \"tmie\"?"),
        ("time,torqe", "did you mean torque by \"torqe\"?"),
        ("time,motor", "choose the torque with --column NAME"),
    ] {
        bench.write("t.csv", &format!("{heading}\n0,0\n"));
        asks(&bench, &["simulate", &link, "t.csv"], expected);
    }
    bench.write("h.csv", "time,hub_angel\n0,0\n");
    let played = ["simulate", &link, "out/torque.csv", "--feedback", "1,1", "--reference", "h.csv"];
    asks(&bench, &played, "did you mean hub_angle by \"hub_angel\"?");
}
