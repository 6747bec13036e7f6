//! `solve --write`: the torque alone, cut, shifted, for a converter, as CSV, C and MATLAB.

use std::fs;
use std::process::Command;

use super::{
    Bench, LINK, MOTION, apart, column, number, peak, repository, stderr, stdout, succeeded, with,
};

/// The number before a word in a text.
#[track_caller]
fn before(text: &str, word: &str) -> f64 {
    let head = text.split(word).next().unwrap();
    head.split_whitespace().last().unwrap().parse().unwrap()
}

#[test]
fn the_torque_alone_is_that_of_the_folder_and_leaves_none() {
    let bench = Bench::new();
    let text = stdout(&bench.solve("--write alone.csv"));
    assert_eq!(bench.names("."), ["alone.csv"]);
    assert!(!text.contains("written"), "{text}");
    assert!(text.contains("table    8234 rows, -3.676 … 4.557 s; alone.csv\n"), "{text}");
    assert!(text.contains("         the motion begins at 0.000 s\n"), "{text}");
    bench.solve("-o out --write beside.csv --start-at 0");
    assert_eq!(bench.read("out/torque.csv"), bench.read("alone.csv"));
    let [beside, alone] = ["beside.csv", "alone.csv"].map(|file| bench.table(file));
    assert_eq!(beside[1], alone[1]);
    assert_eq!(beside[0].1[..2], [0.0, 0.001]);
    let output = bench.solve("--write -");
    assert_eq!(stdout(&output), bench.read("alone.csv"));
    let said = "table    8234 rows, -3.676 … 4.557 s; -\n         the motion begins at 0.000 s\n";
    assert_eq!(stderr(&output), said);
}

#[test]
fn what_verify_finds_is_said_beside_a_printed_table() {
    let bench = super::arms::bench();
    for inputs in [&format!("{LINK} {MOTION}"), "arm.toml path.csv"] {
        let output = bench.run(&format!("solve {inputs} --write - --verify"));
        assert!(stdout(&output).starts_with("time_s,torque"), "{inputs}");
        assert!(stderr(&output).contains("found     at most   of\n"), "{}", stderr(&output));
    }
}

/// A law of damping that has an equation in time: a simulation of the table finds the same.
const DAMPED: &str = "--set damping={model='rayleigh',beta=1e-3}";

#[test]
fn a_cut_table_begins_and_ends_at_rest_and_its_cost_is_that_of_a_simulation() {
    let bench = Bench::new();
    let text = stdout(&bench.solve(&format!("{DAMPED} --write cut.csv --window 0.5% -o out")));
    assert!(text.contains("cut below 0.500 % of the torque's peak\n"), "{text}");
    let torque = column(&bench, "cut.csv", "torque_n_m");
    assert_eq!((torque[0], torque[torque.len() - 1]), (0.0, 0.0));
    for k in [1, torque.len() - 2] {
        let share = torque[k].abs() / peak(&torque);
        assert!((0.005..0.006).contains(&share), "{share}");
    }
    let found_m = simulated_m(&bench, LINK, "cut.csv", DAMPED);
    // A spline through the table's jumps of half a percent is another between two rows.
    assert!((found_m / printed_m(&text) - 1.0).abs() < 0.02, "{found_m}: {text}");
}

#[test]
fn a_cut_that_moves_the_tip_off_is_warned_of() {
    let bench = Bench::new();
    let output = bench.solve("--write cut.csv --window 2% --start-at 0");
    let (text, warned) = (stdout(&output), stderr(&output));
    assert!(warned.contains("warning: the torque table moves the tip off by "), "{warned}");
    let hint = "hint: use a smaller --window, or feedback of the hub's angle\n";
    assert!(warned.contains(hint), "{warned}");
    // 2 % of the peak are reached 0.305 s before the motion.
    let begins = before(&text, " s\n         cut below 2.00 %");
    assert!((begins - 0.305).abs() < 0.002, "{text}");
    let strict = format!("solve {LINK} {MOTION} --write cut.csv --window 2% --deny-warnings");
    bench.ends(4, &strict);
}

