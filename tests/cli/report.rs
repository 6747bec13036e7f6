//! `flexlink report`: pages and figures.

use std::collections::HashSet;
use std::fs;
use std::io::Cursor;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use flexlink::text::significant;

use super::{Bench, LINK, MOTION, number, repository, stderr};

const DRIVE: &str = "--set drive={joint_stiffness=100.0,rotor_inertia=0.01,gear_ratio=2.0}";

fn solved(bench: &Bench, more: &str) {
    bench.solve(&format!("-q -o out {more}"));
}

/// Numbers of an attribute, the first of this name after `from`.
fn attribute<'a>(text: &'a str, name: &str) -> &'a str {
    let begin = text.find(&format!(" {name}=\"")).unwrap() + name.len() + 3;
    text[begin..].split('"').next().unwrap()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// All colours of a picture.
fn colours(picture: &[u8]) -> HashSet<[u8; 3]> {
    let mut reader = png::Decoder::new(Cursor::new(picture)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

/// Points of a line of a figure, in the units of its axes.
pub(super) fn points(svg: &str, line: &str) -> Vec<(f64, f64)> {
    let (x, y) = (numbers(attribute(svg, "data-x")), numbers(attribute(svg, "data-y")));
    let plot = numbers(attribute(svg, "data-plot"));
    let path = &svg[svg.find(&format!("data-name=\"{line}\"")).unwrap()..];
    let places = attribute(path, "d").split(['M', 'L']).filter(|place| !place.is_empty());
    let point = |place: &str| {
        let (across, down) = place.split_once(',').unwrap();
        let (across, down): (f64, f64) = (across.parse().unwrap(), down.parse().unwrap());
        (x[0] + across / plot[2] * (x[1] - x[0]), y[1] - down / plot[3] * (y[1] - y[0]))
    };
    places.map(point).collect()
}

/// Points of a line of a figure are rows of a column of a table, to a share of its largest value or in its unit.
#[track_caller]
fn assert_rows(
    bench: &Bench,
    (figure, line): (&str, &str),
    (file, column): (&str, usize),
    off: f64,
) {
    let shown = points(&bench.read(&format!("figures/{figure}.svg")), line);
    let table = bench.table(file);
    assert!(shown.len() > 500, "{figure}: {} points", shown.len());
    for (time_s, value) in shown {
        let row = table[0].1.partition_point(|time| *time < time_s - 0.0005);
        assert!((table[0].1[row] - time_s).abs() < 1e-4, "{figure} at {time_s} s");
        let error = (table[column].1[row] - value).abs();
        assert!(error < off, "{figure}, {line}, at {time_s} s: {error:e} off");
    }
}

#[test]
fn a_figure_shows_the_numbers_of_the_table() {
    let bench = Bench::new();
    solved(&bench, "");
    let told = bench.silent("report out --svg figures");
    assert_eq!(told, "written  8 figures in figures\n");
    for (figure, line, file, column) in [
        ("torque", "flexible link", "torque", 1),
        ("torque", "rigid link", "rigid_torque", 1),
        ("hub-angle", "flexible link", "hub_angle", 1),
        ("hub-angle", "rigid link", "hub_angle", 4),
        ("tip-acceleration", "tip", "tip", 3),
        ("tip-displacement", "tip", "tip", 1),
        ("tip-under-rigid-torque", "wanted", "tip", 1),
    ] {
        let file = format!("out/{file}.csv");
        let peak = super::peak(&bench.table(&file)[column].1);
        assert_rows(&bench, (figure, line), (&file, column), 3e-4 * peak);
    }
    // Those of README and book are of the paper's example.
    for figure in ["torque.svg", "waves.svg"] {
        let kept = fs::read_to_string(repository(&format!("docs/{figure}"))).unwrap();
        let is_same = kept.lines().eq(bench.read(&format!("figures/{figure}")).lines());
        assert!(is_same, "docs/{figure} is another: write it anew with `report --svg`");
    }
}

/// What is the same in the page of a link and of an arm.
#[test]
fn a_page_needs_nothing_else_escapes_what_it_is_given_and_is_the_one_of_its_files() {
    let bench = Bench::new();
    let of_link = format!("--nodes 7,3,0 --verify {DRIVE} --set segments.beam.name=\"<img>\"");
    let of_arm = "--set links.fore.segments.0.name=\"<img>\" --set links.fore.limits.torque=1 \
                  --set analysis.second_order=\"none\" --set mesh.elements=4";
    let arm = "specs/arms/two_links.toml trajectories/arms/line_1.5s.csv";
    for (inputs, options, expected, words) in [
        (
            &format!("{LINK} {MOTION}"),
            of_link.as_str(),
            "first animation figures link glossary results checks inputs",
            "T/a_tip of the paper's dense H",
        ),
        (
            &arm.to_owned(),
            of_arm,
            "warnings first animation arm figures glossary results errors inputs",
            "joint 2: limits.torque = 1 N m is exceeded",
        ),
    ] {
        let more =
            format!("solve {inputs} -q --moments --every 4 --digits full {options} --report");
        let title = ["--set", "title=\"</script><script>alert(1)</script>\""];
        bench.done(&super::with(&more, &title));
        let page = bench.read("out/report.html");
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
        assert!(page.contains("&lt;/script&gt;&lt;script&gt;alert(1)"), "the title is not there");
        assert!(!page.contains("<script>alert") && !page.contains("<img"), "a name is not escaped");
        let arguments = "--set 'title=&quot;&lt;/script&gt;&lt;script&gt;alert(1)";
        assert!(page.contains(arguments), "the arguments as a shell takes them");
        let scripts = page.matches("</script>").count();
        assert_eq!(scripts, 3, "the motion, the style of figures, the script");
        let addresses = page.matches("://").count();
        assert_eq!(addresses, page.matches("http://www.w3.org/2000/svg").count(), "an address");
        let sections = page.split("<section id=\"").skip(1);
        let sections: Vec<&str> = sections.filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(sections.join(" "), expected, "torque first, tables last");
        let policy = attribute(&page[page.find("Content-Security-Policy").unwrap()..], "content");
        assert!(policy.starts_with("default-src 'none'; style-src 'sha256-"), "{policy}");
        assert!(!page.contains(" style="), "a style that the policy refuses");
        assert!(page.replace("&#39;", "'").contains(words), "{words}");
        assert!(page.len() < 2_000_000, "{} bytes", page.len());
        assert_eq!(bench.silent("report out"), "written  out/report.html\n");
        assert!(page == bench.read("out/report.html"), "{inputs}");
        // A later run removes an old page.
        bench.done(&format!("solve {inputs} -q {options}"));
        assert!(!bench.path("out/report.html").exists(), "an old page stays");
    }
}

#[test]
fn the_same_result_gives_the_same_page_and_the_same_pictures() {
    let bench = Bench::new();
    solved(&bench, "--every 10");
    bench.silent("report out -q -o a.html --png a");
    bench.silent("report out -q -o b.html --png b");
    assert!(bench.read("a.html") == bench.read("b.html"));
    assert_eq!(bench.names("a").len(), 8);
    for name in bench.names("a") {
        let picture = fs::read(bench.path("a").join(&name)).unwrap();
        assert!(picture.starts_with(b"\x89PNG\r\n\x1a\n"), "{name}");
        let width = u32::from_be_bytes(picture[16..20].try_into().unwrap());
        assert_eq!(width, 1520, "{name}");
        assert!(picture == fs::read(bench.path("b").join(&name)).unwrap(), "{name}");
        let colours = colours(&picture);
        assert!(colours.len() > 40, "{name}: {} colours", colours.len());
        assert!(colours.contains(&[28, 36, 48]), "{name} has no letters");
    }
}

#[test]
fn a_page_goes_with_its_run() {
    let bench = Bench::new();
    let told = bench.silent(&format!("solve {LINK} {MOTION} -o out --report"));
    let is_of_page = |line: &str| line.starts_with("written  out") && line.ends_with("report.html");
    assert!(told.lines().any(is_of_page), "{told}");
    let page = bench.read("out/report.html").replace("&#39;", "'");
    // Frequencies, damping and errors say what they are.
    for words in [
        "hysteretic, ratio 0.02",
        "frequency in Hz",
        "<td>1.900</td>",
        "damping ratio",
        "the tip's travel",
        "the peak of the hub rate",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("torque mesh error"), "an error without what it is a share of");
    fs::remove_file(bench.path("out/report.html")).unwrap();
    let page = bench.silent("report out -o -");
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"), "standard output");
    assert!(!bench.path("out/report.html").exists());
}

#[test]
fn what_was_not_written_is_not_shown_and_that_is_said() {
    let bench = Bench::new();
    solved(&bench, "--nodes 0,10");
    bench.silent("report out -q");
    let page = bench.read("out/report.html");
    assert!(!page.contains("id=\"fig-waves\""));
    let why = "since no node between root and tip was written";
    assert!(page.contains(why), "why there are no waves");
    assert!(!page.contains("id=\"animation\""), "a link of two points");
    solved(&bench, "--every 9000");
    bench.silent("report out -q");
    assert!(!bench.read("out/report.html").contains("id=\"fig-waves\""), "waves of one moment");
}

#[test]
fn the_rigid_torque_moves_the_tip_as_a_simulation_says() {
    let bench = Bench::new();
    let friction = "--set hub.viscous_friction=0.1";
    solved(&bench, friction);
    let play = format!("-q -o played --column rigid_torque_n_m {friction}");
    bench.done(&format!("simulate {LINK} out/rigid_torque.csv {play}"));
    bench.silent("report out -q --svg figures");
    let line = ("tip-under-rigid-torque", "rigid link's torque");
    assert_rows(&bench, line, ("played/tip.csv", 1), 3e-4);
}

#[test]
fn the_motors_torque_has_a_figure_of_its_own() {
    let bench = Bench::new();
    solved(&bench, &format!("{DRIVE} --report"));
    let page = bench.read("out/report.html");
    let figure = |id: &str| {
        let found = &page[page.find(&format!("id=\"fig-{id}\"")).unwrap()..];
        found[..found.find("</figure>").unwrap()].replace("&#39;", "'")
    };
    assert!(!figure("torque").contains("data-name=\"motor\""), "it has an axis of its own");
    let motor = figure("motor-torque");
    assert!(motor.contains("data-name=\"motor\"") && motor.contains("T_m = T/n"));
    let peak = bench.number("out", "results/peak_motor_torque_n_m");
    let told = format!("At most {peak:.4} N m, on the motor's side of the drive.");
    assert!(motor.contains(&told), "{peak}");
}

#[test]
fn a_page_does_not_depend_on_the_digits_that_are_written() {
    let bench = Bench::new();
    for more in ["--digits 1", "--digits 5 --set segments.beam.elements=7"] {
        solved(&bench, &format!("{more} --report"));
        let page = bench.read("out/report.html");
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
        bench.silent("report out -q");
        assert!(bench.read("out/report.html").starts_with("<!DOCTYPE html>"));
    }
}

#[cfg(unix)]
#[test]
fn the_page_has_its_name_before_the_summary() {
    use std::os::unix::fs::MetadataExt as _;
    let bench = Bench::new();
    solved(&bench, "--report");
    let named = |name: &str| {
        let about = fs::metadata(bench.path("out").join(name)).unwrap();
        (about.ctime(), about.ctime_nsec())
    };
    for name in bench.names("out") {
        assert!(named(&name) <= named("summary.json"), "{name}");
    }
}

#[test]
fn a_page_waits_for_the_run_that_holds_its_folder_and_says_so() {
    let bench = Bench::new();
    solved(&bench, "");
    let lock = fs::File::create_new(bench.path("out/.flexlink.lock")).unwrap();
    lock.lock().unwrap();
    // What the other run is about to replace must not be read before.
    let summary = bench.read("out/summary.json");
    fs::remove_file(bench.path("out/summary.json")).unwrap();
    let mut program = bench.program("report out -q");
    let waits = program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    thread::sleep(Duration::from_millis(1500));
    bench.write("out/summary.json", &summary);
    fs::remove_file(bench.path("out/.flexlink.lock")).unwrap();
    drop(lock);
    let output = waits.wait_with_output().unwrap();
    let told = "note: out: another run is writing into the folder; waiting until it is done\n";
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), told));
    assert!(bench.path("out/report.html").exists());
}

