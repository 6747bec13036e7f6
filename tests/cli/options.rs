//! Options that thin, round, replace or silence what is written.

use super::sweep::swept;
use super::{Bench, LINK, MOTION, apart, column, peak, repository, simulated, stderr, stdout};

#[test]
fn chosen_nodes_are_columns_of_the_whole_table() {
    let bench = Bench::new();
    bench.solve("-o all --deflections --moments");
    bench.solve("-o few --deflections --moments --nodes 0,5,10");
    for name in ["nodal_displacements.csv", "nodal_deflections.csv", "bending_moments.csv"] {
        let few = bench.table(&format!("few/{name}"));
        assert_eq!(few.len(), 4, "{name}");
        for (heading, values) in few {
            // Three nodes may have a smaller peak than all, and then one decimal more.
            let whole = column(&bench, &format!("all/{name}"), &heading);
            assert!(apart(&values, &whole) < 1e-9, "{name}: {heading}");
        }
    }
}

#[test]
fn a_station_is_a_node_of_the_mesh_at_its_place() {
    let bench = Bench::new();
    bench.solve("--set segments.beam.elements=54 --nodes 19,21,55 --moments -o fine");
    // The mesh of ten elements has a node at 0.6 m, and none at 0.65 m.
    for (stations, told, nodes) in [
        ("60cm,0.65", "0.6 m: node 4, 0.65 m: node 5", ["11", "4", "5"]),
        ("0.65,60cm", "0.65 m: node 5, 0.6 m: node 4", ["11", "5", "4"]),
    ] {
        let options = format!("--stations {stations} --nodes 11 --moments --report");
        let text = stdout(&bench.solve(&options));
        assert!(text.contains(&format!("stations {told}\n")), "{text}");
        for (file, letter, unit) in
            [("nodal_displacements.csv", "v", "m"), ("bending_moments.csv", "m", "n_m")]
        {
            let all = nodes.map(|node| format!("{letter}{node}_{unit}"));
            let of = |run: &str, name: &str| column(&bench, &format!("{run}/{file}"), name);
            let heading = bench.read(&format!("out/{file}")).lines().next().unwrap().to_owned();
            assert_eq!(heading, format!("time_s,{}", all.join(",")));
            assert_eq!(of("out", "time_s"), of("fine", "time_s"), "both have the same window");
            for (node, of_fine) in [("4", "19"), ("5", "21"), ("11", "55")] {
                let [own, exact] = [("out", node), ("fine", of_fine)]
                    .map(|(run, node)| of(run, &format!("{letter}{node}_{unit}")));
                let off = apart(&own, &exact);
                assert!(off < 3e-4 * peak(&exact).max(1e-6), "{file}, {node}: {off}");
            }
        }
        bench.done(&format!("solve --repeat out {LINK} {MOTION}"));
        bench.done("report out");
    }
    simulated(&bench, "out/torque.csv --stations 0.65,0.6 -o played");
    let heading = bench.read("played/nodal_displacements.csv");
    assert!(heading.starts_with("time_s,v5_m,v4_m\n"));
}

#[test]
fn every_seventh_row_of_the_nodal_tables_is_written_and_every_row_of_the_others() {
    let bench = Bench::new();
    bench.solve("-o all --moments");
    bench.solve("-o few --moments --every 7");
    for name in ["nodal_displacements.csv", "bending_moments.csv"] {
        let [all, few] = ["all", "few"].map(|run| bench.table(&format!("{run}/{name}")));
        assert_eq!(all.len(), few.len(), "{name}");
        for ((heading, all), (own, few)) in all.iter().zip(&few) {
            assert_eq!(heading, own, "{name}");
            let expected: Vec<f64> = all.iter().copied().step_by(7).collect();
            assert!(apart(few, &expected) < 1e-8, "{name}: {heading}");
        }
    }
    assert!(bench.read("all/torque.csv") == bench.read("few/torque.csv"));
}

#[test]
fn four_digits_are_a_ten_thousandth_of_the_peak() {
    let bench = Bench::new();
    bench.solve("-o rounded --digits 4");
    bench.solve("-o full --digits full");
    let [rounded, full] =
        ["rounded", "full"].map(|run| column(&bench, &format!("{run}/torque.csv"), "torque_n_m"));
    assert!(apart(&rounded, &full) <= 0.5001e-4);
    let text = bench.read("rounded/torque.csv");
    let decimals = |row: &str| row.rsplit_once('.').unwrap().1.len();
    assert!(text.lines().skip(1).all(|row| decimals(row) == 4));
}