#[test]
fn values_for_a_converter_move_the_tip_far_less_off_than_samples_of_the_torque() {
    let bench = Bench::new();
    let text = stdout(&bench.solve(&format!("{DAMPED} -o out --write held.csv --hold zero")));
    let held = format!("{DAMPED} --hold zero");
    let [held_m, samples_m] =
        ["held.csv", "out/torque.csv"].map(|table| simulated_m(&bench, LINK, table, &held));
    // The samples come half a step late: 1.14 m/s times 0.5 ms.
    assert!((4e-4..7e-4).contains(&samples_m), "{samples_m}");
    assert!(held_m < 0.02 * samples_m, "{held_m} of {samples_m}");
    let printed = printed_m(&text);
    assert!((held_m - printed).abs() < 0.1 * printed + 1e-7, "{held_m} and {printed}");
}

#[test]
fn a_c_header_compiles_and_has_the_numbers_of_the_table() {
    let bench = Bench::new();
    let title = ["--set", "title=\"no /* end */ here\""];
    for file in ["my_move.h", "table.csv"] {
        bench.solve(&with(&format!("--write {file} --start-at 0 --window 1%"), &title));
    }
    let header = bench.read("my_move.h");
    assert!(header.starts_with("/*\n * no / * end * / here\n"), "{}", &header[..200]);
    assert!(header.contains("SHA-256 "), "{}", &header[..900]);
    assert!(header.contains("#ifndef MY_MOVE_H_"), "{}", &header[..900]);
    let numbers = "\"%.17g,%.17g\\n\", my_move_time_s[k], my_move_n_m[k]";
    let names = ["time_s", "torque_n_m"];
    let Some(printed) = printed_by_c(&bench, "my_move", numbers, "STEP_S == 0.001", &names) else {
        return;
    };
    assert_eq!(printed, bench.table("table.csv"));
}

#[test]
fn a_matlab_script_has_a_row_for_each_time_and_makes_a_timeseries() {
    let bench = super::arms::bench();
    for file in ["torque.m", "torque.csv"] {
        bench.done(&format!("solve arm.toml path.csv -q --write {file}"));
    }
    let script = bench.read("torque.m");
    let array = |name: &str| -> Vec<String> {
        let rows = script.split(&format!("\n{name} = [\n")).nth(1).unwrap();
        rows.split("];").next().unwrap().lines().map(|line| line.replace(' ', ",")).collect()
    };
    let (times, torques) = (array("torque_time_s"), array("torque_n_m"));
    assert_eq!(times.len(), torques.len());
    let rows = times.iter().zip(&torques).map(|(time, torque)| format!("{time},{torque}\n"));
    bench.write("rows.csv", &format!("{}\n{}", TORQUES.join(","), rows.collect::<String>()));
    assert_eq!(bench.table("rows.csv"), bench.table("torque.csv"));
    let call = "torque_series = timeseries(torque_n_m, torque_time_s, 'Name', 'torque');";
    assert!(script.contains(call), "{script}");
}

const TORQUES: [&str; 3] = ["time_s", "torque1_n_m", "torque2_n_m"];

/// The tip's largest error in m that is printed.
#[track_caller]
fn printed_m(text: &str) -> f64 {
    before(text.split("at the rows by").nth(1).expect(text), " m, ")
}

/// `solve` of the arm of the bench into `out`; must succeed, warned or not.
#[track_caller]
fn solved_arm(bench: &Bench, more: &str) -> String {
    bench.printed(&format!("solve arm.toml path.csv -o out {more}"))
}

/// The tip's largest error in m when `simulate` plays a table to the end of the run in `out`.
#[track_caller]
fn simulated_m(bench: &Bench, link: &str, table: &str, more: &str) -> f64 {
    let end_s = column(bench, "out/tip.csv", "time_s").last().unwrap().to_string();
    let target = format!("--target out/tip.csv -q --until {end_s}");
    bench.done(&format!("simulate {link} {table} {target} {more}"));
    bench.number("simulated", "tip_error/worst_m")
}