/// Multiplies a column of a table of the folder `out`, whose largest number then is `peak`.
fn scale(bench: &Bench, file: &str, column: usize, peak: f64) {
    let largest = super::peak(&bench.table(file)[column].1);
    let text = bench.read(file);
    let (head, rows) = text.split_once('\n').unwrap();
    let row = |line: &str| {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        let value: f64 = fields[column].parse().unwrap();
        fields[column] = format!("{:e}", value / largest * peak);
        fields.join(",") + "\n"
    };
    bench.write(file, &format!("{head}\n{}", rows.lines().map(row).collect::<String>()));
}

#[test]
fn numbers_at_the_ends_of_what_a_computer_has_are_left_out_of_a_page_in_words() {
    let bench = Bench::new();
    // The largest number of a column becomes 1.7e308, or a denormal.
    for (file, column, told) in [
        ("torque", 1, ["Torque at the hub, since", ""]),
        ("tip", 1, ["Displacement of the tip, since"; 2]),
        ("hub_angle", 1, ["Rotation of the hub, since", ""]),
        ("rigid_torque", 1, ["Torque at the hub, since", ""]),
        ("nodal_displacements", 5, ["waves and animation, since", ""]),
    ] {
        for (peak, told) in [1.7e308, 1e-310].into_iter().zip(told) {
            solved(&bench, "--every 4 --nodes 1,3,5,7,9");
            scale(&bench, &format!("out/{file}.csv"), column, peak);
            bench.silent("report out -q");
            let page = bench.read("out/report.html");
            let plain = page.split("<style>").next().unwrap().to_owned()
                + page.split("</style>").nth(1).unwrap().split("<script>").next().unwrap();
            for word in [">inf", " inf ", "NaN", "\"inf", ",inf", "[null", ",null"] {
                assert!(!plain.contains(word), "{file} to {peak:e}: {word}");
            }
            assert!(page.contains(told), "{file} to {peak:e}: {told}");
        }
    }
}

