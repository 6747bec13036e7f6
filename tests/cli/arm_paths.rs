//! Paths of arms that `trajectory` makes: what is written, refused before it is solved, and fitted to limits.

use std::f64::consts::TAU;

use super::{Bench, column, ended, repository, stderr, stdout, succeeded};

const ARM: &str = "specs/arms/two_links.toml";

const SEPTIC: [&str; 4] = ["trajectory", "septic", "--step", "0.01"];
const LINE: [&str; 6] = ["--path", "line", "--from", "0.9,-0.5", "--to", "0.5 m,800 mm"];

fn made(bench: &Bench, arguments: &[&str]) -> Vec<(String, Vec<f64>)> {
    bench.silent(&[&SEPTIC, arguments, &["-o", "path.csv"]].concat());
    bench.table("path.csv")
}

#[test]
fn a_line_has_times_and_places_from_rest_to_rest() {
    let bench = Bench::new();
    let rests = ["--duration", "1.5", "--rest-before", "0.2", "--rest-after", "0.1"];
    let columns = made(&bench, &[&LINE[..], &rests].concat());
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["time", "x", "y"]);
    let [time, x, y] = [0, 1, 2].map(|column: usize| &columns[column].1);
    assert_eq!(time.len(), 20 + 151 + 10);
    assert!(
        x[..=20].iter().all(|x| x.total_cmp(&0.9).is_eq())
            && y[170..].iter().all(|y| y.total_cmp(&0.8).is_eq())
    );
    for (k, (x, y)) in x[20..=170].iter().zip(&y[20..=170]).enumerate() {
        let of = |k: usize| {
            let u = f64::from(u32::try_from(k).unwrap()) / 150.0;
            u.powi(4) * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u)))
        };
        // Without cancellation: of the half that is left.
        let share = if k > 75 { 1.0 - of(150 - k) } else { of(k) };
        assert!((x - (0.9 - 0.4 * share)).abs() < 1e-15, "row {k}");
        assert!((y - (-0.5 + 1.3 * share)).abs() < 1e-15, "row {k}");
    }
}

#[test]
fn outer_links_keep_the_directions_that_are_given() {
    let bench = Bench::new();
    let arc = ["--path", "arc", "--from", "0.7,0", "--center", "0,0", "--angle", "-90 deg"];
    let columns = made(&bench, &[&arc[..], &["--duration", "2", "--angles", "30 deg,-1"]].concat());
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["time", "x", "y", "angle3", "angle4"]);
    assert!(columns[3].1.iter().all(|angle| (angle - 30_f64.to_radians()).abs() < 1e-15));
    assert!(columns[4].1.iter().all(|angle| angle.total_cmp(&-1.0).is_eq()));
    let (x, y) = (&columns[1].1, &columns[2].1);
    assert!((y[200] + 0.7).abs() < 1e-15 && x[200].abs() < 1e-15, "clockwise by a quarter");
}

#[test]
fn what_the_arm_does_not_reach_is_refused_as_solve_refuses_it() {
    let bench = Bench::new();
    let arm = repository(ARM);
    let refused = |to: &str, words: &str| {
        let line = ["--path", "line", "--from", "0.9,-0.5", "--to", to, "--duration", "1"];
        let path = [&SEPTIC, &line[..], &["-o", "far.csv"]].concat();
        let checked = bench.ends(3, &[&path[..], &["--link", &arm]].concat());
        assert!(!bench.path("far.csv").exists(), "nothing is written");
        bench.done(&path);
        let solved = bench.run(&["solve", &arm, "far.csv"]);
        std::fs::remove_file(bench.path("far.csv")).unwrap();
        let [own, solved] = [stderr(&checked), stderr(&solved)];
        let place = own.strip_prefix("error: --path: row ").unwrap_or_else(|| panic!("{own}"));
        let (row, rest) = place.split_once(", at ").unwrap();
        let (time, message) = rest.split_once(" s: ").unwrap();
        let (row, time): (f64, f64) = (row.parse().unwrap(), time.parse().unwrap());
        assert!((time - 0.01 * (row - 1.0)).abs() < 1e-12, "{own}");
        assert!(solved.ends_with(message) && message.contains(words), "{own}{solved}");
        // Line 1 has the names.
        assert!(solved.contains(&format!("far.csv:{}: ", row + 1.0)), "{own}{solved}");
    };
    refused("1.2,0.9", "m from the first joint, but must be from 0.100000 to 1.300000 m");
    refused("1.2999,0", "the sine of the elbow's angle = 0.0");
    refused("0.1,0", "the sine of the elbow's angle = 0.0");

    let near = ["--path", "line", "--from", "0.9,-0.5", "--to", "1.298,0", "--duration", "1"];
    let near = [&SEPTIC, &near[..], &["--link", &arm, "-o", "near.csv"]].concat();
    let told = stderr(&bench.done(&near));
    assert!(told.starts_with("warning: the sine of the elbow's angle falls to 0.1"), "{told}");
    bench.ends(4, &[&near[..], &["--deny-warnings"]].concat());
}

