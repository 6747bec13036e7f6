//! Warnings reach whoever must see them: in tables, on pages, and as an exit code.

use super::sweep::{rows, sweep, swept};
use super::{Bench, LINK, MOTION, column, ended, repository, stderr, stdout};

/// Cases of which the second bends too much.
const VARY: [&str; 2] = ["--vary", "distance*=1,3"];

/// The cells of a column of a sweep's table.
fn cells(bench: &Bench, table: &str, name: &str) -> Vec<String> {
    let rows = rows(bench, table);
    let place = rows[0].iter().position(|heading| heading == name).unwrap();
    rows[1..].iter().map(|row| row[place].clone()).collect()
}

#[test]
fn an_acceleration_that_jumps_is_remarked_where_it_overshoots() {
    let bench = Bench::new();
    let tube = repository(LINK);
    for (profile, jumps) in [
        ("bang-bang", true),
        ("trapezoid", true),
        ("versine", true),
        ("sine", false),
        ("septic", false),
    ] {
        bench.done(&[
            "trajectory",
            profile,
            "--distance",
            "0.5",
            "--duration",
            "0.5",
            "--step",
            "0.0005",
            "-o",
            "tip.csv",
        ]);
        let output = bench.run(&[
            "solve",
            &tube,
            "tip.csv",
            "--set",
            "mesh.elements=\"auto\"",
            "--set",
            "segments.*.EI*=100",
        ]);
        let told = stderr(&output);
        assert!(output.status.success(), "{told}");
        assert_eq!(
            told.contains("remark: the acceleration jumps: followed to"),
            jumps,
            "{profile}: {told}"
        );
        let summary = bench.json("out/summary.json");
        let largest =
            column(&bench, "tip.csv", "acceleration").iter().fold(0.0, |m: f64, a| m.max(a.abs()));
        let share = summary["motion"]["peak_acceleration_m_s2"].as_f64().unwrap() / largest - 1.0;
        assert_eq!(share > 0.05, jumps, "{profile}: {share}");
        if jumps {
            assert!(
                told.contains(&format!("{:.0} % above its samples", 100.0 * share)),
                "{share}: {told}"
            );
        }
    }
    // A smooth motion overshoots its samples, too, where these are few or its band is cut.
    for (profile, step, more) in [
        ("s-curve", "0.02", &[][..]),
        ("sine", "0.1", &[]),
        ("s-curve", "0.001", &["--set", "analysis.tip_tolerance=1e-3"]),
        ("s-curve", "0.001", &["--lowpass", "3"]),
    ] {
        let made = ["trajectory", profile, "--distance", "0.5", "--duration", "1", "--step", step];
        bench.done(&[&made[..], &["-o", "tip.csv"]].concat());
        let output = bench.done(&[&["solve", &tube, "tip.csv"], more].concat());
        assert!(!stderr(&output).contains("jumps"), "{profile} {step}: {}", stderr(&output));
    }
    // Displacements say nothing of a jump: theirs may be rounding.
    let rounded = |k: i32| {
        let t = (f64::from(k - 10) / 100.0).clamp(0.0, 1.0);
        format!(
            "{:.2},{:.4}\n",
            0.01 * f64::from(k),
            0.5 * t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t)
        )
    };
    let rows: String = (0..=120).map(rounded).collect();
    bench.write("tip.csv", &format!("time,displacement\n{rows}"));
    let output = bench.run(&["solve", &tube, "tip.csv"]);
    assert!(output.status.success() && !stderr(&output).contains("jumps"), "{}", stderr(&output));
}

#[test]
fn a_warning_is_an_error_where_it_is_denied_and_the_results_are_written() {
    let bench = Bench::new();
    let (link, motion) = (&repository(LINK), &repository(MOTION));
    bench.solve(&["-q"]);
    let cut = ["--set", "analysis.lead=0.1", "--set", "limits.torque=1"];
    let cases = [
        (vec!["solve", link, motion, "-o", "results"], 2),
        (vec!["simulate", link, "out/rigid_torque.csv", "--column", "rigid_torque_n_m"], 2),
    ];
    for (arguments, warnings) in cases {
        let arguments = [&arguments[..], &cut].concat();
        let allowed = bench.done(&arguments);
        assert_eq!(stderr(&allowed).matches("warning: ").count(), warnings, "{arguments:?}");
        let denied = bench.ends(4, &[&arguments[..], &["--deny-warnings"]].concat());
        let error = format!(
            "error: --deny-warnings: warnings = {warnings}, but must be none; all output is written\n"
        );
        assert_eq!(stderr(&denied), stderr(&allowed) + &error);
        assert_eq!(stdout(&denied), stdout(&allowed));
    }
    assert!(bench.path("results/summary.json").exists());
    assert!(bench.path("simulated/summary.json").exists());
}

