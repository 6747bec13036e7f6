//! Folders that are refused, each in its words.

use super::{Bench, PAPER};

const A_RUN: &str = "this is not the folder of a run of `flexlink solve`, `simulate` or `robust`";
const ONE_RUN: &str = "a folder holds one run";

/// A run of solve in `out`, with all of its tables.
fn solved() -> Bench {
    let bench = Bench::new();
    bench.solve(&format!("{PAPER} --deflections --moments --nodes 0,10 --every 10"));
    bench
}

/// The refusal of the run after a change of the text of one of its files, which is then undone.
#[track_caller]
fn after(bench: &Bench, file: &str, change: impl Fn(&str) -> String) -> String {
    let name = format!("out/{file}");
    let text = bench.read(&name);
    let changed = change(&text);
    assert_ne!(changed, text, "{file} is changed");
    bench.write(&name, &changed);
    let refusal = bench.refusal("out").0;
    bench.write(&name, &text);
    refusal
}

/// A text with another line, numbered from 1, or without it.
fn with_line(text: &str, line: usize, change: impl Fn(&str) -> Option<String>) -> String {
    let lines = text.lines().enumerate();
    let changed =
        lines.filter_map(|(k, row)| if k + 1 == line { change(row) } else { Some(row.to_owned()) });
    changed.map(|row| row + "\n").collect()
}

fn with_field(text: &str, line: usize, field: usize, value: &str) -> String {
    with_line(text, line, |row| {
        let mut fields: Vec<&str> = row.split(',').collect();
        fields[field] = value;
        Some(fields.join(","))
    })
}

#[test]
fn a_missing_file_is_told_by_its_name() {
    let bench = solved();
    let histories = "torque rigid_torque hub_angle tip nodes";
    let nodal = "nodal_displacements nodal_deflections bending_moments";
    for name in histories.split(' ').chain(nodal.split(' ')) {
        let name = &format!("{name}.csv");
        let path = bench.path("out").join(name);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let named = "summary.json names it";
        assert_eq!(bench.refusal("out").0, format!("out: {name} is missing, but {named}"));
        let summary = bench.read("out/summary.json");
        let unnamed = summary.replace(&format!("    \"{name}\",\n"), "");
        assert_ne!(unnamed, summary);
        bench.write("out/summary.json", &unnamed);
        if name.starts_with("nodal") || name.starts_with("bending") {
            let run = bench.run_of("out");
            assert_eq!(run.links[0].moments_n_m.is_none(), name.starts_with("bending"));
            assert!(run.links[0].deflections_m.is_some());
        } else {
            assert_eq!(bench.refusal("out").0, format!("out: {name} is missing: {A_RUN}"));
        }
        bench.write("out/summary.json", &summary);
        std::fs::write(&path, bytes).unwrap();
    }
    bench.run_of("out");
}

#[test]
fn a_foreign_folder_and_a_path_of_nothing_are_refused() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("none")).unwrap();
    let too = "name the folder of solve, simulate or robust, or the table of sweep";
    let empty = (format!("none: summary.json is missing: {A_RUN}"), Some(too.to_owned()));
    assert_eq!(bench.refusal("none"), empty);
    bench.write("none/data.csv", "a,b\n1,2\n");
    assert_eq!(bench.refusal("none"), empty);
    let missing = bench.refusal("nowhere").0;
    assert!(missing.starts_with("nowhere: cannot read: "), "{missing}");
}

