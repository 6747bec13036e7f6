//! The page of `robust`, and its figures, against the files of the folder.

use std::fs;

use super::report::points;
use super::{Bench, LINK, MOTION, number};

const KEYS: &str = "--uncertain segments.*.EI*=±5% --uncertain payload.mass=0..0.02";

/// A study of the paper's first link.
fn study(bench: &Bench, more: &str) {
    bench.done(&format!("robust {LINK} {MOTION} {KEYS} -q {more}"));
}

/// The numbers of a column of robust.csv in the rows of a kind.
fn of_kind(bench: &Bench, kind: &str, column: &str) -> Vec<f64> {
    let [kinds, cells] = ["kind", column].map(|name| bench.cells("robust/robust.csv", name));
    let pairs = kinds.iter().zip(cells).filter(|(own, _)| *own == kind);
    pairs.map(|(_, cell)| cell.parse().unwrap_or(f64::NAN)).collect()
}

#[track_caller]
fn assert_close(found: f64, exact: f64, off: f64) {
    assert!((found - exact).abs() < off, "{found} is not {exact}");
}

#[test]
fn the_page_is_the_one_of_its_files() {
    let bench = Bench::new();
    let sheet = "specs/carriages/sheet.toml";
    let motion = "trajectory min-jerk --distance 0.2 --duration 0.44 --step 0.001 -o move.csv";
    bench.done(motion);
    let arm = "specs/arms/two_links.toml trajectories/arms/line_1.5s.csv --play position --runs 1 \
               --set mesh.elements=4";
    for (arguments, words) in [
        (
            format!("{LINK} {MOTION} {KEYS} --set title=<b> --allow 1%"),
            ["torque of solve, without feedback", "The file has 1.000", "mass in kg", "&lt;b&gt;"],
        ),
        (
            format!(
                "{sheet} move.csv --set gravity=[0,0] --play position --uncertain segments.*.E*=±5%"
            ),
            ["carriage travel of solve, held exactly", "of the travel in %", "Steel sheet", ""],
        ),
        (
            format!("{arm} --uncertain links.*.segments.*.EI*=±10%"),
            ["angles of the joints of solve", "distances, without a sign", "Link 2", ""],
        ),
    ] {
        bench.done(&format!("robust {arguments} -q --report"));
        let page = bench.read("robust/report.html");
        fs::remove_file(bench.path("robust/report.html")).unwrap();
        assert_eq!(bench.silent("report robust"), "written  robust/report.html\n");
        assert!(page == bench.read("robust/report.html"), "{arguments}");
        for words in words {
            assert!(page.contains(words), "{arguments}: {words}");
        }
        assert!(!page.contains("<b>") && !page.contains(" style="), "{arguments}");
        let sections = page.split("<section id=\"").skip(1);
        let sections: Vec<&str> = sections.filter_map(|rest| rest.split('"').next()).collect();
        let sections = sections.join(" ");
        let expected = "figures link glossary results keys inputs";
        assert_eq!(sections.trim_start_matches("warnings "), expected);
        assert_eq!(sections.starts_with("warnings"), arguments.contains("--allow"));
    }
    // A later study removes an old page.
    study(&bench, "--runs 0");
    assert!(!bench.path("robust/report.html").exists(), "an old page stays");
}

#[test]
fn figures_show_the_numbers_of_the_files() {
    let bench = Bench::new();
    study(&bench, "--runs 300");
    let told = bench.silent("report robust --svg figures");
    assert_eq!(told, "written  5 figures in figures\n");
    let figure = |name: &str| bench.read(&format!("figures/{name}.svg"));
    let summary = bench.json("robust/summary.json");
    let percent = 100.0 / number(&summary, "travel_m");

    // The payload has the larger share and stands first.
    let bars = figure("keys");
    for (measure, word) in ["tip error", "rest vibration", "drift"].into_iter().enumerate() {
        let shown = points(&bars, word);
        assert_eq!(shown.len(), 2);
        for ((place, size), key) in shown.into_iter().zip([1, 0]) {
            assert_close(place, f64::from(2 - key), 1e-4);
            let exact = number(&summary, &format!("keys/{key}/worst/{measure}/size_m"));
            assert_close(size, percent * exact, 1e-4);
        }
    }
    assert!(bars.contains("payload.mass: 82 %") && bars.contains("segments.*.EI*: 18 %"));

    // The rows of a key alone, with the link of the file: seven, of which one is that link; the payload has no such value.
    for (number, key, rows, per_m) in [(1, 1, 7..14, 1.0), (2, 0, 0..7, 1.0)] {
        let heading = ["segments.*.EI*", "payload.mass"][key];
        let value = of_kind(&bench, "key", heading);
        for (word, column, scale) in [
            ("tip error", "tip_error", 100.0),
            ("rest vibration", "rest_vibration", 100.0),
            ("drift", "drift_m", percent),
        ] {
            let shown = points(&figure(&format!("key-{number}")), word);
            let sizes = of_kind(&bench, "key", column);
            assert_eq!(shown.len(), 7, "{heading}");
            for ((x, y), row) in shown.into_iter().zip(rows.clone()) {
                assert_close(x, value[row], 1e-4 * value[rows.end - 1].abs());
                assert_close(y, per_m * scale * sizes[row].abs(), 1e-4);
            }
        }
    }

    let shown = points(&figure("sample"), "plants below");
    let mut sizes = of_kind(&bench, "sample", "tip_error");
    sizes.sort_by(f64::total_cmp);
    assert_eq!(shown.len(), 300);
    for (k, (x, y)) in shown.iter().enumerate() {
        assert_close(*x, 100.0 * sizes[k], 1e-4);
        assert_close(*y, 100.0 * k as f64 / 299.0, 1e-3);
    }
    let p95 = percent * number(&summary, "quantiles/0/p95_m/0");
    let below = shown.iter().filter(|(x, _)| *x < p95).count();
    assert_eq!(below, 285, "95 % of 299 intervals lie below the quantile");

    let envelope = figure("envelope");
    for (name, column) in [("highest error", "highest_error_m"), ("lowest error", "lowest_error_m")]
    {
        let [times, errors] =
            ["time_s", column].map(|name| super::column(&bench, "robust/envelope.csv", name));
        for (time_s, error_m) in points(&envelope, name) {
            let row = times.partition_point(|own| *own < time_s - 0.004);
            assert_close(time_s, times[row], 1e-4);
            assert_close(error_m, errors[row], 1e-6);
        }
    }
    let band = points(&envelope, "settling band 1.00 % (0.00500 m)");
    assert_close(band[0].1, number(&summary, "band_m"), 1e-6);
}

