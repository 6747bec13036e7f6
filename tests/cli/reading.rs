//! Tables as instruments write them: what is told, and what the run is worth.

use std::collections::BTreeMap;

use super::{Bench, LINK, min_jerk, peak, refusal, repository, septic};

/// A copy of an instrument's file.
fn copied(bench: &Bench, name: &str) {
    let from = repository(&format!("tests/files/instruments/{name}"));
    std::fs::copy(from, bench.path(name)).unwrap();
}

#[test]
fn a_recording_is_solved_as_its_standard_form_is() {
    let bench = Bench::new();
    copied(&bench, "excel_de.csv");
    let text = bench.read("excel_de.csv").replace(',', ".");
    let row = |row: &str| row.split(';').take(2).collect::<Vec<_>>().join(",") + "\n";
    let rows: String = text.lines().skip(1).map(row).collect();
    bench.write("standard.csv", &format!("time,displacement [mm]\n{rows}"));
    let note = "note: excel_de.csv: read ; as delimiter, decimal comma, time from column 1 \"Zeit\", \
                displacement from column 2 \"Weg\" in mm\n\
                remark: excel_de.csv: columns not read: 3 \"Kraft (N)\"\n\
                hint: --columns QUANTITY=NUMBER reads one of them instead\n";
    let found = bench.told(&format!("solve {LINK} excel_de.csv -o found"));
    let rest = found.strip_prefix(note).unwrap_or_else(|| panic!("{found}"));
    assert_eq!(bench.told(&format!("solve {LINK} standard.csv -o standard")), rest);
    for name in ["torque.csv", "hub_angle.csv", "tip.csv"] {
        let [found, standard] =
            ["found", "standard"].map(|run| bench.read(&format!("{run}/{name}")));
        assert!(found == standard, "{name}");
    }
}

#[test]
fn options_of_the_reader_are_recorded_and_repeated() {
    let bench = Bench::new();
    copied(&bench, "matlab_writematrix.csv");
    let options = "--columns time=1,displacement=3 --unit m --skip 0";
    bench.done(&format!("solve {LINK} matlab_writematrix.csv -q {options}"));
    let recorded = &bench.json("out/summary.json")["inputs"]["arguments"];
    let expected = ["--columns", "time=1", "--columns", "displacement=3", "--unit", "m"];
    assert_eq!(*recorded, serde_json::json!(expected));
    bench.done(&format!("solve --repeat out {LINK}"));
}

#[test]
fn a_slip_beside_a_known_column_is_remarked() {
    let bench = Bench::new();
    copied(&bench, "reference.csv");
    let text = bench.read("reference.csv").replace("displacement\n", "displacement,acelleration\n");
    let row = |row: &str| format!("{row}{}\n", if row.starts_with("time") { "" } else { ",0" });
    bench.write("slip.csv", &text.lines().map(row).collect::<String>());
    let found = bench.told(&format!("verify {LINK} slip.csv"));
    let remark = "remark: slip.csv: columns not read: 3 \"acelleration\"\n\
                  hint: did you write acceleration as \"acelleration\"?\n";
    assert!(found.starts_with(remark), "{found}");
}

#[test]
fn torques_targets_and_references_are_read_in_any_form() {
    let bench = Bench::new();
    bench.solve("-q");
    for (name, from, heading) in [
        ("torque.csv", "torque", "Zeit (s);Drehmoment (Nm)"),
        ("tip.csv", "tip", "Zeit (s);Position (m);Speed (m/s);acc (m/s2)"),
        ("hub.csv", "hub_angle", "t;Hub angle (rad);Hub rate (rad/s);a;b"),
    ] {
        let table = bench.read(&format!("out/{from}.csv"));
        let (_, rows) = table.split_once('\n').unwrap();
        bench.write(name, &format!("{heading}\n{}", rows.replace(',', ";").replace('.', ",")));
    }
    let play = format!("simulate {LINK} --feedback 20,2 -q");
    let found = bench.told(&format!("{play} torque.csv --reference hub.csv --target tip.csv"));
    assert_eq!(found.matches("decimal comma").count(), 3, "{found}");
    let standard = "out/torque.csv --reference out/hub_angle.csv --target out/tip.csv";
    bench.done(&format!("{play} {standard} -o standard"));
    assert!(bench.read("simulated/tip.csv") == bench.read("standard/tip.csv"));

    let vary = "--vary payload.mass=0,0.05 --torque torque.csv -q";
    let found = bench.told(&format!("sweep {LINK} tip.csv {vary}"));
    assert_eq!(found.matches("decimal comma").count(), 2, "{found}");
}

