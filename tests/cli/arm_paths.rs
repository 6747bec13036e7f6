//! Paths of arms that `trajectory` makes: what is written, refused before it is solved, and fitted to limits.

use std::f64::consts::TAU;

use super::{
    Bench, apart, column, ended, ninth, number, peak, repository, septic, stderr, stdout, succeeded,
};

const ARM: &str = "specs/arms/two_links.toml";

const SEPTIC: &str = "trajectory septic --step 0.01";

fn made(bench: &Bench, arguments: &[&str]) -> Vec<(String, Vec<f64>)> {
    bench.silent(&super::with(SEPTIC, &[arguments, &["-o", "path.csv"]].concat()));
    bench.table("path.csv")
}

#[test]
fn a_line_has_times_and_places_from_rest_to_rest() {
    let bench = Bench::new();
    let line = ["--path", "line", "--from", "0.9,-0.5", "--to", "0.5 m,800 mm"];
    let rests = ["--duration", "1.5", "--rest-before", "0.2", "--rest-after", "0.1"];
    let columns = made(&bench, &[&line[..], &rests].concat());
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["time", "x", "y"]);
    let [time, x, y] = [0, 1, 2].map(|column: usize| &columns[column].1);
    assert_eq!(time.len(), 20 + 151 + 10);
    assert_eq!((&x[..=20], &y[170..]), (&[0.9; 21][..], &[0.8; 11][..]));
    for (k, (x, y)) in (0..=150).zip(x[20..].iter().zip(&y[20..])) {
        // Without cancellation: of the half that is left.
        let of = |k: i32| septic(f64::from(k) / 150.0);
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
    let refused = |to: &str, words: &str| {
        let path =
            format!("{SEPTIC} --path line --from 0.9,-0.5 --to {to} --duration 1 -o far.csv");
        let own = bench.error(3, &format!("{path} --link {ARM}"));
        assert!(!bench.path("far.csv").exists(), "nothing is written");
        bench.done(&path);
        let solved = stderr(&bench.run(&format!("solve {ARM} far.csv")));
        std::fs::remove_file(bench.path("far.csv")).unwrap();
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

    let near = format!(
        "{SEPTIC} --path line --from 0.9,-0.5 --to 1.298,0 --duration 1 --link {ARM} -o near.csv"
    );
    let told = bench.told(&near);
    assert!(told.starts_with("warning: the sine of the elbow's angle falls to 0.1"), "{told}");
    bench.ends(4, &format!("{near} --deny-warnings"));
}

#[test]
fn the_square_of_the_repository_is_made_by_its_command_and_followed_without_a_warning() {
    let bench = Bench::new();
    let file = "trajectories/arms/square_6s.csv";
    let text = std::fs::read_to_string(repository(file)).unwrap();
    let command = text.lines().find_map(|line| line.strip_prefix("# flexlink ")).unwrap();
    assert!(text.ends_with(&bench.printed(command)), "the file is what its command writes");
    let solved = bench.silent(&format!("solve {ARM} {file} -o out"));
    assert!(solved.contains("path     of the tip"));
}

#[test]
fn the_shortest_path_within_the_limits_of_all_joints_is_found() {
    let bench = Bench::new();
    let line = "trajectory septic --path line --from 0.9,-0.1 --to 0.9,0.1";
    let links = std::fs::read_to_string(repository(ARM)).unwrap();
    bench.write("coarse.toml", &format!("{links}\n[mesh]\nelements = 4\n"));
    let fit = |limits: &str| bench.run(&format!("{line} --link coarse.toml {limits} -o fit.csv"));
    let output = fit("--step 0.04 --fit-limit hub_rate=0.3 --fit-limit fore.torque=20");
    let told = stderr(&succeeded(output));
    let rest = told.strip_prefix("note: ").unwrap_or_else(|| panic!("{told}"));
    let (duration, rest) = rest.split_once(" s, the shortest duration within ").unwrap();
    let (within, binds) = rest.split_once("; ").unwrap();
    let limits = "joint 1 hub_rate=0.3 rad/s, joint 2 torque=20 N m, joint 2 hub_rate=0.3 rad/s";
    assert_eq!(within, limits);
    assert!(binds.starts_with("joint 1 limits.hub_rate binds: 0.29"), "{told}");
    let duration: f64 = duration.parse().unwrap();
    let rate = |duration_s: f64| -> f64 {
        bench.done(&format!("{line} --step 0.04 --duration {duration_s:.3} -o exact.csv"));
        number(
            &bench.reply("solve coarse.toml exact.csv --json"),
            "results/joints/0/peak_hub_rate_rad_s",
        )
    };
    assert!(rate(duration - 0.04) > 0.3 && rate(duration) <= 0.3, "{duration} s");
    assert!(bench.read("fit.csv").ends_with(&bench.read("exact.csv")));

    // Where no shorter path can be solved, that is told, not a limit that is far away.
    let loose = stderr(&fit("--step 0.02 --fit-limit hub_rate=0.8"));
    assert!(loose.contains("; no limit binds: with a step less, step = 0.02"), "{loose}");

    let heavy = stderr(&ended(4, fit("--step 0.02 --fit-limit upper.torque=2")));
    let message = "error: joint 1: limits.torque = 2.000 N m, but must be at least ";
    assert!(heavy.starts_with(message), "{heavy}");
}

/// Linear, on a mesh of its own: what is read counts here.
const LINEAR: &str = "--set analysis.second_order=\"none\" --set mesh.elements=4 -q";

/// A path of two links, as its samples are at uniform or uneven times.
fn samples(uneven: f64) -> impl Fn(f64) -> [f64; 3] {
    move |k: f64| {
        let u = k / 200.0 + uneven * (TAU * k / 200.0).sin() / TAU;
        [u, 0.9, -0.5 + 0.6 * ninth(u)]
    }
}

/// Largest difference of both torques of two runs, over the largest torque.
fn difference(bench: &Bench, runs: [&str; 2]) -> f64 {
    let of = |run: &str, name: &str| column(bench, &format!("{run}/torques.csv"), name);
    let [times, others] = runs.map(|run| of(run, "time_s"));
    let same = |time: &f64| others.iter().position(|other| (other - time).abs() < 1e-9);
    let rows: Vec<(usize, usize)> =
        times.iter().enumerate().filter_map(|(k, time)| Some((k, same(time)?))).collect();
    assert!(rows.len() > 200, "{}", rows.len());
    let differ = |name: &str| {
        let [own, other] = runs.map(|run| of(run, name));
        let (own, other): (Vec<f64>, Vec<f64>) =
            rows.iter().map(|(a, b)| (own[*a], other[*b])).unzip();
        apart(&own, &other) / peak(&own)
    };
    differ("torque1_n_m").max(differ("torque2_n_m"))
}

fn solved(bench: &Bench, arguments: &str) -> String {
    bench.told(&format!("solve {ARM} {arguments} {LINEAR}"))
}

#[test]
fn a_path_as_an_instrument_writes_it_is_read_by_the_options_recorded_and_repeated() {
    let bench = Bench::new();
    bench.sampled("path.csv", "time,x,y", 0..=200, samples(0.0));
    solved(&bench, "path.csv -o standard");
    let lab = (0..=200).map(f64::from).map(samples(0.0)).map(|[time, x, y]| {
        let [ms, x, y] = [1e3 * time, 1e3 * x, -2e3 * y].map(|own| format!("{own:.12}"));
        format!("7;{y};{x};{ms}\n").replace('.', ",")
    });
    bench.write("lab.csv", &format!("Messung 3\nNr;hoch;rechts;Zeit\n{}", lab.collect::<String>()));
    let columns = "--columns time=4,x=rechts --columns y=2 --time-unit ms --unit mm";
    let told = solved(&bench, &format!("lab.csv -o lab {columns} --scale y=-0.5 --skip 1"));
    let note = "note: lab.csv: read ; as delimiter, decimal comma, y from column 2 \"hoch\" in mm, \
                x from column 3 \"rechts\" in mm, time from column 4 \"Zeit\" in ms\n";
    assert!(told.starts_with(note), "{told}");
    let off = difference(&bench, ["standard", "lab"]);
    assert!(off < 1e-8, "{off:e}");
    let recorded = bench.json("lab/summary.json")["inputs"]["arguments"].to_string();
    assert!(recorded.contains("\"--columns\",\"x=rechts\""), "{recorded}");
    assert!(recorded.contains("\"--scale\",\"y=-0.5\""), "{recorded}");
    bench.done(&format!("solve --repeat lab {ARM} lab.csv"));
}

#[test]
fn uneven_samples_of_a_path_are_made_uniform_by_a_spline_and_repeated() {
    let bench = Bench::new();
    bench.sampled("even.csv", "time,x,y", 0..=200, samples(0.0));
    bench.sampled("uneven.csv", "time,x,y", 0..=200, samples(0.05));
    solved(&bench, "even.csv -o even");
    solved(&bench, "uneven.csv --resample 0.005 -o uneven");
    let off = difference(&bench, ["even", "uneven"]);
    assert!(off > 1e-12 && off < 1e-6, "{off:e}");
    bench.done(&format!("solve --repeat uneven {ARM} uneven.csv"));

    let linear = "--vary mesh.elements=4 --set analysis.second_order=\"none\" -o sweep.csv -q";
    bench.done(&format!("sweep {ARM} uneven.csv --resample 0.005 {linear}"));
    let peak = bench.number("uneven", "results/joints/0/peak_torque_n_m");
    let found = bench.numbers("sweep.csv", "peak_torque1_n_m")[0];
    assert!((found / peak - 1.0).abs() < 1e-8, "{found} {peak}");
}

/// An arm of so many links under gravity that turn by a septic in 2 s, each joint its own way: times and torques, and the
/// largest error that the run states of them, over each range.
fn turning(bench: &Bench, links: usize, step_s: f64) -> (Vec<(String, Vec<f64>)>, f64) {
    let link = |(number, numbers): (usize, &[f64; 7])| {
        let [length, ei, mass, hub, tip, ..] = numbers;
        let end = if number + 1 == links { "payload" } else { "tip" };
        format!(
            "[[links]]\nname = 'l{number}'\nsegments = [{{ length = {length}, EI = {ei}, mass_per_length = {mass} }}]\n\
             hub = {{ inertia = {hub} }}\n{end} = {{ mass = {tip} }}\n\
             damping = {{ model = 'rayleigh', beta = 2e-4 }}\n"
        )
    };
    let numbers = [
        [0.5, 80.0, 0.8, 0.02, 0.4, -1.2, 1.0],
        [0.4, 40.0, 0.6, 0.01, 0.3, -0.3, -0.6],
        [0.3, 15.0, 0.4, 0.004, 0.15, 0.3, 0.8],
        [0.2, 5.0, 0.2, 0.001, 0.1, 0.6, 1.5],
        [0.15, 2.0, 0.1, 0.0005, 0.05, -0.2, 0.9],
    ];
    let arm: String = numbers[..links].iter().enumerate().map(link).collect();
    bench.write("turning.toml", &format!("gravity = [0, -9.81]\nelbow = 'left'\n{arm}"));
    let row = |k: i32| {
        let s = f64::from(k) * step_s / 2.0;
        let angles = numbers[..links].iter().map(|own| own[5] + own[6] * septic(s));
        let cells: Vec<String> = angles.map(|angle| angle.to_string()).collect();
        format!("{},{}\n", 2.0 * s, cells.join(","))
    };
    let rows = (0..).take_while(|k| f64::from(*k) * step_s < 2.0 + 0.5 * step_s).map(row);
    let names: Vec<String> = (1..=links).map(|number| format!("angle{number}")).collect();
    let rows = format!("time,{}\n{}", names.join(","), rows.collect::<String>());
    bench.write("turning.csv", &rows);
    bench.done("solve turning.toml turning.csv -o turned");
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
            // The windows begin where the torques leave their rest: rows are matched by their times.
            let same = |time: f64| {
                let row = fine[0].1.partition_point(|own| *own < time - 1e-6);
                fine[0].1.get(row).is_some_and(|own| (own - time).abs() < 1e-6).then_some(row)
            };
            let times = coarse[0].1.iter().enumerate();
            let rows: Vec<_> = times.filter_map(|(k, time)| Some((k, same(*time)?))).collect();
            assert!(rows.len() > 80, "{} rows", rows.len());
            for ((name, own), (_, other)) in coarse.iter().zip(&fine).skip(1) {
                let [low, high] =
                    [f64::min, f64::max].map(|of| own.iter().copied().reduce(of).unwrap());
                let most =
                    rows.iter().map(|(k, row)| (own[*k] - other[*row]).abs()).fold(0.0, f64::max);
                let share = most / (high - low);
                assert!(share < stated, "{links} links, {step_s} s, {name}: {share}, {stated}");
            }
        }
    }
}

