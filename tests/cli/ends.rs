//! Motions that repeat, and tips that move at their ends, on the command line.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::{Bench, column, json_of, stderr, stdout};

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

/// The link, a cycle of 80 rows, one with its first row again, and one that travels on.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("strip.toml", STRIP);
    let row = |k: u32| 0.03 * (1.0 - (TAU * f64::from(k) / 80.0).cos());
    let table = |rows: u32| {
        (0..rows).fold("time,displacement\n".to_owned(), |mut table, k| {
            let _ = writeln!(table, "{},{}", 0.0125 * f64::from(k), row(k));
            table
        })
    };
    bench.write("cycle.csv", &table(80));
    bench.write("again.csv", &table(81));
    let turning = (0..80).fold("time,velocity\n".to_owned(), |mut table, k| {
        let share = TAU * f64::from(k) / 80.0;
        let _ = writeln!(table, "{},{}", 0.0125 * f64::from(k), 0.2 + 0.1 * share.sin());
        table
    });
    bench.write("turning.csv", &turning);
    let passing = (0..=160).fold("time,velocity\n".to_owned(), |mut table, k| {
        let away = (f64::from(k) - 80.0) / 18.0;
        let _ = writeln!(table, "{},{}", 0.0125 * f64::from(k), 0.2 - 0.1 * (-away * away).exp());
        table
    });
    bench.write("passing.csv", &passing);
    bench
}

#[test]
fn a_cycle_is_solved_told_verified_repeated_and_played() {
    let bench = bench();
    let output = bench.silent(&["solve", "strip.toml", "cycle.csv", "--periodic", "--report"]);
    let text = stdout(&output);
    assert!(text.contains("\nmotion   cycle of 0.06000 m in 1.000 s at 0.0125 s; peaks"), "{text}");
    assert!(text.contains("\ntiming   one cycle, which the torque repeats\n"), "{text}");
    assert!(text.contains("written  80 rows, ") && !text.contains("window"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["motion"]["ends"], "periodic");
    assert!(summary["results"]["lead_s"].is_null() && summary["results"]["lag_s"].is_null());
    assert_eq!(bench.read("out/torque.csv").lines().count(), 81);
    // Wherever the cycle begins, the hub turns by the range of its angle.
    let angle = column(&bench, "out/hub_angle.csv", "hub_angle_rad");
    let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|of| angle.iter().copied().reduce(of).unwrap());
    let turns = summary["results"]["peak_hub_angle_rad"].as_f64().unwrap();
    assert!((turns / (high - low) - 1.0).abs() < 1e-3, "{turns} of {low} … {high}");
    // Nor does it matter where the samples lie: twelve a cycle, with the ends of the motion on them and between them.
    let turns = [0.0, 0.25, 0.5].map(|phase| {
        let row = |k: u32| {
            let displacement = 0.03 * (1.0 - (TAU * (f64::from(k) + phase) / 12.0).cos());
            format!("{:.12},{displacement}\n", f64::from(k) / 12.0)
        };
        bench.write(
            "few.csv",
            &format!("time,displacement\n{}", (0..12).map(row).collect::<String>()),
        );
        let output =
            bench.run(&["solve", "strip.toml", "few.csv", "--periodic", "--json", "-o", "few"]);
        let json = json_of(&output);
        json["results"]["peak_hub_angle_rad"].as_f64().unwrap()
    });
    let alike = |other: f64| (other / turns[0] - 1.0).abs() < 1e-2;
    assert!(turns.into_iter().all(alike), "{turns:?}");
    let page = bench.read("out/report.html");
    assert!(page.contains("This is one cycle, which the torque repeats."));
    assert!(page.contains("it is played from rest, where this motion does not begin"));
    bench.done(&["solve", "--repeat", "out", "-o", "again"]);
    assert_eq!(bench.read("again/torque.csv"), bench.read("out/torque.csv"));
    let verified = bench.done(&["verify", "strip.toml", "cycle.csv", "--periodic"]);
    assert!(!stdout(&verified).contains("not made"), "{}", stdout(&verified));
    let played = ["simulate", "strip.toml", "out/torque.csv", "--target", "out/tip.csv"];
    let text = stdout(&bench.silent(&[&played[..], &["--periodic"]].concat()));
    assert!(!text.contains("\nafter ") && !text.contains("\ndecay "), "{text}");
    let strays = text.lines().find_map(|line| line.strip_prefix("error    tip strays by up to "));
    let strays_m: f64 = strays.unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(strays_m < 1e-6 * 0.06, "{text}");
    // From rest the same torque leads elsewhere.
    let resting = stdout(&bench.run(&played));
    assert!(resting.contains("\nafter ") && resting.contains("error    tip strays"), "{resting}");
}