#[test]
fn times_in_days_are_told_before_the_work_and_the_refusal_names_the_unit() {
    let bench = Bench::new();
    let rows_from = |first_day: f64| {
        let row = |k: i32| {
            let u = f64::from(k) / 100.0;
            format!("{:.12},{:.9}\n", first_day + u / 86400.0, min_jerk(u))
        };
        (0..=100).map(row).collect::<String>()
    };
    // Of days that begin at 0 the window alone would be large.
    bench.write("days.csv", &format!("time,displacement\n{}", rows_from(0.0)));
    let found = bench.error(3, "solve specs/quanser_flexgage.toml days.csv");
    assert!(found.starts_with("remark: the tip moves for 1.157e-5 s"), "{found}");
    assert!(found.contains("\nerror: days.csv: time = such that "), "{found}");
    let rows = rows_from(45349.0);
    bench.write("days.csv", &format!("time,displacement\n{rows}"));
    let found = bench.error(3, &format!("solve {LINK} days.csv"));
    let hint = "hint: name the unit in the column's heading, as in \"time [ms]\"\n";
    assert!(found.starts_with("remark: the tip moves for "), "{found}");
    assert!(found.contains("probably time in another unit"), "{found}");
    assert!(found.ends_with(hint), "{found}");
    assert!(found.contains("error: days.csv: time = such that the period = 216"), "{found}");
    // `verify` refuses it in the same words.
    assert_eq!(bench.error(3, &format!("verify {LINK} days.csv")), found);
    bench.write("named.csv", &format!("time [d],displacement\n{rows}"));
    bench.done(&format!("solve {LINK} named.csv"));
}

#[test]
fn a_sign_that_may_stand_between_thousands_needs_the_option() {
    let bench = Bench::new();
    let row = |k: i32| {
        let um = 3e5 * min_jerk(f64::from(k) / 100.0) + 1e4;
        let (thousands, rest) = ((um / 1e3).trunc(), um.round() % 1e3);
        format!("{};{thousands}.{rest:03}\n", 10 * k)
    };
    bench.write(
        "um.csv",
        &format!("Zeit (ms);Weg (um)\n{}", (0..=100).map(row).collect::<String>()),
    );
    let solve = format!("solve {LINK} um.csv");
    bench.refuses(3, &solve, "hint: use --decimal point if decimals follow it; write nothing");
    bench.done(&format!("{solve} --decimal point"));
}

#[cfg(unix)]
#[test]
fn measured_values_in_a_pipe_are_refused() {
    let bench = Bench::new();
    bench.write("measured.toml", "[[response]]\nfile = 'pipe'\ntransfer = 'hub_angle'\n");
    let made = std::process::Command::new("mkfifo").arg(bench.path("pipe")).status();
    assert!(made.expect("mkfifo").success());
    let fit = format!("fit {LINK} measured.toml --free segments.*.EI");
    refusal(3, bench.run(&fit), "must be a file");
}

/// A file in which one number of a row is changed: to what it was, and something more.
fn spoiled(bench: &Bench, (from, to): (&str, &str), (row, column): (usize, usize), more: f64) {
    let text = bench.read(from);
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut fields: Vec<String> = lines[row].split(',').map(str::to_owned).collect();
    fields[column] = (fields[column].parse::<f64>().unwrap() + more).to_string();
    lines[row] = fields.join(",");
    bench.write(to, &(lines.join("\n") + "\n"));
}

