//! Many cases in one table.

use std::process::Output;

use super::{
    Bench, LINK, MOTION, Words, apart, column, ended, number, refusal, repository, simulated,
    stderr, stdout, succeeded, with,
};

/// `sweep` of the paper's first example with more arguments.
pub(super) fn sweep(bench: &Bench, arguments: &(impl Words + ?Sized)) -> Output {
    bench.run(&with(&["sweep", LINK, MOTION], arguments))
}

#[track_caller]
pub(super) fn swept(bench: &Bench, arguments: &(impl Words + ?Sized)) -> Output {
    succeeded(sweep(bench, arguments))
}

#[test]
fn every_row_holds_what_solve_finds_for_its_values() {
    let bench = Bench::new();
    swept(&bench, &["--vary", "segments.*.EI*=1,4", "--vary", "payload.mass=0 g:50 g:2"]);
    let rows = bench.rows("sweep.csv");
    let header = "segments.*.EI*,payload.mass [g],period_1_s,zero_1_per_s,peak_torque_n_m,\
                  rms_torque_n_m,peak_rigid_torque_n_m,torque_ratio,lead_s,lag_s,\
                  peak_hub_angle_rad,peak_hub_rate_rad_s,peak_hub_acceleration_rad_s2,\
                  peak_power_w,peak_root_moment_n_m,peak_deflection_m,\
                  rms_power_w,band_hz,tip_error,torque_mesh_error,torque_window_error,\
                  torque_model_error,tip_model_error,warnings,error";
    assert_eq!(rows[0].join(","), header);
    let values: Vec<_> = rows[1..].iter().map(|row| row[..2].join(" ")).collect();
    assert_eq!(values, ["1 0", "1 50", "4 0", "4 50"]);
    for row in &rows[1..] {
        let mass = format!("payload.mass={} g", row[1]);
        bench.solve(&["--set", &format!("segments.*.EI*={}", row[0]), "--set", &mass]);
        let summary = bench.json("out/summary.json");
        for (name, field) in rows[0].iter().zip(row).skip(2).take(21) {
            let path = match name.as_str() {
                "period_1_s" => "periods_s/0",
                "zero_1_per_s" => "zeros_per_s/0",
                "band_hz" => "analysis/band_hz",
                "tip_error" => "errors/tip",
                "torque_mesh_error" => "errors/torque/mesh",
                "torque_window_error" => "errors/torque/window",
                "torque_model_error" => "errors/torque/model",
                "tip_model_error" => "errors/tip_model",
                name => &format!("results/{name}"),
            };
            let (found, expected) = (field.parse::<f64>().unwrap(), number(&summary, path));
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
        swept(
            &bench,
            &format!("--vary segments.*.EI*=0.5:8:9:log --threads {threads} -o {threads}"),
        );
    }
    assert_eq!(bench.read("1").lines().count(), 10);
    assert!(bench.read("1") == bench.read("2") && bench.read("1") == bench.read("7"));
}

#[test]
fn a_case_that_fails_says_why_and_the_rest_goes_on() {
    let bench = Bench::new();
    let told = stderr(&swept(&bench, "--vary damping.ratio=0.02,1.5,0.03"));
    let rows = bench.rows("sweep.csv");
    let (error, numbers) = rows[2].split_last().unwrap();
    assert_eq!(error, "--vary 'damping.ratio=1.5': damping.ratio = 1.5, but must lie in [0, 1)");
    assert!(numbers[1..].iter().all(String::is_empty));
    assert!(rows[1][1..15].iter().all(|field| !field.is_empty()));
    assert_eq!(rows[3][0], "0.03");
    let warning = "warning: 1 of 3 cases failed, the first is case 2: --vary";
    assert!(told.starts_with(warning), "{told}");
}

#[test]
fn a_sweep_of_which_no_case_can_be_solved_fails() {
    let bench = Bench::new();
    // A window far beyond what is transformed.
    let failed = sweep(&bench, "--vary analysis.lead=1e6,1e7 -q");
    refusal(4, failed, "error: no case could be solved; the first: ");
    assert_eq!(bench.read("sweep.csv").lines().count(), 3);
}

#[test]
fn results_that_cannot_be_written_end_the_sweep_and_keep_its_rows() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("cases")).unwrap();
    bench.write("cases/1", "mine");
    let told = stderr(&ended(5, sweep(&bench, "--vary payload.mass=0,0.01 --outputs cases")));
    let error = "error: cases/1: cannot create the folder: File exists\n";
    assert!(told.ends_with(error), "{told}");
    assert_eq!(bench.names("."), ["cases"], "no file without a row is left");
    ended(2, sweep(&bench, "--vary payload.mass=0,0.01 --outputs all --nodes 11"));
    assert_eq!(bench.names("."), ["cases"]);
    let told = stderr(&ended(5, sweep(&bench, "--vary payload.mass=0,0.01 -o .")));
    assert!(told.ends_with("a folder has this name\n"), "{told}");
}

