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