#[test]
fn a_path_whose_rates_jump_is_refused_at_every_step() {
    let bench = Bench::new();
    for (step_s, steps) in [(0.004, 250), (0.0005, 2000)] {
        bench.sampled("jump.csv", "time,angle1,angle2", 0..=steps, |k| {
            let turned = 0.5 * ((k * step_s - 0.3) / 0.4).clamp(0.0, 1.0);
            [k * step_s, 0.2 + turned, 1.2 + turned]
        });
        let output = bench.run(&format!("solve {ARM} jump.csv -o jumped"));
        assert!(!output.status.success(), "{step_s} s: {}", stdout(&output));
        assert!(stderr(&output).contains("a smoother motion"), "{step_s} s: {}", stderr(&output));
    }
}

/// Sines of a few samples on two links: the step that the refusal names is solved.
#[test]
fn the_step_that_a_refusal_names_is_solved() {
    let bench = Bench::new();
    for duration_s in [0.5, 0.7] {
        let solve = |step_s: f64| {
            let steps = (1..10_000).find(|k| f64::from(*k) * step_s >= duration_s).unwrap();
            bench.sampled("coarse.csv", "time,angle1,angle2", 0..=2 * steps, |k| {
                let s = k / f64::from(steps) - 0.5;
                let turn = s.clamp(0.0, 1.0);
                let turn = turn - (TAU * turn).sin() / TAU;
                [(s + 0.5) * duration_s, 0.2 + 0.5 * turn, 1.2 - 0.3 * turn]
            });
            bench.run(&format!("solve {ARM} coarse.csv -o coarse"))
        };
        let refused = stderr(&solve(0.02));
        let (_, named) = refused.split_once("but must be shorter, about ").expect(&refused);
        let named_s: f64 = named.split(' ').next().unwrap().parse().unwrap();
        assert!(named_s > 0.001, "{refused}");
        succeeded(solve(named_s));
    }
}
