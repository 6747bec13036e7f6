//! Motions that repeat, and tips that move at their ends, on the command line.

use std::f64::consts::TAU;

use super::{Bench, column, stderr, stdout};

const STRIP: &str = "[[segments]]
length = 0.4
EI = 0.3
mass_per_length = 0.15
elements = 4
[hub]
inertia = 2e-3
viscous_friction = 1e-3
[payload]
mass = 0.05
[damping]
model = 'rayleigh'
beta = 1e-3
";

/// The link, a cycle of 80 rows, one that travels on, and one that passes by.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("strip.toml", STRIP);
    bench.sampled("cycle.csv", "time,displacement", 0..80, |k| {
        [0.0125 * k, 0.03 * (1.0 - (TAU * k / 80.0).cos())]
    });
    bench.sampled("turning.csv", "time,velocity", 0..80, |k| {
        [0.0125 * k, 0.2 + 0.1 * (TAU * k / 80.0).sin()]
    });
    bench.sampled("passing.csv", "time,velocity", 0..=160, |k| {
        let away = (k - 80.0) / 18.0;
        [0.0125 * k, 0.2 - 0.1 * (-away * away).exp()]
    });
    bench
}

/// By how far the tip strays in m, as `simulate` prints it.
#[track_caller]
fn strays_m(text: &str) -> f64 {
    let strays = text.lines().find_map(|line| line.strip_prefix("error    tip strays by up to "));
    strays.expect(text).split(' ').next().unwrap().parse().unwrap()
}

/// The torque of a cycle is played as a cycle, and misses the cycle of another link.
#[test]
fn a_sweep_plays_the_torque_of_a_cycle_as_a_cycle() {
    let bench = bench();
    bench.done("solve strip.toml cycle.csv --periodic -q");
    let played = "sweep strip.toml cycle.csv --periodic --torque out/torque.csv";
    bench.silent(&format!("{played} --vary payload.mass*=1,1.2"));
    let shares = bench.numbers("sweep.csv", "tip_error_share");
    assert!(shares[0] < 1e-5 && shares[1] > 1e-3, "{shares:?}");
}

#[test]
fn a_cycle_is_solved_told_verified_repeated_and_played() {
    let bench = bench();
    let text = bench.silent("solve strip.toml cycle.csv --periodic --report");
    assert!(text.contains("\nmotion   cycle of 0.06000 m in 1.000 s at 0.0125 s; peaks"), "{text}");
    assert!(text.contains("\ntiming   one cycle, which the torque repeats\n"), "{text}");
    assert!(text.contains("written  80 rows, ") && !text.contains("window"), "{text}");
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["motion"]["ends"], "periodic");
    assert!(summary["results"]["lead_s"].is_null() && summary["results"]["lag_s"].is_null());
    assert_eq!(bench.read("out/torque.csv").lines().count(), 81);
    // Wherever the cycle begins, the hub turns by the range of its angle.
    let angle = column(&bench, "out/hub_angle.csv", "hub_angle_rad");
    let [low, high] = [f64::min, f64::max].map(|of| angle.iter().copied().reduce(of).unwrap());
    let turns = bench.number("out", "results/peak_hub_angle_rad");
    assert!((turns / (high - low) - 1.0).abs() < 1e-3, "{turns} of {low} … {high}");
    // Nor does it matter where the samples lie: twelve a cycle, with the ends of the motion on them and between them.
    let turns = [0.0, 0.25, 0.5].map(|phase| {
        bench.sampled("few.csv", "time,displacement", 0..12, |k| {
            [k / 12.0, 0.03 * (1.0 - (TAU * (k + phase) / 12.0).cos())]
        });
        bench.run("solve strip.toml few.csv --periodic --json -o few");
        bench.number("few", "results/peak_hub_angle_rad")
    });
    let alike = |other: f64| (other / turns[0] - 1.0).abs() < 1e-2;
    assert!(turns.into_iter().all(alike), "{turns:?}");
    let page = bench.read("out/report.html");
    assert!(page.contains("This is one cycle, which the torque repeats."));
    assert!(page.contains("it is played from rest, where this motion does not begin"));
    bench.done("solve --repeat out -o again");
    assert_eq!(bench.read("again/torque.csv"), bench.read("out/torque.csv"));
    let verified = bench.printed("verify strip.toml cycle.csv --periodic");
    assert!(!verified.contains("not made"), "{verified}");
    let played = "simulate strip.toml out/torque.csv --target out/tip.csv";
    let text = bench.silent(&format!("{played} --periodic"));
    assert!(!text.contains("\nafter ") && !text.contains("\ndecay "), "{text}");
    assert!(strays_m(&text) < 1e-6 * 0.06, "{text}");
    // From rest the same torque leads elsewhere.
    let resting = stdout(&bench.run(played));
    assert!(resting.contains("\nafter ") && resting.contains("error    tip strays"), "{resting}");
}

#[test]
fn a_cycle_of_the_hub_moves_the_tip_and_verifies_a_link_under_gravity() {
    let bench = bench();
    let weight = "--periodic --set gravity=[0,-9.81] --set start_angle=-1";
    for of_link in ["--periodic", weight] {
        bench.done(&format!("solve strip.toml cycle.csv {of_link}"));
        let play = "simulate strip.toml out/hub_angle.csv --target out/tip.csv --input hub-angle";
        let text = stdout(&bench.run(&format!("{play} {of_link}")));
        assert!(strays_m(&text) < 1e-5 * 0.06, "{text}");
    }
    let text = bench.printed(&format!("verify strip.toml cycle.csv {weight}"));
    assert!(text.contains("tip, the hub moved as solved") && !text.contains("not made"), "{text}");
    // Friction holds the mean of a torque that pushes one way.
    bench.write("push.csv", "time,torque\n0,1\n0.1,0\n0.2,0\n0.3,0\n0.4,0\n");
    bench.done("simulate strip.toml push.csv --periodic");
}

#[test]
fn a_sweep_has_no_lead_of_a_cycle() {
    let bench = bench();
    bench.done("sweep strip.toml turning.csv --vary payload.mass=0.02,0.05 --periodic");
    assert_eq!(bench.cells("sweep.csv", "lead_s"), ["", ""]);
}

#[test]
fn a_velocity_column_says_that_the_tip_moves_on() {
    let bench = bench();
    let output = bench.run("solve strip.toml passing.csv");
    let text = stdout(&output);
    assert!(text.contains(" of it at changing velocity, at 0.0125 s;\n"), "{text}");
    assert!(text.contains("\n         from 0.200 to 0.200 m/s; peaks"), "{text}");
    let remark = "remark: the tip moves at 0.200 m/s before its motion and at 0.200 m/s after";
    assert!(stderr(&output).contains(remark), "{}", stderr(&output));
    let asked = bench.run("solve strip.toml passing.csv --moving-ends");
    assert!(!stderr(&asked).contains("remark"), "{}", stderr(&asked));
    assert_eq!(stdout(&asked), text);
    let cycle = stdout(&bench.run("solve strip.toml turning.csv --periodic"));
    assert!(cycle.contains("\nmotion   cycle that leads on by 0.2000 m in 1.000 s"), "{cycle}");
}
