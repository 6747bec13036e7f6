//! `solve --write`: the torque alone, cut, shifted, for a converter, as CSV, C and MATLAB.

use std::fs;
use std::process::{Command, Output};

use super::{Bench, LINK, MOTION, column, json_of, repository, stderr, stdout, succeeded};

/// `solve` of the paper's first example; must succeed.
#[track_caller]
fn told(bench: &Bench, arguments: &[&str]) -> String {
    stdout(&bench.solve(arguments))
}

/// The number before a word in a text.
#[track_caller]
fn before(text: &str, word: &str) -> f64 {
    let head = text.split(word).next().unwrap();
    head.split_whitespace().last().unwrap().parse().unwrap()
}

#[track_caller]
fn refused(output: &Output, message: &str) {
    assert_eq!((output.status.code(), stdout(output)), (Some(2), String::new()));
    assert!(stderr(output).contains(message), "{}", stderr(output));
}

#[test]
fn the_torque_alone_is_that_of_the_folder_and_leaves_none() {
    let bench = Bench::new();
    let text = told(&bench, &["--write", "alone.csv"]);
    assert_eq!(bench.names("."), ["alone.csv"]);
    assert!(!text.contains("written"), "{text}");
    assert!(text.contains("table    8234 rows, -3.676 … 4.557 s; alone.csv\n"), "{text}");
    assert!(text.contains("         the motion begins at 0.000 s\n"), "{text}");
    told(&bench, &["-o", "out", "--write", "beside.csv", "--start-at", "0"]);
    assert_eq!(bench.read("out/torque.csv"), bench.read("alone.csv"));
    assert_eq!(
        column(&bench, "beside.csv", "torque_n_m"),
        column(&bench, "alone.csv", "torque_n_m")
    );
    let shifted = column(&bench, "beside.csv", "time_s");
    assert!((shifted[0], shifted[1]) == (0.0, 0.001), "{:?}", &shifted[..2]);
    let output = bench.solve(&["--write", "-"]);
    assert_eq!(stdout(&output), bench.read("alone.csv"));
    let said = "table    8234 rows, -3.676 … 4.557 s; -\n         the motion begins at 0.000 s\n";
    assert_eq!(stderr(&output), said);
}

#[test]
fn what_verify_finds_is_said_beside_a_printed_table() {
    let bench = super::arms::bench();
    let link = [repository(LINK), repository(MOTION)];
    for [link, motion] in [link, ["arm.toml", "path.csv"].map(str::to_owned)] {
        let output = bench.run(&["solve", &link, &motion, "--write", "-", "--verify"]);
        assert!(stdout(&output).starts_with("time_s,torque"), "{link}");
        assert!(stderr(&output).contains("found     at most   of\n"), "{}", stderr(&output));
    }
}

#[test]
fn a_cut_table_begins_and_ends_at_rest_and_its_cost_is_that_of_a_simulation() {
    let bench = Bench::new();
    // With a law of damping that has an equation in time a simulation of the table finds the same.
    let damped = ["--set", "damping={model='rayleigh',beta=1e-3}"];
    let cut = ["--write", "cut.csv", "--window", "0.5%", "-o", "out"];
    let output = bench.solve(&[&damped[..], &cut].concat());
    let text = stdout(&output);
    assert!(text.contains("cut below 0.500 % of the torque's peak\n"), "{text}");
    let torque = column(&bench, "cut.csv", "torque_n_m");
    let peak = torque.iter().fold(0.0_f64, |peak, t| peak.max(t.abs()));
    assert_eq!((torque[0], torque[torque.len() - 1]), (0.0, 0.0));
    for k in [1, torque.len() - 2] {
        assert!((0.005..0.006).contains(&(torque[k].abs() / peak)), "{}", torque[k] / peak);
    }
    let worst_m = before(text.split("at the rows by").nth(1).unwrap(), " m, ");
    let end_s = column(&bench, "out/tip.csv", "time_s").last().unwrap().to_string();
    let link = repository(LINK);
    let simulate = [&["simulate", &link, "cut.csv"][..], &damped].concat();
    let ends = ["--target", "out/tip.csv", "--until", &end_s, "-q"];
    bench.done(&[&simulate[..], &ends].concat());
    let found_m = bench.json("simulated/summary.json")["tip_error"]["worst_m"].as_f64().unwrap();
    // A spline through the table's jumps of half a percent is another between two rows.
    assert!((found_m / worst_m - 1.0).abs() < 0.02, "{found_m} and {worst_m}");
}

