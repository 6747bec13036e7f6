//! Texts, tables and captions of pages: what a user typed stands as it is, and what is told is true for each kind of result.

use std::collections::HashSet;

use super::{Bench, LINK, MOTION, repository};

const SHEET: &str = "specs/carriages/sheet.toml trajectories/min_jerk_1s.csv";
const GANTRY: &str = "specs/carriages/gantry_arm.toml trajectories/arms/gantry_1.5s.csv";
const ARM: &str = "specs/arms/two_links.toml trajectories/arms/line_1.5s.csv";

/// A page without scripts and styles.
fn page(bench: &Bench, name: &str) -> String {
    let text = bench.read(name).replace("&#39;", "'");
    let mut shown = String::new();
    let mut parts = text.split("<script");
    shown += parts.next().unwrap();
    parts.for_each(|part| shown += part.split_once("</script>").unwrap().1);
    shown
}

/// The caption of a figure.
fn caption(page: &str, figure: &str) -> String {
    let found = &page[page.find(&format!("id=\"fig-{figure}\"")).unwrap()..];
    let found = &found[found.find("<figcaption>").unwrap() + 12..];
    found[..found.find('<').unwrap()].to_owned()
}

/// Rows of the first table after a text of a page.
fn rows_after(page: &str, from: &str) -> Vec<Vec<String>> {
    let found = &page[page.find(from).unwrap()..];
    let body = &found[found.find("<tbody>").unwrap()..found.find("</tbody>").unwrap()];
    let text = |cell: &str| cell.split_once('>').unwrap().1.split('<').next().unwrap().to_owned();
    let cells = |row: &str| {
        let cells = row.split("<t").skip(1).filter(|cell| cell.starts_with(['d', 'h']));
        cells.map(text).collect()
    };
    body.split("<tr>").skip(1).map(cells).collect()
}

/// The page of each of these has a carriage or an output first, whose words replace those of a hub and its tip. The names,
/// files and arguments would be others in these words.
#[test]
fn what_a_user_typed_stands_in_a_page_as_it_is() {
    let bench = Bench::new();
    let typed = ["torque_x", "hub_y", "tip_z"];
    let title = "title=\"The hub's torque, 3 N m at the tip\"";
    let hub = ["solve", LINK, MOTION, "-q", "-o", "hub_y", "--set", "hub.inertia=0.1"];
    bench.done(&[&hub[..], &["--set", title]].concat());
    bench.done(&format!("solve {SHEET} -q -o torque_x"));
    bench.done(&format!("solve {SHEET} -q -o tip_z --set output.at=0.4"));
    let changed = ["force_x", "carriage_y", "output_z", "carriage.mass=0.1", "\u{fdd0}"];
    for order in [["torque_x", "hub_y", "tip_z"], ["tip_z", "torque_x", "hub_y"]] {
        bench.done(&format!("report {} -q -o all.html --svg figures", order.join(" ")));
        let page = page(&bench, "all.html");
        let svg = bench.read("figures/tip-displacement.svg");
        for name in typed {
            assert!(page.contains(&format!("<th scope=\"col\">{name}</th>")), "{name}");
            let line = format!("data-name=\"{name}\"");
            assert!(page.contains(&line) && svg.contains(&line), "{name} is a line");
            assert!(page.contains(&format!(">{name}</text>")), "{name} in the legend");
        }
        assert!(page.contains("<td>--set hub.inertia=0.1 --set "), "arguments of hub_y");
        assert!(page.contains("the joint of hub_y, since it is a turning link"), "not shown");
        for word in changed {
            assert!(!page.contains(word) && !svg.contains(word), "{word}");
        }
        // The numbers of each run have the words of its joint.
        let rows = rows_after(&page, "id=\"beside\"");
        let place = order.iter().position(|name| *name == "hub_y").unwrap();
        let peak = rows.iter().find(|row| row[0] == "peak torque").unwrap();
        assert!(peak[1 + place].ends_with(" N m"), "{peak:?}");
        assert!(page.contains("<tr><th scope=\"row\">start angle</th><td>1.571 rad</td></tr>"));
    }
    // The first has its title, and a link of a carriage the names of its segments.
    let sheet = bench_link(&bench, "specs/carriages/sheet.toml", "\"sheet\"", "\"hub_part\"");
    bench.done(&format!("solve {sheet} trajectories/min_jerk_1s.csv -q -o x --set title=\"hub\""));
    bench.done("report x -q -o x.html");
    let x = page(&bench, "x.html");
    for words in ["<h1>hub</h1>", "<title>hub</title>", "segment hub_part", ">hub_part</text>"] {
        assert!(x.contains(words), "{words}");
    }
    // A sweep over a segment with such a name.
    let vary = "--vary segments.hub_part.E*=1,2 --vary payload.mass=0,0.01";
    bench.done(&format!("sweep {sheet} trajectories/min_jerk_1s.csv -q -o torque.csv {vary}"));
    bench.done("report torque.csv -q -o sweep.html --svg maps");
    let sweep = page(&bench, "sweep.html");
    for words in [
        "Sweep over segments.hub_part.E* and payload.mass",
        "torque.csv · 4 cases",
        "<th scope=\"col\">segments.hub_part.E*</th>",
        "<th scope=\"col\">peak_force_n</th>",
        ">segments.hub_part.E*</text>",
    ] {
        assert!(sweep.contains(words), "{words}");
    }
    assert!(bench.read("maps/peak-torque.svg").contains(">segments.hub_part.E*</text>"));
    assert!(!sweep.contains("carriage_part") && !sweep.contains("force.csv"));
    // Studies: what is played is a torque for a hub, a force for a carriage.
    let uncertain = "-q --runs 1 --play effort --uncertain payload.mass=0..0.01";
    bench.done(&format!("robust {SHEET} --set gravity=[0,0] {uncertain} -o torque_r"));
    bench.done(&format!("robust {LINK} {MOTION} {uncertain} -o hub_r"));
    bench.done("report torque_r hub_r -q -o robust.html");
    let robust = page(&bench, "robust.html");
    let played = rows_after(&robust, "id=\"beside\"");
    let [_, of_sheet, of_hub] = &played.iter().find(|row| row[0] == "played").unwrap()[..] else {
        panic!("{played:?}")
    };
    assert!(of_sheet.starts_with("force of solve"), "{of_sheet}");
    assert!(of_hub.starts_with("torque of solve"), "{of_hub}");
    assert!(robust.contains("highest, hub_r") && !robust.contains("carriage_r"));
}