#[test]
fn the_tables_of_an_arm_without_weight_move_its_tip_off_as_a_simulation_says() {
    let bench = super::arms::bench();
    let level = "--set gravity=[0,0]";
    let text = solved_arm(&bench, &format!("{level} --write cut.csv --window 1%"));
    assert!(text.contains("cut below 1.00 % of every torque's peak\n"), "{text}");
    assert!(text.contains("s; free joints drift on after a cut\n"), "{text}");
    // The first row is at rest, and in the next one of the torques is beyond its share.
    let torques = [TORQUES[1], TORQUES[2]].map(|name| column(&bench, "cut.csv", name));
    let last = torques[0].len() - 1;
    for (rest, row) in [(0, 1), (last, last - 1)] {
        let shares = torques.each_ref().map(|own| own[row].abs() / peak(own));
        assert!(torques.iter().all(|own| own[rest] == 0.0));
        assert!((0.01..0.012).contains(&shares[0].max(shares[1])), "{shares:?}");
    }
    let found_m = simulated_m(&bench, "arm.toml", "cut.csv", level);
    // A spline through the table's jumps is another between two rows.
    assert!((found_m / printed_m(&text) - 1.0).abs() < 0.03, "{found_m}: {text}");

    let held = format!("{level} --hold zero");
    let text = solved_arm(&bench, &format!("{held} --write held.csv"));
    let [held_m, samples_m] =
        ["held.csv", "out/torques.csv"].map(|table| simulated_m(&bench, "arm.toml", table, &held));
    assert!(held_m < 1e-3 * samples_m, "{held_m} of {samples_m}");
    // Printed with what the solved tip is off by, a millionth of its travel.
    let printed_m = printed_m(&text);
    assert!((held_m..held_m + 1e-6).contains(&printed_m), "{held_m}: {text}");
}

#[test]
fn the_cut_table_of_an_arm_that_falls_is_played_with_the_feedback_that_is_told() {
    let bench = super::arms::bench();
    let text = solved_arm(&bench, "--write cut.csv --window 5%");
    assert!(text.contains("cut below 5.00 % of every torque's range\n"), "{text}");
    let told = "nothing else holds the arm: played with feedback around its joints,\n";
    let gains = text.split(told).nth(1).expect(&text).split_whitespace().next().unwrap();
    // What holds the arm at rest goes on before the first row and after the last.
    let times = column(&bench, "out/torques.csv", "time_s");
    let cut = TORQUES.map(|name| column(&bench, "cut.csv", name));
    let row = |time: &f64| {
        let row = cut[0].partition_point(|own| *own < time - 1e-9).min(cut[0].len() - 1);
        format!("{time},{},{}\n", cut[1][row], cut[2][row])
    };
    let rows: String = times.iter().map(row).collect();
    assert!(cut[0].len() < times.len());
    bench.write("whole.csv", &format!("{}\n{rows}", TORQUES.join(",")));
    let around = format!("--feedback {gains} --reference out/joint_angles.csv");
    let found_m = simulated_m(&bench, "arm.toml", "whole.csv", &around);
    assert!((found_m / printed_m(&text) - 1.0).abs() < 0.03, "{found_m}: {text}");
    // The torques themselves lead the tip along its path.
    let solved_m = simulated_m(&bench, "arm.toml", "out/torques.csv", &around);
    assert!(solved_m < 0.01 * found_m, "{solved_m} of {found_m}");
}

#[test]
fn a_c_header_of_an_arm_has_a_row_for_each_time_and_a_column_for_each_joint() {
    let bench = super::arms::bench();
    for file in ["torque.h", "torque.csv"] {
        let cut = ["--window", "5%", "--start-at", "-0.1 s"];
        bench.done(&with(&format!("solve arm.toml path.csv -q --write {file}"), &cut));
    }
    let header = bench.read("torque.h");
    let command =
        "flexlink solve arm.toml path.csv --write torque.h --start-at=-0.1 --window 0.05\n";
    assert!(header.contains(command), "{}", &header[..600]);
    let numbers = "\"%.17g,%.17g,%.17g\\n\", torque_time_s[k], torque_n_m[k][0], torque_n_m[k][1]";
    let Some(printed) = printed_by_c(&bench, "torque", numbers, "JOINTS == 2", &TORQUES) else {
        return;
    };
    // In CSV each column has the digits of its own peak.
    for ((name, own), (other_name, other)) in printed.iter().zip(&bench.table("torque.csv")) {
        assert!(name == other_name && apart(own, other) < 1e-8, "{name}");
    }
}