#[test]
fn warnings_stand_in_the_page_with_what_helps() {
    let bench = Bench::new();
    let coarse = "--set payload.mass=0.1 --set mesh.elements=2 --set segments.*.elements=1";
    bench.run(&format!("solve {LINK} {MOTION} -q -o out {coarse}"));
    bench.silent("report out -q");
    let page = bench.read("out/report.html");
    assert!(page.contains("<section id=\"warnings\""));
    assert!(page.contains("elements halved") && page.contains("What helps: use more elements"));
}

#[test]
fn a_simulation_has_a_page() {
    let bench = Bench::new();
    solved(&bench, "");
    bench.silent(&format!("simulate {LINK} out/torque.csv -q -o played"));
    bench.silent("report played -q");
    let page = bench.read("played/report.html");
    for figure in ["torque", "tip-displacement", "hub-angle", "waves", "transfer", "mode-shapes"] {
        assert!(page.contains(&format!("id=\"fig-{figure}\"")), "{figure}");
    }
    assert!(!page.contains("fig-tip-under-rigid-torque"), "no motion was asked for");
    assert!(page.contains("residual amplitude"), "its numbers");
    let captions = page.split("<figcaption>").skip(1).filter_map(|rest| rest.split('<').next());
    for caption in captions {
        assert!(!caption.contains("Bayo") && !caption.contains("(figure"), "{caption}");
    }
}

