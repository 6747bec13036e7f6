//! Tables as instruments write them: what is told, and what the run is worth.

use std::collections::BTreeMap;

use super::{Bench, LINK, refusal, repository, stderr};

const FILES: &str = "tests/files/instruments";

/// Runs the program, which must succeed, and returns what it prints to standard error.
fn told(bench: &Bench, arguments: &[&str]) -> String {
    let output = bench.done(arguments);
    stderr(&output)
}

/// A copy of an instrument's file.
fn copied(bench: &Bench, name: &str) {
    std::fs::copy(repository(&format!("{FILES}/{name}")), bench.path(name)).unwrap();
}

#[test]
fn a_recording_is_solved_as_its_standard_form_is() {
    let bench = Bench::new();
    let link = repository(LINK);
    copied(&bench, "excel_de.csv");
    let standard: String = bench.read("excel_de.csv").lines().skip(1).fold(
        "time,displacement [mm]\n".to_owned(),
        |text, row| {
            let fields: Vec<String> = row.split(';').map(|f| f.replace(',', ".")).collect();
            text + &fields[..2].join(",") + "\n"
        },
    );
    bench.write("standard.csv", &standard);
    let note = "note: excel_de.csv: read ; as delimiter, decimal comma, time from column 1 \"Zeit\", \
                displacement from column 2 \"Weg\" in mm\n\
                remark: excel_de.csv: columns not read: 3 \"Kraft (N)\"\n\
                hint: --columns QUANTITY=NUMBER reads one of them instead\n";
    let found = told(&bench, &["solve", &link, "excel_de.csv", "-o", "found"]);
    let rest = found.strip_prefix(note).unwrap_or_else(|| panic!("{found}"));
    assert_eq!(told(&bench, &["solve", &link, "standard.csv", "-o", "standard"]), rest);
    for name in ["torque.csv", "hub_angle.csv", "tip.csv"] {
        let [found, standard] =
            ["found", "standard"].map(|run| bench.read(&format!("{run}/{name}")));
        assert!(found == standard, "{name}");
    }
}

#[test]
fn options_of_the_reader_are_recorded_and_repeated() {
    let bench = Bench::new();
    let link = repository(LINK);
    copied(&bench, "matlab_writematrix.csv");
    let options = ["--columns", "time=1,displacement=3", "--unit", "m", "--skip", "0"];
    let arguments = ["solve", &link, "matlab_writematrix.csv", "-q"];
    told(&bench, &[&arguments[..], &options].concat());
    let recorded = &bench.json("out/summary.json")["inputs"]["arguments"];
    let expected = ["--columns", "time=1", "--columns", "displacement=3", "--unit", "m"];
    assert_eq!(*recorded, serde_json::json!(expected));
    bench.done(&["solve", "--repeat", "out", &link]);
}

#[test]
fn a_slip_beside_a_known_column_is_remarked() {
    let bench = Bench::new();
    copied(&bench, "reference.csv");
    let text = bench.read("reference.csv").replace("displacement\n", "displacement,acelleration\n");
    let rows: String = text
        .lines()
        .map(|row| if row.starts_with("time") { format!("{row}\n") } else { format!("{row},0\n") })
        .collect();
    bench.write("slip.csv", &rows);
    let found = told(&bench, &["verify", &repository(LINK), "slip.csv"]);
    let remark = "remark: slip.csv: columns not read: 3 \"acelleration\"\n\
                  hint: did you write acceleration as \"acelleration\"?\n";
    assert!(found.starts_with(remark), "{found}");
}

#[test]
fn torques_targets_and_references_are_read_in_any_form() {
    let bench = Bench::new();
    let link = repository(LINK);
    bench.solve(&["-q"]);
    let german = |name: &str, names: &str| {
        let table = bench.read(name);
        let (_, rows) = table.split_once('\n').unwrap();
        format!("{names}\n{}", rows.replace(',', ";").replace('.', ","))
    };
    bench.write("torque.csv", &german("out/torque.csv", "Zeit (s);Drehmoment (Nm)"));
    let names = "Zeit (s);Position (m);Speed (m/s);acc (m/s2)";
    bench.write("tip.csv", &german("out/tip.csv", names));
    let names = "t;Hub angle (rad);Hub rate (rad/s);a;b";
    bench.write("hub.csv", &german("out/hub_angle.csv", names));
    let feedback = ["--feedback", "20,2", "--reference", "hub.csv", "--target", "tip.csv", "-q"];
    let found = told(&bench, &[&["simulate", &link, "torque.csv"], &feedback[..]].concat());
    assert_eq!(found.matches("decimal comma").count(), 3, "{found}");
    let standard =
        ["--feedback", "20,2", "--reference", "out/hub_angle.csv", "--target", "out/tip.csv", "-q"];
    let arguments = ["simulate", &link, "out/torque.csv", "-o", "standard"];
    told(&bench, &[&arguments[..], &standard].concat());
    assert!(bench.read("simulated/tip.csv") == bench.read("standard/tip.csv"));

    let vary = ["--vary", "payload.mass=0,0.05", "--torque", "torque.csv", "-q"];
    let found = told(&bench, &[&["sweep", &link, "tip.csv"], &vary[..]].concat());
    assert_eq!(found.matches("decimal comma").count(), 2, "{found}");
}