/// A link file of the repository with another word, on the bench.
fn bench_link(bench: &Bench, file: &str, from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(repository(file)).unwrap();
    assert!(text.contains(from), "{file}");
    bench.write("link.toml", &text.replace(from, to));
    "link.toml".to_owned()
}

#[test]
fn numbers_side_by_side_stand_once_in_the_row_of_their_quantity() {
    let bench = Bench::new();
    bench.done(&format!("solve {GANTRY} -q -o gantry"));
    bench.done(&format!("solve {ARM} -q -o arm"));
    bench.done(&format!("solve {LINK} {MOTION} -q -o link"));
    bench.done(&format!("simulate {LINK} link/torque.csv -q -o played"));
    bench.done("report arm gantry link played -q -o all.html");
    let all = page(&bench, "all.html");
    let rows = rows_after(&all, "id=\"beside\"");
    let names: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    let distinct: HashSet<&str> = names.iter().copied().collect();
    assert_eq!(distinct.len(), names.len(), "{names:?}");
    let row = |name: &str| {
        rows.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{name}: {names:?}"))
    };
    // The carriage has its numbers in its own rows alone, its lead in words.
    assert!(!names.iter().any(|name| name.starts_with("carriage ")), "{names:?}");
    assert!(row("carriage: lead")[2].contains("after the tip has set out"));
    assert!(names.contains(&"carriage: peak speed") && names.contains(&"joint 2: peak rate"));
    assert_eq!(row("carriage: start")[2], "0.000 m", "less than the grid of the answer resolves");
    // The tip of a link stands beside that of an arm, a solution beside a simulation.
    let is_full = |name: &str, runs: &[usize]| runs.iter().all(|run| !row(name)[*run].is_empty());
    assert!(is_full("peak tip velocity", &[1, 2, 3]), "{rows:?}");
    assert!(is_full("tip travel", &[3, 4]) && is_full("farthest", &[1, 2, 3, 4]), "{rows:?}");
    let metres = |run: usize| row("farthest")[run].trim_end_matches(" m").parse::<f64>().unwrap();
    assert!((metres(3) - 0.5).abs() < 1e-3, "the motion of the paper: {}", metres(3));
    assert!(all.contains("the rigid arms of other results than arm, since"), "{all}");
}