#[test]
fn a_simulation_shows_its_target_and_the_limits_of_the_link_file() {
    let bench = Bench::new();
    solved(&bench, "");
    let play = format!("simulate {LINK} out/torque.csv -q -o played");
    let limits = "--set limits={torque=2.0,hub_rate=0.5,deflection=0.1}";
    let target = format!("{play} --target out/tip.csv --set payload.mass=0.05 {limits}");
    let told = stderr(&bench.run(&target));
    let summary = bench.json("played/summary.json");
    let warnings = summary["warnings"].as_array().unwrap();
    for (key, warning) in ["hub_rate", "deflection"].into_iter().zip(warnings) {
        assert_eq!(warning["kind"], "limit_exceeded");
        let message = warning["message"].as_str().unwrap();
        assert!(message.starts_with(&format!("limits.{key}")), "{message}");
        assert!(told.contains(&format!("warning: {message}\n")), "{told}");
    }
    bench.silent("report played -q --svg figures");
    assert_rows(&bench, ("tip-displacement", "wanted"), ("out/tip.csv", 1), 3e-4);
    let svg = bench.read("figures/tip-error.svg");
    let shown = points(&svg, "simulated less wanted");
    let worst = number(&summary, "tip_error/worst_m");
    let peak = shown.iter().fold(0.0_f64, |peak, (_, value)| peak.max(value.abs()));
    assert!((peak / worst - 1.0).abs() < 1e-3, "{peak} of {worst}");
    assert!(svg.contains(&format!("at most {worst:.5} m")), "{worst}: its caption");
    for (figure, limit) in [
        ("torque", "limit 2 N m"),
        ("hub-rate", "limit 0.5 rad/s"),
        ("tip-deflection", "limit 0.1 m"),
    ] {
        assert!(bench.read(&format!("figures/{figure}.svg")).contains(limit), "{figure}");
    }
    // A later run without a target takes its table away.
    assert!(bench.path("played/tip_error.csv").exists());
    bench.silent(&play);
    assert!(!bench.path("played/tip_error.csv").exists());
}