#[test]
fn a_bad_sample_is_refused_and_on_request_replaced_and_counted() {
    let bench = Bench::new();
    let motion = "trajectory septic --step 0.005 --duration 1";
    bench.done(&format!("{motion} --distance 0.5 -o link.csv"));
    bench.done(&format!("{motion} --path line --from 0.9,-0.5 --to 0.5,0.8 -o arm.csv"));
    // The acceleration of the link's tip, and y of the arm's.
    for (file, name, column, torque) in
        [(LINK, "link", 1, "torque"), ("specs/arms/two_links.toml", "arm", 2, "torques")]
    {
        spoiled(&bench, (&format!("{name}.csv"), "bad.csv"), (81, column), 0.005);
        let text = bench.error(3, &format!("solve {file} bad.csv -q"));
        assert!(text.contains("bad.csv:82: ") && text.contains("it is 0.00500 m"), "{text}");
        assert!(text.contains("--drop-outliers"), "{text}");
        let text = bench.told(&format!("solve {file} bad.csv --drop-outliers -o dropped"));
        let remark = "remark: 1 sample was replaced by the values that its neighbours predict\n";
        assert!(text.contains(remark), "{text}");
        let summary = bench.json("dropped/summary.json");
        let kinds = summary["remarks"].as_array().unwrap().iter();
        assert!(kinds.map(|own| &own["kind"]).any(|kind| kind == "dropped_outliers"), "{summary}");
        assert_eq!(summary["inputs"]["arguments"], serde_json::json!(["--drop-outliers"]));
        bench.done(&format!("solve {file} {name}.csv -o good"));
        // By the time in whole steps: the runs may begin one apart.
        let of = |folder: &str| -> BTreeMap<String, f64> {
            let columns = bench.table(&format!("{folder}/{torque}.csv"));
            let steps = columns[0].1.iter().map(|time| format!("{:.0}", time / 0.005));
            steps.zip(columns[1].1.iter().copied()).collect()
        };
        let (good, dropped) = (of("good"), of("dropped"));
        let common = good.iter().filter_map(|(step, own)| Some(own - dropped.get(step)?));
        let differences: Vec<f64> = common.collect();
        assert!(differences.len() + 2 >= good.len().max(dropped.len()));
        let torques: Vec<f64> = good.into_values().collect();
        assert!(peak(&differences) < 1e-2 * peak(&torques), "{name}: {}", peak(&differences));
        // Nothing was replaced in a good file.
        let text = bench.told(&format!("solve {file} {name}.csv --drop-outliers"));
        assert!(!text.contains("replaced"), "{text}");
    }
}

/// Rows of bad samples, and how far these are off in m.
#[test]
fn bad_samples_beside_each_other_and_at_the_ends_are_refused_and_replaced() {
    let bench = Bench::new();
    let row = |k: i32| {
        let time_s = 0.005 * f64::from(k);
        format!("{time_s:.3},{:.9}\n", 0.5 * septic(time_s.min(1.0)))
    };
    let last = 221;
    bench.write(
        "good.csv",
        &format!("time,displacement\n{}", (0..221).map(row).collect::<String>()),
    );
    for bad in [
        &[(101, 0.005), (102, 0.004)][..],
        &[(101, 0.005), (102, -0.006)],
        &[(101, -0.005), (103, -0.005)],
        &[(101, 0.005), (102, 0.006), (103, 0.004)],
        &[(1, 0.005)],
        &[(2, 0.005)],
        &[(3, 0.005)],
        &[(1, 0.003), (2, 0.004)],
        &[(last - 2, 0.005)],
        &[(last - 1, -0.005), (last, -0.005)],
    ] {
        std::fs::copy(bench.path("good.csv"), bench.path("bad.csv")).unwrap();
        for (row, off) in bad {
            spoiled(&bench, ("bad.csv", "bad.csv"), (*row, 1), *off);
        }
        let text = bench.error(3, &format!("solve {LINK} bad.csv -q"));
        let named = format!("bad.csv:{}: displacement = ", bad[0].0 + 1);
        assert!(text.contains(&named) && text.contains("--drop-outliers"), "{bad:?}: {text}");
        let text = bench.told(&format!("solve {LINK} bad.csv --drop-outliers"));
        let counted = match bad.len() {
            1 => "remark: 1 sample was replaced".to_owned(),
            more => format!("remark: {more} samples were replaced"),
        };
        assert!(text.contains(&counted), "{bad:?}: {text}");
    }
}