#[test]
fn a_verified_answer_with_a_warning_fails_where_warnings_are_denied() {
    let bench = Bench::new();
    let arguments = ["verify", &repository(LINK), &repository(MOTION), "--deny-warnings", "-q"];
    let plain = bench.run(&arguments);
    assert_eq!((plain.status.code(), stderr(&plain)), (Some(0), String::new()));
    // All terms change the torque of a strip on a large hub by 19 % of its peak, and the tip's motion by less than 1 %.
    bench.write(
        "radius.toml",
        "segments = [{ length = 0.3, EI = 0.02, mass_per_length = 0.05 }]\n\
         hub = { inertia = 0.02, radius = 0.9 }\npayload = { mass = 0.02 }\ndamping = { ratio = 0.01 }\n",
    );
    let made =
        ["trajectory", "septic", "--distance", "0.6", "--duration", "0.7", "--step", "0.001"];
    bench.done(&[&made[..], &["-o", "radius.csv"]].concat());
    let warned = bench.ends(4, &["verify", "radius.toml", "radius.csv", "--deny-warnings", "-q"]);
    let error = "error: --deny-warnings: warnings = 1, but must be none; all output is written\n";
    let told = stderr(&warned);
    assert!(told.starts_with("warning: large deflections ") && told.ends_with(error), "{told}");
}

#[test]
fn nothing_is_denied_where_nothing_is_warned_of() {
    let bench = Bench::new();
    bench.solve(&["--deny-warnings"]);
    let link = repository(LINK);
    let trajectory = ["trajectory", "septic", "--distance", "0.1", "--duration", "1"];
    for arguments in [
        &["simulate", &link, "out/torque.csv", "--target", "out/tip.csv", "--deny-warnings"][..],
        &["modes", &link, "--count", "3", "--deny-warnings"],
        &["frf", &link, "--to", "10", "--points", "3", "--deny-warnings"],
        &[&trajectory[..], &["--step", "0.01", "--deny-warnings"]].concat(),
    ] {
        bench.done(arguments);
    }
}