#[test]
fn the_paper_is_named_for_its_own_links_and_motion_alone() {
    let bench = Bench::new();
    let stiffer = ["--set", "segments.root.I=1e-1 cm^4", "--set", "segments.beam.I=1e-2 cm^4"];
    for (more, figures) in [
        (&[][..], &["5", "4", "3", "6", "8"][..]),
        (&stiffer, &["7", "9"]),
        (&["--set", "payload.mass=0.05"], &[]),
        (&["--set", "damping.ratio=0.03"], &[]),
    ] {
        bench.solve(&[&["-q", "--report"], more].concat());
        let page = bench.read("out/report.html");
        let named = page.split("(Bayo 1987, figure ").skip(1);
        let named: Vec<_> = named.filter_map(|rest| Some(rest.split_once(')')?.0)).collect();
        assert_eq!(named, figures, "{more:?}");
    }
}

#[test]
fn limits_are_lines_in_the_figures_of_a_run_that_was_read_back() {
    let bench = Bench::new();
    let limits = "--set limits={torque=2.0,hub_rate=0.5,deflection=0.3}";
    solved(&bench, &format!("--digits full {limits} --report"));
    let page = bench.read("out/report.html");
    bench.silent("report out -q --svg figures -o again.html");
    let is_same = page == bench.read("again.html");
    assert!(is_same, "the limits of the summary are those of the link file");
    for (figure, limit, at) in
        [("torque", "limit 2 N m", 2.0), ("hub-rate", "limit 0.5 rad/s", 0.5)]
    {
        let drawn = points(&bench.read(&format!("figures/{figure}.svg")), limit);
        let off = |(_, value): &(f64, f64)| (value.abs() - at).abs();
        assert!(drawn.len() >= 2 && drawn.iter().all(|point| off(point) < 1e-3), "{drawn:?}");
    }
    solved(&bench, "--set limits.torque=20.0 --report");
    let page = bench.read("out/report.html");
    assert!(page.contains("The limit 20 N m is beyond the figure."));
    assert!(!page.contains("fig-hub-rate"));
}

