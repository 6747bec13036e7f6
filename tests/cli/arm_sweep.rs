//! `sweep` of arms: rows as `solve` has them, scaled times, cases that fail, shards, refusals.

use super::arms::bench;
use super::{Bench, number};

#[track_caller]
fn swept(bench: &Bench, options: &str) {
    bench.done(&format!("sweep arm.toml path.csv {options}"));
}

#[track_caller]
fn solve(bench: &Bench, options: &str) {
    bench.done(&format!("solve arm.toml {options}"));
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
    assert_eq!(compared, 1 + 2 * 17 + 5);
}

#[test]
fn every_row_of_an_arm_holds_what_solve_finds_for_its_values() {
    let bench = bench();
    swept(&bench, "--vary links.*.segments.*.EI*=0.5,1,2 --outputs all --every 5");
    let rows = bench.rows("sweep.csv");
    let header = rows[0].join(",");
    let first = "links.*.segments.*.EI*,zero_1_per_s,peak_torque1_n_m,rms_torque1_n_m,\
                 peak_rigid_torque1_n_m,torque_ratio1,lead1_s,lag1_s,peak_hub_angle1_rad,peak_hub_rate1_rad_s,peak_hub_acceleration1_rad_s2,\
                 peak_power1_w,peak_root_moment1_n_m,peak_deflection1_m,rms_power1_w,\
                 peak_motor_torque1_n_m,rms_motor_torque1_n_m,peak_motor_rate1_rad_s,peak_motor_power1_w,peak_torque2_n_m,";
    let last = ",peak_motor_power2_w,contraction,tip_error,mesh_error,window_error,\
                iteration_error,warnings,error";
    assert!(header.starts_with(first) && header.ends_with(last), "{header}");
    assert_eq!(rows.len(), 4);
    for (number, row) in rows.iter().enumerate().skip(1) {
        solve(&bench, &format!("path.csv --set {}={} --every 5", rows[0][0], row[0]));
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
    swept(&bench, "--vary duration*=1,1.25 --outputs all");
    let rows = bench.rows("sweep.csv");
    bench.sampled("slow.csv", "time,x,y", 0..=500, |k| {
        let [time, x, y] = super::arms::path(k);
        [1.25 * time, x, y]
    });
    solve(&bench, "slow.csv");
    assert_row(&bench, &rows[0], &rows[2], 1e-6);
    let rates = bench.cells("sweep.csv", "peak_hub_rate1_rad_s");
    let [fast, slow] = [0, 1].map(|case: usize| rates[case].parse::<f64>().unwrap());
    assert!(slow < 0.9 * fast, "{slow} {fast}");
    swept(&bench, "--vary duration*=1 --scale-duration 1.25 -o shared.csv");
    assert_eq!(bench.rows("shared.csv")[1][1..], rows[2][1..]);
    // The record of the case has what `solve` takes for it.
    bench.done("solve --repeat all/2");
}

#[test]
fn a_case_of_an_arm_that_fails_says_why_and_shards_make_the_whole() {
    let bench = bench();
    std::fs::create_dir(bench.path("in")).unwrap();
    std::fs::rename(bench.path("path.csv"), bench.path("in/path.csv")).unwrap();
    let vary = "--vary links.fore.segments.0.length=0.6,0.1,-1 --vary duration*=1,-1";
    let run = |more: &str| bench.told(&format!("sweep arm.toml in/path.csv {vary} {more}"));
    let told = run("");
    let begins = "warning: 5 of 6 cases failed, the first is case 2: ";
    assert!(told.contains(begins), "{told}");
    assert!(told.contains("remark: 1 of 6 cases, the first is case 1: periods and"), "{told}");
    let rows = bench.rows("sweep.csv");
    let errors = bench.cells("sweep.csv", "error");
    assert_eq!(errors[0], "");
    assert!(rows[1][2..].iter().filter(|field| field.is_empty()).count() == 5, "{:?}", rows[1]);
    assert!(errors[1].contains("above 0"), "{}", errors[1]);
    // The file without its folder, which may lie elsewhere on another machine.
    assert!(errors[2].starts_with("path.csv:2: the end of the second link = "), "{}", errors[2]);
    let short = "--vary 'links.fore.segments.0.length=-1': links.fore.segments.0.length = -1 m";
    assert!(errors[4].starts_with(short), "{}", errors[4]);
    assert!(rows[3][2..rows[3].len() - 1].iter().all(String::is_empty), "{:?}", rows[3]);
    run("--shard 1/2");
    run("--shard 2/2");
    bench.done("sweep -o merged.csv --merge sweep-1-of-2.csv sweep-2-of-2.csv");
    assert!(bench.read("merged.csv") == bench.read("sweep.csv"));
    run("--shard 1/2 --resume");
}

#[test]
fn the_page_of_an_arms_sweep_has_a_figure_for_each_joint() {
    let bench = bench();
    let stiffness = "--vary links.*.segments.*.EI*=1,4";
    swept(&bench, &format!("{stiffness} --vary duration*=1,1.5"));
    bench.done("report sweep.csv -q --svg maps");
    let topics = [
        "lag",
        "lead",
        "peak-deflection",
        "peak-hub-rate",
        "peak-power",
        "peak-root-moment",
        "peak-torque",
        "torque-ratio",
    ];
    let of_joints = |topic: &&str| [1, 2].map(|joint| format!("{topic}-joint-{joint}.svg"));
    let mut expected: Vec<String> = topics.iter().flat_map(of_joints).collect();
    // The arm has limits, and a motor at its second joint.
    let of_motor = ["power", "rate", "torque"].map(|own| format!("peak-motor-{own}-joint-2.svg"));
    expected.extend(of_motor.into_iter().chain(["feasible.svg".to_owned()]));
    expected.sort();
    assert_eq!(bench.names("maps"), expected);
    assert!(bench.read("maps/lead-joint-2.svg").contains("Lead, joint 2, over two values"));
    // A limit of one joint hatches the map of this joint alone. So does that of all limits.
    let peak = bench.numbers("sweep.csv", "peak_hub_rate2_rad_s");
    let limit = 0.5 * (peak[0] + peak[1]);
    let limit = format!("--set links.fore.limits={{hub_rate={limit}}}");
    swept(&bench, &format!("{stiffness} --vary duration*=1,1.5 {limit}"));
    bench.done("report sweep.csv -q --svg maps");
    for (figure, is_hatched) in [("peak-hub-rate-joint-2", true), ("feasible", true)] {
        let svg = bench.read(&format!("maps/{figure}.svg"));
        assert_eq!(svg.contains("class=\"stripes\""), is_hatched, "{figure}");
    }
    assert!(!bench.read("maps/peak-hub-rate-joint-1.svg").contains("class=\"stripes\""));
    swept(&bench, stiffness);
    bench.done("report sweep.csv -q --svg lines");
    // The last point of the second joint is the last row's.
    let svg = bench.read("lines/peak-torque-joint-2.svg");
    let peak = bench.numbers("sweep.csv", "peak_torque2_n_m")[1];
    let last = super::report::points(&svg, "flexible").last().unwrap().1;
    assert!((last - peak).abs() < 1e-3 * peak, "{last} {peak}");
    assert_eq!(super::report::points(&svg, "rigid").len(), 2);
    let other = bench.read("sweep.csv").replace("peak_torque2_n_m", "peak_torque3_n_m");
    bench.write("other.csv", &other);
    bench.ends(3, "report other.csv");
}

/// A factor on the distance is a path to a nearer end, and a path beyond the reach fails its case.
#[test]
fn a_factor_on_the_distance_is_a_path_about_its_start() {
    let bench = bench();
    swept(&bench, "--vary distance*=1,0.5,9");
    let rows = bench.rows("sweep.csv");
    solve(&bench, "path.csv --scale-distance 0.5");
    assert_row(&bench, &rows[0], &rows[2], 1e-9);
    assert!(rows[3].last().unwrap().contains("the arm does not reach"), "{:?}", rows[3]);
    let [_, x_m, y_m] = super::arms::path(0.0);
    bench.sampled("nearer.csv", "time,x,y", 0..=500, |k| {
        let [time, x, y] = super::arms::path(k);
        [time, 0.5 * (x + x_m), 0.5 * (y + y_m)]
    });
    solve(&bench, "nearer.csv");
    // Round-off moves the last digits of the errors.
    for joint in [1, 2] {
        let own = bench.numbers("sweep.csv", &format!("peak_torque{joint}_n_m"))[1];
        let peak = bench.number("out", &format!("results/joints/{}/peak_torque_n_m", joint - 1));
        assert!((own / peak - 1.0).abs() < 1e-6, "{own} {peak}");
    }
    // A factor of 1 is no option at all.
    solve(&bench, "path.csv");
    let torques = bench.read("out/torques.csv");
    solve(&bench, "path.csv --scale-distance 1");
    assert_eq!(bench.read("out/torques.csv"), torques);
}

/// Torques of the inversion lead the arm that they were solved for along its path, and a heavier one elsewhere.
#[test]
fn torques_played_on_cases_of_an_arm_miss_the_path_of_another_arm() {
    let bench = bench();
    let flat = "--set gravity=[0,0]";
    solve(&bench, &format!("path.csv {flat}"));
    let played = "--torque out/torques.csv --vary links.fore.payload.mass*=1,1.2";
    swept(&bench, &format!("{played} {flat} --outputs cases"));
    let of = |name: &str| bench.numbers("sweep.csv", name);
    let shares = of("tip_error_share");
    assert!(shares[0] < 1e-5 && shares[1] > 1e-2, "{shares:?}");
    for case in [0, 1] {
        let summary = bench.json(&format!("cases/{}/summary.json", case + 1));
        for (path, name) in [
            ("tip_error/worst_m", "tip_error_m"),
            ("results/joints/0/peak_hub_rate_rad_s", "peak_hub_rate1_rad_s"),
            ("results/joints/1/peak_hub_rate_rad_s", "peak_hub_rate2_rad_s"),
        ] {
            let (own, other) = (number(&summary, path), of(name)[case]);
            assert!((own - other).abs() <= 1e-9 * other.abs(), "{name}: {own} {other}");
        }
    }
    bench.done("report sweep.csv -q");
    let torques = "--torque out/torques.csv --column torque1 --vary gravity=[0,0]";
    let refused = format!("sweep arm.toml path.csv {torques}");
    bench.refuses(2, &refused, "--column names one column");
}