#[test]
fn times_in_days_are_told_before_the_work_and_the_refusal_names_the_unit() {
    let bench = Bench::new();
    let rows_from = |first_day: f64| {
        let row = |k: i32| {
            let u = f64::from(k) / 100.0;
            let (day, m) = (first_day + u / 86400.0, u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u));
            format!("{day:.12},{m:.9}\n")
        };
        (0..=100).map(row).collect::<Vec<_>>().concat()
    };
    // Of days that begin at 0 the window alone would be large.
    bench.write("days.csv", &format!("time,displacement\n{}", rows_from(0.0)));
    let quick = repository("specs/quanser_flexgage.toml");
    let output = bench.run(&["solve", &quick, "days.csv"]);
    let found = stderr(&output);
    assert!(found.starts_with("remark: the tip moves for 1.157e-5 s"), "{found}");
    assert!(found.contains("\nerror: days.csv: time = such that "), "{found}");
    assert_eq!(output.status.code(), Some(3));
    let rows = rows_from(45349.0);
    bench.write("days.csv", &format!("time,displacement\n{rows}"));
    let output = bench.run(&["solve", &repository(LINK), "days.csv"]);
    let found = stderr(&output);
    let hint = "hint: name the unit in the column's heading, as in \"time [ms]\"\n";
    assert!(found.starts_with("remark: the tip moves for "), "{found}");
    assert!(found.contains("probably time in another unit"), "{found}");
    assert!(found.ends_with(hint), "{found}");
    assert!(found.contains("error: days.csv: time = such that the period = 216"), "{found}");
    assert_eq!(output.status.code(), Some(3));
    // `verify` refuses it in the same words.
    let output = bench.run(&["verify", &repository(LINK), "days.csv"]);
    assert_eq!((stderr(&output), output.status.code()), (found, Some(3)));
    bench.write("named.csv", &format!("time [d],displacement\n{rows}"));
    bench.done(&["solve", &repository(LINK), "named.csv"]);
}

#[test]
fn a_sign_that_may_stand_between_thousands_needs_the_option() {
    let bench = Bench::new();
    let row = |k: i32| {
        let u = f64::from(k) / 100.0;
        let um = 3e5 * u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u) + 1e4;
        let (thousands, rest) = ((um / 1e3).trunc(), um.round() % 1e3);
        format!("{};{thousands}.{rest:03}\n", 10 * k)
    };
    let rows = (0..=100).map(row).collect::<Vec<_>>().concat();
    bench.write("um.csv", &format!("Zeit (ms);Weg (um)\n{rows}"));
    let arguments = ["solve", &repository(LINK), "um.csv", "--decimal", "point"];
    bench.refuses(
        3,
        &arguments[..3],
        "hint: use --decimal point if decimals follow it; write nothing",
    );
    bench.done(&arguments);
}

#[cfg(unix)]
#[test]
fn measured_values_in_a_pipe_are_refused() {
    let bench = Bench::new();
    let fit = |name: &str| {
        let response = format!("[[response]]\nfile = \"{name}\"\ntransfer = \"hub_angle\"\n");
        bench.write("measured.toml", &response);
        bench.run(&["fit", &repository(LINK), "measured.toml", "--free", "segments.*.EI"])
    };
    let made = std::process::Command::new("mkfifo").arg(bench.path("pipe")).status();
    assert!(made.expect("mkfifo").success());
    refusal(3, fit("pipe"), "must be a file");
}

/// A file in which one number of a row is changed: to what it was, and something more.
fn spoiled(bench: &Bench, (from, to): (&str, &str), (row, column): (usize, usize), more: f64) {
    let text: String = bench
        .read(from)
        .lines()
        .enumerate()
        .map(|(line, text)| {
            let mut fields: Vec<String> = text.split(',').map(str::to_owned).collect();
            if line == row {
                fields[column] = (fields[column].parse::<f64>().unwrap() + more).to_string();
            }
            fields.join(",") + "\n"
        })
        .collect();
    bench.write(to, &text);
}

