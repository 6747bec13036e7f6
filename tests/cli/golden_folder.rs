//! `solve --golden`: a small folder whose rows do not depend on where the window begins.

use super::{Bench, LINK, MOTION, apart, column, peak, stdout};

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
fn is_every_fifth(bench: &Bench, file: &str, columns: &[&str]) {
    let [small, whole] = ["small", "whole"].map(|folder| format!("{folder}/{file}"));
    let kept: Vec<usize> =
        (0..).zip(numbers(bench, &whole)).filter(|(_, n)| n % 5.0 == 0.0).map(|(k, _)| k).collect();
    assert!(kept[0] > 0 && kept[0] < 5, "the window begins elsewhere than at a multiple of 5");
    let names: Vec<String> = bench.table(&small).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, [&["time_s"], columns].concat());
    for name in names {
        let whole = column(bench, &whole, &name);
        let expected: Vec<f64> = kept.iter().map(|k| whole[*k]).collect();
        assert!(apart(&column(bench, &small, &name), &expected) <= 1e-9 * peak(&whole), "{name}");
    }
}

#[test]
fn a_golden_folder_has_three_nodes_and_every_fifth_row_and_is_repeated() {
    let bench = Bench::new();
    bench.solve("-o whole --set hub.inertia*=1.001");
    let told = stdout(&bench.solve("-o small --set hub.inertia*=1.001 --golden"));
    assert_eq!(bench.names("small"), FILES);
    let rows = numbers(&bench, "small/torque.csv").len();
    assert!(told.contains(&format!("\nwritten  {rows} rows, -3.67")), "{told}");
    let hub = ["hub_angle_rad", "hub_rate_rad_s", "hub_acceleration_rad_s2", "rigid_hub_angle_rad"];
    is_every_fifth(&bench, "torque.csv", &["torque_n_m"]);
    is_every_fifth(&bench, "hub_angle.csv", &hub);
    let tip = ["tip_displacement_m", "tip_velocity_m_s", "tip_acceleration_m_s2"];
    is_every_fifth(&bench, "tip.csv", &tip);
    is_every_fifth(&bench, "nodal_displacements.csv", &["v3_m", "v7_m", "v10_m"]);
    assert_eq!(bench.read("small/nodes.csv"), bench.read("whole/nodes.csv"));
    let summary = bench.json("small/summary.json");
    assert_eq!(summary["results"], bench.json("whole/summary.json")["results"]);
    assert_eq!(summary["files"].as_array().unwrap().len(), FILES.len());

    let repeated = bench.printed(&format!("solve --repeat small {LINK} {MOTION}"));
    assert_eq!(repeated, "same     6 files of small, byte for byte\n");
    let told = "error: small/summary.json: inputs.arguments = --golden, but must be a run without it: a golden \
                folder lacks some tables\n";
    assert_eq!(bench.error(3, "report small"), told);
}

#[test]
fn a_window_that_begins_elsewhere_has_the_same_rows() {
    let bench = Bench::new();
    bench.solve("-o golden --golden");
    bench.solve("-o moved --golden --set hub.inertia*=1.001");
    let start = |folder: &str| (1e3 * bench.number(folder, "analysis/window_start_s")).round();
    let off = (start("golden") - start("moved")) % 5.0;
    assert!(off.abs() > 0.5, "the windows are a multiple of 5 apart");
    let told = bench.printed("compare golden moved --common-rows --rtol 0.01 --atol 1e-3");
    assert!(told.contains("equal    torque.csv: 2 columns, 164"), "{told}");
}

#[test]
fn a_golden_folder_of_an_arm_has_torques_joint_angles_and_three_nodes_of_each_link() {
    let bench = super::arms::bench();
    bench.done("solve arm.toml path.csv -q -o whole");
    bench.done("solve arm.toml path.csv -q -o small --golden");
    let tables = ["joint_angles.csv", "nodal_positions.csv", "tip.csv", "torques.csv"];
    let mut files = [&tables[..], &["nodes.csv", "summary.json"]].concat();
    files.sort_unstable();
    assert_eq!(bench.names("small"), files);
    for file in tables {
        let [small, whole] =
            ["small", "whole"].map(|folder| column(&bench, &format!("{folder}/{file}"), "time_s"));
        // A step of 2 ms.
        let fifth = |time_s: &&f64| (*time_s * 500.0).round() % 5.0 == 0.0;
        assert_eq!(small, whole.iter().filter(fifth).copied().collect::<Vec<f64>>(), "{file}");
    }
    assert_eq!(bench.table("small/nodal_positions.csv").len(), 1 + 2 * 3 * 2);
    bench.done("solve --repeat small");
}