#[test]
fn a_torque_that_leaves_its_neighbours_for_a_sample_is_told_and_played() {
    let bench = Bench::new();
    let torque = |of: &dyn Fn(u32) -> f64| {
        let row = |k: u32| format!("{:.3},{:.6}\n", 0.005 * f64::from(k), of(k));
        let rows: String = (0..400).map(row).collect();
        bench.write("torque.csv", &format!("time,torque\n{rows}"));
        bench.told(&format!("simulate {LINK} torque.csv"))
    };
    let wave = |k: u32| (0.016 * f64::from(k)).sin();
    let found = torque(&|k| if k == 150 { wave(k) + 0.3 } else { wave(k) });
    assert!(found.contains("line 152: torque = 0.97"), "{found}");
    assert!(found.contains(" N m does not follow its neighbours, which predict 0.67"), "{found}");
    // Commands that jump are none of it.
    let steps = |k: u32| if (k / 50).is_multiple_of(2) { 1.0 } else { -1.0 };
    let bits = |k: u32| if (k.wrapping_mul(2_654_435_761) >> 20) & 1 == 0 { 1.0 } else { -1.0 };
    let short = |k: u32| if (50..53).contains(&k) { 1.0 } else { wave(k) };
    for honest in [&wave as &dyn Fn(u32) -> f64, &steps, &bits, &short] {
        let found = torque(honest);
        assert!(!found.contains("follow"), "{found}");
    }
}

/// Rows of a table of this program, with a new first field.
fn retimed(text: &str, time: impl Fn(f64) -> String, skip: usize) -> String {
    let row = |row: &str| {
        let (time_s, rest) = row.split_once(',').unwrap();
        format!("{},{rest}\n", time(time_s.parse().unwrap()))
    };
    text.lines().skip(1 + skip).map(row).collect()
}

#[test]
fn options_with_the_name_of_a_table_are_for_this_table() {
    let bench = Bench::new();
    bench.solve("-q");
    let play = format!("simulate {LINK} out/torque.csv -q");
    bench.done(&format!("{play} --target out/tip.csv -o standard"));
    let seconds = |time_s: f64| time_s.to_string();
    let rows = retimed(&bench.read("out/tip.csv"), seconds, 0);
    bench.write("tip.csv", &format!("Stand 3\n{rows}"));
    let options = "--columns target:time=1,displacement=2 --skip target:1";
    bench.done(&format!("{play} --target tip.csv {options}"));
    assert!(bench.read("simulated/tip_error.csv") == bench.read("standard/tip_error.csv"));
    let recorded = &bench.json("simulated/summary.json")["inputs"]["arguments"];
    let expected = ["--columns", "target:time=1", "--columns", "target:displacement=2"];
    let expected = [&expected[..], &["--skip", "target:1"]].concat();
    assert_eq!(*recorded, serde_json::json!(expected));

    let found = bench.error(3, &format!("{play} --target tip.csv --skip target:1"));
    assert!(found.contains("--columns target:time=1,displacement=2"), "{found}");
    let found = bench.error(2, &format!("solve {LINK} tip.csv --unit measured:mm"));
    assert!(found.contains("measured is no table of this command, which reads motion"), "{found}");
    let found = bench.error(2, &format!("solve {LINK} tip.csv --skip 1 --skip motion:2"));
    assert!(found.contains("--skip has two values for one table"), "{found}");
}

