//! Many cases in one table.

use std::process::Output;

use super::{
    Bench, LINK, MOTION, column, ended, json_of, refusal, repository, stderr, stdout, succeeded,
};

/// `sweep` of the paper's first example with more arguments.
pub(super) fn sweep(bench: &Bench, arguments: &[&str]) -> Output {
    let (link, motion) = (repository(LINK), repository(MOTION));
    bench.run(&[&["sweep", &link, &motion], arguments].concat())
}

#[track_caller]
pub(super) fn swept(bench: &Bench, arguments: &[&str]) -> Output {
    succeeded(sweep(bench, arguments))
}

/// The rows of a table, as fields of text; commas in quotes part none.
pub(super) fn rows(bench: &Bench, name: &str) -> Vec<Vec<String>> {
    let text = bench.read(name);
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    let fields = |row: csv::StringRecord| row.iter().map(str::to_owned).collect();
    reader.records().map(|row| fields(row.unwrap())).collect()
}

#[test]
fn every_row_holds_what_solve_finds_for_its_values() {
    let bench = Bench::new();
    swept(&bench, &["--vary", "segments.*.EI*=1,4", "--vary", "payload.mass=0 g:50 g:2"]);
    let rows = rows(&bench, "sweep.csv");
    let header = "segments.*.EI*,payload.mass [g],period_1_s,zero_1_per_s,peak_torque_n_m,\
                  rms_torque_n_m,peak_rigid_torque_n_m,torque_ratio,lead_s,lag_s,\
                  peak_hub_rate_rad_s,peak_power_w,peak_root_moment_n_m,peak_deflection_m,\
                  rms_power_w,band_hz,tip_error,torque_mesh_error,torque_window_error,\
                  torque_model_error,tip_model_error,warnings,error";
    assert_eq!(rows[0].join(","), header);
    let values: Vec<_> = rows[1..].iter().map(|row| row[..2].join(" ")).collect();
    assert_eq!(values, ["1 0", "1 50", "4 0", "4 50"]);
    for row in &rows[1..] {
        let stiffness = format!("segments.*.EI*={}", row[0]);
        let mass = format!("payload.mass={} g", row[1]);
        bench.solve(&["--set", &stiffness, "--set", &mass]);
        let summary = bench.json("out/summary.json");
        let results = &summary["results"];
        let expected = [
            ("period_1_s", &summary["periods_s"][0]),
            ("zero_1_per_s", &summary["zeros_per_s"][0]),
            ("band_hz", &summary["analysis"]["band_hz"]),
            ("tip_error", &summary["errors"]["tip"]),
            ("torque_mesh_error", &summary["errors"]["torque"]["mesh"]),
            ("torque_window_error", &summary["errors"]["torque"]["window"]),
            ("torque_model_error", &summary["errors"]["torque"]["model"]),
            ("tip_model_error", &summary["errors"]["tip_model"]),
        ];
        let expected = expected
            .into_iter()
            .chain(rows[0][4..14].iter().map(|name| (name.as_str(), &results[name.as_str()])));
        for (name, expected) in expected {
            let place = rows[0].iter().position(|heading| heading == name).unwrap();
            let (found, expected) =
                (row[place].parse::<f64>().unwrap(), expected.as_f64().unwrap());
            // Twelve digits are written.
            let error = (found - expected).abs();
            assert!(error <= 1e-11 * expected.abs(), "{name}: {found} is not {expected}");
        }
        assert_eq!(row.last().unwrap(), "");
    }
}

#[test]
fn the_table_does_not_depend_on_the_number_of_threads() {
    let bench = Bench::new();
    for threads in ["1", "2", "7"] {
        let arguments =
            ["--vary", "segments.*.EI*=0.5:8:9:log", "--threads", threads, "-o", threads];
        swept(&bench, &arguments);
    }
    assert_eq!(bench.read("1").lines().count(), 10);
    assert!(bench.read("1") == bench.read("2") && bench.read("1") == bench.read("7"));
}

#[test]
fn a_case_that_fails_says_why_and_the_rest_goes_on() {
    let bench = Bench::new();
    let output = swept(&bench, &["--vary", "damping.ratio=0.02,1.5,0.03"]);
    let rows = rows(&bench, "sweep.csv");
    let (error, numbers) = rows[2].split_last().unwrap();
    assert_eq!(error, "--vary 'damping.ratio=1.5': damping.ratio = 1.5, but must lie in [0, 1)");
    assert!(numbers[1..].iter().all(String::is_empty));
    assert!(rows[1][1..15].iter().all(|field| !field.is_empty()));
    assert_eq!(rows[3][0], "0.03");
    assert!(
        stderr(&output).starts_with("warning: 1 of 3 cases failed, the first is case 2: --vary")
    );
}