/// The command that made the square of the repository, from its first line.
fn square_command(text: &str) -> Vec<String> {
    let command = text.lines().find_map(|line| line.strip_prefix("# flexlink ")).unwrap();
    command.split(' ').map(str::to_owned).collect()
}

#[test]
fn the_square_of_the_repository_is_made_by_its_command_and_followed_without_a_warning() {
    let bench = Bench::new();
    let file = repository("trajectories/arms/square_6s.csv");
    let text = std::fs::read_to_string(&file).unwrap();
    let command = square_command(&text);
    let output = bench.done(&command.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(text.ends_with(&stdout(&output)), "the file is what its command writes");
    let solved = bench.silent(&["solve", &repository(ARM), &file, "-o", "out"]);
    assert!(stdout(&solved).contains("path     of the tip"));
}

#[test]
fn the_shortest_path_within_the_limits_of_all_joints_is_found() {
    let bench = Bench::new();
    let step = ["trajectory", "septic", "--step", "0.02"];
    let line = ["--path", "line", "--from", "0.9,-0.1", "--to", "0.9,0.1"];
    let links = std::fs::read_to_string(repository(ARM)).unwrap();
    bench.write("coarse.toml", &format!("{links}\n[mesh]\nelements = 4\n"));
    let arm = "coarse.toml";
    let fit = |limits: &[&str]| {
        bench.run(&[&step, &line[..], &["--link", arm], limits, &["-o", "fit.csv"]].concat())
    };
    let output = fit(&["--fit-limit", "hub_rate=0.3", "--fit-limit", "fore.torque=20"]);
    let told = stderr(&output);
    assert!(output.status.success(), "{told}");
    let rest = told.strip_prefix("note: ").unwrap_or_else(|| panic!("{told}"));
    let (duration, rest) = rest.split_once(" s, the shortest duration within ").unwrap();
    let (within, binds) = rest.split_once("; ").unwrap();
    let limits = "joint 1 hub_rate=0.3 rad/s, joint 2 torque=20 N m, joint 2 hub_rate=0.3 rad/s";
    assert_eq!(within, limits);
    assert!(binds.starts_with("joint 1 limits.hub_rate binds: 0.29"), "{told}");
    let duration: f64 = duration.parse().unwrap();
    let rate = |duration_s: f64| -> f64 {
        let duration = format!("{duration_s:.3}");
        let exact = ["--duration", &duration, "-o", "exact.csv"];
        bench.done(&[&step, &line[..], &exact].concat());
        let summary = stdout(&bench.run(&["solve", arm, "exact.csv", "--json"]));
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        summary["results"]["joints"][0]["peak_hub_rate_rad_s"].as_f64().unwrap()
    };
    assert!(rate(duration - 0.02) > 0.3 && rate(duration) <= 0.3, "{duration} s");
    assert!(bench.read("fit.csv").ends_with(&bench.read("exact.csv")));

    // Where no shorter path can be solved, that is told, not a limit that is far away.
    let loose = stderr(&fit(&["--fit-limit", "hub_rate=0.8"]));
    assert!(loose.contains("; no limit binds: with a step less, step = 0.02"), "{loose}");

    let heavy = ended(4, fit(&["--fit-limit", "upper.torque=2"]));
    let message = "error: joint 1: limits.torque = 2.000 N m, but must be at least ";
    assert!(stderr(&heavy).starts_with(message), "{}", stderr(&heavy));
}

/// Linear, on a mesh of its own: what is read counts here.
const LINEAR: [&str; 4] = ["--set", "analysis.second_order=\"none\"", "--set", "mesh.elements=4"];

/// A path of two links, as its samples are at uniform or uneven times.
fn samples(uneven: f64) -> Vec<[f64; 3]> {
    let of = |k: u32| {
        let even = f64::from(k) / 200.0;
        let u = even + uneven * (std::f64::consts::TAU * even).sin() / std::f64::consts::TAU;
        let share = u.powi(5) * (126.0 - u * (420.0 - u * (540.0 - u * (315.0 - 70.0 * u))));
        [u, 0.9, -0.5 + 0.6 * share]
    };
    (0..=200).map(of).collect()
}

fn table(heading: &str, rows: impl IntoIterator<Item = String>) -> String {
    rows.into_iter().fold(format!("{heading}\n"), |text, row| text + &row + "\n")
}

fn standard([time, x, y]: [f64; 3]) -> String {
    format!("{time:.15},{x:.15},{y:.15}")
}

/// Largest difference of both torques of two runs, over the largest torque.
fn difference(bench: &Bench, runs: [&str; 2]) -> f64 {
    let mut worst: f64 = 0.0;
    for name in ["torque1_n_m", "torque2_n_m"] {
        let of = |run: &str, name: &str| column(bench, &format!("{run}/torques.csv"), name);
        let [times, others] = runs.map(|run| of(run, "time_s"));
        let [own, other] = runs.map(|run| of(run, name));
        let peak = own.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        let same = |time: &f64| others.iter().position(|other| (other - time).abs() < 1e-9);
        let pairs: Vec<_> =
            times.iter().zip(&own).filter_map(|(t, a)| Some((a, other[same(t)?]))).collect();
        assert!(pairs.len() > 200, "{}", pairs.len());
        worst = pairs.iter().fold(worst, |most, (a, b)| most.max((*a - b).abs() / peak));
    }
    worst
}

fn solved(bench: &Bench, arguments: &[&str]) -> String {
    let arm = repository(ARM);
    let output = bench.done(&[&["solve", &arm], arguments, &LINEAR, &["-q"]].concat());
    stderr(&output)
}

#[test]
fn a_path_as_an_instrument_writes_it_is_read_by_the_options_recorded_and_repeated() {
    let bench = Bench::new();
    bench.write("path.csv", &table("time,x,y", samples(0.0).into_iter().map(standard)));
    solved(&bench, &["path.csv", "-o", "standard"]);
    let lab = samples(0.0).into_iter().map(|[time, x, y]| {
        let [ms, x, y] = [1e3 * time, 1e3 * x, -2e3 * y].map(|own| format!("{own:.12}"));
        format!("7;{y};{x};{ms}").replace('.', ",")
    });
    bench.write("lab.csv", &table("Messung 3\nNr;hoch;rechts;Zeit", lab));
    let reading = [
        "--columns",
        "time=4,x=rechts",
        "--columns",
        "y=2",
        "--time-unit",
        "ms",
        "--unit",
        "mm",
        "--scale",
        "y=-0.5",
        "--skip",
        "1",
    ];
    let told = solved(&bench, &[&["lab.csv", "-o", "lab"], &reading[..]].concat());
    let note = "note: lab.csv: read ; as delimiter, decimal comma, y from column 2 \"hoch\" in mm, \
                x from column 3 \"rechts\" in mm, time from column 4 \"Zeit\" in ms\n";
    assert!(told.starts_with(note), "{told}");
    let off = difference(&bench, ["standard", "lab"]);
    assert!(off < 1e-8, "{off:e}");
    let recorded = bench.json("lab/summary.json")["inputs"]["arguments"].to_string();
    assert!(recorded.contains("\"--columns\",\"x=rechts\""), "{recorded}");
    assert!(recorded.contains("\"--scale\",\"y=-0.5\""), "{recorded}");
    bench.done(&["solve", "--repeat", "lab", &repository(ARM), "lab.csv"]);
}

#[test]
fn uneven_samples_of_a_path_are_made_uniform_by_a_spline_and_repeated() {
    let bench = Bench::new();
    bench.write("even.csv", &table("time,x,y", samples(0.0).into_iter().map(standard)));
    bench.write("uneven.csv", &table("time,x,y", samples(0.05).into_iter().map(standard)));
    solved(&bench, &["even.csv", "-o", "even"]);
    solved(&bench, &["uneven.csv", "--resample", "0.005", "-o", "uneven"]);
    let off = difference(&bench, ["even", "uneven"]);
    assert!(off > 1e-12 && off < 1e-6, "{off:e}");
    bench.done(&["solve", "--repeat", "uneven", &repository(ARM), "uneven.csv"]);

    let arm = repository(ARM);
    let sweep = ["sweep", &arm, "uneven.csv", "--resample", "0.005", "--vary", "mesh.elements=4"];
    let linear = ["--set", "analysis.second_order=\"none\"", "-o", "sweep.csv", "-q"];
    bench.done(&[&sweep[..], &linear].concat());
    let summary = bench.json("uneven/summary.json");
    let peak = summary["results"]["joints"][0]["peak_torque_n_m"].as_f64().unwrap();
    let text = bench.read("sweep.csv");
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let at = names.iter().position(|name| *name == "peak_torque1_n_m").unwrap();
    let found: f64 = text.lines().nth(1).unwrap().split(',').nth(at).unwrap().parse().unwrap();
    assert!((found / peak - 1.0).abs() < 1e-8, "{found} {peak}");
}

/// An arm of so many links under gravity that turn by a septic in 2 s, each joint its own way: times and torques, and the
/// largest error that the run states of them, over each range.
fn turning(bench: &Bench, links: usize, step_s: f64) -> (Vec<(String, Vec<f64>)>, f64) {
    let link = |(number, numbers): (usize, &[f64; 6])| {
        let [length, ei, mass, hub, tip, _] = numbers;
        let end = if number + 1 == links { "payload" } else { "tip" };
        format!(
            "[[links]]\nname = 'l{number}'\nsegments = [{{ length = {length}, EI = {ei}, mass_per_length = {mass} }}]\n\
             hub = {{ inertia = {hub} }}\n{end} = {{ mass = {tip} }}\n\
             damping = {{ model = 'rayleigh', beta = 2e-4 }}\n"
        )
    };
    let numbers = [
        [0.5, 80.0, 0.8, 0.02, 0.4, 1.0],
        [0.4, 40.0, 0.6, 0.01, 0.3, -0.6],
        [0.3, 15.0, 0.4, 0.004, 0.15, 0.8],
        [0.2, 5.0, 0.2, 0.001, 0.1, 1.5],
        [0.15, 2.0, 0.1, 0.0005, 0.05, 0.9],
    ];
    let arm: Vec<String> = numbers[..links].iter().enumerate().map(link).collect();
    bench.write("turning.toml", &format!("gravity = [0, -9.81]\nelbow = 'left'\n{}", arm.concat()));
    let row = |k: i32| {
        let s = f64::from(k) * step_s / 2.0;
        let q = s.powi(4) * (35.0 - s * (84.0 - s * (70.0 - 20.0 * s)));
        let from = [-1.2, -0.3, 0.3, 0.6, -0.2];
        let angles = from.iter().zip(&numbers[..links]).map(|(from, own)| from + own[5] * q);
        let cells: Vec<String> = angles.map(|angle| angle.to_string()).collect();
        format!("{},{}\n", 2.0 * s, cells.join(","))
    };
    let rows = (0..).take_while(|k| f64::from(*k) * step_s < 2.0 + 0.5 * step_s).map(row);
    let names: Vec<String> = (1..=links).map(|number| format!("angle{number}")).collect();
    let rows = format!("time,{}\n{}", names.join(","), rows.collect::<String>());
    bench.write("turning.csv", &rows);
    bench.done(&["solve", "turning.toml", "turning.csv", "-o", "turned"]);
    let summary = bench.json("turned/summary.json");
    let stated = summary["errors"]["joints"].as_array().unwrap().iter().map(|joint| {
        let kinds = ["mesh", "window", "step", "iteration"];
        kinds.iter().filter_map(|kind| joint["torque"][*kind].as_f64()).sum::<f64>()
    });
    (bench.table("turned/torques.csv"), stated.fold(0.0, f64::max))
}

#[test]
fn every_step_of_the_same_path_gives_the_same_torques_within_what_is_stated() {
    let bench = Bench::new();
    for links in 2..=5 {
        let (coarse, of_coarse) = turning(&bench, links, 0.002);
        for step_s in [0.02, 0.008, 0.001, 0.0005, 0.00025, 1.25e-4] {
            let (fine, of_fine) = turning(&bench, links, step_s);
            let stated = of_coarse + of_fine;
            assert!(stated < 1e-4, "{links} links, {step_s} s: {stated}");
            for (own, other) in coarse.iter().zip(&fine).skip(1) {
                let [low, high] =
                    own.1.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |ends, own| {
                        [ends[0].min(*own), ends[1].max(*own)]
                    });
                // The windows begin where the torques leave their rest: rows are matched by their times.
                let apart = coarse[0].1.iter().zip(&own.1).filter_map(|(time, torque)| {
                    let row = fine[0].1.partition_point(|own| *own < time - 1e-6);
                    let is_same = fine[0].1.get(row).is_some_and(|own| (own - time).abs() < 1e-6);
                    is_same.then(|| (torque - other.1[row]).abs())
                });
                let apart: Vec<f64> = apart.collect();
                assert!(apart.len() > 80, "{}: {} rows", own.0, apart.len());
                let most = apart.into_iter().fold(0.0, f64::max);
                let share = most / (high - low);
                assert!(share < stated, "{links} links, {step_s} s, {}: {share}, {stated}", own.0);
            }
        }
    }
}