#[test]
fn a_bad_sample_is_refused_and_on_request_replaced_and_counted() {
    let bench = Bench::new();
    let arm = repository("specs/arms/two_links.toml");
    let septic = ["trajectory", "septic", "--step", "0.005", "--duration", "1"];
    told(&bench, &[&septic[..], &["--distance", "0.5", "-o", "link.csv"]].concat());
    let line = ["--path", "line", "--from", "0.9,-0.5", "--to", "0.5,0.8", "-o", "arm.csv"];
    told(&bench, &[&septic[..], &line].concat());
    // The acceleration of the link's tip, and y of the arm's.
    for (file, name, column, torque) in
        [(repository(LINK), "link", 1, "torque"), (arm, "arm", 2, "torques")]
    {
        let file_of_good = format!("{name}.csv");
        spoiled(&bench, (&file_of_good, "bad.csv"), (81, column), 0.005);
        let text = stderr(&bench.ends(3, &["solve", &file, "bad.csv", "-q"]));
        assert!(text.contains("bad.csv:82: ") && text.contains("it is 0.00500 m"), "{text}");
        assert!(text.contains("--drop-outliers"), "{text}");
        let dropped = ["solve", &file, "bad.csv", "--drop-outliers", "-o", "dropped"];
        let text = told(&bench, &dropped);
        let remark = "remark: 1 sample was replaced by the values that its neighbours predict\n";
        assert!(text.contains(remark), "{text}");
        let summary = bench.json("dropped/summary.json");
        let kinds = summary["remarks"].as_array().unwrap().iter();
        assert!(kinds.map(|own| &own["kind"]).any(|kind| kind == "dropped_outliers"), "{summary}");
        assert_eq!(summary["inputs"]["arguments"], serde_json::json!(["--drop-outliers"]));
        told(&bench, &["solve", &file, &file_of_good, "-o", "good"]);
        // By the time in whole steps: the runs may begin one apart.
        let of = |folder: &str| -> BTreeMap<String, f64> {
            let columns = bench.table(&format!("{folder}/{torque}.csv"));
            let torques = &columns[1];
            let steps = columns[0].1.iter().map(|time| format!("{:.0}", time / 0.005));
            steps.zip(torques.1.iter().copied()).collect()
        };
        let (good, dropped) = (of("good"), of("dropped"));
        let peak = good.values().fold(0.0_f64, |most, own| most.max(own.abs()));
        let common = good.iter().filter_map(|(step, own)| Some((own, dropped.get(step)?)));
        let differences: Vec<f64> = common.map(|(own, other)| (own - other).abs()).collect();
        assert!(differences.len() + 2 >= good.len().max(dropped.len()));
        let worst = differences.into_iter().fold(0.0_f64, f64::max);
        assert!(worst < 1e-2 * peak, "{name}: {worst} of {peak}");
        // Nothing was replaced in a good file.
        let text = told(&bench, &["solve", &file, &file_of_good, "--drop-outliers"]);
        assert!(!text.contains("replaced"), "{text}");
    }
}

/// Rows of bad samples, and how far these are off in m.
#[test]
fn bad_samples_beside_each_other_and_at_the_ends_are_refused_and_replaced() {
    let bench = Bench::new();
    let link = repository(LINK);
    let row = |k: u32| {
        let time_s = 0.005 * f64::from(k);
        let u = time_s.min(1.0);
        let place_m = 0.5 * u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3));
        format!("{time_s:.3},{place_m:.9}\n")
    };
    let rows: Vec<String> = (0..=220).map(row).collect();
    bench.write("good.csv", &format!("time,displacement\n{}", rows.concat()));
    let last = rows.len();
    for bad in [
        vec![(101, 0.005), (102, 0.004)],
        vec![(101, 0.005), (102, -0.006)],
        vec![(101, -0.005), (103, -0.005)],
        vec![(101, 0.005), (102, 0.006), (103, 0.004)],
        vec![(1, 0.005)],
        vec![(2, 0.005)],
        vec![(3, 0.005)],
        vec![(1, 0.003), (2, 0.004)],
        vec![(last - 2, 0.005)],
        vec![(last - 1, -0.005), (last, -0.005)],
    ] {
        std::fs::copy(bench.path("good.csv"), bench.path("bad.csv")).unwrap();
        for (row, off) in &bad {
            spoiled(&bench, ("bad.csv", "bad.csv"), (*row, 1), *off);
        }
        let text = stderr(&bench.ends(3, &["solve", &link, "bad.csv", "-q"]));
        let named = format!("bad.csv:{}: displacement = ", bad[0].0 + 1);
        assert!(text.contains(&named) && text.contains("--drop-outliers"), "{bad:?}: {text}");
        let text = told(&bench, &["solve", &link, "bad.csv", "--drop-outliers"]);
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
    let link = repository(LINK);
    let torque = |of: &dyn Fn(u32) -> f64| {
        let row = |k: u32| format!("{:.3},{:.6}\n", 0.005 * f64::from(k), of(k));
        let rows: Vec<String> = (0..400).map(row).collect();
        bench.write("torque.csv", &format!("time,torque\n{}", rows.concat()));
        told(&bench, &["simulate", &link, "torque.csv"])
    };
    let wave = |k: u32| (0.016 * f64::from(k)).sin();
    let pulsed = |k: u32| if k == 150 { wave(k) + 0.3 } else { wave(k) };
    let found = torque(&pulsed);
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
