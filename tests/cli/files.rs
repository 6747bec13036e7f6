//! The files of `solve`: names, headings, rows.

use super::{Bench, LINK, MOTION, apart, column, peak};

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
    bench.solve("--deflections --moments");
    let mut names = [&ALWAYS[..], &["bending_moments.csv", "nodal_deflections.csv"]].concat();
    names.sort_unstable();
    assert_eq!(bench.names("out"), names);
    let nodes = |letter: &str, unit: &str| {
        let columns: Vec<String> = (0..=10).map(|k| format!("{letter}{k}_{unit}")).collect();
        columns.join(",")
    };
    for (name, columns) in [
        ("torque", "torque_n_m"),
        ("rigid_torque", "rigid_torque_n_m"),
        ("hub_angle", "hub_angle_rad,hub_rate_rad_s,hub_acceleration_rad_s2,rigid_hub_angle_rad"),
        ("nodal_displacements", &nodes("v", "m")),
        ("nodal_deflections", &nodes("w", "m")),
        ("bending_moments", &nodes("m", "n_m")),
        ("tip", "tip_displacement_m,tip_velocity_m_s,tip_acceleration_m_s2"),
    ] {
        assert_eq!(header(&bench, &format!("out/{name}.csv")), format!("time_s,{columns}"));
    }
    assert_eq!(header(&bench, "out/nodes.csv"), "node,x_m,segment");
    // Numbers have fixed decimals and no negative zero.
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
fn a_run_without_moments_removes_those_of_the_run_before_and_nothing_else() {
    let bench = Bench::new();
    bench.solve("-o a/b --moments");
    bench.write("a/b/notes.txt", "mine");
    assert!(bench.path("a/b/bending_moments.csv").exists());
    bench.solve("-o a/b");
    assert_eq!(bench.read("a/b/notes.txt"), "mine");
    std::fs::remove_file(bench.path("a/b/notes.txt")).unwrap();
    assert_eq!(
        (bench.names("a/b").as_slice(), bench.names(".")),
        (&ALWAYS.map(str::to_owned)[..], vec!["a".into()])
    );
}

#[test]
fn all_histories_stand_on_one_uniform_grid_that_holds_the_trajectorys_samples() {
    let bench = Bench::new();
    bench.solve("");
    let times = |name: &str| column(&bench, &format!("out/{name}.csv"), "time_s");
    let time = times("torque");
    for name in ["rigid_torque", "hub_angle", "tip", "nodal_displacements"] {
        assert!(times(name) == time, "{name}");
    }
    let zero = time.iter().position(|t| t.abs() < 1e-15).unwrap();
    for (k, t) in time.iter().enumerate() {
        assert!((t - (k as f64 - zero as f64) * 1e-3).abs() < 1e-12, "row {k}: {t}");
    }
    assert!(zero > 300 && time[time.len() - 1] > 1.18, "lead and lag");
    // The tip of the table is that of the last node, and rests at both ends.
    let tip = column(&bench, "out/tip.csv", "tip_displacement_m");
    assert!(apart(&tip, &column(&bench, "out/nodal_displacements.csv", "v10_m")) < 1e-9);
    let end = tip[tip.len() - 1];
    assert!(tip[0].abs() < 1e-9 && (end - 0.5).abs() < 1e-5, "{end}");
}

#[test]
fn nodes_are_listed_with_the_segment_that_ends_there_or_its_number() {
    let bench = Bench::new();
    bench.solve("");
    let rows = bench.rows("out/nodes.csv");
    assert_eq!(rows.len(), 12);
    for (k, row) in rows[1..].iter().enumerate() {
        assert_eq!(row[0], k.to_string());
        assert!((row[1].parse::<f64>().unwrap() - 0.15 * k as f64).abs() < 1e-9);
        assert_eq!(row[2], if k < 2 { "root" } else { "beam" });
    }
    bench.write("link.toml", "segments = [{ length = 1, EI = 5, mass_per_length = 0.8 }]");
    bench.done(&format!("solve link.toml {MOTION} --set mesh.elements=2"));
    assert_eq!(bench.cells("out/nodes.csv", "segment"), ["0"; 3]);
}

/// Largest difference of two torques over the peak, the first window inside the second.
fn torque_difference(bench: &Bench, first: &str, second: &str) -> f64 {
    let of = |folder: &str, name: &str| column(bench, &format!("{folder}/torque.csv"), name);
    let (begins, torque) = (of(first, "time_s")[0], of(first, "torque_n_m"));
    let start = of(second, "time_s").iter().position(|t| (t - begins).abs() < 1e-9).unwrap();
    let covered = &of(second, "torque_n_m")[start..][..torque.len()];
    apart(&torque, covered) / peak(&torque)
}

/// The tip as written holds more rest than the trajectory, so that the period is longer. Without
/// damping the torque decays so fast that this does not matter; the tail of hysteretic damping
/// does, below the tolerance of 1e-6.
#[test]
fn the_tip_written_is_accepted_as_a_motion_and_needs_the_same_torque() {
    let bench = Bench::new();
    // A roll-off of what is rolled off already would take some of it away once more.
    let fine = "--set analysis.tip_tolerance=0 --set segments.*.elements=40";
    for (damping, allowed) in [("damping={model=\"none\"}", 1e-8), ("damping.ratio=0.02", 1e-6)] {
        for digits in ["10", "full"] {
            let options = format!("--set {damping} --digits {digits} {fine}");
            bench.solve(&format!("-o first {options}"));
            bench.silent(&format!("solve {LINK} first/tip.csv -o second {options}"));
            let difference = torque_difference(&bench, "first", "second");
            assert!(difference < allowed, "{damping}, {digits}: {difference:e} of the peak");
        }
    }
}