/// The table that a C program prints from a header, whose constant must be as said; none without a compiler.
#[track_caller]
fn printed_by_c(
    bench: &Bench,
    header: &str,
    numbers: &str,
    constant: &str,
    names: &[&str],
) -> Option<Vec<(String, Vec<f64>)>> {
    let prefix = header.to_uppercase();
    let main = format!(
        "#include \"{header}.h\"\n#include \"{header}.h\"\n#include <stdio.h>\n\
         int main(void) {{ for (int k = 0; k < {prefix}_LENGTH; k++) {{ printf({numbers}); }}\n\
         return {prefix}_{constant} ? 0 : 1; }}\n"
    );
    bench.write("main.c", &main);
    let compile = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "main.c", "-o", "main"];
    // The linker of Rust's programs; without one there is nothing to try.
    succeeded(Command::new("cc").args(compile).current_dir(bench.path(".")).output().ok()?);
    let printed = stdout(&succeeded(Command::new(bench.path("main")).output().unwrap()));
    bench.write("printed.csv", &format!("{}\n{printed}", names.join(",")));
    Some(bench.table("printed.csv"))
}

#[test]
fn the_summary_has_the_table_and_a_repetition_finds_the_same() {
    let bench = Bench::new();
    fs::copy(repository(LINK), bench.path("link.toml")).unwrap();
    fs::copy(repository(MOTION), bench.path("motion.csv")).unwrap();
    let run = |options: &str| bench.run(&format!("solve link.toml motion.csv {options}"));
    let table = "--write cut.h --window 2% --start-at 0 --hold zero";
    let output = run(&format!("{table} -o out"));
    let summary = bench.json("out/summary.json");
    let found = &summary["table"];
    let arguments = ["--write", "cut.h", "--start-at", "0", "--window", "0.02", "--hold", "zero"];
    assert_eq!(found["arguments"], serde_json::json!(arguments));
    for (key, value) in [("file", "cut.h"), ("form", "c"), ("hold", "zero")] {
        assert_eq!(found[key], value);
    }
    let of = |key: &str| number(found, key);
    for (key, value) in [("start_s", 0.0), ("step_s", 0.001), ("window", 0.02)] {
        assert!((of(key) - value).abs() < 1e-15, "{found}");
    }
    assert!((of("end_s") - 0.001 * (of("rows") - 1.0)).abs() < 1e-9);
    assert!((of("moves_from_s") - 0.306).abs() < 0.002, "{found}");
    let worst_m = of("tip_error/worst_m");
    assert!((worst_m / printed_m(&stdout(&output)) - 1.0).abs() < 0.01, "{worst_m}");
    let warnings = summary["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|own| own["kind"] == "table_moves_tip"), "{warnings:?}");
    let json = super::json_of(&run(&format!("{table} --json")));
    assert_eq!(json["table"], *found);
    fs::remove_file(bench.path("cut.h")).unwrap();
    let repeated = bench.printed("solve --repeat out");
    assert_eq!(repeated, "same     7 files of out, byte for byte\n");
    assert!(!bench.path("cut.h").exists());
    let over = "solve link.toml motion.csv --write out/torque.csv";
    bench.refuses(2, over, "must not be a file of a run's results");
    // A torque that nothing changes has no error to measure.
    succeeded(run("--write -"));
    let table = bench.reply("solve link.toml motion.csv --write whole.m --json")["table"].clone();
    assert_eq!((&table["form"], &table["tip_error"]), (&"matlab".into(), &().into()));
}
