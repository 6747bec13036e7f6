//! Warnings reach whoever must see them: in tables, on pages, and as an exit code.

use super::sweep::{sweep, swept};
use super::{Bench, LINK, MOTION, column, ended, min_jerk, peak, stderr, stdout};

/// Cases of which the second bends too much.
const VARY: &str = "--vary distance*=1,3";

#[test]
fn an_acceleration_that_jumps_is_remarked_where_it_overshoots() {
    let bench = Bench::new();
    let trajectory = |profile: &str, duration: &str, step: &str| {
        let times = format!("--duration {duration} --step {step} -o tip.csv");
        bench.done(&format!("trajectory {profile} --distance 0.5 {times}"));
    };
    for (profile, jumps) in [
        ("bang-bang", true),
        ("trapezoid", true),
        ("versine", true),
        ("sine", false),
        ("septic", false),
    ] {
        trajectory(profile, "0.5", "0.0005");
        let stiff = "--set mesh.elements=\"auto\" --set segments.*.EI*=100";
        let told = bench.told(&format!("solve {LINK} tip.csv {stiff}"));
        let remark = "remark: the acceleration jumps: followed to";
        assert_eq!(told.contains(remark), jumps, "{profile}: {told}");
        let largest = peak(&column(&bench, "tip.csv", "acceleration"));
        let share = bench.number("out", "motion/peak_acceleration_m_s2") / largest - 1.0;
        assert_eq!(share > 0.05, jumps, "{profile}: {share}");
        let above = format!("{:.0} % above its samples", 100.0 * share);
        assert!(!jumps || told.contains(&above), "{share}: {told}");
    }
    // A smooth motion overshoots its samples, too, where these are few or its band is cut.
    for (profile, step, more) in [
        ("s-curve", "0.02", ""),
        ("sine", "0.1", ""),
        ("s-curve", "0.001", "--set analysis.tip_tolerance=1e-3"),
        ("s-curve", "0.001", "--lowpass 3"),
    ] {
        trajectory(profile, "1", step);
        let told = bench.told(&format!("solve {LINK} tip.csv {more}"));
        assert!(!told.contains("jumps"), "{profile} {step}: {told}");
    }
    // Displacements say nothing of a jump: theirs may be rounding.
    let rounded = |k: i32| {
        let t = (f64::from(k - 10) / 100.0).clamp(0.0, 1.0);
        format!("{:.2},{:.4}\n", 0.01 * f64::from(k), 0.5 * min_jerk(t))
    };
    let rows: String = (0..=120).map(rounded).collect();
    bench.write("tip.csv", &format!("time,displacement\n{rows}"));
    let told = bench.told(&format!("solve {LINK} tip.csv"));
    assert!(!told.contains("jumps"), "{told}");
}

/// The error of warnings that are denied.
fn denied(warnings: usize) -> String {
    format!(
        "error: --deny-warnings: warnings = {warnings}, but must be none; all output is written\n"
    )
}

#[test]
fn a_warning_is_an_error_where_it_is_denied_and_the_results_are_written() {
    let bench = Bench::new();
    bench.solve("-q");
    for arguments in [
        format!("solve {LINK} {MOTION} -o results"),
        format!("simulate {LINK} out/rigid_torque.csv --column rigid_torque_n_m"),
    ] {
        let arguments = format!("{arguments} --set analysis.lead=0.1 --set limits.torque=1");
        let allowed = bench.done(&arguments);
        assert_eq!(stderr(&allowed).matches("warning: ").count(), 2, "{arguments:?}");
        let failed = bench.ends(4, &format!("{arguments} --deny-warnings"));
        assert_eq!(stderr(&failed), stderr(&allowed) + &denied(2));
        assert_eq!(stdout(&failed), stdout(&allowed));
    }
    assert!(bench.path("results/summary.json").exists());
    assert!(bench.path("simulated/summary.json").exists());
}

#[test]
fn a_verified_answer_with_a_warning_fails_where_warnings_are_denied() {
    let bench = Bench::new();
    bench.silent(&format!("verify {LINK} {MOTION} --deny-warnings -q"));
    // All terms change the torque of a strip on a large hub by 19 % of its peak, and the tip's motion by less than 1 %.
    bench.write(
        "radius.toml",
        "segments = [{ length = 0.3, EI = 0.02, mass_per_length = 0.05 }]\n\
         hub = { inertia = 0.02, radius = 0.9 }\npayload = { mass = 0.02 }\ndamping = { ratio = 0.01 }\n",
    );
    bench.done("trajectory septic --distance 0.6 --duration 0.7 --step 0.001 -o radius.csv");
    let told = bench.error(4, "verify radius.toml radius.csv --deny-warnings -q");
    assert!(
        told.starts_with("warning: large deflections ") && told.ends_with(&denied(1)),
        "{told}"
    );
}

#[test]
fn nothing_is_denied_where_nothing_is_warned_of() {
    let bench = Bench::new();
    bench.solve("--deny-warnings");
    for arguments in [
        &format!("simulate {LINK} out/torque.csv --target out/tip.csv"),
        &format!("modes {LINK} --count 3"),
        &format!("frf {LINK} --to 10 --points 3"),
        "trajectory septic --distance 0.1 --duration 1 --step 0.01",
    ] {
        bench.done(&format!("{arguments} --deny-warnings"));
    }
}

