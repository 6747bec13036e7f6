//! `sweep` of arms: rows as `solve` has them, scaled times, cases that fail, shards, refusals.

use std::process::Output;

use super::arms::bench;
use super::sweep::rows;
use super::{Bench, stderr, succeeded};

/// `sweep` of the line of the arm in these tests.
fn sweep(bench: &Bench, options: &[&str]) -> Output {
    bench.run(&[&["sweep", "arm.toml", "path.csv"], options].concat())
}

#[track_caller]
fn swept(bench: &Bench, options: &[&str]) -> Output {
    succeeded(sweep(bench, options))
}

#[track_caller]
fn solve(bench: &Bench, options: &[&str]) {
    bench.done(&[&["solve", "arm.toml"], options].concat());
}

/// Where summary.json has the number of a column of joints, `peak_torque2_n_m`: the number of the joint from 0,
/// and `peak_torque_n_m`.
fn of_joint(name: &str) -> Option<(usize, String)> {
    let at = name.find(['1', '2'])?;
    let joint: usize = name[at..=at].parse().unwrap();
    Some((joint - 1, format!("{}{}", &name[..at], &name[at + 1..])))
}

/// The worst error of a kind of all quantities of all joints in the summary of a run.
fn worst(summary: &serde_json::Value, kind: &str) -> f64 {
    let joints = summary["errors"]["joints"].as_array().unwrap().iter();
    let quantities = joints.flat_map(|joint| joint.as_object().unwrap().values());
    quantities.filter_map(|errors| errors[kind].as_f64()).fold(0.0, f64::max)
}

/// Compares every number of a row with the summary of a run, to so much of it.
#[track_caller]
fn assert_row(bench: &Bench, names: &[String], row: &[String], tolerance: f64) {
    let summary = bench.json("out/summary.json");
    let mut compared = 0;
    for (name, field) in names.iter().zip(row) {
        let expected = match name.as_str() {
            name if name == "warnings" || name == "error" || name.ends_with('*') => continue,
            "zero_1_per_s" => summary["analysis"]["first_zero_per_s"].as_f64(),
            "contraction" => summary["second_order"]["contraction"].as_f64(),
            "tip_error" => summary["errors"]["tip"].as_f64(),
            "mesh_error" => Some(worst(&summary, "mesh")),
            "window_error" => Some(worst(&summary, "window")),
            "iteration_error" => Some(worst(&summary, "iteration")),
            name => {
                let (joint, key) = of_joint(name).unwrap();
                summary["results"]["joints"][joint][key].as_f64()
            }
        };
        match expected {
            // A joint without a drive has no motor.
            None => assert_eq!(field, "", "{name}"),
            Some(expected) => {
                let found: f64 = field.parse().unwrap();
                let off = (found - expected).abs();
                assert!(off <= tolerance * expected.abs(), "{name}: {found} is not {expected}");
            }
        }
        compared += 1;
    }
    assert_eq!(compared, 1 + 2 * 15 + 5);
}

#[test]
fn every_row_of_an_arm_holds_what_solve_finds_for_its_values() {
    let bench = bench();
    let vary = ["--vary", "links.*.segments.*.EI*=0.5,1,2", "--outputs", "all", "--every", "5"];
    swept(&bench, &vary);
    let rows = rows(&bench, "sweep.csv");
    let header = rows[0].join(",");
    let first = "links.*.segments.*.EI*,zero_1_per_s,peak_torque1_n_m,rms_torque1_n_m,\
                 peak_rigid_torque1_n_m,torque_ratio1,lead1_s,lag1_s,peak_hub_rate1_rad_s,\
                 peak_power1_w,peak_root_moment1_n_m,peak_deflection1_m,rms_power1_w,\
                 peak_motor_torque1_n_m,rms_motor_torque1_n_m,peak_motor_rate1_rad_s,peak_motor_power1_w,peak_torque2_n_m,";
    let last = ",peak_motor_power2_w,contraction,tip_error,mesh_error,window_error,\
                iteration_error,warnings,error";
    assert!(header.starts_with(first) && header.ends_with(last), "{header}");
    assert_eq!(rows.len(), 4);
    for (number, row) in rows.iter().enumerate().skip(1) {
        let set = format!("{}={}", rows[0][0], row[0]);
        solve(&bench, &["path.csv", "--set", &set, "--every", "5"]);
        // Twelve digits are written.
        assert_row(&bench, &rows[0], row, 1e-11);
        assert!(row[row.len() - 2].starts_with("limit_exceeded:joint1.torque"), "{row:?}");
        assert_eq!(row.last().unwrap(), "");
        assert!(bench.contents(&format!("all/{number}")) == bench.contents("out"), "{number}");
    }
}

