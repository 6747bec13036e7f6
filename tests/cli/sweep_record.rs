//! The record beside the table of a sweep: what the table is of.

use super::sweep::{rows, sweep, swept};
use super::{Bench, keys, stderr, succeeded};

const VARY: [&str; 2] = ["--vary", "hub.inertia*=1,2"];

#[test]
fn a_factor_and_a_value_have_headings_of_their_own() {
    let bench = Bench::new();
    let headings = |vary: &str| {
        swept(&bench, &["--vary", vary]);
        rows(&bench, "sweep.csv")[0][0].clone()
    };
    assert_eq!(headings("hub.inertia=1,2"), "hub.inertia");
    assert_eq!(headings("hub.inertia*=1,2"), "hub.inertia*");
    assert_eq!(headings("distance*=1,2"), "distance*");
    assert_eq!(headings("duration*=1,2"), "duration*");
}

#[test]
fn beside_a_table_lies_what_it_is_of() {
    let bench = Bench::new();
    let set = ["--set", "payload.mass=\"50 g\"", "-o", "a/stiffness.csv"];
    swept(&bench, &[&VARY[..], &set].concat());
    assert_eq!(bench.names("a"), ["stiffness.csv", "stiffness.json"]);
    let record = bench.json("a/stiffness.json");
    assert!(bench.read("a/stiffness.json").starts_with("{\n  \"format\": 2,\n"));
    let expected =
        ["cases", "command", "flexlink", "format", "inputs", "links", "shard", "table", "title"];
    let mut found = keys(&record);
    found.sort_unstable();
    assert_eq!(found, expected);
    assert_eq!(record["command"], "sweep");
    assert_eq!(record["flexlink"], env!("CARGO_PKG_VERSION"));
    assert_eq!(record["inputs"]["vary"], serde_json::json!(["hub.inertia*=1,2"]));
    assert_eq!(
        record["inputs"]["arguments"],
        serde_json::json!(["--set", "payload.mass=\"50 g\""])
    );
    // The fingerprints are those that a run of solve has.
    bench.solve(&["-q"]);
    let summary = bench.json("out/summary.json");
    for input in ["link", "motion"] {
        assert_eq!(record["inputs"][input], summary["inputs"][input]);
    }
    assert_eq!(record["title"], summary["title"]);

    let page = |table: &str| {
        bench.done(&["report", table, "-o", "page.html"]);
        bench.read("page.html")
    };
    let shown = page("a/stiffness.csv");
    let sha256 = summary["inputs"]["link"]["sha256"].as_str().unwrap();
    assert!(shown.contains("bayo1987_example1.toml") && shown.contains(sha256));
    assert!(
        shown.contains("--vary &#39;hub.inertia*=1,2&#39;")
            || shown.contains("--vary 'hub.inertia*=1,2'")
    );
    std::fs::remove_file(bench.path("a/stiffness.json")).unwrap();
    assert!(page("a/stiffness.csv").contains("The table has no record beside it"));
}

#[test]
fn a_table_that_was_changed_is_not_shown_as_that_of_its_record() {
    let bench = Bench::new();
    swept(&bench, &VARY);
    let text = bench.read("sweep.csv");
    bench.write("sweep.csv", &text.replacen("\n2,", "\n3,", 1));
    let error = stderr(&bench.ends(3, &["report", "sweep.csv"]));
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
    let output = sweep(&bench, &VARY);
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(2), message));
    assert_eq!(bench.names("."), ["sweep.json"]);
    swept(&bench, &[&VARY[..], &["--shard", "1/1", "-o", "s.csv"]].concat());
    let shards = [&VARY[..], &["-o", "a.csv", "--shard"]].concat();
    swept(&bench, &[&shards[..], &["1/2"]].concat());
    let merged = bench.run(&["sweep", "--merge", "a.csv"]);
    assert_eq!((merged.status.code(), stderr(&merged).as_str()), (Some(2), message));
    assert_eq!(bench.read("sweep.json"), "{\"mine\": true}\n");
    // That of an earlier sweep makes way.
    swept(&bench, &[&VARY[..], &["-o", "s.csv"]].concat());
    succeeded(swept(&bench, &[&VARY[..], &["-o", "-"]].concat()));
}
