//! `simulate` of arms on the command line: torques played, where the arm starts, states, refusals.

use super::arms::bench;
use super::{Bench, apart, column, number, peak, stderr, stdout};

/// Solves the line of the arm in these tests.
fn solved(options: &str) -> Bench {
    let bench = bench();
    bench.done(&format!("solve arm.toml path.csv {options}"));
    bench
}

#[test]
fn torques_of_an_arm_are_played_with_feedback_and_written() {
    let bench = solved("");
    let play = "simulate arm.toml out/torques.csv --target out/tip.csv --feedback 50,1 \
                --reference out/joint_angles.csv";
    let output = bench.done(play);
    let exceeded = "warning: joint 1: limits.torque = 5 N m is exceeded at the joint: ";
    assert!(stderr(&output).starts_with(exceeded), "{}", stderr(&output));
    let text = stdout(&output);
    for begins in
        ["arm      2 links, 1.300 m", "feedback 50.00 N m/rad, 1.000 N m s/rad", "joint 2  peak "]
    {
        assert!(text.lines().any(|line| line.starts_with(begins)), "{text}");
    }
    let summary = bench.json("simulated/summary.json");
    assert_eq!(summary["warnings"][0]["kind"], "limit_exceeded");
    assert!(number(&summary, "tip_error/share") < 1e-6, "{}", summary["tip_error"]);
    assert!(number(&summary, "errors/energy") < 1e-6);
    let of =
        |folder: &str, file: &str, name: &str| column(&bench, &format!("{folder}/{file}"), name);
    for (file, name) in [
        ("torques.csv", "torque2_n_m"),
        ("joint_angles.csv", "joint2_rad"),
        ("chord_angles.csv", "angle1_rad"),
        ("nodal_positions.csv", "y2_1_m"),
    ] {
        let (own, solved) = (of("simulated", file, name), of("out", file, name));
        let off = apart(&own, &solved);
        assert!(off < 2e-5 * peak(&solved), "{off:e} of {:e}: {name}", peak(&solved));
    }
    assert_eq!(of("simulated", "tip_error.csv", "wanted_y_m"), of("out", "tip.csv", "y_m"));
    let worst = peak(&of("simulated", "tip_error.csv", "tip_error_m"));
    assert!((worst / number(&summary, "tip_error/worst_m") - 1.0).abs() < 1e-6, "{worst:e}");
    bench.refuses(2, &format!("{play} -o all --nodes 999"), "--nodes = 999, but must name");
    bench.done("report simulated -q");
    let page = bench.read("simulated/report.html");
    assert!(page.contains("bending moments, since a simulation does not write them"));
    for line in ["wanted x", "wanted y", "distance"] {
        assert!(page.contains(&format!("data-name=\"{line}\"")), "{line}");
    }
}

#[test]
fn an_arm_starts_where_it_is_told_and_goes_on_from_a_state() {
    let still = "--set gravity=[0,0]";
    let bench = solved(still);
    let play = format!("simulate arm.toml out/torques.csv {still}");
    bench.silent(&format!("{play} --target out/tip.csv -o whole"));
    let [first, second] =
        ["angle1_rad", "angle2_rad"].map(|name| column(&bench, "out/chord_angles.csv", name)[0]);
    bench.silent(&format!("{play} --at {first},{second} -o posed --save-state end.json"));
    let of = |run: &str, axis: &str| column(&bench, &format!("{run}/tip.csv"), axis);
    for axis in ["x_m", "y_m"] {
        assert!(apart(&of("whole", axis), &of("posed", axis)) < 1e-8, "{axis}");
    }
    // From the state at its end the arm rests where it is.
    bench.write("none.csv", "time,torque1,torque2\n2,0,0\n2.1,0,0\n2.2,0,0\n2.3,0,0\n");
    bench.done(&format!("simulate arm.toml none.csv --state end.json -o on {still}"));
    let ends = ["posed", "on"].map(|run| *of(run, "x_m").last().unwrap());
    assert!((ends[0] - ends[1]).abs() < 1e-6, "{ends:?}");
}

#[test]
fn torques_that_do_not_hold_the_arm_where_it_starts_are_warned_of() {
    let bench = bench();
    bench.write("none.csv", "time,torque1,torque2\n0,0,0\n0.01,0,0\n0.02,0,0\n0.03,0,0\n");
    let told = stderr(&bench.run("simulate arm.toml none.csv --at 0,1"));
    let begins = "warning: torque1 begins with 0.0 N m, but 11.0824 N m hold the arm";
    assert!(told.starts_with(begins), "{told}");
}

/// The torques that moved joints take are those of the inversion, by equations that share nothing with it.
#[test]
fn joints_moved_as_solved_take_the_solved_torques() {
    let bench = solved("");
    let moved = "simulate arm.toml out/joint_angles.csv --input hub-angle";
    let text = stdout(&bench.run(&format!("{moved} --target out/tip.csv")));
    assert!(text.lines().any(|line| line.starts_with("input    joint angles")), "{text}");
    let summary = bench.json("simulated/summary.json");
    assert!(summary["joint_angles"]["samples"].as_u64().unwrap() > 100);
    assert!(number(&summary, "tip_error/share") < 1e-4, "{}", summary["tip_error"]);
    for name in ["torque1_n_m", "torque2_n_m"] {
        let [own, solved] = ["simulated", "out"]
            .map(|folder| column(&bench, &format!("{folder}/torques.csv"), name));
        let [low, high] = [f64::min, f64::max].map(|of| solved.iter().copied().reduce(of).unwrap());
        assert!(apart(&own, &solved) < 1e-3 * (high - low), "{name}");
    }
    bench.done("report simulated -q");
    bench.refuses(2, &format!("{moved} --at 0,1"), "--input = hub-angle, but must be");
    bench.refuses(3, "simulate arm.toml out/tip.csv --input hub-angle", "joint1");
}