#[test]
fn a_factor_on_the_duration_is_a_path_with_scaled_times() {
    let bench = bench();
    swept(&bench, &["--vary", "duration*=1,1.25", "--outputs", "all"]);
    let rows = rows(&bench, "sweep.csv");
    let scaled =
        bench.read("path.csv").lines().skip(1).fold("time,x,y\n".to_owned(), |text, row| {
            let (time, place) = row.split_once(',').unwrap();
            format!("{text}{:.5},{place}\n", 1.25 * time.parse::<f64>().unwrap())
        });
    bench.write("slow.csv", &scaled);
    solve(&bench, &["slow.csv"]);
    assert_row(&bench, &rows[0], &rows[2], 1e-6);
    let [fast, slow] = [1, 2].map(|row: usize| rows[row][8].parse::<f64>().unwrap());
    assert!(slow < 0.9 * fast, "{slow} {fast}");
    let shared = ["--vary", "duration*=1", "--scale-duration", "1.25", "-o", "shared.csv"];
    swept(&bench, &shared);
    assert_eq!(self::rows(&bench, "shared.csv")[1][1..], rows[2][1..]);
    // The record of the case has what `solve` takes for it.
    bench.done(&["solve", "--repeat", "all/2"]);
}

#[test]
fn a_case_of_an_arm_that_fails_says_why_and_shards_make_the_whole() {
    let bench = bench();
    std::fs::create_dir(bench.path("in")).unwrap();
    std::fs::rename(bench.path("path.csv"), bench.path("in/path.csv")).unwrap();
    let run = |options: &[&str]| {
        let vary = "links.fore.segments.0.length=0.6,0.1,-1";
        let arguments =
            ["sweep", "arm.toml", "in/path.csv", "--vary", vary, "--vary", "duration*=1,-1"];
        bench.done(&[&arguments, options].concat())
    };
    let output = run(&[]);
    let told = "warning: 5 of 6 cases failed, the first is case 2: ";
    assert!(stderr(&output).starts_with(told), "{}", stderr(&output));
    let rows = rows(&bench, "sweep.csv");
    let errors: Vec<&str> = rows[1..].iter().map(|row| row.last().unwrap().as_str()).collect();
    assert_eq!(errors[0], "");
    assert!(rows[1][2..].iter().filter(|field| field.is_empty()).count() == 5, "{:?}", rows[1]);
    assert!(errors[1].contains("above 0"), "{}", errors[1]);
    // The file without its folder, which may lie elsewhere on another machine.
    assert!(errors[2].starts_with("path.csv:2: the end of the second link = "), "{}", errors[2]);
    let short = "--vary 'links.fore.segments.0.length=-1': links.fore.segments.0.length = -1 m";
    assert!(errors[4].starts_with(short), "{}", errors[4]);
    assert!(rows[3][2..rows[3].len() - 1].iter().all(String::is_empty), "{:?}", rows[3]);
    for shard in ["1/2", "2/2"] {
        run(&["--shard", shard]);
    }
    let merge = ["sweep", "-o", "merged.csv", "--merge", "sweep-1-of-2.csv", "sweep-2-of-2.csv"];
    bench.done(&merge);
    assert!(bench.read("merged.csv") == bench.read("sweep.csv"));
    run(&["--shard", "1/2", "--resume"]);
}

#[test]
fn the_page_of_an_arms_sweep_has_a_figure_for_each_joint() {
    let bench = bench();
    let stiffness = ["--vary", "links.*.segments.*.EI*=1,4"];
    swept(&bench, &[&stiffness[..], &["--vary", "duration*=1,1.5"]].concat());
    let done = |arguments: &[&str]| {
        bench.done(arguments);
    };
    done(&["report", "sweep.csv", "-q", "--svg", "maps"]);
    let topics = ["deflection", "lag", "lead", "peak-torque", "torque-ratio"];
    let of_joints = |topic: &&str| [1, 2].map(|joint| format!("{topic}-joint-{joint}.svg"));
    let expected: Vec<String> = topics.iter().flat_map(of_joints).collect();
    assert_eq!(bench.names("maps"), expected);
    assert!(bench.read("maps/lead-joint-2.svg").contains("Lead, joint 2, over two values"));
    swept(&bench, &stiffness);
    done(&["report", "sweep.csv", "-q", "--svg", "lines"]);
    // The last point of the second joint is the last row's.
    let (svg, rows) = (bench.read("lines/peak-torque-joint-2.svg"), rows(&bench, "sweep.csv"));
    let column = rows[0].iter().position(|name| name == "peak_torque2_n_m").unwrap();
    let shown = super::report::points(&svg, "flexible");
    let (peak, last) = (rows[2][column].parse::<f64>().unwrap(), shown.last().unwrap().1);
    assert!((last - peak).abs() < 1e-3 * peak, "{last} {peak}");
    assert_eq!(super::report::points(&svg, "rigid").len(), 2);
    bench.write(
        "other.csv",
        &bench.read("sweep.csv").replace("peak_torque2_n_m", "peak_torque3_n_m"),
    );
    bench.ends(3, &["report", "other.csv"]);
}