#[test]
fn tables_of_one_clock_keep_their_shift() {
    let bench = Bench::new();
    bench.solve("-q");
    let start_s = bench.table("out/torque.csv")[0].1[0];
    let of_day = |since: f64| {
        let since = since.rem_euclid(86_400.0);
        let [hours, minutes] = [since / 3600.0, since / 60.0 % 60.0].map(f64::floor);
        format!("{hours:02.0}:{minutes:02.0}:{:09.6}", since % 60.0)
    };
    let clock = |time_s: f64| of_day(36_010.0 + time_s);
    // The torque begins before midnight, the target after it.
    let night = |time_s: f64| of_day(86_399.9 + time_s - start_s);
    let seconds = |time_s: f64| time_s.to_string();
    let ways =
        [("numbers", &seconds as &dyn Fn(f64) -> String), ("clock", &clock), ("night", &night)];
    for (name, time) in ways {
        let torque = retimed(&bench.read("out/torque.csv"), time, 0);
        bench.write("torque.csv", &format!("time,torque_n_m\n{torque}"));
        let tip = retimed(&bench.read("out/tip.csv"), time, 200);
        bench.write("tip.csv", &format!("time,displacement,velocity,acceleration\n{tip}"));
        bench.done(&format!("simulate {LINK} torque.csv --target tip.csv -q -o {name}"));
    }
    let errors = |name: &str| -> Vec<f64> {
        let text = bench.read(&format!("{name}/tip_error.csv"));
        text.lines().skip(1).map(|row| row.rsplit_once(',').unwrap().1.parse().unwrap()).collect()
    };
    let [numbers, clock, night] = ["numbers", "clock", "night"].map(errors);
    for clock in [clock, night] {
        assert_eq!(numbers.len(), clock.len());
        assert!(numbers.iter().zip(&clock).all(|(a, b)| (a - b).abs() < 1e-8));
    }
    let tip = bench.read("out/tip.csv");
    let early = retimed(&tip, |time_s| (time_s - 50.0).to_string(), 0);
    bench.write("early.csv", &format!("time,displacement,velocity,acceleration\n{early}"));
    let found = bench.error(3, &format!("simulate {LINK} out/torque.csv --target early.csv -q"));
    assert!(found.contains("must last beyond the beginning of the simulation"), "{found}");
}

#[test]
fn resampling_neither_smooths_steps_nor_fills_long_gaps() {
    let bench = Bench::new();
    let rows =
        |time: &dyn Fn(i32) -> f64, torque: &dyn Fn(i32) -> f64, leave: &dyn Fn(i32) -> bool| {
            let row = |k: i32| format!("{:.6},{}\n", time(k), torque(k));
            let rows = (0..=400).filter(|k| !leave(*k)).map(row).collect::<String>();
            format!("time,torque\n{rows}")
        };
    let even = |k: i32| 0.005 * f64::from(k);
    let uneven = |k: i32| even(k) + if k % 3 == 1 { 4e-4 } else { 0.0 };
    let stairs = |k: i32| if k / 40 % 2 == 0 { 1.0 } else { -1.0 };
    let sine = |k: i32| (std::f64::consts::PI * 0.01 * f64::from(k)).sin();
    bench.write("even.csv", &rows(&even, &stairs, &|_| false));
    bench.write("uneven.csv", &rows(&uneven, &stairs, &|_| false));
    bench.write("gap.csv", &rows(&even, &sine, &|k| (120..=133).contains(&k)));
    bench.write("short.csv", &rows(&even, &sine, &|k| (120..=122).contains(&k)));
    let play = |file: &str| format!("simulate {LINK} {file} --resample 0.005 -q");
    bench.done(&format!("{} --hold zero", play("even.csv")));
    for hold in ["zero", "linear"] {
        let found = bench.error(3, &format!("{} --hold {hold}", play("uneven.csv")));
        assert!(found.contains("uneven.csv: the times are not uniform"), "{found}");
    }
    let found = bench.error(3, &play("gap.csv"));
    let must =
        "gap.csv:121: gap = 0.0750 s after this row, but must be at most 0.0500 s, 10 usual steps";
    assert!(found.contains(must), "{found}");
    let found = bench.told(&play("short.csv"));
    assert!(found.contains("a gap of 0.0200 s after line 121 interpolated"), "{found}");
}

#[test]
fn a_reference_shifted_to_other_times_than_the_torque_is_refused() {
    let bench = Bench::new();
    bench.solve("-q");
    let torque = bench.read("out/torque.csv");
    let rows = retimed(&torque, |time_s| time_s.to_string(), 0);
    bench.write("torque.csv", &format!("# motion begins at 0.5 s\ntime,torque\n{rows}"));
    let play =
        format!("simulate {LINK} torque.csv --feedback 20,2 -q --reference out/hub_angle.csv");
    let found = bench.error(3, &play);
    assert!(found.contains("hub_angle.csv: times = "), "{found}");
    assert!(found.contains(" of TORQUE"), "{found}");
}

/// A motion over 1.2 s whose camera has 239.76 frames a second.
fn camera(bench: &Bench, name: &str) {
    let row = |k: i32| {
        let time_s = f64::from(k) / 239.76;
        format!("{time_s:.9},{:.9}\n", 0.5 * septic((time_s / 1.2).min(1.0)))
    };
    let rows: String = (0..=300).map(row).collect();
    bench.write(name, &format!("time,displacement\n{rows}"));
}

