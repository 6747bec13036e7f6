//! `flexlink simulate`: files, columns and numbers.

use super::{Bench, LINK, apart, column, peak, simulated};

const ALWAYS: [&str; 6] = [
    "hub_angle.csv",
    "nodal_displacements.csv",
    "nodes.csv",
    "summary.json",
    "tip.csv",
    "torque.csv",
];

const FEEDBACK: &str = "--feedback 20,2 --reference out/hub_angle.csv";

/// The torque of the paper's first example in `out`, ready to be played.
fn solved() -> Bench {
    let bench = Bench::new();
    bench.solve("-q");
    bench
}

fn headings(bench: &Bench, name: &str) -> Vec<String> {
    bench.table(name).into_iter().map(|(heading, _)| heading).collect()
}

#[test]
fn every_file_appears_in_the_default_folder_with_its_columns_at_the_torques_times() {
    let bench = solved();
    simulated(&bench, "out/torque.csv");
    assert_eq!(bench.names("simulated"), ALWAYS);
    let displacements: Vec<String> = (0..=10).map(|k| format!("v{k}_m")).collect();
    let time = column(&bench, "out/torque.csv", "time_s");
    for (name, expected) in [
        ("torque.csv", "torque_n_m"),
        ("tip.csv", "tip_displacement_m,tip_velocity_m_s,tip_acceleration_m_s2"),
        ("hub_angle.csv", "hub_angle_rad,hub_rate_rad_s,hub_acceleration_rad_s2"),
        ("nodal_displacements.csv", &displacements.join(",")),
    ] {
        let found = headings(&bench, &format!("simulated/{name}")).join(",");
        assert_eq!(found, format!("time_s,{expected}"));
        assert_eq!(column(&bench, &format!("simulated/{name}"), "time_s"), time, "{name}");
    }
    assert_eq!(bench.read("simulated/nodes.csv"), bench.read("out/nodes.csv"));
    // The tip of the table is that of the last node.
    let tip = column(&bench, "simulated/tip.csv", "tip_displacement_m");
    let last = column(&bench, "simulated/nodal_displacements.csv", "v10_m");
    assert!(apart(&tip, &last) < 1e-9);
    assert!((tip[tip.len() - 1] - 0.5).abs() < 1e-4);
}

#[test]
fn the_torque_written_is_that_played_and_zero_after_its_end() {
    let bench = solved();
    let rigid = "out/rigid_torque.csv --column rigid_torque_n_m --until 5";
    simulated(&bench, &format!("{rigid} --set hub.viscous_friction=0.3 --digits full"));
    let given = column(&bench, "out/rigid_torque.csv", "rigid_torque_n_m");
    let played = column(&bench, "simulated/torque.csv", "torque_n_m");
    assert_eq!(played.len(), column(&bench, "simulated/tip.csv", "time_s").len());
    assert_eq!(played[..given.len()], given[..]);
    let after = &played[given.len()..];
    assert!(after.len() == 443 && after.iter().all(|torque| *torque == 0.0), "{}", after.len());
}

#[test]
fn a_run_removes_the_page_of_the_run_before_and_nothing_of_the_users() {
    let bench = solved();
    simulated(&bench, "out/torque.csv");
    for folder in ["out", "simulated"] {
        bench.write(&format!("{folder}/report.html"), "<!doctype html>");
        bench.write(&format!("{folder}/notes.html"), "mine");
    }
    let has_page = |folder: &str| bench.path(folder).join("report.html").exists();
    simulated(&bench, "out/torque.csv");
    assert!(!has_page("simulated") && has_page("out"));
    bench.solve("-q");
    assert!(!has_page("out"));
    for folder in ["out", "simulated"] {
        assert_eq!(bench.read(&format!("{folder}/notes.html")), "mine");
    }
}

/// `u = T + k_p (θ_ref − θ) + k_d (θ̇_ref − θ̇)`
#[test]
fn the_torque_with_feedback_is_that_of_its_law() {
    let bench = solved();
    simulated(&bench, &format!("out/torque.csv {FEEDBACK} --set payload.mass=0.05 --digits full"));
    let given = column(&bench, "out/torque.csv", "torque_n_m");
    let motor = column(&bench, "simulated/torque.csv", "torque_n_m");
    let of = |folder: &str, name: &str| column(&bench, &format!("{folder}/hub_angle.csv"), name);
    let (wanted, wanted_rate) = (of("out", "hub_angle_rad"), of("out", "hub_rate_rad_s"));
    let (angle, rate) = (of("simulated", "hub_angle_rad"), of("simulated", "hub_rate_rad_s"));
    let feedback = |k: usize| 20.0 * (wanted[k] - angle[k]) + 2.0 * (wanted_rate[k] - rate[k]);
    let feedback: Vec<f64> = (0..given.len()).map(feedback).collect();
    let expected: Vec<f64> = given.iter().zip(&feedback).map(|(a, b)| a + b).collect();
    assert!(apart(&motor, &expected) < 1e-9);
    assert!(peak(&feedback) > 0.1, "the payload calls for it: {} N m", peak(&feedback));
}