/// A factor on the distance is a path to a nearer end, and a path beyond the reach fails its case.
#[test]
fn a_factor_on_the_distance_is_a_path_about_its_start() {
    let bench = bench();
    swept(&bench, &["--vary", "distance*=1,0.5,9"]);
    let rows = rows(&bench, "sweep.csv");
    solve(&bench, &["path.csv", "--scale-distance", "0.5"]);
    assert_row(&bench, &rows[0], &rows[2], 1e-9);
    assert!(rows[3].last().unwrap().contains("the arm does not reach"), "{:?}", rows[3]);
    let text = bench.read("path.csv");
    let numbers =
        |line: &str| -> Vec<f64> { line.split(',').map(|x| x.parse().unwrap()).collect() };
    let first = numbers(text.lines().nth(1).unwrap());
    let halved = text.lines().skip(1).map(|line| {
        let own = numbers(line);
        let at = |axis: usize| 0.5 * (own[axis] + first[axis]);
        format!("{},{},{}\n", own[0], at(1), at(2))
    });
    let nearer = "time,x,y\n".to_owned() + &halved.collect::<String>();
    bench.write("nearer.csv", &nearer);
    solve(&bench, &["nearer.csv"]);
    // Round-off moves the last digits of the errors.
    let expected = bench.json("out/summary.json");
    for joint in [1, 2] {
        let name = format!("peak_torque{joint}_n_m");
        let at = rows[0].iter().position(|own| *own == name).unwrap();
        let own: f64 = rows[2][at].parse().unwrap();
        let peak = expected["results"]["joints"][joint - 1]["peak_torque_n_m"].as_f64().unwrap();
        assert!((own / peak - 1.0).abs() < 1e-6, "{own} {peak}");
    }
    // A factor of 1 is no option at all.
    solve(&bench, &["path.csv"]);
    let torques = bench.read("out/torques.csv");
    solve(&bench, &["path.csv", "--scale-distance", "1"]);
    assert_eq!(bench.read("out/torques.csv"), torques);
}

/// Torques of the inversion lead the arm that they were solved for along its path, and a heavier one elsewhere.
#[test]
fn torques_played_on_cases_of_an_arm_miss_the_path_of_another_arm() {
    let bench = bench();
    let flat = ["--set", "gravity=[0, 0]"];
    solve(&bench, &[&["path.csv"], &flat[..]].concat());
    let played = ["--torque", "out/torques.csv", "--vary", "links.fore.payload.mass*=1,1.2"];
    swept(&bench, &[&played[..], &flat, &["--outputs", "cases"]].concat());
    let rows = rows(&bench, "sweep.csv");
    let at = |name: &str| rows[0].iter().position(|own| own == name).unwrap();
    let number = |row: usize, name: &str| -> f64 { rows[row][at(name)].parse().unwrap() };
    assert!(number(1, "tip_error_share") < 1e-5, "{:?}", rows[1]);
    assert!(number(2, "tip_error_share") > 1e-2, "{:?}", rows[2]);
    for (case, folder) in [(1, "cases/1"), (2, "cases/2")] {
        let summary = bench.json(&format!("{folder}/summary.json"));
        let is_in_row = |value: &serde_json::Value, name: &str| {
            let (own, other) = (value.as_f64().unwrap(), number(case, name));
            assert!((own - other).abs() <= 1e-9 * other.abs(), "{name}: {own} {other}");
        };
        is_in_row(&summary["tip_error"]["worst_m"], "tip_error_m");
        for joint in [1, 2] {
            let own = &summary["results"]["joints"][joint - 1]["peak_hub_rate_rad_s"];
            is_in_row(own, &format!("peak_hub_rate{joint}_rad_s"));
        }
    }
    bench.done(&["report", "sweep.csv", "-q"]);
    let torques =
        ["--torque", "out/torques.csv", "--column", "torque1", "--vary", "gravity=[0, 0]"];
    let refused = [&["sweep", "arm.toml", "path.csv"], &torques[..]].concat();
    bench.refuses(2, &refused, "--column names one column");
}