#[test]
fn warnings_of_compare_repeat_and_sweep_are_errors_where_they_are_denied() {
    let bench = Bench::new();
    bench.solve("-q");
    bench.write("none.toml", "[[columns]]\ncolumn = 'none'\nignore = true\n");
    let is_denied = |arguments: &str, allowed: i32| {
        let plain = bench.error(allowed, arguments);
        let failed = bench.error(4, &format!("{arguments} --deny-warnings"));
        assert_eq!(failed, plain + &denied(1));
    };
    is_denied("compare out out -q --tolerances none.toml", 0);
    let version = format!("\"flexlink\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let summary = bench.read("out/summary.json").replace(&version, "\"flexlink\": \"0.0.1\"");
    bench.write("out/summary.json", &summary);
    is_denied(&format!("solve --repeat out {LINK} {MOTION} -q"), 1);

    // The first rows of a sweep that was interrupted.
    let vary = "--vary payload.mass=0,0.01";
    for (values, hint) in [
        ("0,0.01", "use --resume to keep the rows of an interrupted sweep"),
        ("0,0.02", "use another -o to keep rows of another sweep"),
    ] {
        let stopped = stdout(&sweep(&bench, &format!("{vary} -o - --shard 1/2")));
        bench.write("sweep.csv.part", &stopped.replace("\"1/2\"", "\"1/1\""));
        let output = sweep(&bench, &format!("--vary payload.mass={values} --deny-warnings"));
        let told = stderr(&ended(4, output));
        let warning =
            "warning: sweep.csv.part held 1 row of an interrupted sweep, which begins anew\nhint: ";
        assert!(told.starts_with(&format!("{warning}{hint}\n")), "{told}");
    }
}

#[test]
fn one_table_of_a_run_that_is_accepted_alone_is_warned_of() {
    let bench = Bench::new();
    bench.solve("-q");
    bench.solve("-q -o other --set payload.mass=0.1");
    let one = "compare out/torque.csv other/torque.csv --bless -q";
    let told = bench.told(one);
    let warning = "warning: out/torque.csv: no longer matches the summary.json beside it";
    assert!(told.starts_with(warning), "{told}");
    assert_eq!(stderr(&bench.run(one)), "", "nothing is left to accept");
    bench.silent("compare out other --bless -q");
}

#[test]
fn the_table_of_a_sweep_names_the_kinds_of_every_cases_warnings() {
    let bench = Bench::new();
    let more = "--set limits.torque=1 --set limits.rms_torque=1e3";
    swept(&bench, &format!("{VARY} {more}"));
    let expected = ["limit_exceeded:torque", "inexact_model;limit_exceeded:torque"];
    assert_eq!(bench.cells("sweep.csv", "warnings"), expected);
    assert_eq!(bench.cells("sweep.csv", "error"), ["", ""]);
    // What a run of solve has in its summary.
    bench.solve(&format!("--scale-distance 3 {more}"));
    let summary = bench.json("out/summary.json");
    let kinds = summary["warnings"].as_array().unwrap().iter().map(|warning| &warning["kind"]);
    assert!(kinds.eq(["inexact_model", "limit_exceeded"]));

    bench.done("report sweep.csv -o page.html");
    let shown = bench.read("page.html");
    let warnings = shown.find("<h2>Warnings</h2>").unwrap();
    assert!(warnings < shown.find("<h2>Figures</h2>").unwrap());
    for words in [
        "<strong>inexact model</strong> <span class=\"hint\">1 of 2 cases, the first is row 2",
        "<strong>limit exceeded: torque</strong>",
        "<td>inexact_model;limit_exceeded:torque</td>",
    ] {
        assert!(shown.contains(words), "{words}");
    }
}

#[test]
fn the_page_of_a_run_has_its_warnings_above_its_results() {
    let bench = Bench::new();
    bench.solve("--scale-distance 3 --report -q");
    let page = bench.read("out/report.html");
    let place = |heading: &str| page.find(&format!("<h2>{heading}</h2>")).unwrap();
    assert!(place("Warnings") < place("Torque, tip and hub"));
}

#[test]
fn a_sweep_fails_where_it_is_asked_to_and_its_table_is_written() {
    let strict = "error: --strict: cases that failed or exceed a limit";
    let warned = "error: --deny-warnings: cases that failed or warn";
    let hint = "hint: the columns warnings and error name them\n";
    let failing = "--vary damping.ratio=0.02,1.5,0.03";
    let limit = format!("{VARY} --set limits.torque=2");
    for (arguments, option, error) in [
        (VARY, "--strict", None),
        (VARY, "--deny-warnings", Some(format!("{warned} = 1 of 2"))),
        (&limit, "--strict", Some(format!("{strict} = 1 of 2"))),
        (&limit, "--deny-warnings", Some(format!("{warned} = 1 of 2"))),
        (failing, "--strict", Some(format!("{strict} = 1 of 3"))),
        (failing, "--deny-warnings", Some(format!("{warned} = 1 of 3"))),
    ] {
        let bench = Bench::new();
        let allowed = swept(&bench, &format!("{arguments} -o allowed.csv"));
        let output = sweep(&bench, &format!("{arguments} {option}"));
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
        swept(&bench, &format!("{VARY} --shard {shard}"));
    }
    let warning = "warning: 1 of 2 cases, the first is case 2: inexact_model\n\
                   hint: solve the case alone with flexlink solve for more\n\
                   error: --deny-warnings: ";
    let merge = "sweep --deny-warnings --merge sweep-1-of-2.csv sweep-2-of-2.csv";
    bench.refuses_first(4, merge, warning);
    assert!(bench.path("sweep.csv").exists() && bench.path("sweep.json").exists());
    let again = sweep(&bench, &format!("{VARY} --shard 2/2 --resume --deny-warnings"));
    let told = stderr(&ended(4, again));
    let warning = "warning: 1 of 1 cases, the first is case 2: inexact_model";
    assert!(told.starts_with(warning), "{told}");
}