#[test]
fn a_sweep_of_which_no_case_can_be_solved_fails() {
    let bench = Bench::new();
    // A window far beyond what is transformed.
    refusal(
        4,
        sweep(&bench, &["--vary", "analysis.lead=1e6,1e7", "-q"]),
        "error: no case could be solved; the first: ",
    );
    assert_eq!(bench.read("sweep.csv").lines().count(), 3);
}

#[test]
fn results_that_cannot_be_written_end_the_sweep_and_keep_its_rows() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("cases")).unwrap();
    bench.write("cases/1", "mine");
    let vary = ["--vary", "payload.mass=0,0.01"];
    let output = ended(5, sweep(&bench, &[&vary[..], &["--outputs", "cases"]].concat()));
    assert!(
        stderr(&output).ends_with("error: cases/1: cannot create the folder: File exists\n"),
        "{}",
        stderr(&output)
    );
    assert_eq!(bench.names("."), ["cases"], "no file without a row is left");
    ended(2, sweep(&bench, &[&vary[..], &["--outputs", "all", "--nodes", "11"]].concat()));
    assert_eq!(bench.names("."), ["cases"]);
    let output = ended(5, sweep(&bench, &[&vary[..], &["-o", "."]].concat()));
    assert!(stderr(&output).ends_with("a folder has this name\n"), "{}", stderr(&output));
}

#[cfg(unix)]
#[test]
fn a_sweep_whose_reader_has_gone_away_ends() {
    let bench = Bench::new();
    let program = env!("CARGO_BIN_EXE_flexlink");
    let (link, motion) = (repository(LINK), repository(MOTION));
    // Hours of work, were all of it done.
    let vary = "segments.*.EI*=1:8:1000000";
    let script = format!("'{program}' sweep '{link}' '{motion}' --vary '{vary}' -o - | head -2");
    let output = succeeded(
        std::process::Command::new("bash")
            .args(["-c", &format!("set -o pipefail; {script}")])
            .current_dir(bench.path("."))
            .output()
            .unwrap(),
    );
    assert_eq!(stdout(&output).lines().count(), 2);
}

#[test]
fn a_path_in_an_error_does_not_get_into_the_table() {
    let bench = Bench::new();
    let output = swept(&bench, &["--vary", "segments.beam.length=1.35,-1"]);
    let table = bench.read("sweep.csv");
    let folder = repository("specs");
    assert!(
        !table.contains(&folder) && stderr(&output).starts_with("warning: 1 of 2 cases failed")
    );
    // Here the file's own line is to blame.
    let link =
        std::fs::read_to_string(repository(LINK)).unwrap() + "\n[[masses]]\nat = 1.4\nmass = 0.1\n";
    bench.write("link.toml", &link);
    let (link, motion) = (bench.path("link.toml"), repository(MOTION));
    let vary = ["--vary", "segments.beam.length=1.35,1.2"];
    bench.done(&[&["sweep", link.to_str().unwrap(), &motion], &vary[..]].concat());
    let error = rows(&bench, "sweep.csv")[2].last().unwrap().clone();
    assert!(error.starts_with("link.toml:") || error.starts_with("--vary"), "{error}");
}

#[test]
fn factors_for_all_cases_multiply_those_that_are_varied() {
    let bench = Bench::new();
    let given = ["--scale-duration", "1.6", "--scale-distance=-0.5"];
    swept(&bench, &[&["--vary", "duration*=1,1.25", "--outputs", "all"][..], &given].concat());
    let scaled = rows(&bench, "sweep.csv");
    let of_case = bench.contents("all/2");
    swept(&bench, &["--vary", "distance*=-0.5", "--vary", "duration*=1.6,2", "--outputs", "alone"]);
    let varied = rows(&bench, "sweep.csv");
    for (scaled, varied) in scaled.iter().zip(&varied) {
        assert_eq!(scaled[1..], varied[2..]);
    }
    assert!(of_case == bench.contents("alone/2"));
}