#[test]
fn a_step_that_does_not_divide_the_motion_is_filled_with_its_rest() {
    let bench = Bench::new();
    camera(&bench, "camera.csv");
    // 300 frames last 1.25125 s, 312 steps of 4 ms and 3.25 ms.
    let told = bench.told(&super::with(
        &format!("solve {LINK} camera.csv --write torque.csv -q"),
        &["--resample", "4 ms"],
    ));
    let note = "note: camera.csv: read 7.49e-4 s of rest added after the last row\n";
    assert!(told.contains(note), "{told}");
    let times = &bench.table("torque.csv")[0].1;
    assert!((times[1] - times[0] - 0.004).abs() < 1e-12);
    let exact = |k: i32| {
        let time_s = 0.004 * f64::from(k);
        format!("{time_s:.3},{:.9}\n", 0.5 * septic((time_s / 1.2).min(1.0)))
    };
    let rows: String = (0..=313).map(exact).collect();
    bench.write("exact.csv", &format!("time,displacement\n{rows}"));
    bench.done(&format!("solve {LINK} exact.csv --write exact_torque.csv -q"));
    let [camera, exact] =
        ["torque.csv", "exact_torque.csv"].map(|file| peak(&bench.table(file)[1].1));
    assert!((camera / exact - 1.0).abs() < 1e-3, "{camera} {exact}");
}

#[test]
fn every_table_of_a_command_is_resampled_by_its_name() {
    let bench = Bench::new();
    bench.solve("-q");
    // A gap in every table.
    for name in ["torque", "tip", "hub_angle"] {
        let text = bench.read(&format!("out/{name}.csv"));
        let gap = |(k, row): (usize, &str)| {
            let fields = row.split_once(',').unwrap();
            let gap = "\u{221e},".repeat(fields.1.split(',').count());
            if k == 700 {
                format!("{},{}\n", fields.0, gap.trim_end_matches(','))
            } else {
                format!("{row}\n")
            }
        };
        bench.write(&format!("{name}.csv"), &text.lines().enumerate().map(gap).collect::<String>());
    }
    let step = bench.table("out/torque.csv")[0].1[1] - bench.table("out/torque.csv")[0].1[0];
    let play = format!("simulate {LINK} torque.csv -q --feedback 20,2");
    let tables = "--reference hub_angle.csv --target tip.csv --measured tip.csv";
    let refused = |options: &str, name: &str| {
        let found = bench.error(3, &format!("{play} {tables} {options}"));
        assert!(found.contains("= \u{221e}, but must be a finite number"), "{found}");
        assert!(found.contains(&format!("hint: --resample {name}STEP leaves out")), "{found}");
    };
    let mut options = String::new();
    for name in ["", "reference:", "target:", "measured:"] {
        refused(&options, name);
        options.extend([" --resample ", name, &step.to_string()]);
    }
    let found = bench.told(&format!("{play} {tables} {options}"));
    assert_eq!(found.matches("without line 701, which lacks a value").count(), 4, "{found}");
    let sweep =
        format!("sweep {LINK} out/tip.csv --vary payload.mass=0,0.05 --torque torque.csv -q");
    let found = bench.error(3, &sweep);
    assert!(found.contains("hint: --resample torque:STEP leaves out"), "{found}");
    bench.done(&format!("{sweep} --resample torque:{step}"));
    let learn = format!(
        "learn {LINK} trajectories/sine_0.88s.csv tip.csv --applied torque.csv --uncertain segments.*.EI*=±10%"
    );
    let found = bench.error(3, &learn);
    assert!(found.contains("hint: --resample applied:STEP leaves out"), "{found}");
    let found = bench.error(3, &format!("{learn} --resample applied:{step}"));
    assert!(found.contains("hint: --resample measured:STEP leaves out"), "{found}");
}

#[test]
fn a_cycle_is_not_resampled() {
    let bench = Bench::new();
    let options = "--periodic --resample 0.002";
    let found = bench.error(2, &format!("solve {LINK} trajectories/sine_0.88s.csv {options}"));
    assert!(found.contains("--resample stands beside --periodic"), "{found}");
}