#[test]
fn a_path_whose_rates_jump_is_refused_at_every_step() {
    let bench = Bench::new();
    let arm = repository(ARM);
    for step_s in [0.004, 0.0005] {
        let row = |k: i32| {
            let time = f64::from(k) * step_s;
            let turned = 0.5 * ((time - 0.3) / 0.4).clamp(0.0, 1.0);
            format!("{time},{},{}", 0.2 + turned, 1.2 + turned)
        };
        let rows = (0..).take_while(|k| f64::from(*k) * step_s < 1.0 + 0.5 * step_s).map(row);
        bench.write("jump.csv", &table("time,angle1,angle2", rows));
        let output = bench.run(&["solve", &arm, "jump.csv", "-o", "jumped"]);
        assert!(!output.status.success(), "{step_s} s: {}", stdout(&output));
        assert!(stderr(&output).contains("a smoother motion"), "{step_s} s: {}", stderr(&output));
    }
}

/// Sines of a few samples on two links: the step that the refusal names is solved.
#[test]
fn the_step_that_a_refusal_names_is_solved() {
    let bench = Bench::new();
    let arm = repository(ARM);
    for duration_s in [0.5, 0.7] {
        let solve = |step_s: f64| {
            let steps = (1..10_000).find(|k| f64::from(*k) * step_s >= duration_s).unwrap();
            let row = |k: i32| {
                let s = f64::from(k) / f64::from(steps) - 0.5;
                let turn = s.clamp(0.0, 1.0);
                let turn = turn - (TAU * turn).sin() / TAU;
                format!("{},{},{}", (s + 0.5) * duration_s, 0.2 + 0.5 * turn, 1.2 - 0.3 * turn)
            };
            bench.write("coarse.csv", &table("time,angle1,angle2", (0..=2 * steps).map(row)));
            bench.run(&["solve", &arm, "coarse.csv", "-o", "coarse"])
        };
        let refused = stderr(&solve(0.02));
        let (_, named) = refused.split_once("but must be shorter, about ").expect(&refused);
        let named_s: f64 = named.split(' ').next().unwrap().parse().unwrap();
        assert!(named_s > 0.001, "{refused}");
        succeeded(solve(named_s));
    }
}