#[test]
fn a_sweep_has_lines_over_one_value_and_colours_over_two() {
    let bench = Bench::new();
    let sweep = |name: &str, vary: &str| {
        bench.done(&format!("sweep {LINK} {MOTION} -q -o {name}.csv --vary {vary}"));
    };
    sweep("one", "segments.*.EI*=1,2,4,8");
    bench.silent("report one.csv -q --svg one");
    let names = "lag.svg lead.svg peak-deflection.svg peak-hub-rate.svg peak-power.svg \
                 peak-root-moment.svg peak-torque.svg torque-ratio.svg";
    assert_eq!(bench.names("one").join(" "), names);
    let svg = bench.read("one/torque-ratio.svg");
    let [factors, ratios] =
        ["segments.*.EI*", "torque_ratio"].map(|name| bench.numbers("one.csv", name));
    let axis = numbers(attribute(&svg, "data-x"));
    let (shown, plot) = (points(&svg, "ratio"), numbers(attribute(&svg, "data-plot")));
    assert_eq!(attribute(&svg, "data-x-scale"), "log");
    for (k, (at, ratio)) in shown.iter().enumerate() {
        let across = (at - axis[0]) / (axis[1] - axis[0]) * plot[2];
        let expected = (factors[k] / axis[0]).ln() / (axis[1] / axis[0]).ln() * plot[2];
        assert!((across - expected).abs() < 0.01, "factor {}", factors[k]);
        assert!((ratio - ratios[k]).abs() < 1e-3, "ratio {}", ratios[k]);
    }

    sweep("two", "segments.*.EI*=1,4 --vary payload.mass=0,0.05,0.1");
    bench.silent("report two.csv -q -o two.html");
    let page = bench.read("two.html");
    assert_eq!(page.matches("data:image/png;base64,").count(), 8, "colour maps");
    assert_eq!(page.matches("class=\"on-").count(), 8 * 6, "a number in each field");
    for words in
        ["Bayo (1987), example 1", "<section id=\"link\"", "0, 0.05, 0.1", "hysteretic, ratio"]
    {
        assert!(page.contains(words), "{words}");
    }
    sweep("three", "segments.*.EI*=1,4 --vary payload.mass=0,0.1 --vary hub.inertia=0.1,0.2");
    assert_eq!(bench.silent("report three.csv"), "written  three.html\n");
    bench.silent("report three.csv -q --svg three");
    let svg = bench.read("three/lead.svg");
    let line = "data-name=\"segments.*.EI* = 4, payload.mass = 0.1 kg\"";
    assert!(svg.contains(line), "a line of its own");
    let last = [attribute(&svg, "data-x-name"), attribute(&svg, "data-x-unit")];
    assert_eq!(last, ["hub.inertia", "kg m²"]);
}

/// Columns and rows of the hatched fields of a map.
fn hatched(svg: &str) -> HashSet<(usize, usize)> {
    let fields = svg.split("class=\"stripes\" data-column=").skip(1);
    let number = |text: &str, name: &str| attribute(text, name).parse().unwrap();
    let place = |text: &str| {
        let text = format!(" data-column={text}");
        (number(&text, "data-column"), number(&text, "data-row"))
    };
    fields.map(place).collect()
}

/// The hatching is held against the numbers of the table and the limits of the command line.
#[test]
fn limits_of_a_sweep_are_lines_over_one_value_and_hatch_the_fields_over_two() {
    let bench = Bench::new();
    let limits = [("torque", 1.8, "N m"), ("hub_rate", 0.55, "rad/s"), ("deflection", 0.12, "m")];
    let set = "--set limits={torque=1.8,hub_rate=0.55,deflection=0.12}";
    let sweep = |name: &str, vary: &str| {
        bench.done(&format!("sweep {LINK} {MOTION} -q -o {name}.csv {set} {vary}"));
        bench.done(&format!("report {name}.csv -q --svg {name}"));
    };
    let column = |table: &str, key: &str, unit: &str| {
        let unit = match unit {
            "N m" => "n_m",
            "rad/s" => "rad_s",
            unit => unit,
        };
        bench.numbers(&format!("{table}.csv"), &format!("peak_{key}_{unit}"))
    };
    sweep("one", "--vary segments.*.EI*=1,1.5,8");
    let mut shares = bench.read("one/feasible.svg");
    assert!(points(&shares, "limit 1").iter().all(|(_, share)| (share - 1.0).abs() < 1e-3));
    for (key, limit, unit) in limits {
        let svg = bench.read(&format!("one/peak-{}.svg", key.replace('_', "-")));
        let line = points(&svg, &format!("limit {limit} {unit}"));
        let off = |(_, value): &(f64, f64)| (value - limit).abs();
        assert!(line.len() == 2 && line.iter().all(|point| off(point) < 1e-3), "{key}: {line:?}");
        let line = points(&shares, &key.replace('_', " "));
        for ((_, share), value) in line.iter().zip(column("one", key, unit)) {
            assert!((share - value / limit).abs() < 3e-3, "{key}: {share}");
        }
    }

    let stiffness = [1.0, 1.5, 8.0];
    let masses = [0.0, 0.1];
    sweep("two", "--vary segments.*.EI*=1,1.5,8 --vary payload.mass=0,0.1");
    let mut any = HashSet::new();
    let mut most: Vec<(f64, &str)> = vec![(0.0, ""); stiffness.len() * masses.len()];
    for (key, limit, unit) in limits {
        let values = column("two", key, unit);
        // The last value varies fastest.
        let place = |case: usize| (case / masses.len(), case % masses.len());
        let over = (0..values.len()).filter(|case| values[*case] > limit).map(place);
        let over: HashSet<(usize, usize)> = over.collect();
        let svg = bench.read(&format!("two/peak-{}.svg", key.replace('_', "-")));
        assert_eq!(hatched(&svg), over, "{key}");
        assert!(
            over.is_empty() || svg.contains(&format!("over the limit {limit} {unit}")),
            "{key}"
        );
        any.extend(over);
        for (most, value) in most.iter_mut().zip(values) {
            if value / limit > most.0 {
                *most = (value / limit, key);
            }
        }
    }
    shares = bench.read("two/feasible.svg");
    assert_eq!(hatched(&shares), any, "some limit");
    assert!(!any.is_empty() && any.len() < most.len(), "{most:?}");
    for (key, ..) in limits {
        let times = most.iter().filter(|(_, own)| *own == key).count();
        let words = format!("{} in {times}", key.replace('_', " "));
        assert_eq!(shares.contains(&words), times > 0, "{words}");
    }
    let told: Vec<f64> = shares
        .split("text-anchor=\"middle\">")
        .filter(|text| text.contains("</g>") || text.contains("on-light"))
        .filter_map(|text| text.split('<').next()?.parse().ok())
        .collect();
    for (share, _) in &most {
        assert!(told.iter().any(|own| (own - share).abs() < 0.006 * share), "{share}: {told:?}");
    }
    // A limit that is varied has no line, but the cases over it are hatched all the same.
    bench.done(&format!(
        "sweep {LINK} {MOTION} -q -o varied.csv --vary limits.torque=1,2 --vary payload.mass=0,0.1"
    ));
    bench.done("report varied.csv -q --svg varied");
    let svg = bench.read("varied/peak-torque.svg");
    let peaks = bench.numbers("varied.csv", "peak_torque_n_m");
    let over = (0..4).filter(|case| peaks[*case] > [1.0, 2.0][case / 2]);
    let axis = attribute(&svg, "data-x-name") == "limits.torque";
    let place = |case: usize| if axis { (case / 2, case % 2) } else { (case % 2, case / 2) };
    assert_eq!(hatched(&svg), over.map(place).collect(), "{peaks:?}");
    assert!(svg.contains("Its limit is among the varied values"));
}

