//! The files of `solve`: names, headings, rows.

use super::{Bench, LINK, MOTION, repository};

const ALWAYS: [&str; 7] = [
    "hub_angle.csv",
    "nodal_displacements.csv",
    "nodes.csv",
    "rigid_torque.csv",
    "summary.json",
    "tip.csv",
    "torque.csv",
];

fn header(bench: &Bench, name: &str) -> String {
    bench.read(name).lines().next().unwrap().to_owned()
}

#[test]
fn every_file_appears_with_the_headings_of_the_interface() {
    let bench = Bench::new();
    bench.solve(&["--deflections", "--moments"]);
    let mut names = [&ALWAYS[..], &["bending_moments.csv", "nodal_deflections.csv"]].concat();
    names.sort_unstable();
    assert_eq!(bench.names("out"), names);
    let nodes = |letter: &str, unit: &str| {
        let columns: Vec<String> = (0..=10).map(|k| format!("{letter}{k}_{unit}")).collect();
        format!("time_s,{}", columns.join(","))
    };
    for (name, expected) in [
        ("torque.csv", "time_s,torque_n_m".to_owned()),
        ("rigid_torque.csv", "time_s,rigid_torque_n_m".to_owned()),
        (
            "hub_angle.csv",
            "time_s,hub_angle_rad,hub_rate_rad_s,hub_acceleration_rad_s2,rigid_hub_angle_rad"
                .to_owned(),
        ),
        ("nodal_displacements.csv", nodes("v", "m")),
        ("nodal_deflections.csv", nodes("w", "m")),
        ("bending_moments.csv", nodes("m", "n_m")),
        ("tip.csv", "time_s,tip_displacement_m,tip_velocity_m_s,tip_acceleration_m_s2".to_owned()),
        ("nodes.csv", "node,x_m,segment".to_owned()),
    ] {
        assert_eq!(header(&bench, &format!("out/{name}")), expected);
    }
}

#[test]
fn without_options_the_optional_tables_are_left_out() {
    let bench = Bench::new();
    bench.solve(&["-o", "a/b"]);
    assert_eq!(bench.names("a/b"), ALWAYS);
    assert_eq!(bench.names("."), ["a"]);
}

#[test]
fn a_run_without_moments_removes_those_of_the_run_before_and_nothing_else() {
    let bench = Bench::new();
    bench.solve(&["--moments"]);
    bench.write("out/notes.txt", "mine");
    assert!(bench.path("out/bending_moments.csv").exists());
    bench.solve(&[]);
    assert!(!bench.path("out/bending_moments.csv").exists());
    assert_eq!(bench.read("out/notes.txt"), "mine");
}

#[test]
fn all_histories_stand_on_one_uniform_grid_that_holds_the_trajectorys_samples() {
    let bench = Bench::new();
    bench.solve(&[]);
    let times = |name: &str| bench.table(&format!("out/{name}")).swap_remove(0).1;
    let time = times("torque.csv");
    for name in ["rigid_torque.csv", "hub_angle.csv", "tip.csv", "nodal_displacements.csv"] {
        assert!(times(name) == time, "{name}");
    }
    let zero = time.iter().position(|t| t.abs() < 1e-15).unwrap();
    for (k, t) in time.iter().enumerate() {
        assert!((t - (k as f64 - zero as f64) * 1e-3).abs() < 1e-12, "row {k}: {t}");
    }
    assert!(zero > 300 && time[time.len() - 1] > 1.18, "lead and lag");
}

#[test]
fn nodes_are_listed_with_the_segment_that_ends_there() {
    let bench = Bench::new();
    bench.solve(&[]);
    let text = bench.read("out/nodes.csv");
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|row| row.split(',').collect()).collect();
    assert_eq!(rows.len(), 11);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row[0], k.to_string());
        assert!((row[1].parse::<f64>().unwrap() - 0.15 * k as f64).abs() < 1e-9);
        assert_eq!(row[2], if k < 2 { "root" } else { "beam" });
    }
}

