//! `solve --golden`: a small folder whose rows do not depend on where the window begins.

use super::{Bench, column, repository, stderr, stdout};

/// Files of a link's golden folder.
const FILES: [&str; 6] = [
    "hub_angle.csv",
    "nodal_displacements.csv",
    "nodes.csv",
    "summary.json",
    "tip.csv",
    "torque.csv",
];

/// Numbers of the rows of a table, counted from time 0, where the motion begins.
fn numbers(bench: &Bench, file: &str) -> Vec<f64> {
    column(bench, file, "time_s").iter().map(|time_s| (time_s * 1e3).round()).collect()
}

/// Every row of the small table is in the whole one, with these columns, and there every fifth from 0 is.
#[track_caller]
fn is_every_fifth(bench: &Bench, small: &str, whole: &str, columns: &[&str]) {
    let kept: Vec<usize> =
        (0..).zip(numbers(bench, whole)).filter(|(_, n)| n % 5.0 == 0.0).map(|(k, _)| k).collect();
    assert!(kept[0] > 0 && kept[0] < 5, "the window begins elsewhere than at a multiple of 5");
    let found: Vec<String> = bench.table(small).into_iter().map(|(name, _)| name).collect();
    assert_eq!(found, [&["time_s"], columns].concat());
    for name in found {
        let (small, whole) = (column(bench, small, &name), column(bench, whole, &name));
        let peak = whole.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        assert_eq!(small.len(), kept.len(), "{name}");
        let apart = small.iter().zip(&kept).map(|(x, k)| (x - whole[*k]).abs());
        assert!(apart.fold(0.0, f64::max) <= 1e-9 * peak, "{name}");
    }
}

#[test]
fn a_golden_folder_has_three_nodes_and_every_fifth_row_and_is_repeated() {
    let bench = Bench::new();
    bench.solve(&["-o", "whole", "--set", "hub.inertia*=1.001"]);
    let output = bench.solve(&["-o", "small", "--set", "hub.inertia*=1.001", "--golden"]);
    assert_eq!(bench.names("small"), FILES);
    let rows = numbers(&bench, "small/torque.csv").len();
    assert!(
        stdout(&output).contains(&format!("\nwritten  {rows} rows, -3.67")),
        "{}",
        stdout(&output)
    );
    let hub = ["hub_angle_rad", "hub_rate_rad_s", "hub_acceleration_rad_s2", "rigid_hub_angle_rad"];
    let tip = ["tip_displacement_m", "tip_velocity_m_s", "tip_acceleration_m_s2"];
    for (file, columns) in [
        ("torque.csv", &["torque_n_m"][..]),
        ("hub_angle.csv", &hub),
        ("tip.csv", &tip),
        ("nodal_displacements.csv", &["v3_m", "v7_m", "v10_m"]),
    ] {
        is_every_fifth(&bench, &format!("small/{file}"), &format!("whole/{file}"), columns);
    }
    assert_eq!(bench.read("small/nodes.csv"), bench.read("whole/nodes.csv"));
    let summary = bench.json("small/summary.json");
    assert_eq!(summary["results"], bench.json("whole/summary.json")["results"]);
    assert_eq!(summary["files"].as_array().unwrap().len(), FILES.len());

    let (link, motion) = (repository(super::LINK), repository(super::MOTION));
    let output = bench.run(&["solve", "--repeat", "small", &link, &motion]);
    assert_eq!(
        stdout(&output),
        "same     6 files of small, byte for byte\n",
        "{}",
        stderr(&output)
    );
    let output = bench.run(&["report", "small"]);
    let told = "error: small/summary.json: inputs.arguments = --golden, but must be a run without it: a golden \
                folder lacks some tables\n";
    assert_eq!((output.status.code(), &*stderr(&output)), (Some(3), told));
}

#[test]
fn a_window_that_begins_elsewhere_has_the_same_rows() {
    let bench = Bench::new();
    bench.solve(&["-o", "golden", "--golden"]);
    bench.solve(&["-o", "moved", "--golden", "--set", "hub.inertia*=1.001"]);
    let start = |folder: &str| {
        let summary = bench.json(&format!("{folder}/summary.json"));
        (1e3 * summary["analysis"]["window_start_s"].as_f64().unwrap()).round()
    };
    let apart = (start("golden") - start("moved")) % 5.0;
    assert!(apart.abs() > 0.5, "the windows are a multiple of 5 apart");
    let compare =
        ["compare", "golden", "moved", "--common-rows", "--rtol", "0.01", "--atol", "1e-3"];
    let output = bench.done(&compare);
    assert!(stdout(&output).contains("equal    torque.csv: 2 columns, 164"), "{}", stdout(&output));
}

#[test]
fn a_golden_folder_of_an_arm_has_torques_joint_angles_and_three_nodes_of_each_link() {
    let bench = super::arms::bench();
    for options in [&["-o", "whole"][..], &["-o", "small", "--golden"]] {
        bench.done(&[&["solve", "arm.toml", "path.csv", "-q"], options].concat());
    }
    let files = [
        "joint_angles.csv",
        "nodal_positions.csv",
        "nodes.csv",
        "summary.json",
        "tip.csv",
        "torques.csv",
    ];
    assert_eq!(bench.names("small"), files);
    for file in ["joint_angles.csv", "tip.csv", "torques.csv", "nodal_positions.csv"] {
        let [small, whole] = ["small", "whole"]
            .map(|folder: &str| column(&bench, &format!("{folder}/{file}"), "time_s"));
        // A step of 2 ms.
        let fifth = |time_s: &&f64| (*time_s * 500.0).round() % 5.0 == 0.0;
        assert_eq!(small, whole.iter().filter(fifth).copied().collect::<Vec<f64>>(), "{file}");
    }
    let names: Vec<String> =
        bench.table("small/nodal_positions.csv").into_iter().map(|(name, _)| name).collect();
    assert_eq!(names.len(), 1 + 2 * 3 * 2, "{names:?}");
    bench.done(&["solve", "--repeat", "small"]);
}