#[test]
fn a_cycle_of_the_hub_moves_the_tip_and_verifies_a_link_under_gravity() {
    let bench = bench();
    let weight = ["--set", "gravity=[0, -9.81]", "--set", "start_angle=-1"];
    for of_link in [&[][..], &weight] {
        let solve = [&["solve", "strip.toml", "cycle.csv", "--periodic"], of_link].concat();
        bench.done(&solve);
        let play = ["simulate", "strip.toml", "out/hub_angle.csv", "--target", "out/tip.csv"];
        let cycle = ["--input", "hub-angle", "--periodic"];
        let text = stdout(&bench.run(&[&play[..], &cycle, of_link].concat()));
        let strays =
            text.lines().find_map(|line| line.strip_prefix("error    tip strays by up to "));
        let strays_m: f64 = strays.unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(strays_m < 1e-5 * 0.06, "{text}");
    }
    let verify = [&["verify", "strip.toml", "cycle.csv", "--periodic"], &weight[..]].concat();
    let output = bench.done(&verify);
    assert!(
        stdout(&output).contains("tip, the hub moved as solved")
            && !stdout(&output).contains("not made")
    );
    // Friction holds the mean of a torque that pushes one way.
    bench.write("push.csv", "time,torque\n0,1\n0.1,0\n0.2,0\n0.3,0\n0.4,0\n");
    bench.done(&["simulate", "strip.toml", "push.csv", "--periodic"]);
}

#[test]
fn a_sweep_has_no_lead_of_a_cycle() {
    let bench = bench();
    let vary = ["--vary", "payload.mass=0.02,0.05", "--periodic"];
    bench.done(&[&["sweep", "strip.toml", "turning.csv"], &vary[..]].concat());
    let table = bench.read("sweep.csv");
    let mut rows = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    let lead = names.iter().position(|name| *name == "lead_s").unwrap();
    let rows: Vec<Vec<&str>> = rows.map(|row| row.split(',').collect()).collect();
    assert!(rows.len() == 2 && rows.iter().all(|row| row[lead].is_empty()), "{table}");
}

#[test]
fn a_velocity_column_says_that_the_tip_moves_on() {
    let bench = bench();
    let output = bench.run(&["solve", "strip.toml", "passing.csv"]);
    let text = stdout(&output);
    assert!(text.contains(" of it at changing velocity, at 0.0125 s;\n"), "{text}");
    assert!(text.contains("\n         from 0.200 to 0.200 m/s; peaks"), "{text}");
    let remark = "remark: the tip moves at 0.200 m/s before its motion and at 0.200 m/s after";
    assert!(stderr(&output).contains(remark), "{}", stderr(&output));
    let asked = bench.run(&["solve", "strip.toml", "passing.csv", "--moving-ends"]);
    assert!(!stderr(&asked).contains("remark"), "{}", stderr(&asked));
    assert_eq!(stdout(&asked), text);
    let cycle = stdout(&bench.run(&["solve", "strip.toml", "turning.csv", "--periodic"]));
    assert!(cycle.contains("\nmotion   cycle that leads on by 0.2000 m in 1.000 s"), "{cycle}");
}
