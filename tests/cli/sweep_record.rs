//! The record beside the table of a sweep: what the table is of.

use super::sweep::{sweep, swept};
use super::{Bench, keys, stderr};

const VARY: &str = "--vary hub.inertia*=1,2";

#[test]
fn a_factor_and_a_value_have_headings_of_their_own() {
    let bench = Bench::new();
    for heading in ["hub.inertia", "hub.inertia*", "distance*", "duration*"] {
        swept(&bench, &format!("--vary {heading}=1,2"));
        assert_eq!(bench.rows("sweep.csv")[0][0], heading);
    }
}

#[test]
fn beside_a_table_lies_what_it_is_of() {
    let bench = Bench::new();
    let set = ["--set", "payload.mass=\"50 g\""];
    swept(&bench, &super::with(&format!("{VARY} -o a/stiffness.csv"), &set));
    assert_eq!(bench.names("a"), ["stiffness.csv", "stiffness.json"]);
    let record = bench.json("a/stiffness.json");
    assert!(bench.read("a/stiffness.json").starts_with("{\n  \"format\": 2,\n"));
    let mut found = keys(&record);
    found.sort_unstable();
    assert_eq!(found.join(" "), "cases command flexlink format inputs links shard table title");
    assert_eq!(record["command"], "sweep");
    assert_eq!(record["flexlink"], env!("CARGO_PKG_VERSION"));
    assert_eq!(record["inputs"]["vary"], serde_json::json!(["hub.inertia*=1,2"]));
    assert_eq!(record["inputs"]["arguments"], serde_json::json!(set));
    // The fingerprints are those that a run of solve has.
    bench.solve("-q");
    let summary = bench.json("out/summary.json");
    for input in ["link", "motion"] {
        assert_eq!(record["inputs"][input], summary["inputs"][input]);
    }
    assert_eq!(record["title"], summary["title"]);

    let page = || {
        bench.done("report a/stiffness.csv -o page.html");
        bench.read("page.html").replace("&#39;", "'")
    };
    let shown = page();
    let sha256 = summary["inputs"]["link"]["sha256"].as_str().unwrap();
    assert!(shown.contains("bayo1987_example1.toml") && shown.contains(sha256));
    assert!(shown.contains("--vary 'hub.inertia*=1,2'"));
    std::fs::remove_file(bench.path("a/stiffness.json")).unwrap();
    assert!(page().contains("The table has no record beside it"));
}

#[test]
fn a_table_that_was_changed_is_not_shown_as_that_of_its_record() {
    let bench = Bench::new();
    swept(&bench, VARY);
    let text = bench.read("sweep.csv");
    bench.write("sweep.csv", &text.replacen("\n2,", "\n3,", 1));
    let error = bench.error(3, "report sweep.csv");
    assert!(error.starts_with("error: sweep.json: table.sha256 = \""), "{error}");
    let hint = "hint: the table has changed since; without sweep.json it is taken as it is\n";
    assert!(error.ends_with(hint), "{error}");
}

#[test]
fn a_file_in_the_place_of_the_record_is_kept() {
    let bench = Bench::new();
    bench.write("sweep.json", "{\"mine\": true}\n");
    let message = "error: --output = sweep.csv, but its record sweep.json would replace a file that \
                   no sweep has written\nhint: use another name for the table, or for that file\n";
    let output = sweep(&bench, VARY);
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(2), message));
    assert_eq!(bench.names("."), ["sweep.json"]);
    swept(&bench, &format!("{VARY} --shard 1/1 -o s.csv"));
    swept(&bench, &format!("{VARY} --shard 1/2 -o a.csv"));
    assert_eq!(bench.error(2, "sweep --merge a.csv"), message);
    assert_eq!(bench.read("sweep.json"), "{\"mine\": true}\n");
    // That of an earlier sweep makes way.
    swept(&bench, &format!("{VARY} -o s.csv"));
    swept(&bench, &format!("{VARY} -o -"));
}