#[test]
fn a_slower_and_a_longer_motion_scale_the_torque_of_a_stiff_link() {
    let bench = Bench::new();
    let vary =
        ["--vary", "distance*=1,2", "--vary", "duration*=1,2", "--set", "segments.*.EI*=1e4"];
    swept(&bench, &vary);
    let rows = rows(&bench, "sweep.csv");
    let place = |name: &str| rows[0].iter().position(|heading| heading == name).unwrap();
    let column = |name: &str| -> Vec<f64> {
        rows[1..].iter().map(|row| row[place(name)].parse().unwrap()).collect()
    };
    let rigid = column("peak_rigid_torque_n_m");
    for (shorter, farther) in [(rigid[0], rigid[2]), (rigid[1], rigid[3])] {
        assert!((farther / shorter - 2.0).abs() < 1e-9, "{farther} is not twice {shorter}");
    }
    // The cut-off is found to a thousandth: a slower motion may lose a little more of its torque.
    assert!(
        (rigid[1] / rigid[0] - 0.25).abs() < 1e-5,
        "{} is no quarter of {}",
        rigid[1],
        rigid[0]
    );
    for ratio in column("torque_ratio") {
        assert!((ratio - 1.0).abs() < 1e-2, "{ratio}");
    }
}

#[test]
fn full_results_are_those_of_solve() {
    let bench = Bench::new();
    let thin = ["--nodes", "0,10", "--every", "5", "--digits", "8"];
    let vary = ["--vary", "payload.mass=0.05,0.1", "--outputs", "all cases"];
    swept(&bench, &[&vary[..], &thin].concat());
    assert_eq!(bench.names("all cases"), ["1", "2"]);
    bench.solve(&[&["--set", "payload.mass=0.1"], &thin[..]].concat());
    assert!(bench.contents("all cases/2") == bench.contents("out"));
}

#[test]
fn one_torque_on_many_links_tells_how_far_each_tip_strays() {
    let bench = Bench::new();
    bench.solve(&["-q"]);
    let torque = ["--torque", "out/torque.csv", "--outputs", "played"];
    swept(&bench, &[&["--vary", "segments.*.EI*=1,1.1"], &torque[..]].concat());
    let table = rows(&bench, "sweep.csv");
    let header = "segments.*.EI*,period_1_s,zero_1_per_s,tip_error_m,tip_error_share,\
                  tip_error_time_s,rms_tip_error_m,final_tip_error_m,residual_m,residual_share,\
                  residual_frequency_hz,residual_decay_s,peak_hub_rate_rad_s,peak_power_w,\
                  peak_deflection_m,tip_model_error,deflection_model_error,warnings,error";
    assert_eq!(table[0].join(","), header);
    // What simulate finds against the same target.
    for (row, factor) in table[1..].iter().zip(["1", "1.1"]) {
        let set = format!("segments.*.EI*={factor}");
        let target = ["--target", "out/tip.csv", "-o", "alone", "--set", &set];
        super::simulated(&bench, &[&["out/torque.csv"], &target[..]].concat());
        let summary = bench.json("alone/summary.json");
        for (place, expected) in [
            (3, &summary["tip_error"]["worst_m"]),
            (4, &summary["tip_error"]["share"]),
            (8, &summary["residual"]["amplitude_m"]),
            (14, &summary["results"]["peak_deflection_m"]),
            (15, &summary["errors"]["tip"]["model"]),
            (16, &summary["errors"]["deflection"]["model"]),
        ] {
            let found: f64 = row[place].parse().unwrap();
            let expected = expected.as_f64().unwrap();
            // The sweep holds the tip against the motion asked for, `out/tip.csv` is within 1e-6 of it.
            assert!((found - expected).abs() < 1e-6, "{}: {found}, {expected}", table[0][place]);
        }
        let number = if factor == "1" { "1" } else { "2" };
        let tip = format!("played/{number}/tip.csv");
        let (found, alone) = (
            column(&bench, &tip, "tip_displacement_m"),
            column(&bench, "alone/tip.csv", "tip_displacement_m"),
        );
        assert!(found.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-9));
    }
    // method.md, section 7: 1.4 % for ten percent of stiffness.
    assert!((table[2][4].parse::<f64>().unwrap() - 0.0142).abs() < 2e-4);
}