#[test]
fn a_study_without_a_sample_says_what_is_not_shown() {
    let bench = Bench::new();
    study(&bench, "--runs 0 --report");
    let page = bench.read("robust/report.html");
    for words in ["since no plant is drawn", "since fewer than two plants are drawn"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("Drawn plants"));
}

#[test]
fn a_damaged_folder_of_a_study_is_refused() {
    let bench = Bench::new();
    study(&bench, "--runs 2");
    let refused = |file: &str, change: &dyn Fn(&str) -> String, words: &str| {
        let text = bench.read(&format!("robust/{file}"));
        let changed = change(&text);
        assert_ne!(changed, text, "{words}");
        bench.write(&format!("robust/{file}"), &changed);
        bench.refuses(3, "report robust", words);
        bench.write(&format!("robust/{file}"), &text);
    };
    let line = |number: usize, own: &'static str| {
        move |text: &str| {
            let mut lines: Vec<&str> = text.lines().collect();
            lines[number - 1] = own;
            lines.join("\n") + "\n"
        }
    };
    let table = "robust/robust.csv";
    for (own, words) in [
        ("key,1,0,much,0,0,0", ":3: tip_error = \"much\", but must be a finite number"),
        ("key,1,0,0,0,,0", ":3: drift_m = \"\", but must be a finite number"),
        (
            "key,soft,0,0,0,0,0",
            ":3: segments.*.EI* = \"soft\", but must be a finite number or nothing",
        ),
        ("key,1,0,0,0,0,inf", ":3: settling_s = \"inf\", but must be a finite number or nothing"),
        (
            "edge,1,0,0,0,0,0",
            ":3: kind = \"edge\", but must be one of nominal, key, corner, sample",
        ),
        ("key,1,0", ":3: fields = 3, but must be 7"),
    ] {
        refused("robust.csv", &line(3, own), &format!("{table}{words}"));
    }
    let shorter = |text: &str| text.trim_end().rsplit_once('\n').unwrap().0.to_owned() + "\n";
    let unknown = |text: &str| text.replacen("\nnominal", "\nkey", 1);
    refused("robust.csv", &unknown, &format!("{table}: the first row must be the nominal plant"));
    refused("robust.csv", &shorter, &format!("{table}: rows = "));
    let renamed = |text: &str| text.replace("drift_m", "drift");
    refused("robust.csv", &renamed, &format!("{table}: columns = "));
    refused("envelope.csv", &line(4, "a,b,c"), "robust/envelope.csv:4: time_s = \"a\"");
    refused("envelope.csv", &|_| "time_s,low\n0,1\n".to_owned(), "lowest_error_m");
    let travel = |text: &str| text.replace("\"travel_m\"", "\"travel\"");
    refused("summary.json", &travel, "travel_m is missing");
    let format = |text: &str| text.replacen("\"format\": 2", "\"format\": 1", 1);
    refused("summary.json", &format, "format = 1, but must be 2");
    for file in ["envelope.csv", "robust.csv"] {
        let path = bench.path(&format!("robust/{file}"));
        let bytes = fs::read(&path).unwrap();
        fs::remove_file(&path).unwrap();
        bench.refuses(3, "report robust", &format!("robust: {file} is missing"));
        fs::write(&path, bytes).unwrap();
    }
    bench.silent("report robust");
}

#[test]
fn a_key_has_one_interval_and_the_record_one_command() {
    let bench = Bench::new();
    let twice = format!("robust {LINK} {MOTION} {KEYS} --uncertain payload.mass=0..0.03");
    bench.refuses(2, &twice, "payload.mass has two intervals");
    study(&bench, "--runs 0 --command rigid");
    let record = bench.read("robust/summary.json");
    assert_eq!(record.matches("\"command\":").count(), 1);
    assert!(record.contains("\"command\": \"robust\"") && record.contains("\"played\": \"rigid\""));
}