/// More lines than a figure holds are dots: several cases over one value, some of which failed.
#[test]
fn dots_have_a_row_for_each_case_and_failed_cases_are_no_cases_within_limits() {
    let bench = Bench::new();
    let vary =
        "--vary payload.mass=0:0.1:3 --vary segments.*.EI*=0.5:2:3 --vary hub.inertia=0,0.1,0.2";
    bench.done(&format!("sweep {LINK} {MOTION} -q -o dots.csv {vary} --set limits.torque=1.5"));
    bench.done("report dots.csv -q -o dots.html");
    let dots = page(&bench, "dots.html");
    let [torque, axis] =
        ["peak_torque_n_m", "hub.inertia"].map(|name| bench.numbers("dots.csv", name));
    let rows = rows_after(&dots, "id=\"fig-peak-torque\"");
    assert_eq!(rows.len(), 27);
    let number = |text: &str| text.replace('−', "-").parse::<f64>().unwrap();
    let mut left: Vec<(f64, f64)> = axis.into_iter().zip(torque).collect();
    for row in &rows {
        let (x, value) = (number(&row[0]), number(&row[1]));
        let off = |own: &(f64, f64)| 1e3 * (own.0 - x).abs() + (own.1 - value).abs();
        let nearest = |a: &usize, b: &usize| off(&left[*a]).total_cmp(&off(&left[*b]));
        let at = (0..left.len()).min_by(nearest).unwrap();
        assert!(off(&left[at]) < 6e-4, "no case of {row:?}");
        let (_, exact) = left.swap_remove(at);
        let kind = if exact > 1.5 { "over the limit 1.5 N m" } else { "within the limit" };
        assert_eq!(row[2], kind, "{exact}");
    }
    let head = "<th scope=\"col\">torque in N m</th><th scope=\"col\">case</th>";
    assert!(dots.contains(head));

    let vary = "--vary hub.inertia=-0.05:0.2:6 --vary payload.mass=0:0.1:3";
    bench.run(&format!("sweep {LINK} {MOTION} -q -o failed.csv {vary} --set limits.torque=10"));
    let count = bench.cells("failed.csv", "error").iter().filter(|error| !error.is_empty()).count();
    assert_eq!(count, 3, "a negative inertia has no answer");
    bench.done("report failed.csv -q -o failed.html");
    let failed = page(&bench, "failed.html");
    let feasible = caption(&failed, "feasible");
    assert!(feasible.contains("0 of 15 solved cases exceed a limit; 3 failed."), "{feasible}");
    let torque = caption(&failed, "peak-torque");
    assert!(torque.contains("No solved case exceeds the limit of 10 N m."), "{torque}");
    for caption in [feasible, torque] {
        assert!(caption.contains("empty where there is none, or where it failed."), "{caption}");
    }
}

/// Each share is the peak of the table over the limit of its row, however the limit is varied.
#[test]
fn a_varied_limit_has_its_share_in_each_case() {
    let bench = Bench::new();
    let limits = [1.0, 2.0, 3.0];
    for (set, vary) in
        [("", "limits.torque=1,2,3"), ("--set limits.torque=2", "limits.torque*=0.5,1,1.5")]
    {
        let vary = format!("--vary {vary} --vary payload.mass=0,0.05,0.1");
        bench.done(&format!("sweep {LINK} {MOTION} -q -o varied.csv {set} {vary}"));
        bench.done("report varied.csv -q -o varied.html");
        let varied = page(&bench, "varied.html");
        let peaks = bench.numbers("varied.csv", "peak_torque_n_m");
        let exact: Vec<f64> = (0..9).map(|case| peaks[case] / limits[case / 3]).collect();
        let cells = rows_after(&varied, "id=\"fig-feasible\"").concat();
        let found: Vec<f64> = cells.iter().filter_map(|cell| cell.parse().ok()).collect();
        let has = |share: &f64| found.iter().any(|own| (own / share - 1.0).abs() < 1e-4);
        assert!(exact.iter().all(has), "{vary}: {found:?} lacks some of {exact:?}");
        let over = exact.iter().filter(|share| **share > 1.0).count();
        let words = format!("{over} of 9 cases exceed a limit.");
        assert!(caption(&varied, "feasible").contains(&words), "{}", caption(&varied, "feasible"));
    }
    // The torque that is played has no column: what is over its limit is told in words.
    bench.done(&format!("solve {LINK} {MOTION} -q -o one"));
    let vary = "--vary payload.mass=0,0.05 --vary hub.inertia=0.1,0.2";
    let play = format!("{vary} --torque one/torque.csv --set limits.torque=1.2");
    bench.done(&format!("sweep {LINK} {MOTION} -q -o played.csv {play}"));
    bench.done("report played.csv -q -o played.html");
    let played = page(&bench, "played.html");
    let why = "<li>Feasible, the nearness to the limits of torque, since the table does not have";
    assert!(played.contains(why) && !played.contains("fig-feasible"), "{played}");
}

