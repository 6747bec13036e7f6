//! `solve --write`: the torque alone, cut, shifted, for a converter, as CSV, C and MATLAB.

use std::fs;
use std::process::{Command, Output};

use super::{Bench, LINK, MOTION, column, repository, stderr, stdout};

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
    let worst_m = before(text.split("off by").nth(1).unwrap(), " m, ");
    let end_s = column(&bench, "out/tip.csv", "time_s").last().unwrap().to_string();
    let link = repository(LINK);
    let simulate = [&["simulate", &link, "cut.csv"][..], &damped].concat();
    let ends = ["--target", "out/tip.csv", "--until", &end_s, "-q"];
    let output = bench.run(&[&simulate[..], &ends].concat());
    assert!(output.status.success(), "{}", stderr(&output));
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
        warned.contains("hint: a smaller --window, or feedback of the hub's angle\n"),
        "{warned}"
    );
    // 2 % of the peak are reached 0.305 s before the motion.
    let begins = before(&text, " s\n         cut below 2.00 %");
    assert!((begins - 0.305).abs() < 0.002, "{text}");
    let (link, motion) = (repository(LINK), repository(MOTION));
    let strict =
        ["solve", &link, &motion, "--write", "cut.csv", "--window", "2%", "--deny-warnings"];
    assert_eq!(bench.run(&strict).status.code(), Some(4));
}

#[test]
fn values_for_a_converter_move_the_tip_far_less_off_than_samples_of_the_torque() {
    let bench = Bench::new();
    let damped = ["--set", "damping={model='rayleigh',beta=1e-3}"];
    let run = [&damped[..], &["-o", "out", "--write", "held.csv", "--hold", "zero"]].concat();
    let text = told(&bench, &run);
    let printed = before(text.split("off by").nth(1).unwrap(), " m, ");
    let link = repository(LINK);
    let worst_m = |table: &str| {
        let simulate = [&["simulate", &link, table][..], &damped].concat();
        let output = bench
            .run(&[&simulate[..], &["--hold", "zero", "--target", "out/tip.csv", "-q"]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
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
    told(&bench, &["--set", title, "--write", "my move.h", "--start-at", "0", "--window", "1%"]);
    told(&bench, &["--set", title, "--write", "table.csv", "--start-at", "0", "--window", "1%"]);
    let header = bench.read("my move.h");
    assert!(header.starts_with("/*\n * no / * end * / here\n"), "{}", &header[..200]);
    assert!(
        header.contains("SHA-256 ") && header.contains("#ifndef MY_MOVE_H\n"),
        "{}",
        &header[..900]
    );
    bench.write(
        "main.c",
        "#include \"my move.h\"\n#include \"my move.h\"\n#include <stdio.h>\n\
         int main(void) { for (int k = 0; k < MY_MOVE_LENGTH; k++) {\n\
         printf(\"%.17g,%.17g\\n\", my_move_time_s[k], my_move_n_m[k]); }\n\
         return MY_MOVE_STEP_S == 0.001 ? 0 : 1; }\n",
    );
    let compile = ["-Wall", "-Wextra", "-Werror", "main.c", "-o", "main"];
    // The linker of Rust's programs; without one there is nothing to try.
    let Ok(compiled) = Command::new("cc").args(compile).current_dir(bench.path(".")).output()
    else {
        return;
    };
    assert!(compiled.status.success(), "{}", stderr(&compiled));
    let output = Command::new(bench.path("main")).output().unwrap();
    assert!(output.status.success());
    let printed = format!("time_s,torque_n_m\n{}", stdout(&output));
    fs::write(bench.path("printed.csv"), printed).unwrap();
    assert_eq!(bench.table("printed.csv"), bench.table("table.csv"));
}

#[test]
fn a_matlab_script_has_a_row_for_each_time_and_makes_a_timeseries() {
    let bench = super::arms::bench();
    for file in ["torque.m", "torque.csv"] {
        let output = bench.run(&["solve", "arm.toml", "path.csv", "-q", "--write", file]);
        assert!(output.status.success(), "{}", stderr(&output));
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
    for option in [&["--window", "2%"][..], &["--hold", "zero"]] {
        let output = bench
            .run(&[&["solve", "arm.toml", "path.csv", "--write", "torque.m"], option].concat());
        refused(&output, &format!("{} is for one link, and the arm has several", option[0]));
    }
}

#[test]
fn a_file_that_is_no_form_or_replaces_another_is_refused() {
    let bench = Bench::new();
    fs::copy(repository(LINK), bench.path("link.toml")).unwrap();
    fs::copy(repository(MOTION), bench.path("motion.csv")).unwrap();
    let solve =
        |options: &[&str]| bench.run(&[&["solve", "link.toml", "motion.csv"], options].concat());
    refused(
        &solve(&["--write", "torque.txt"]),
        "--write = torque.txt, but must end in .csv, .h or .m",
    );
    refused(
        &solve(&["--write", "motion.csv"]),
        "--write = motion.csv, but must not be a file that is read",
    );
    refused(&solve(&["-o", ".", "--write", "tip.csv"]), "must not be a file of a run's results");
    refused(&solve(&["-o", "new", "--write", "new/torque.csv"]), "must not be a file of a run's");
    bench.solve(&["-o", "there"]);
    refused(&solve(&["--write", "there/torque.csv"]), "must not be a file of a run's results");
    let golden = "--golden is given, but has an effect only with -o beside --write";
    refused(&solve(&["--golden", "--write", "q.csv"]), golden);
    refused(
        &solve(&["--write", "a.csv", "--report"]),
        "--report is given, but has an effect only with -o beside --write",
    );
    refused(
        &solve(&["--write", "-", "--json"]),
        "--json is given, but standard output has the table of --write -",
    );
    refused(&solve(&["--window", "2%"]), "--write <FILE>");
    refused(
        &solve(&["--write", "a.csv", "--window", "100%"]),
        "must be a share above 0 and below 1",
    );
    fs::copy(repository("trajectories/sway_1s.csv"), bench.path("motion.csv")).unwrap();
    let cycle = solve(&["--write", "a.csv", "--window", "2%", "--periodic"]);
    refused(&cycle, "--window is for a motion from rest to rest");
}