#[test]
fn a_foreign_or_damaged_summary_is_refused() {
    let bench = solved();
    let summary = |text: &str| after(&bench, "summary.json", |_| text.to_owned());
    let other =
        |format: &str| format!("{{{format} \"flexlink\": \"0.1.0\", \"command\": \"solve\"}}");
    for (text, expected) in [
        ("{\"name\": \"a page\"}", &format!(": flexlink is missing: {A_RUN}")[..]),
        (
            "{\"flexlink\": \"0.1.0\", \"command\": \"modes\"}",
            ": command = \"modes\", but must be \"solve\" or \"simulate\"",
        ),
        (&other(""), ": format is missing, but must be 2"),
        (&other("\"format\": 1,"), ": format = 1, but must be 2"),
        (&other("\"format\": 3,"), ": format = 3, but must be 2"),
        ("", ":1: content = EOF while parsing a value, but must be the summary"),
        (" [[1]]", ": content = a list, but must be an object"),
        ("{\n\"flexlink\": \"0.1", ":2: content = EOF while parsing a string, but"),
    ] {
        let refusal = summary(text);
        assert!(refusal.starts_with(&format!("out/summary.json{expected}")), "{refusal}");
    }
    let change =
        |from: &str, to: &str| after(&bench, "summary.json", |text| text.replacen(from, to, 1));
    for (from, to, expected) in [
        ("\"title\"", "\"name\"", "title is missing"),
        (
            "\"length_m\": 0.15",
            "\"length_m\": \"0.15\"",
            "length_m = string \"0.15\", but must be a number",
        ),
        (
            "\"length_m\": 0.15",
            "\"length_m\": -0.15",
            "/summary.json: link.segments.0.length = -0.15 m, but must be finite and above 0",
        ),
        (
            "\"length_m\": 0.15",
            "\"length_m\": 0.25",
            "/summary.json: link.length_m = 1.5 m, but must be 1.6 m, the sum of hub radius and segments",
        ),
        ("\"lead_s\"", "\"lead\"", "/summary.json: results.lead_s is missing"),
        (
            "\"lead_s\": ",
            "\"lead_s\": \"soon\", \"lead\": ",
            "/summary.json: results.lead_s is missing",
        ),
        (
            "\"motion\": {\n    \"given\"",
            "\"mution\": {\n    \"given\"",
            "/summary.json: motion is missing",
        ),
        (
            "\"tip.csv\"",
            "\"../tip.csv\"",
            ": files = \"../tip.csv\", but must be names, without folders or control characters",
        ),
    ] {
        let refusal = change(from, to);
        let is_whole = expected.starts_with(['/', ':']);
        let expected = if is_whole { format!("out{expected}") } else { expected.to_owned() };
        assert!(refusal.starts_with("out") && refusal.ends_with(&expected), "{refusal}");
        assert!(!is_whole || refusal == expected, "{refusal}");
    }
}

#[test]
fn an_older_run_is_refused_with_the_advice_to_run_it_again() {
    let bench = solved();
    let own = bench.read("out/summary.json");
    assert!(own.starts_with("{\n  \"format\": 2,\n"), "{own}");
    let older = own.replacen("  \"format\": 2,\n", "", 1);
    let version = format!("\"flexlink\": \"{}\"", env!("CARGO_PKG_VERSION"));
    bench.write("out/summary.json", &older.replace(&version, "\"flexlink\": \"0.0.9\""));
    let message = "out/summary.json: format is missing, but must be 2";
    let hint = "flexlink 0.0.9 wrote it in an older format: run it again";
    assert_eq!(bench.refusal("out"), (message.to_owned(), Some(hint.to_owned())));
}

#[test]
fn a_later_version_is_told_of_where_something_is_missing() {
    let bench = solved();
    let own = env!("CARGO_PKG_VERSION");
    let summary = bench.read("out/summary.json");
    let version = format!("\"flexlink\": \"{own}\"");
    let later = summary.replace(&version, "\"flexlink\": \"10.0.0\", \"new\": {}");
    let hint = format!("flexlink 10.0.0 wrote it, and this is {own}: take that version");
    // Keys of a later version are passed over.
    bench.write("out/summary.json", &later);
    assert_eq!(bench.run_of("out").origin.version, "10.0.0");
    bench.write("out/summary.json", &later.replace("\"title\"", "\"name\""));
    assert_eq!(bench.refusal("out").1, Some(hint.clone()));
    bench.write("out/summary.json", &later);
    std::fs::remove_file(bench.path("out/tip.csv")).unwrap();
    assert_eq!(bench.refusal("out").1, Some(hint));
    bench.write("out/summary.json", &summary);
    assert_eq!(bench.refusal("out").1, None);
}

#[test]
fn columns_that_are_missing_unknown_or_twice_are_refused() {
    let bench = solved();
    // A file, a word of its names, another in its place, and what is told.
    for row in [
        "torque|torque_n_m|torque_nm|columns = \"time_s,torque_nm\", but must include torque_n_m",
        "torque|time_s|time|columns = \"time,torque_n_m\", but must include time_s",
        "rigid_torque|time_s,rigid_torque_n_m|rigid_torque_n_m,time_s|column 1 = \"rigid_torque_n_m\", but must be \
         time_s",
        "nodes|node,x_m|node,x|columns = \"node,x,segment\", but must be \"node,x_m,segment\"",
        "nodal_displacements|v10_m|v11_m|column 3 = \"v11_m\", but must be of a node, v0_m to v10_m",
        "nodal_displacements|v10_m|v010_m|column 3 = \"v010_m\", but must be of a node, v0_m to v10_m",
        "nodal_deflections|w0_m|v0_m|column 2 = \"v0_m\", but must be of a node, w0_m to w10_m",
        "bending_moments|m0_n_m|m10_n_m|column 3 = \"m10_n_m\", but must not repeat column 2",
    ] {
        let [file, from, to, expected] = row.split('|').collect::<Vec<_>>()[..] else { panic!() };
        let refusal = after(&bench, &format!("{file}.csv"), |text| text.replacen(from, to, 1));
        assert_eq!(refusal, format!("out/{file}.csv:1: {expected}"));
    }
    let more = after(&bench, "tip.csv", |text| text.replace('\n', ",tip_angle_rad\n"));
    let known = "time_s, tip_displacement_m, tip_velocity_m_s, tip_acceleration_m_s2";
    let expected = format!("column 5 = \"tip_angle_rad\", but must be one of {known}");
    assert_eq!(more, format!("out/tip.csv:1: {expected}"));
}

