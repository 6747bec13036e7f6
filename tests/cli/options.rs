//! Options that thin, round, replace or silence what is written.

use super::sweep::swept;
use super::{Bench, LINK, MOTION, column, repository, simulated, stderr, stdout};

#[test]
fn chosen_nodes_are_columns_of_the_whole_table() {
    let bench = Bench::new();
    bench.solve(&["-o", "all", "--deflections", "--moments"]);
    bench.solve(&["-o", "few", "--deflections", "--moments", "--nodes", "0,5,10"]);
    for name in ["nodal_displacements.csv", "nodal_deflections.csv", "bending_moments.csv"] {
        let all = bench.table(&format!("all/{name}"));
        let few = bench.table(&format!("few/{name}"));
        assert_eq!(few.len(), 4, "{name}");
        for (heading, values) in few {
            let whole = all.iter().find(|(other, _)| *other == heading).unwrap();
            // Three nodes may have a smaller peak than all, and then one decimal more.
            let close = values.iter().zip(&whole.1).all(|(a, b)| (a - b).abs() < 1e-9);
            assert!(close && values.len() == whole.1.len(), "{name}: {heading}");
        }
    }
}

#[test]
fn a_station_is_a_node_of_the_mesh_at_its_place() {
    let bench = Bench::new();
    let fine = ["--set", "segments.beam.elements=54", "--nodes", "19,21,55", "--moments"];
    bench.solve(&[&fine[..], &["-o", "fine"]].concat());
    // The mesh of ten elements has a node at 0.6 m, and none at 0.65 m.
    for (stations, columns) in [("60cm,0.65", ["4", "5"]), ("0.65,60cm", ["5", "4"])] {
        let output =
            bench.solve(&["--stations", stations, "--nodes", "11", "--moments", "--report"]);
        let text = stdout(&output);
        let named: Vec<String> = stations
            .split(',')
            .zip(columns)
            .map(|(at, node)| format!("{} m: node {node}", at.replace("60cm", "0.6")))
            .collect();
        assert!(text.contains(&format!("stations {}\n", named.join(", "))), "{text}");
        for (file, letter, unit) in
            [("nodal_displacements.csv", "v", "m"), ("bending_moments.csv", "m", "n_m")]
        {
            let heading = bench.read(&format!("out/{file}")).lines().next().unwrap().to_owned();
            let all = ["11", columns[0], columns[1]].map(|node| format!("{letter}{node}_{unit}"));
            assert_eq!(heading, format!("time_s,{}", all.join(",")));
            for (node, of_fine) in [("4", "19"), ("5", "21"), ("11", "55")] {
                let own = column(&bench, &format!("out/{file}"), &format!("{letter}{node}_{unit}"));
                let name = format!("{letter}{of_fine}_{unit}");
                let exact = column(&bench, &format!("fine/{file}"), &name);
                let peak = exact.iter().fold(1e-6, |m: f64, x| m.max(x.abs()));
                let times =
                    ["out", "fine"].map(|run| column(&bench, &format!("{run}/{file}"), "time_s"));
                assert_eq!(times[0], times[1], "both meshes have the same window");
                let rows = own.iter().zip(&exact);
                let off = rows.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                assert!(off < 3e-4 * peak, "{file}, {name}: {off} of {peak}");
            }
        }
        let (link, motion) = (repository(LINK), repository(MOTION));
        bench.done(&["solve", "--repeat", "out", &link, &motion]);
        bench.done(&["report", "out"]);
    }
    simulated(&bench, &["out/torque.csv", "--stations", "0.65,0.6", "-o", "played"]);
    let heading = bench.read("played/nodal_displacements.csv");
    assert!(heading.starts_with("time_s,v5_m,v4_m\n"));
}

#[test]
fn every_seventh_row_of_the_nodal_tables_is_written_and_every_row_of_the_others() {
    let bench = Bench::new();
    bench.solve(&["-o", "all", "--moments"]);
    bench.solve(&["-o", "few", "--moments", "--every", "7"]);
    for name in ["nodal_displacements.csv", "bending_moments.csv"] {
        let (all, few) = (bench.read(&format!("all/{name}")), bench.read(&format!("few/{name}")));
        let expected: Vec<&str> =
            all.lines().take(1).chain(all.lines().skip(1).step_by(7)).collect();
        let few: Vec<&str> = few.lines().collect();
        assert_eq!(few.len(), expected.len(), "{name}");
        let close = |a: &str, b: &str| {
            a.split(',').zip(b.split(',')).all(|(a, b)| {
                let number = |text: &str| text.parse::<f64>();
                match (number(a), number(b)) {
                    (Ok(a), Ok(b)) => (a - b).abs() < 1e-8,
                    _ => a == b,
                }
            })
        };
        assert!(few.iter().zip(&expected).all(|(a, b)| close(a, b)), "{name}");
    }
    assert!(bench.read("all/torque.csv") == bench.read("few/torque.csv"));
}

#[test]
fn four_digits_are_a_ten_thousandth_of_the_peak() {
    let bench = Bench::new();
    bench.solve(&["-o", "rounded", "--digits", "4"]);
    bench.solve(&["-o", "full", "--digits", "full"]);
    let (rounded, full) = (bench.table("rounded/torque.csv"), bench.table("full/torque.csv"));
    for (a, b) in rounded[1].1.iter().zip(&full[1].1) {
        assert!((a - b).abs() <= 0.5001e-4, "{a} for {b}");
    }
    let text = bench.read("rounded/torque.csv");
    let decimals = |row: &str| row.rsplit_once('.').unwrap().1.len();
    assert!(text.lines().skip(1).all(|row| decimals(row) == 4));
}