#[test]
fn a_cut_that_moves_the_tip_off_is_warned_of() {
    let bench = Bench::new();
    let output = bench.solve(&["--write", "cut.csv", "--window", "2%", "--start-at", "0"]);
    let (text, warned) = (stdout(&output), stderr(&output));
    assert!(warned.contains("warning: the torque table moves the tip off by "), "{warned}");
    assert!(
        warned.contains("hint: use a smaller --window, or feedback of the hub's angle\n"),
        "{warned}"
    );
    // 2 % of the peak are reached 0.305 s before the motion.
    let begins = before(&text, " s\n         cut below 2.00 %");
    assert!((begins - 0.305).abs() < 0.002, "{text}");
    let (link, motion) = (repository(LINK), repository(MOTION));
    let strict =
        ["solve", &link, &motion, "--write", "cut.csv", "--window", "2%", "--deny-warnings"];
    bench.ends(4, &strict);
}

#[test]
fn values_for_a_converter_move_the_tip_far_less_off_than_samples_of_the_torque() {
    let bench = Bench::new();
    let damped = ["--set", "damping={model='rayleigh',beta=1e-3}"];
    let run = [&damped[..], &["-o", "out", "--write", "held.csv", "--hold", "zero"]].concat();
    let text = told(&bench, &run);
    let printed = before(text.split("at the rows by").nth(1).unwrap(), " m, ");
    let link = repository(LINK);
    let worst_m = |table: &str| {
        let simulate = [&["simulate", &link, table][..], &damped].concat();
        bench.done(&[&simulate[..], &["--hold", "zero", "--target", "out/tip.csv", "-q"]].concat());
        bench.json("simulated/summary.json")["tip_error"]["worst_m"].as_f64().unwrap()
    };
    let (held_m, samples_m) = (worst_m("held.csv"), worst_m("out/torque.csv"));
    // The samples come half a step late: 1.14 m/s times 0.5 ms.
    assert!((4e-4..7e-4).contains(&samples_m), "{samples_m}");
    assert!(held_m < 0.02 * samples_m, "{held_m} of {samples_m}");
    assert!((held_m - printed).abs() < 0.1 * printed + 1e-7, "{held_m} and {printed}");
}

#[test]
fn a_c_header_compiles_and_has_the_numbers_of_the_table() {
    let bench = Bench::new();
    let title = "title=\"no /* end */ here\"";
    told(&bench, &["--set", title, "--write", "my_move.h", "--start-at", "0", "--window", "1%"]);
    told(&bench, &["--set", title, "--write", "table.csv", "--start-at", "0", "--window", "1%"]);
    let header = bench.read("my_move.h");
    assert!(header.starts_with("/*\n * no / * end * / here\n"), "{}", &header[..200]);
    assert!(
        header.contains("SHA-256 ") && header.contains("#ifndef MY_MOVE_H_"),
        "{}",
        &header[..900]
    );
    bench.write(
        "main.c",
        "#include \"my_move.h\"\n#include \"my_move.h\"\n#include <stdio.h>\n\
         int main(void) { for (int k = 0; k < MY_MOVE_LENGTH; k++) {\n\
         printf(\"%.17g,%.17g\\n\", my_move_time_s[k], my_move_n_m[k]); }\n\
         return MY_MOVE_STEP_S == 0.001 ? 0 : 1; }\n",
    );
    let Some(printed) = run_c(&bench) else { return };
    fs::write(bench.path("printed.csv"), format!("time_s,torque_n_m\n{printed}")).unwrap();
    assert_eq!(bench.table("printed.csv"), bench.table("table.csv"));
}

#[test]
fn a_matlab_script_has_a_row_for_each_time_and_makes_a_timeseries() {
    let bench = super::arms::bench();
    for file in ["torque.m", "torque.csv"] {
        bench.done(&["solve", "arm.toml", "path.csv", "-q", "--write", file]);
    }
    let script = bench.read("torque.m");
    let array = |name: &str| -> Vec<Vec<f64>> {
        let rows =
            script.split(&format!("\n{name} = [\n")).nth(1).unwrap().split("];").next().unwrap();
        let row = |line: &str| line.split(' ').map(|number| number.parse().unwrap()).collect();
        rows.lines().map(row).collect()
    };
    let of_table =
        ["time_s", "torque1_n_m", "torque2_n_m"].map(|name| column(&bench, "torque.csv", name));
    let (times, torques) = (array("torque_time_s"), array("torque_n_m"));
    assert_eq!((times.len(), torques.len()), (of_table[0].len(), of_table[0].len()));
    for (k, (time, torque)) in times.iter().zip(&torques).enumerate() {
        assert_eq!([time.as_slice(), torque].concat(), of_table.each_ref().map(|column| column[k]));
    }
    let call = "torque_series = timeseries(torque_n_m, torque_time_s, 'Name', 'torque');";
    assert!(script.contains(call), "{script}");
}