#[cfg(unix)]
#[test]
fn a_sweep_whose_reader_has_gone_away_ends() {
    let program = env!("CARGO_BIN_EXE_flexlink");
    let (link, motion) = (repository(LINK), repository(MOTION));
    // Hours of work, were all of it done.
    let sweep = format!("sweep '{link}' '{motion}' --vary 'segments.*.EI*=1:8:1000000' -o -");
    let script = format!("set -o pipefail; '{program}' {sweep} | head -2");
    let mut bash = std::process::Command::new("bash");
    let output = bash.args(["-c", &script]).current_dir(Bench::new().path(".")).output();
    assert_eq!(stdout(&succeeded(output.unwrap())).lines().count(), 2);
}

#[test]
fn a_path_in_an_error_does_not_get_into_the_table() {
    let bench = Bench::new();
    let told = stderr(&swept(&bench, "--vary segments.beam.length=1.35,-1"));
    assert!(!bench.read("sweep.csv").contains(&repository("specs")));
    assert!(told.starts_with("warning: 1 of 2 cases failed"), "{told}");
    // Here the file's own line is to blame.
    let link = std::fs::read_to_string(repository(LINK)).unwrap();
    bench.write("link.toml", &(link + "\n[[masses]]\nat = 1.4\nmass = 0.1\n"));
    let link = bench.path("link.toml").to_str().unwrap().to_owned();
    bench.done(&["sweep", &link, MOTION, "--vary", "segments.beam.length=1.35,1.2"]);
    let error = &bench.cells("sweep.csv", "error")[1];
    assert!(error.starts_with("link.toml:") || error.starts_with("--vary"), "{error}");
}

#[test]
fn factors_for_all_cases_multiply_those_that_are_varied() {
    let bench = Bench::new();
    let given = "--scale-duration 1.6 --scale-distance=-0.5";
    swept(&bench, &format!("--vary duration*=1,1.25 --outputs all {given}"));
    let scaled = bench.rows("sweep.csv");
    swept(&bench, "--vary distance*=-0.5 --vary duration*=1.6,2 --outputs alone");
    for (scaled, varied) in scaled.iter().zip(&bench.rows("sweep.csv")) {
        assert_eq!(scaled[1..], varied[2..]);
    }
    assert!(bench.contents("all/2") == bench.contents("alone/2"));
}