#[test]
fn full_digits_keep_every_bit_that_the_summary_tells() {
    let bench = Bench::new();
    // Of every frequency of the samples, peaks are those of the rows.
    bench.solve("--digits full --set analysis.tip_tolerance=0");
    let peak = peak(&column(&bench, "out/torque.csv", "torque_n_m"));
    // As text: not every JSON reader keeps the last bit.
    let told = format!("\"peak_torque_n_m\": {peak},");
    assert!(bench.read("out/summary.json").contains(&told), "{told}");
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let bench = Bench::new();
    for threads in ["1", "2", "3"] {
        bench.solve(&format!("--moments --deflections --threads {threads} -o {threads}"));
    }
    bench.solve("--moments --deflections -o default");
    let alone = bench.contents("1");
    assert_eq!(alone.len(), 9);
    for folder in ["2", "3", "default"] {
        assert!(bench.contents(folder) == alone, "{folder} threads");
    }
    bench.solve("-q");
    for threads in ["1", "2", "3"] {
        let target = "out/torque.csv --target out/tip.csv";
        simulated(&bench, &format!("{target} --threads {threads} -o played{threads}"));
        assert!(bench.contents("played1") == bench.contents(&format!("played{threads}")));
    }
}

#[test]
fn json_prints_the_file_and_quiet_prints_nothing() {
    let bench = Bench::new();
    for (command, folder) in [
        (format!("solve {LINK} {MOTION}"), "out"),
        (format!("simulate {LINK} out/torque.csv"), "simulated"),
    ] {
        let printed = bench.silent(&format!("{command} --json"));
        assert_eq!(printed, bench.read(&format!("{folder}/summary.json")));
        assert_eq!(bench.silent(&format!("{command} --quiet")), "");
    }
    let output = bench.solve("-q --set analysis.lead=0.1");
    assert_eq!(stdout(&output), "");
    assert!(stderr(&output).starts_with("warning: the torque outside the written window"));
}

#[test]
fn a_setting_changes_the_link_and_is_recorded() {
    let bench = Bench::new();
    let settings = ["--set", "segments.*.I*=4", "--set", "payload.mass=\"50 g\""];
    bench.solve(&settings);
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["inputs"]["arguments"], serde_json::json!(settings));
    assert_eq!(summary["link"]["segments"][1]["bending_stiffness_n_m2"][0], 20.0);
    assert_eq!(summary["link"]["payload"]["mass_kg"], 0.05);
}

#[test]
fn what_shapes_the_results_is_recorded_as_it_is_given_and_nothing_else() {
    let bench = Bench::new();
    let shaping = "--set payload.mass=0.05 --resample 0.002 --nodes 0,10 --stations 0.25,1.5 --every 10 \
                   --deflections --moments --digits full";
    bench.solve(&format!("{shaping} --threads 1 --sync --strict --report -q -o all"));
    let shaping: Vec<&str> = shaping.split_whitespace().collect();
    let arguments = &bench.json("all/summary.json")["inputs"]["arguments"];
    assert_eq!(*arguments, serde_json::json!(shaping));
    bench.solve("--every 1 --digits 10");
    assert_eq!(bench.json("out/summary.json")["inputs"]["arguments"], serde_json::json!([]));
}

#[test]
fn a_motion_off_the_grid_is_resampled_on_demand() {
    let bench = Bench::new();
    let motion = std::fs::read_to_string(repository(MOTION)).unwrap();
    // Without every row whose number a third divides, the times are not uniform.
    let rows = motion.lines().enumerate().filter(|(k, _)| *k < 3 || *k > 880 || k % 3 != 0);
    let thinned: Vec<&str> = rows.map(|(_, row)| row).collect();
    bench.write("thin.csv", &thinned.join("\n"));
    bench.done(&format!("solve {LINK} thin.csv --resample 0.001"));
    bench.solve("-o whole");
    let [thin, whole] = ["out", "whole"]
        .map(|run| peak(&column(&bench, &format!("{run}/torque.csv"), "torque_n_m")));
    assert!((thin / whole - 1.0).abs() < 1e-4, "{thin} {whole}");
}

#[test]
fn a_scaled_motion_is_that_of_the_same_factors_in_solve() {
    let bench = Bench::new();
    swept(&bench, "--vary distance*=-0.5,0.3 --vary duration*=1,1.3 --outputs all");
    for (case, factors) in [
        ("all/1", "--scale-distance=-0.5"),
        ("all/2", "--scale-distance=-0.5 --scale-duration 1.3"),
        ("all/4", "--scale-distance 0.3 --scale-duration 1.3"),
    ] {
        bench.solve(factors);
        assert!(bench.contents(case) == bench.contents("out"), "{case}");
        let recorded = &bench.json(&format!("{case}/summary.json"))["inputs"]["arguments"];
        assert_eq!(*recorded, serde_json::json!(factors.split(' ').collect::<Vec<_>>()));
    }
}