/// The tip's largest error in m that is printed.
#[track_caller]
fn printed_m(text: &str) -> f64 {
    before(text.split("at the rows by").nth(1).expect(text), " m, ")
}

/// `solve` of the arm of the bench into `out`; must succeed, warned or not.
#[track_caller]
fn solved_arm(bench: &Bench, arguments: &[&str]) -> String {
    let solve = ["solve", "arm.toml", "path.csv", "-o", "out"];
    let output = bench.done(&[&solve[..], arguments].concat());
    stdout(&output)
}

/// The tip's largest error in m when `simulate` plays torques on the arm.
#[track_caller]
fn simulated_arm_m(bench: &Bench, table: &str, arguments: &[&str]) -> f64 {
    let end_s = column(bench, "out/tip.csv", "time_s").last().unwrap().to_string();
    let simulate = ["simulate", "arm.toml", table, "--target", "out/tip.csv", "-q"];
    bench.done(&[&simulate[..], &["--until", &end_s], arguments].concat());
    bench.json("simulated/summary.json")["tip_error"]["worst_m"].as_f64().unwrap()
}

#[test]
fn the_tables_of_an_arm_without_weight_move_its_tip_off_as_a_simulation_says() {
    let bench = super::arms::bench();
    let level = ["--set", "gravity=[0, 0]"];
    let text =
        solved_arm(&bench, &[&level[..], &["--write", "cut.csv", "--window", "1%"]].concat());
    assert!(text.contains("cut below 1.00 % of every torque's peak\n"), "{text}");
    assert!(text.contains("s; free joints drift on after a cut\n"), "{text}");
    // The first row is at rest, and in the next one of the torques is beyond its share.
    let torques = [1, 2].map(|joint| column(&bench, "cut.csv", &format!("torque{joint}_n_m")));
    let peaks = torques.each_ref().map(|own| own.iter().fold(0.0_f64, |peak, t| peak.max(t.abs())));
    let last = torques[0].len() - 1;
    for (rest, row) in [(0, 1), (last, last - 1)] {
        let shares = [0, 1].map(|k: usize| torques[k][row].abs() / peaks[k]);
        assert!(torques.iter().all(|own| own[rest] == 0.0));
        assert!((0.01..0.012).contains(&shares[0].max(shares[1])), "{shares:?}");
    }
    let found_m = simulated_arm_m(&bench, "cut.csv", &level);
    // A spline through the table's jumps is another between two rows.
    assert!((found_m / printed_m(&text) - 1.0).abs() < 0.03, "{found_m}: {text}");

    let text =
        solved_arm(&bench, &[&level[..], &["--write", "held.csv", "--hold", "zero"]].concat());
    let held = [&level[..], &["--hold", "zero"]].concat();
    let held_m = simulated_arm_m(&bench, "held.csv", &held);
    let samples_m = simulated_arm_m(&bench, "out/torques.csv", &held);
    assert!(held_m < 1e-3 * samples_m, "{held_m} of {samples_m}");
    // Printed with what the solved tip is off by, a millionth of its travel.
    let printed_m = printed_m(&text);
    assert!((held_m..held_m + 1e-6).contains(&printed_m), "{held_m}: {text}");
}

#[test]
fn the_cut_table_of_an_arm_that_falls_is_played_with_the_feedback_that_is_told() {
    let bench = super::arms::bench();
    let text = solved_arm(&bench, &["--write", "cut.csv", "--window", "5%"]);
    assert!(text.contains("cut below 5.00 % of every torque's range\n"), "{text}");
    let told = "the arm falls from a pose: played with feedback around its joints,\n";
    let gains = text.split(told).nth(1).expect(&text).split_whitespace().next().unwrap();
    // What holds the arm at rest goes on before the first row and after the last.
    let times = column(&bench, "out/torques.csv", "time_s");
    let cut = ["time_s", "torque1_n_m", "torque2_n_m"].map(|name| column(&bench, "cut.csv", name));
    let row = |time: &f64| {
        let row = cut[0].partition_point(|own| *own < time - 1e-9).min(cut[0].len() - 1);
        format!("{time},{},{}\n", cut[1][row], cut[2][row])
    };
    let rows: String = times.iter().map(row).collect();
    assert!(cut[0].len() < times.len());
    bench.write("whole.csv", &format!("time_s,torque1_n_m,torque2_n_m\n{rows}"));
    let around = ["--feedback", gains, "--reference", "out/joint_angles.csv"];
    let found_m = simulated_arm_m(&bench, "whole.csv", &around);
    assert!((found_m / printed_m(&text) - 1.0).abs() < 0.03, "{found_m}: {text}");
    // The torques themselves lead the tip along its path.
    let solved_m = simulated_arm_m(&bench, "out/torques.csv", &around);
    assert!(solved_m < 0.01 * found_m, "{solved_m} of {found_m}");
}