#[test]
fn feedback_alone_drives_the_link_too() {
    let bench = solved();
    let times = column(&bench, "out/torque.csv", "time_s");
    let rows: Vec<String> = times.iter().map(|time| format!("{time:.3},0\n")).collect();
    let rows = rows.concat();
    bench.write("nought.csv", &format!("time,torque\n{rows}"));
    simulated(&bench, &format!("nought.csv --target out/tip.csv -q {FEEDBACK}"));
    let travel = bench.number("simulated", "results/farthest_m");
    assert!((0.5..1.0).contains(&travel), "{travel} m");
}

#[test]
fn the_time_goes_on_as_far_as_asked_for_and_as_the_target_does() {
    let bench = solved();
    let text = bench.read("out/torque.csv");
    bench.write("early.csv", &text.lines().take(3600).collect::<Vec<_>>().join("\n"));
    for (arguments, end_s) in [
        ("out/rigid_torque.csv --column rigid_torque_n_m", 4.557),
        ("out/torque.csv --until 6.5", 6.5),
        // A whole step.
        ("out/torque.csv --until 4.5575", 4.558),
        ("early.csv --until -0.05", -0.05),
        ("early.csv --target out/tip.csv", 4.557),
    ] {
        simulated(&bench, arguments);
        let last = *column(&bench, "simulated/tip.csv", "time_s").last().unwrap();
        assert!((last - end_s).abs() < 1e-9, "{arguments}: {last}");
    }
}

#[test]
fn a_target_may_have_a_step_and_times_of_its_own() {
    let bench = solved();
    let share = |target: &str| {
        simulated(&bench, &format!("out/torque.csv --target {target}"));
        bench.number("simulated", "tip_error/share")
    };
    let expected = share("out/tip.csv");
    let text = bench.read("out/tip.csv");
    let (heading, rows) = text.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().collect();
    let fifth: Vec<&str> = rows.iter().skip(2).step_by(5).copied().collect();
    let before = ["-3.678,0,0,0", "-3.677,0,0,0"];
    for (target, rows) in [
        ("fifth.csv", fifth),
        ("early.csv", [&before[..], &rows].concat()),
        ("short.csv", rows[3000..5000].to_vec()),
    ] {
        bench.write(target, &format!("{heading}\n{}\n", rows.join("\n")));
        let found = share(target);
        assert!((found / expected - 1.0).abs() < 1e-3, "{target}: {found} is not {expected}");
    }
}

#[test]
fn nodes_and_rows_are_thinned_and_digits_chosen() {
    let bench = solved();
    simulated(&bench, "out/torque.csv -o all");
    simulated(&bench, "out/torque.csv --nodes 0,5 --every 7 --digits full -o few");
    assert_eq!(headings(&bench, "few/nodal_displacements.csv"), ["time_s", "v0_m", "v5_m"]);
    let [all, few] =
        ["all", "few"].map(|run| column(&bench, &format!("{run}/nodal_displacements.csv"), "v5_m"));
    let expected: Vec<f64> = all.into_iter().step_by(7).collect();
    assert!(apart(&few, &expected) < 1e-9);
    let told = bench.read("few/summary.json");
    let farthest = peak(&column(&bench, "few/tip.csv", "tip_displacement_m"));
    assert!(told.contains(&format!("\"farthest_m\": {farthest},")), "every bit of {farthest}");
}

#[test]
fn the_simulated_tip_reads_back_as_a_target_and_as_a_motion() {
    let bench = solved();
    simulated(&bench, "out/torque.csv -o first");
    simulated(&bench, "out/torque.csv --target first/tip.csv -o second");
    let share = bench.number("second", "tip_error/share");
    assert!(share < 1e-9, "{share:e}");
    // At rest at its end but for 1e-5 of its peak velocity, as the viscous law leaves it.
    bench.done(&format!("solve {LINK} first/tip.csv -o again"));
}

/// Writes a column with its times under a heading of this name, moved by a constant.
fn moved(bench: &Bench, file: &str, from: &str, heading: &str, by: f64) {
    let [times, values] =
        ["time_s", from].map(|name| column(bench, &format!("out/{file}.csv"), name));
    let rows = times.iter().zip(values).map(|(t, x)| format!("{t:.3},{}\n", x + by));
    bench.write(&format!("{file}.csv"), &format!("time,{heading}\n{}", rows.collect::<String>()));
}

#[test]
fn a_link_starts_where_its_target_does_or_else_its_reference() {
    let bench = solved();
    moved(&bench, "tip", "tip_displacement_m", "displacement", 0.75);
    moved(&bench, "hub_angle", "hub_angle_rad", "hub_angle", 0.5);
    for options in [
        "--target tip.csv",
        "--feedback 20,2 --reference hub_angle.csv",
        &format!("--target tip.csv {FEEDBACK}"),
    ] {
        simulated(&bench, &format!("out/torque.csv {options}"));
        let tip = column(&bench, "simulated/tip.csv", "tip_displacement_m");
        let hub = column(&bench, "simulated/hub_angle.csv", "hub_angle_rad");
        assert!((tip[0] - 0.75).abs() < 1e-4 && (hub[0] - 0.5).abs() < 1e-4, "{options:?}");
    }
}
