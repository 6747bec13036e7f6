//! Tables as instruments write them: what is told, and what the run is worth.

use super::{Bench, LINK, repository, stderr, stdout};

const FILES: &str = "tests/files/instruments";

/// Runs the program, which must succeed, and returns what it prints to standard error.
fn told(bench: &Bench, arguments: &[&str]) -> String {
    let output = bench.run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
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
    let found = told(&bench, &["solve", &link, "excel_de.csv", "-o", "found", "-q"]);
    let rest = found.strip_prefix(note).unwrap_or_else(|| panic!("{found}"));
    assert_eq!(told(&bench, &["solve", &link, "standard.csv", "-o", "standard", "-q"]), rest);
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
    let output = bench.run(&["solve", "--repeat", "out", &link]);
    assert!(output.status.success(), "{}{}", stdout(&output), stderr(&output));
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
    let found = told(&bench, &["verify", &repository(LINK), "slip.csv", "-q"]);
    let remark = "remark: slip.csv: columns not read: 3 \"acelleration\"\n\
                  hint: did you mean acceleration by \"acelleration\"?\n";
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