#[test]
fn a_c_header_of_an_arm_has_a_row_for_each_time_and_a_column_for_each_joint() {
    let bench = super::arms::bench();
    for file in ["torque.h", "torque.csv"] {
        solved_arm(&bench, &["-q", "--write", file, "--window", "5%", "--start-at", "-0.1 s"]);
    }
    let header = bench.read("torque.h");
    let command =
        "flexlink solve arm.toml path.csv --write torque.h --start-at=-0.1 --window 0.05\n";
    assert!(header.contains(command), "{}", &header[..600]);
    bench.write(
        "main.c",
        "#include \"torque.h\"\n#include <stdio.h>\n\
         int main(void) { for (int k = 0; k < TORQUE_LENGTH; k++) {\n\
         printf(\"%.17g,%.17g,%.17g\\n\", torque_time_s[k], torque_n_m[k][0], torque_n_m[k][1]); }\n\
         return TORQUE_JOINTS == 2 ? 0 : 1; }\n",
    );
    let printed = run_c(&bench);
    let printed = printed.map(|rows| format!("time_s,torque1_n_m,torque2_n_m\n{rows}"));
    let Some(printed) = printed else { return };
    fs::write(bench.path("printed.csv"), printed).unwrap();
    // In CSV each column has the digits of its own peak.
    for name in ["time_s", "torque1_n_m", "torque2_n_m"] {
        let [own, other] = ["printed.csv", "torque.csv"].map(|file| column(&bench, file, name));
        assert_eq!(own.len(), other.len());
        assert!(own.iter().zip(other).all(|(own, other)| (own - other).abs() < 1e-8), "{name}");
    }
}

/// What main.c of a bench prints; none without a compiler.
#[track_caller]
fn run_c(bench: &Bench) -> Option<String> {
    let compile = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "main.c", "-o", "main"];
    // The linker of Rust's programs; without one there is nothing to try.
    succeeded(Command::new("cc").args(compile).current_dir(bench.path(".")).output().ok()?);
    let output = succeeded(Command::new(bench.path("main")).output().unwrap());
    Some(stdout(&output))
}

#[test]
fn the_summary_has_the_table_and_a_repetition_finds_the_same() {
    let bench = Bench::new();
    fs::copy(repository(LINK), bench.path("link.toml")).unwrap();
    fs::copy(repository(MOTION), bench.path("motion.csv")).unwrap();
    let run =
        |options: &[&str]| bench.run(&[&["solve", "link.toml", "motion.csv"], options].concat());
    let table = ["--write", "cut.h", "--window", "2%", "--start-at", "0", "--hold", "zero"];
    let output = run(&[&table[..], &["-o", "out"]].concat());
    let summary = bench.json("out/summary.json");
    let found = &summary["table"];
    let arguments = ["--write", "cut.h", "--start-at", "0", "--window", "0.02", "--hold", "zero"];
    assert_eq!(found["arguments"], serde_json::json!(arguments));
    for (key, value) in [("file", "cut.h"), ("form", "c"), ("hold", "zero")] {
        assert_eq!(found[key], value);
    }
    let number = |key: &str| found[key].as_f64().unwrap();
    for (key, value) in [("start_s", 0.0), ("step_s", 0.001), ("window", 0.02)] {
        assert!((number(key) - value).abs() < 1e-15, "{found}");
    }
    assert!((number("end_s") - 0.001 * (number("rows") - 1.0)).abs() < 1e-9);
    assert!((number("moves_from_s") - 0.306).abs() < 0.002, "{found}");
    let worst_m = found["tip_error"]["worst_m"].as_f64().unwrap();
    assert!((worst_m / printed_m(&stdout(&output)) - 1.0).abs() < 0.01, "{worst_m}");
    let warnings = summary["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|own| own["kind"] == "table_moves_tip"), "{warnings:?}");
    let json = run(&[&table[..], &["--json"]].concat());
    let json = json_of(&json);
    assert_eq!(json["table"], *found);
    fs::remove_file(bench.path("cut.h")).unwrap();
    let repeated = bench.run(&["solve", "--repeat", "out"]);
    assert_eq!(stdout(&repeated), "same     7 files of out, byte for byte\n");
    assert!(!bench.path("cut.h").exists());
    refused(&run(&["--write", "out/torque.csv"]), "must not be a file of a run's results");
    // A torque that nothing changes has no error to measure.
    succeeded(run(&["--write", "-"]));
    let json = run(&["--write", "whole.m", "--json"]);
    let json = json_of(&json);
    assert_eq!(
        (&json["table"]["form"], &json["table"]["tip_error"]),
        (&"matlab".into(), &().into())
    );
}