/// Even if its lines are too many, and of a quantity without a figure otherwise.
#[test]
fn the_exceeded_quantity_of_a_sweep_is_drawn_whatever_else_is_not() {
    let bench = Bench::new();
    let vary =
        "--vary segments.*.EI*=1,2,4 --vary payload.mass=0,0.05,0.1 --vary hub.inertia=0.1,0.2,0.3";
    let sweep = |more: &str| {
        bench.done(&format!("sweep {LINK} {MOTION} -q -o sweep.csv {vary} {more}"));
        bench.done("report sweep.csv -q --svg figures");
        bench.numbers("sweep.csv", "peak_hub_acceleration_rad_s2")
    };
    let peaks = sweep("");
    assert!(!bench.path("figures/peak-hub-acceleration.svg").exists(), "it has no limit");
    let mut sorted = peaks.clone();
    sorted.sort_by(f64::total_cmp);
    let limit = (50.0 * (sorted[11] + sorted[12])).round() / 100.0;
    assert!(sorted[11] < limit && limit < sorted[12], "{sorted:?}");
    sweep(&format!("--set limits.hub_acceleration={limit}"));
    let svg = bench.read("figures/peak-hub-acceleration.svg");
    let over = points(&svg, &format!("over the limit {limit} rad/s²"));
    let within = points(&svg, "within the limit");
    assert_eq!((over.len(), within.len()), (15, 12));
    assert!(over.iter().all(|(_, value)| *value > limit * 0.999));
    assert!(within.iter().all(|(_, value)| *value < limit * 1.001));
}