#[test]
fn a_table_for_a_converter_is_played_held_on_every_case() {
    let bench = Bench::new();
    let link = repository(LINK);
    let made = ["trajectory", "sine", "--distance", "0.5", "--duration", "0.88", "--step", "0.01"];
    bench.done(&[&made[..], &["-o", "coarse.csv"]].concat());
    let solved =
        ["solve", &link, "coarse.csv", "--write", "held.csv", "--hold", "zero", "-o", "out"];
    bench.done(&solved);
    let strays = |hold: &[&str], name: &str| {
        let played =
            ["sweep", &link, "coarse.csv", "--vary", "hub.inertia*=1,1.05", "--torque", "held.csv"];
        bench.done(&[&played[..], hold, &["-o", name, "-q"]].concat());
        let rows = rows(&bench, name);
        let place = rows[0].iter().position(|heading| heading == "tip_error_m").unwrap();
        rows[1..].iter().map(|row| row[place].parse::<f64>().unwrap()).collect::<Vec<_>>()
    };
    let (held, smooth) =
        (strays(&["--hold", "zero"], "held_rows.csv"), strays(&[], "smooth_rows.csv"));
    assert!(held[0] < 0.3 * smooth[0] && held[1] > 2.0 * held[0], "{held:?} {smooth:?}");
    let alone = bench.run(&[
        "simulate",
        &link,
        "held.csv",
        "--hold",
        "zero",
        "--target",
        "out/tip.csv",
        "--json",
    ]);
    let json = json_of(&alone);
    let worst = json["tip_error"]["worst_m"].as_f64().unwrap();
    assert!((held[0] / worst - 1.0).abs() < 0.02, "{} {worst}", held[0]);
}

#[test]
fn the_cases_do_not_replace_the_torque_that_is_played_on_them() {
    let bench = Bench::new();
    bench.solve(&["-q", "-o", "all/2"]);
    let before = bench.contents("all/2");
    let torque = ["--torque", "all/2/torque.csv", "--outputs", "./all"];
    let output =
        ended(2, sweep(&bench, &[&["--vary", "payload.mass=0,0.01"], &torque[..]].concat()));
    assert_eq!(
        stderr(&output),
        "error: --outputs = ./all, but must be another folder than that of all/2/torque.csv\n\
         hint: a folder holds one run: the results would replace those read\n"
    );
    assert!(bench.contents("all/2") == before);
}

#[test]
fn a_table_may_lie_beside_the_folders_of_its_cases() {
    let bench = Bench::new();
    swept(&bench, &["--vary", "payload.mass=0,0.01", "-o", "all/table.csv", "--outputs", "all"]);
    assert_eq!(bench.names("all"), ["1", "2", "table.csv", "table.json"]);
}

#[test]
fn remarks_do_not_depend_on_the_order_of_the_cases() {
    for (values, first) in [("2700,2.7,2.8", 2), ("2.7,2700,2.8", 1)] {
        let bench = Bench::new();
        let beam = "[hub]\ninertia = 1\n[[segments]]\nlength = 1\nE = '70 GPa'\ndensity = 2700\n\
                    section = { shape = 'rectangle', width = 0.02, thickness = 0.01 }\n";
        bench.write("beam.toml", beam);
        let vary = format!("segments.0.density={values}");
        let motion = super::repository(super::MOTION);
        let output = bench.run(&["sweep", "beam.toml", &motion, "--vary", &vary]);
        let told = stderr(&output);
        let remark =
            format!("remark: 2 of 3 cases, the first is case {first}: segments.0.density = 2.7");
        assert!(told.starts_with(&remark), "{told}");
        assert_eq!(told.matches("remark: ").count(), 1, "{told}");
    }
}

#[test]
fn two_tables_do_not_share_a_record() {
    let bench = Bench::new();
    let vary = ["--vary", "payload.mass=0,0.01", "-o"];
    swept(&bench, &[&vary[..], &["two"]].concat());
    let record = bench.read("two.json");
    let output = ended(2, sweep(&bench, &[&vary[..], &["two.csv"]].concat()));
    let error =
        "error: --output = two.csv, but its record two.json would replace the record of two\n";
    assert!(stderr(&output).starts_with(error), "{}", stderr(&output));
    assert!(bench.read("two.json") == record);
    swept(&bench, &[&vary[..], &["two"]].concat());
}

#[test]
fn rows_go_to_standard_output_for_a_dash_and_nothing_else_does() {
    let bench = Bench::new();
    let output = swept(&bench, &["--vary", "payload.mass=0,0.001", "-o", "-"]);
    swept(&bench, &["--vary", "payload.mass=0,0.001"]);
    assert!(stdout(&output) == bench.read("sweep.csv"));
    assert_eq!(stderr(&output), "", "no progress in a pipe");
}