#[test]
fn fields_that_are_no_numbers_are_refused() {
    let bench = solved();
    for (file, value, expected) in [
        ("torque.csv", "", "torque_n_m = an empty field, but must be a finite number"),
        ("torque.csv", "NaN", "torque_n_m = NaN, but must be a finite number"),
        ("torque.csv", "-inf", "torque_n_m = -inf, but must be a finite number"),
        ("tip.csv", "much", "tip_displacement_m = \"much\", but must be a number"),
        ("hub_angle.csv", "", "hub_angle_rad = an empty field, but must be a finite number"),
        ("bending_moments.csv", "nan", "m0_n_m = nan, but must be a finite number"),
        ("nodes.csv", "x", "x_m = \"x\", but must be a number"),
    ] {
        let refusal = after(&bench, file, |text| with_field(text, 5, 1, value));
        assert_eq!(refusal, format!("out/{file}:5: {expected}"));
    }
    let short = after(&bench, "torque.csv", |text| with_line(text, 7, |_| Some("1".into())));
    assert_eq!(short, "out/torque.csv:7: fields = 1, but must be 2, as many as there are columns");
    let none = after(&bench, "tip.csv", |text| text.lines().next().unwrap().to_owned());
    let rows = "out/tip.csv: the table has no rows, but must have at least one below the names";
    assert_eq!(none, rows);
}

#[test]
fn times_that_are_uneven_or_of_another_run_are_refused() {
    let bench = solved();
    let times = bench.column("out/torque.csv", "time_s");
    let rows = times.len();
    let lost = |text: &str| with_line(text, 9, |_| None);
    let uneven = after(&bench, "torque.csv", lost);
    let expected = format!("out/torque.csv:9: time = {} s, but must be {} s: ", times[8], times[7]);
    assert!(uneven.starts_with(&expected), "{uneven} is not {expected}");
    let back = after(&bench, "torque.csv", |text| with_field(text, 5, 0, &times[0].to_string()));
    let above = format!("must be above {} s of the row before", times[2]);
    assert_eq!(back, format!("out/torque.csv:5: time_s = {} s, but {above}", times[0]));
    for file in ["rigid_torque.csv", "hub_angle.csv", "tip.csv"] {
        let has = format!("must be {rows}, as torque.csv has it: {ONE_RUN}");
        let refusal = after(&bench, file, lost);
        assert_eq!(refusal, format!("out/{file}: rows = {}, but {has}", rows - 1));
        let late = format!("{}", times[3] + 1e-4);
        let other = format!("must be {} s as in torque.csv: {ONE_RUN}", times[3]);
        let refusal = after(&bench, file, |text| with_field(text, 5, 0, &late));
        assert_eq!(refusal, format!("out/{file}:5: time_s = {late} s, but {other}"));
    }
    let fewer = after(&bench, "nodal_displacements.csv", lost);
    assert!(fewer.contains(&format!("as torque.csv has it: {ONE_RUN}")), "{fewer}");
    let shorter = after(&bench, "torque.csv", |text| with_line(text, rows + 1, |_| None));
    let end = format!("must be {} s as in summary.json: {ONE_RUN}", times[rows - 1]);
    assert_eq!(
        shorter,
        format!("out/torque.csv:{rows}: time_s = {} s, but {end}", times[rows - 2])
    );
    let other = after(&bench, "nodes.csv", |text| with_field(text, 4, 1, "0.31"));
    assert!(other.starts_with("out/nodes.csv: nodes.x_m = 0.31 m, but must be 0.3"), "{other}");
    let number = after(&bench, "nodes.csv", |text| with_field(text, 4, 0, "3"));
    assert_eq!(number, "out/nodes.csv:4: node = \"3\", but must be 2");
}