#[test]
fn full_digits_keep_every_bit_that_the_summary_tells() {
    let bench = Bench::new();
    // Of every frequency of the samples, peaks are those of the rows.
    bench.solve(&["--digits", "full", "--set", "analysis.tip_tolerance=0"]);
    let torque = bench.table("out/torque.csv").swap_remove(1).1;
    let peak = torque.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    // As text: not every JSON reader keeps the last bit.
    let told = format!("\"peak_torque_n_m\": {peak},");
    assert!(bench.read("out/summary.json").contains(&told), "{told}");
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let bench = Bench::new();
    let options = ["--moments", "--deflections"];
    for threads in ["1", "2", "3"] {
        bench.solve(&[&options[..], &["--threads", threads, "-o", threads]].concat());
    }
    bench.solve(&[&options[..], &["-o", "default"]].concat());
    let alone = bench.contents("1");
    assert_eq!(alone.len(), 9);
    for folder in ["2", "3", "default"] {
        assert!(bench.contents(folder) == alone, "{folder} threads");
    }
}

#[test]
fn json_prints_the_file_and_quiet_prints_nothing() {
    let bench = Bench::new();
    let output = bench.solve(&["--json"]);
    assert_eq!(stdout(&output), bench.read("out/summary.json"));
    assert_eq!(stderr(&output), "");
    let output = bench.solve(&["--quiet"]);
    assert_eq!((stdout(&output), stderr(&output)), (String::new(), String::new()));
    let output = bench.solve(&["-q", "--set", "analysis.lead=0.1"]);
    assert_eq!(stdout(&output), "");
    assert!(stderr(&output).starts_with("warning: the torque outside the written window"));
}

#[test]
fn a_setting_changes_the_link_and_is_recorded() {
    let bench = Bench::new();
    bench.solve(&["--set", "segments.*.I*=4", "--set", "payload.mass=\"50 g\"", "-q"]);
    let summary = bench.json("out/summary.json");
    assert_eq!(
        summary["inputs"]["arguments"],
        serde_json::json!(["--set", "segments.*.I*=4", "--set", "payload.mass=\"50 g\""])
    );
    assert_eq!(summary["link"]["segments"][1]["bending_stiffness_n_m2"][0], 20.0);
    assert_eq!(summary["link"]["payload"]["mass_kg"], 0.05);
}

#[test]
fn what_shapes_the_results_is_recorded_as_it_is_given_and_nothing_else() {
    let bench = Bench::new();
    let shaping = [
        "--set",
        "payload.mass=0.05",
        "--resample",
        "0.002",
        "--nodes",
        "0,10",
        "--stations",
        "0.25,1.5",
        "--every",
        "10",
        "--deflections",
        "--moments",
        "--digits",
        "full",
    ];
    let others = ["--threads", "1", "--sync", "--strict", "--report", "-q", "-o", "all"];
    bench.solve(&[&shaping[..], &others].concat());
    let arguments = &bench.json("all/summary.json")["inputs"]["arguments"];
    assert_eq!(*arguments, serde_json::json!(shaping));
    bench.solve(&["--every", "1", "--digits", "10"]);
    assert_eq!(bench.json("out/summary.json")["inputs"]["arguments"], serde_json::json!([]));
}

#[test]
fn a_motion_off_the_grid_is_resampled_on_demand() {
    let bench = Bench::new();
    let link = repository(LINK);
    let motion = std::fs::read_to_string(repository(MOTION)).unwrap();
    // Without every row whose number a third divides, the times are not uniform.
    let rows = motion.lines().enumerate().filter(|(k, _)| *k < 3 || *k > 880 || k % 3 != 0);
    let thinned: Vec<&str> = rows.map(|(_, row)| row).collect();
    bench.write("thin.csv", &thinned.join("\n"));
    bench.done(&["solve", &link, "thin.csv", "--resample", "0.001"]);
    bench.solve(&["-o", "whole"]);
    let (thin, whole) = (bench.table("out/torque.csv"), bench.table("whole/torque.csv"));
    let peak = |torque: &[f64]| torque.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    assert!((peak(&thin[1].1) / peak(&whole[1].1) - 1.0).abs() < 1e-4);
}

#[test]
fn a_scaled_motion_is_that_of_the_same_factors_in_solve() {
    let bench = Bench::new();
    let vary = ["--vary", "distance*=-0.5,0.3", "--vary", "duration*=1,1.3", "--outputs", "all"];
    swept(&bench, &vary);
    for (case, factors) in [
        ("all/1", &["--scale-distance=-0.5"][..]),
        ("all/2", &["--scale-distance=-0.5", "--scale-duration", "1.3"]),
        ("all/4", &["--scale-distance", "0.3", "--scale-duration", "1.3"]),
    ] {
        bench.solve(factors);
        assert!(bench.contents(case) == bench.contents("out"), "{case}");
        let recorded = &bench.json(&format!("{case}/summary.json"))["inputs"]["arguments"];
        assert_eq!(*recorded, serde_json::json!(factors));
    }
}
