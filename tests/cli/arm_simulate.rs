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

/// A rig's table: the run's joint 2 in degrees and y of its tip, a row late, and 1.1 times the torque of joint 1.
#[test]
fn a_recording_of_an_arm_is_compared_channel_by_channel() {
    let bench = solved("--digits full");
    let of = |file: &str, name: &str| column(&bench, &format!("out/{file}"), name);
    let times = of("torques.csv", "time_s");
    let (angles, torques) =
        (of("joint_angles.csv", "joint2_rad"), of("torques.csv", "torque1_n_m"));
    let places = of("tip.csv", "y_m");
    let late = |k: usize| k.saturating_sub(1);
    let rows = times.iter().zip(&torques).enumerate().map(|(k, (time, torque))| {
        let angle = angles[late(k)].to_degrees();
        format!("{time},{angle},{},{},0\n", 1.1 * torque, places[late(k)])
    });
    let rows: String = rows.collect();
    bench.write("rig.csv", &format!("time,joint2 [deg],torque1,y,joint3\n{rows}"));
    let play = "simulate arm.toml out/joint_angles.csv --input hub-angle";
    let output = bench.run(&format!("{play} --measured rig.csv"));
    assert!(stderr(&output).contains("columns not read: 5 \"joint3\""), "{}", stderr(&output));
    assert!(stdout(&output).contains("\ny "), "{}", stdout(&output));
    let step_s = times[1] - times[0];
    let summary = bench.json("simulated/summary.json");
    for (number, (name, late, gain)) in
        [("y", 1.0, 1.0), ("joint2", 1.0, 1.0), ("torque1", 0.0, 1.1)].iter().enumerate()
    {
        let channel = &summary["measured"]["channels"][number];
        assert_eq!(channel["channel"], *name);
        let [delay_s, fitted, left] =
            ["delay_s", "gain", "left"].map(|key| channel["fit"][key].as_f64().unwrap());
        assert!((delay_s / step_s - late).abs() < 1e-3, "{name}: {delay_s} s");
        assert!((fitted / gain - 1.0).abs() < 1e-4 && left < 1e-3, "{name}: {channel}");
    }
    bench.write("rig.csv", "time,hub_angle\n0,0\n1,0\n");
    let refused = format!("{play} --measured rig.csv -o other");
    bench.refuses(3, &refused, "must include one of x, y, joint1, joint2, joint1_rate");
}

/// A circle of the tip that repeats: verified by joints that move cycle after cycle, and played with feedback.
#[test]
fn a_cycle_of_an_arm_is_solved_verified_and_played() {
    let bench = bench();
    let row = |k: u32| {
        let turn = std::f64::consts::TAU * f64::from(k) / 100.0;
        let (x, y) = (0.8 + 0.1 * turn.cos(), 0.1 * turn.sin() - 0.1);
        format!("{:.2},{x:.15},{y:.15}\n", 0.01 * f64::from(k))
    };
    let rows: String = (0..100).map(row).collect();
    bench.write("circle.csv", &format!("time,x,y\n{rows}"));
    let arm = "arm.toml --set links.*.damping.beta=2e-3 --set links.upper.limits.torque=20";
    let output = bench.done(&format!("solve {arm} circle.csv --periodic --verify"));
    let text = stdout(&output);
    let line = "path     of the tip, one cycle of 1.000 s at 0.01000 s;\n         the tip moves by 0.2000 m; up";
    assert!(text.contains(line) && text.contains("one cycle, which the torque repeats"), "{text}");
    assert!(!text.contains("torque at rest"), "{text}");
    assert_eq!(bench.json("out/summary.json")["motion"]["ends"], "periodic");
    let feedback = "--feedback 50,1 --reference out/joint_angles.csv";
    let played = bench.done(&format!("simulate {arm} out/torques.csv --periodic {feedback}"));
    assert!(!stdout(&played).contains("hold it where it starts"), "{}", stdout(&played));
    for name in ["x_m", "y_m"] {
        let [own, wanted] =
            ["simulated", "out"].map(|run| column(&bench, &format!("{run}/tip.csv"), name));
        let off = own.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(own.len() == 100 && off < 1e-6, "{name}: {off:e}");
    }
}