/// Words, symbols and units are those of a hub, a carriage, an arm and an arm on a carriage.
#[test]
fn texts_of_a_sweep_are_true_for_its_kind() {
    let bench = Bench::new();
    let swept = |result: &str, more: &str| {
        bench.done(&format!("sweep {result} -q -o sweep.csv {more}"));
        bench.done("report sweep.csv -q -o sweep.html");
        page(&bench, "sweep.html")
    };
    let link = format!("{LINK} {MOTION}");
    let hub = swept(&link, "--vary payload.mass=0,0.05 --set limits.hub_rate=0.1");
    for words in [
        "dθ/dt of the hub.",
        "P = T dθ/dt.",
        "over that of the rigid link.",
        "exceeds 2 % of its peak.",
    ] {
        assert!(hub.contains(words), "{words}");
    }
    for words in ["dq/dt", "of a joint", "of an arm", "under gravity"] {
        assert!(!hub.contains(words), "{words}");
    }
    let sheet = swept(SHEET, "--vary payload.mass=0,0.01");
    for words in ["du/dt of the carriage.", "P = F du/dt.", "|F(t) − F(start)|"] {
        assert!(sheet.contains(words), "{words}");
    }
    let arm =
        swept(ARM, "--vary links.fore.payload.mass=0.2,0.3 --set links.fore.limits.hub_rate=0.1");
    for words in [
        "dq/dt of the joint.",
        "P = T dq/dt.",
        "over that of the rigid arm.",
        "Peak deflection of the link's outer end from the tangent line at its root.",
        "<strong>limit exceeded: rate, joint 2</strong>",
    ] {
        assert!(arm.contains(words), "{words}");
    }
    for words in ["dθ/dt", "Lθ", "the hub", "hub rate", "link or arm"] {
        assert!(!arm.contains(words), "{words}");
    }
    let gantry = swept(GANTRY, "--vary carriage.mass=6,24 --set limits.carriage_speed=0.5");
    for words in [
        "<strong>limit exceeded: carriage speed</strong>",
        "du/dt of the carriage.",
        "P = F du/dt.",
        "P = T dq/dt.",
        "Below 0 the force begins after the tip has set out.",
        "Below 0 the torque begins after the tip has set out.",
    ] {
        assert!(gantry.contains(words), "{words}");
    }
    for figure in ["lead-carriage", "lag-carriage", "peak-power-carriage"] {
        assert!(!caption(&gantry, figure).contains("torque"), "{figure}");
    }
}

/// Open beside a solved run, whose tip is the reference; and a motor with its current and voltage.
#[test]
fn texts_of_runs_are_true_for_what_they_show() {
    let bench = Bench::new();
    let drive = "--set drive={gear_ratio=50,rotor_inertia=1e-5,torque_constant=0.05,resistance=1}";
    bench.done(&format!("solve {LINK} {MOTION} -q -o one {drive}"));
    bench.done(&format!("simulate {LINK} one/torque.csv -q -o open"));
    bench.done("report one -q -o one.html");
    let one = page(&bench, "one.html");
    for (name, unit) in [("peak motor current", "A"), ("peak motor voltage", "V")] {
        let rows = rows_after(&one, "<caption>Results</caption>");
        let row = rows.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{rows:?}"));
        assert!(row[1].ends_with(&format!(" {unit}")), "{row:?}");
    }
    assert!(one.contains("The gap between the two curves is bending."));
    bench.done("report open one -q -o both.html");
    let both = page(&bench, "both.html");
    assert!(
        both.contains("v_wanted: the tip of the solved run")
            && !both.contains("at the times of the target")
    );
    bench.done(&format!("simulate {LINK} one/torque.csv --target one/tip.csv -q -o aimed"));
    bench.done("report aimed open one -q -o both.html");
    assert!(page(&bench, "both.html").contains("at the times of the target"));
    // A link that holds a weight.
    bench.done(&format!("solve {SHEET} -q -o sheet"));
    bench.done("report sheet -q -o sheet.html");
    let words = "The force leaves its value at rest (2 % of its range) ";
    assert!(caption(&page(&bench, "sheet.html"), "torque").contains(words));
}