#[test]
fn warnings_of_compare_repeat_and_sweep_are_errors_where_they_are_denied() {
    let bench = Bench::new();
    bench.solve(&["-q"]);
    bench.write("none.toml", "[[columns]]\ncolumn = 'none'\nignore = true\n");
    let compare = ["compare", "out", "out", "-q", "--tolerances", "none.toml"];
    let summary = bench.read("out/summary.json");
    let version = format!("\"flexlink\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let repeat = ["solve", "--repeat", "out", &repository(LINK), &repository(MOTION), "-q"];
    let denied = |arguments: &[&str], allowed: i32| {
        let plain = bench.ends(allowed, arguments);
        let denied = bench.ends(4, &[arguments, &["--deny-warnings"]].concat());
        let error =
            "error: --deny-warnings: warnings = 1, but must be none; all output is written\n";
        assert_eq!(stderr(&denied), stderr(&plain) + error);
    };
    denied(&compare, 0);
    bench.write("out/summary.json", &summary.replace(&version, "\"flexlink\": \"0.0.1\""));
    denied(&repeat, 1);

    // The first rows of a sweep that was interrupted.
    let vary = ["--vary", "payload.mass=0,0.01", "--shard", "1/1"];
    swept(&bench, &[&vary[..], &["-o", "whole.csv"]].concat());
    for (values, hint) in [
        ("0,0.01", "use --resume to keep the rows of an interrupted sweep"),
        ("0,0.02", "use another -o to keep rows of another sweep"),
    ] {
        let stopped =
            sweep(&bench, &["--vary", "payload.mass=0,0.01", "-o", "-", "--shard", "1/2"]);
        let lines = stdout(&stopped).replace("\"1/2\"", "\"1/1\"");
        bench.write("sweep.csv.part", &lines);
        let vary = format!("payload.mass={values}");
        let output = sweep(&bench, &["--vary", &vary, "--deny-warnings"]);
        let told = stderr(&output);
        let warning =
            "warning: sweep.csv.part held 1 row of an interrupted sweep, which begins anew\nhint: ";
        assert_eq!(output.status.code(), Some(4), "{told}");
        assert!(told.starts_with(&format!("{warning}{hint}\n")), "{told}");
    }
}

#[test]
fn one_table_of_a_run_that_is_accepted_alone_is_warned_of() {
    let bench = Bench::new();
    bench.solve(&["-q"]);
    bench.solve(&["-q", "-o", "other", "--set", "payload.mass=0.1"]);
    let one = ["compare", "out/torque.csv", "other/torque.csv", "--bless", "-q"];
    let blessed = bench.done(&one);
    let warning = "warning: out/torque.csv: no longer matches the summary.json beside it";
    assert!(stderr(&blessed).starts_with(warning), "{}", stderr(&blessed));
    assert_eq!(stderr(&bench.run(&one)), "", "nothing is left to accept");
    let whole = bench.run(&["compare", "out", "other", "--bless", "-q"]);
    assert_eq!((whole.status.code(), stderr(&whole)), (Some(0), String::new()));
}

#[test]
fn the_table_of_a_sweep_names_the_kinds_of_every_cases_warnings() {
    let bench = Bench::new();
    let more = ["--set", "limits.torque=1", "--set", "limits.rms_torque=1e3"];
    swept(&bench, &[&VARY[..], &more].concat());
    let limit = "limit_exceeded:torque";
    let expected = [limit.to_owned(), format!("inexact_model;{limit}")];
    assert_eq!(cells(&bench, "sweep.csv", "warnings"), expected);
    assert_eq!(cells(&bench, "sweep.csv", "error"), ["", ""]);
    // What a run of solve has in its summary.
    bench.solve(&[&["--scale-distance", "3"], &more[..]].concat());
    let summary = bench.json("out/summary.json");
    let kinds = summary["warnings"].as_array().unwrap().iter().map(|warning| &warning["kind"]);
    assert!(kinds.eq(["inexact_model", "limit_exceeded"]));

    let page = |table: &str| {
        bench.done(&["report", table, "-o", "page.html"]);
        bench.read("page.html")
    };
    let shown = page("sweep.csv");
    let warnings = shown.find("<h2>Warnings</h2>").unwrap();
    assert!(warnings < shown.find("<h2>Figures</h2>").unwrap());
    assert!(shown.contains(
        "<strong>inexact model</strong> <span class=\"hint\">1 of 2 cases, the first is row 2"
    ));
    assert!(shown.contains("<strong>limit exceeded: torque</strong>"));
    assert!(shown.contains("<td>inexact_model;limit_exceeded:torque</td>"));
}

#[test]
fn the_page_of_a_run_has_its_warnings_above_its_results() {
    let bench = Bench::new();
    bench.solve(&["--scale-distance", "3", "--report", "-q"]);
    let page = bench.read("out/report.html");
    let place = |heading: &str| page.find(&format!("<h2>{heading}</h2>")).unwrap();
    assert!(place("Warnings") < place("Torque, tip and hub"));
}

#[test]
fn a_sweep_fails_where_it_is_asked_to_and_its_table_is_written() {
    let strict = "error: --strict: cases that failed or exceed a limit";
    let denied = "error: --deny-warnings: cases that failed or warn";
    let hint = "hint: the columns warnings and error name them\n";
    let failing = ["--vary", "damping.ratio=0.02,1.5,0.03"];
    let limit = [&VARY[..], &["--set", "limits.torque=2"]].concat();
    for (arguments, option, error) in [
        (&VARY[..], "--strict", None),
        (&VARY[..], "--deny-warnings", Some(format!("{denied} = 1 of 2"))),
        (&limit[..], "--strict", Some(format!("{strict} = 1 of 2"))),
        (&limit[..], "--deny-warnings", Some(format!("{denied} = 1 of 2"))),
        (&failing[..], "--strict", Some(format!("{strict} = 1 of 3"))),
        (&failing[..], "--deny-warnings", Some(format!("{denied} = 1 of 3"))),
    ] {
        let bench = Bench::new();
        let allowed = swept(&bench, &[arguments, &["-o", "allowed.csv"]].concat());
        let output = sweep(&bench, &[arguments, &[option]].concat());
        let code = if error.is_some() { 4 } else { 0 };
        assert_eq!(output.status.code(), Some(code), "{arguments:?} {option}");
        let error =
            error.map(|text| format!("{text}, but must be none; the table is written\n{hint}"));
        assert_eq!(stderr(&output), stderr(&allowed) + &error.unwrap_or_default());
        assert!(bench.read("sweep.csv") == bench.read("allowed.csv"));
    }
}

#[test]
fn what_a_shard_warned_of_is_told_when_it_is_joined_or_was_complete() {
    let bench = Bench::new();
    for shard in ["1/2", "2/2"] {
        swept(&bench, &[&VARY[..], &["--shard", shard]].concat());
    }
    let warning = "1 of 2 cases, the first is case 2: inexact_model\n\
                   hint: solve the case alone with flexlink solve for more\n";
    let names = ["sweep-1-of-2.csv", "sweep-2-of-2.csv"];
    bench.refuses_first(
        4,
        &[&["sweep", "--deny-warnings", "--merge"], &names[..]].concat(),
        &format!("warning: {warning}error: --deny-warnings: "),
    );
    assert!(bench.path("sweep.csv").exists() && bench.path("sweep.json").exists());
    let again = [&VARY[..], &["--shard", "2/2", "--resume", "--deny-warnings"]].concat();
    let again = ended(4, sweep(&bench, &again));
    assert!(
        stderr(&again).starts_with("warning: 1 of 1 cases, the first is case 2: inexact_model")
    );
}
