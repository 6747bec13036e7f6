//! Paths of arms that `trajectory` makes: what is written, refused before it is solved, and fitted to limits.

use super::{Bench, repository, stderr, stdout};

const ARM: &str = "specs/arms/two_links.toml";

const SEPTIC: [&str; 4] = ["trajectory", "septic", "--step", "0.01"];
const LINE: [&str; 6] = ["--path", "line", "--from", "0.9,-0.5", "--to", "0.5 m,800 mm"];

fn made(bench: &Bench, arguments: &[&str]) -> Vec<(String, Vec<f64>)> {
    let output = bench.run(&[&SEPTIC, arguments, &["-o", "path.csv"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
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
        let checked = bench.run(&[&path[..], &["--link", &arm]].concat());
        assert_eq!(checked.status.code(), Some(3));
        assert!(!bench.path("far.csv").exists(), "nothing is written");
        assert!(bench.run(&path).status.success());
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
    let output = bench.run(&near);
    assert!(output.status.success());
    let told = stderr(&output);
    assert!(told.starts_with("warning: the sine of the elbow's angle falls to 0.1"), "{told}");
    let denied = bench.run(&[&near[..], &["--deny-warnings"]].concat());
    assert_eq!(denied.status.code(), Some(4));
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
    let output = bench.run(&command.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(text.ends_with(&stdout(&output)), "the file is what its command writes");
    let solved = bench.run(&["solve", &repository(ARM), &file, "-o", "out"]);
    assert!(solved.status.success());
    assert_eq!(stderr(&solved), "");
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
        assert!(bench.run(&[&step, &line[..], &exact].concat()).status.success());
        let summary = stdout(&bench.run(&["solve", arm, "exact.csv", "--json"]));
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        summary["results"]["joints"][0]["peak_rate_rad_s"].as_f64().unwrap()
    };
    assert!(rate(duration - 0.02) > 0.3 && rate(duration) <= 0.3, "{duration} s");
    assert!(bench.read("fit.csv").ends_with(&bench.read("exact.csv")));

    // Where no shorter path can be solved, that is told, not a limit that is far away.
    let loose = stderr(&fit(&["--fit-limit", "hub_rate=0.8"]));
    assert!(loose.contains("; no limit binds: with a step less, step = 0.02"), "{loose}");

    let heavy = fit(&["--fit-limit", "upper.torque=2"]);
    assert_eq!(heavy.status.code(), Some(4));
    let message = "error: joint 1: limits.torque = 2.000 N m, but must be at least ";
    assert!(stderr(&heavy).starts_with(message), "{}", stderr(&heavy));
}