#[test]
fn a_segment_without_a_name_is_listed_by_its_number() {
    let bench = Bench::new();
    bench.write("link.toml", "segments = [{ length = 1, EI = 5, mass_per_length = 0.8 }]");
    bench.done(&["solve", "link.toml", &repository(MOTION), "--set", "mesh.elements=2"]);
    let text = bench.read("out/nodes.csv");
    assert!(text.lines().skip(1).all(|row| row.ends_with(",0")), "{text}");
}

#[test]
fn numbers_have_fixed_decimals_and_no_negative_zero() {
    let bench = Bench::new();
    bench.solve(&["--moments", "--deflections"]);
    let tables = bench.contents("out").into_iter();
    for (name, text) in tables.filter(|(name, _)| name != "summary.json" && name != "nodes.csv") {
        let decimals = |row: &str| -> Vec<usize> {
            let fields = row.split(',');
            fields.map(|field| field.split_once('.').map_or(0, |(_, d)| d.len())).collect()
        };
        let expected = decimals(text.lines().nth(1).unwrap());
        for row in text.lines().skip(1) {
            assert_eq!(decimals(row), expected, "{name}: {row}");
            for field in row.split(',') {
                let zero = field.chars().all(|c| "-0.".contains(c));
                let negative_zero = zero && field.starts_with('-');
                assert!(!negative_zero && !field.contains('e'), "{name}: {row}");
            }
        }
    }
}

#[test]
fn the_tip_of_the_table_is_the_tip_of_the_last_node_and_rests_at_both_ends() {
    let bench = Bench::new();
    bench.solve(&[]);
    let tip = bench.table("out/tip.csv").swap_remove(1);
    let last = bench.table("out/nodal_displacements.csv").swap_remove(11);
    assert_eq!((tip.0.as_str(), last.0.as_str()), ("tip_displacement_m", "v10_m"));
    for (a, b) in tip.1.iter().zip(&last.1) {
        assert!((a - b).abs() < 1e-9);
    }
    let end = tip.1[tip.1.len() - 1];
    assert!(tip.1[0].abs() < 1e-9 && (end - 0.5).abs() < 1e-5, "{end}");
}

/// Largest difference of two torques over the peak, the first window inside the second.
fn torque_difference(bench: &Bench, first: &str, second: &str) -> f64 {
    let table = |folder: &str| bench.table(&format!("{folder}/torque.csv"));
    let (first, second) = (table(first), table(second));
    let is_start = |t: &f64| (t - first[0].1[0]).abs() < 1e-9;
    let start = second[0].1.iter().position(is_start).unwrap();
    let pairs = first[1].1.iter().zip(&second[1].1[start..]);
    assert!(pairs.len() == first[1].1.len(), "the window is covered");
    let peak = first[1].1.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / peak
}

/// The tip as written holds more rest than the trajectory, so that the period is longer. Without
/// damping the torque decays so fast that this does not matter; the tail of hysteretic damping
/// does, below the tolerance of 1e-6.
#[test]
fn the_tip_written_is_accepted_as_a_motion_and_needs_the_same_torque() {
    let bench = Bench::new();
    let link = repository(LINK);
    for (damping, allowed) in [("damping={ model = \"none\" }", 1e-8), ("damping.ratio=0.02", 1e-6)]
    {
        for digits in ["10", "full"] {
            // A roll-off of what is rolled off already would take some of it away once more.
            let whole = "analysis.tip_tolerance=0";
            let fine = "segments.*.elements=40";
            let options = ["--set", damping, "--digits", digits, "--set", whole, "--set", fine];
            bench.solve(&[&["-o", "first"], &options[..]].concat());
            let again = ["solve", &link, "first/tip.csv", "-o", "second"];
            bench.silent(&[&again[..], &options[..]].concat());
            let difference = torque_difference(&bench, "first", "second");
            assert!(difference < allowed, "{damping}, {digits}: {difference:e} of the peak");
        }
    }
}