/// The lines of each run are its tables, the numbers those of its summary.
#[test]
fn runs_of_links_stand_side_by_side() {
    let bench = Bench::new();
    let second = repository("specs/bayo1987_example2.toml");
    solved(&bench, "");
    fs::rename(bench.path("out"), bench.path("first")).unwrap();
    bench.done(&format!("solve {second} {MOTION} -q -o second"));
    let told = bench.silent("report first second -o both.html --svg figures");
    assert!(told.ends_with("written  both.html\n"), "{told}");
    for (figure, file, column) in
        [("torque", "torque", 1), ("hub-angle", "hub_angle", 1), ("tip-displacement", "tip", 1)]
    {
        for run in ["first", "second"] {
            assert_rows(&bench, (figure, run), (&format!("{run}/{file}.csv"), column), 3e-3);
        }
    }
    let page = bench.read("both.html").replace("&#39;", "'");
    for run in ["first", "second"] {
        for (name, unit) in [("peak_torque_n_m", "N m"), ("peak_deflection_m", "m")] {
            let peak = bench.number(run, &format!("results/{name}"));
            let cell = format!("<td>{} {unit}</td>", significant(peak, 4));
            assert!(page.contains(&cell), "{run}: {cell}");
        }
    }
    for words in [
        "link, which differ",
        "bayo1987_example2.toml (",
        "<th scope=\"row\">motion</th>",
        "since these figures hold one",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Open beside closed loop, with another payload: the error is that from the tip of the solved run.
    let play = format!("simulate {LINK} first/torque.csv -q --set payload.mass=0.05");
    bench.done(&format!("{play} -o open"));
    bench.done(&format!("{play} --feedback 20,5 --reference first/hub_angle.csv -o closed"));
    bench.done("report first open closed -q --svg figures -o loops.html");
    let svg = bench.read("figures/tip-error.svg");
    let [times, wanted] = [0, 1].map(|column| bench.table("first/tip.csv")[column].1.clone());
    for run in ["open", "closed"] {
        let tip = bench.table(&format!("{run}/tip.csv"));
        let shown = points(&svg, run);
        assert!(shown.len() > 300, "{run}: {}", shown.len());
        for (time_s, error) in shown.iter().step_by(7) {
            let row = tip[0].1.partition_point(|time| *time < time_s - 0.0005);
            let at = times.partition_point(|time| *time < time_s - 0.0005).min(times.len() - 1);
            let exact = tip[1].1[row] - wanted[at] - (tip[1].1[0] - wanted[0]);
            assert!((error - exact).abs() < 3e-4, "{run} at {time_s} s: {error} {exact}");
        }
    }
    // A carriage has no torque, but its tip moves along the same axis.
    let carriage = repository("specs/carriages/strip_on_cart.toml");
    bench.run(&format!("solve {carriage} {MOTION} -q -o slides"));
    bench.done("report first slides -q -o both.html");
    let page = bench.read("both.html");
    assert!(
        page.contains("the joint of slides, since it is a sliding link and first a turning link")
    );
    let figure = |id: &str| {
        let found = &page[page.find(&format!("id=\"fig-{id}\"")).unwrap()..];
        found[..found.find("</figure>").unwrap()].to_owned()
    };
    assert!(!figure("torque").contains("data-name=\"slides\""));
    assert!(figure("tip-displacement").contains("data-name=\"slides\""));
    // The numbers of a hub keep their words on the page of a carriage.
    bench.done("report slides first -q -o both.html");
    let page = bench.read("both.html");
    for name in ["peak torque", "peak force"] {
        assert!(page.contains(&format!("<th scope=\"row\">{name}</th>")), "{name}");
    }
    assert!(
        page.contains("the joint of first, since it is a turning link and slides a sliding link")
    );
    bench.done("report first first -q -o both.html");
    assert!(bench.read("both.html").contains("<strong>first (2)</strong>"));
}

#[test]
fn what_is_no_result_is_refused_in_words() {
    let bench = Bench::new();
    fs::create_dir(bench.path("empty")).unwrap();
    let told = bench.error(3, "report empty");
    assert!(told.contains("empty") && told.contains("flexlink solve"), "{told}");
    solved(&bench, "");
    fs::remove_file(bench.path("out/torque.csv")).unwrap();
    bench.refuses(3, "report out", "torque.csv");
    bench.write("foreign.csv", "a,b\n1,2\n");
    bench.refuses(3, "report foreign.csv", "foreign.csv");
    assert!(!bench.names(".").contains(&"report.html".to_owned()), "a page of nothing");
    bench.ends(2, "report foreign.csv -o foreign.csv");
    bench.ends(2, "report out -o out/tip.csv");
    assert!(bench.read("out/tip.csv").starts_with("time_s,"), "a page over a table");
}