#[test]
fn a_slower_and_a_longer_motion_scale_the_torque_of_a_stiff_link() {
    let bench = Bench::new();
    swept(&bench, "--vary distance*=1,2 --vary duration*=1,2 --set segments.*.EI*=1e4");
    let rigid = bench.numbers("sweep.csv", "peak_rigid_torque_n_m");
    for (shorter, farther) in [(rigid[0], rigid[2]), (rigid[1], rigid[3])] {
        assert!((farther / shorter - 2.0).abs() < 1e-9, "{farther} is not twice {shorter}");
    }
    // The cut-off is found to a thousandth: a slower motion may lose a little more of its torque.
    assert!((rigid[1] / rigid[0] - 0.25).abs() < 1e-5, "{rigid:?}");
    for ratio in bench.numbers("sweep.csv", "torque_ratio") {
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
    bench.solve("-q");
    swept(&bench, "--vary segments.*.EI*=1,1.1 --torque out/torque.csv --outputs played");
    let header = "segments.*.EI*,period_1_s,zero_1_per_s,tip_error_m,tip_error_share,\
                  tip_error_time_s,rms_tip_error_m,final_tip_error_m,residual_m,residual_share,\
                  residual_frequency_hz,residual_decay_s,peak_hub_angle_rad,peak_hub_rate_rad_s,\
                  peak_hub_acceleration_rad_s2,peak_power_w,\
                  peak_deflection_m,tip_model_error,deflection_model_error,warnings,error";
    assert_eq!(bench.rows("sweep.csv")[0].join(","), header);
    // What simulate finds against the same target.
    for (case, factor) in ["1", "1.1"].into_iter().enumerate() {
        let set = format!("--target out/tip.csv -o alone --set segments.*.EI*={factor}");
        simulated(&bench, &format!("out/torque.csv {set}"));
        for (name, path) in [
            ("tip_error_m", "tip_error/worst_m"),
            ("tip_error_share", "tip_error/share"),
            ("residual_m", "residual/amplitude_m"),
            ("peak_deflection_m", "results/peak_deflection_m"),
            ("tip_model_error", "errors/tip/model"),
            ("deflection_model_error", "errors/deflection/model"),
        ] {
            let found = bench.numbers("sweep.csv", name)[case];
            let expected = bench.number("alone", path);
            // The sweep holds the tip against the motion asked for, `out/tip.csv` is within 1e-6 of it.
            assert!((found - expected).abs() < 1e-6, "{name}: {found}, {expected}");
        }
        let [found, alone] = [&format!("played/{}", case + 1), "alone"]
            .map(|run| column(&bench, &format!("{run}/tip.csv"), "tip_displacement_m"));
        assert!(apart(&found, &alone) < 1e-9);
    }
    // method.md, section 7: 1.4 % for ten percent of stiffness.
    let share = bench.numbers("sweep.csv", "tip_error_share")[1];
    assert!((share - 0.0142).abs() < 2e-4, "{share}");
}

#[test]
fn a_table_for_a_converter_is_played_held_on_every_case() {
    let bench = Bench::new();
    bench.done("trajectory sine --distance 0.5 --duration 0.88 --step 0.01 -o coarse.csv");
    bench.done(&format!("solve {LINK} coarse.csv --write held.csv --hold zero -o out"));
    let strays = |more: &str| {
        let vary = "--vary hub.inertia*=1,1.05 --torque held.csv -o rows.csv -q";
        bench.done(&format!("sweep {LINK} coarse.csv {vary} {more}"));
        bench.numbers("rows.csv", "tip_error_m")
    };
    let (held, smooth) = (strays("--hold zero"), strays(""));
    assert!(held[0] < 0.3 * smooth[0] && held[1] > 2.0 * held[0], "{held:?} {smooth:?}");
    simulated(&bench, "held.csv --hold zero --target out/tip.csv");
    let worst = bench.number("simulated", "tip_error/worst_m");
    assert!((held[0] / worst - 1.0).abs() < 0.02, "{} {worst}", held[0]);
}

#[test]
fn the_cases_do_not_replace_the_torque_that_is_played_on_them() {
    let bench = Bench::new();
    bench.solve("-q -o all/2");
    let before = bench.contents("all/2");
    let torque = "--vary payload.mass=0,0.01 --torque all/2/torque.csv --outputs ./all";
    assert_eq!(
        stderr(&ended(2, sweep(&bench, torque))),
        "error: --outputs = ./all, but must be another folder than that of all/2/torque.csv\n\
         hint: a folder holds one run: the results would replace those read\n"
    );
    assert!(bench.contents("all/2") == before);
}

#[test]
fn a_table_may_lie_beside_the_folders_of_its_cases() {
    let bench = Bench::new();
    swept(&bench, "--vary payload.mass=0,0.01 -o all/table.csv --outputs all");
    assert_eq!(bench.names("all"), ["1", "2", "table.csv", "table.json"]);
}

#[test]
fn remarks_do_not_depend_on_the_order_of_the_cases() {
    let bench = Bench::new();
    let beam = "[hub]\ninertia = 1\n[[segments]]\nlength = 1\nE = '70 GPa'\ndensity = 2700\n\
                section = { shape = 'rectangle', width = 0.02, thickness = 0.01 }\n";
    bench.write("beam.toml", beam);
    for (values, first) in [("2700,2.7,2.8", 2), ("2.7,2700,2.8", 1)] {
        let vary = format!("sweep beam.toml {MOTION} --vary segments.0.density={values}");
        let told = stderr(&bench.run(&vary));
        let remark =
            format!("remark: 2 of 3 cases, the first is case {first}: segments.0.density = 2.7");
        assert!(told.starts_with(&remark), "{told}");
        assert_eq!(told.matches("remark: ").count(), 1, "{told}");
    }
}

#[test]
fn two_tables_do_not_share_a_record() {
    let bench = Bench::new();
    let vary = "--vary payload.mass=0,0.01 -o two";
    swept(&bench, vary);
    let record = bench.read("two.json");
    let told = stderr(&ended(2, sweep(&bench, &format!("{vary}.csv"))));
    let error =
        "error: --output = two.csv, but its record two.json would replace the record of two\n";
    assert!(told.starts_with(error), "{told}");
    assert!(bench.read("two.json") == record);
    swept(&bench, vary);
}

#[test]
fn rows_go_to_standard_output_for_a_dash_and_nothing_else_does() {
    let bench = Bench::new();
    let output = swept(&bench, "--vary payload.mass=0,0.001 -o -");
    swept(&bench, "--vary payload.mass=0,0.001");
    assert!(stdout(&output) == bench.read("sweep.csv"));
    assert_eq!(stderr(&output), "", "no progress in a pipe");
}

#[test]
fn a_key_of_segments_is_named_with_its_path() {
    let bench = Bench::new();
    let arm = "specs/arms/two_links.toml";
    for (command, path) in [
        (format!("sweep {LINK} {MOTION} --vary EI=1,2"), "segments.*.EI"),
        (format!("modes {LINK} --set mass_per_length*=2"), "segments.*.mass_per_length"),
        (format!("modes {arm} --at 0,1 --set EI*=2"), "links.*.segments.*.EI"),
    ] {
        let told = stderr(&bench.run(&command));
        let key = path.rsplit('.').next().unwrap();
        let hint = format!("hint: {key} is a key of segments: {path} changes all of them\n");
        assert!(told.ends_with(&hint), "{told}");
        let right = command.replace(&format!(" {key}"), &format!(" {path}"));
        assert!(bench.run(&right).status.success(), "{right}");
    }
}
