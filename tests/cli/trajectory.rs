//! `trajectory`: motions that `solve` takes as they are.

use super::{Bench, LINK, column, number, peak, repository, stderr, with};

const PROFILES: [&str; 8] =
    ["sine", "versine", "min-jerk", "septic", "trapezoid", "s-curve", "bang-bang", "gaussian"];

const SEPTIC: &str = "trajectory septic --distance 0.5";

#[test]
fn every_profile_is_a_motion_of_the_distance_asked_for() {
    let bench = Bench::new();
    for profile in PROFILES {
        let made = "--distance -0.5 --duration 0.88 --step 0.002 -o move.csv";
        bench.silent(&format!("trajectory {profile} {made}"));
        let told = bench.told(&format!("solve {LINK} move.csv --json"));
        let travel = bench.number("out", "motion/travel_m");
        assert!((travel + 0.5).abs() < 1e-12, "{profile}: {travel}");
        assert!(!told.contains("integrates to"), "{profile} ends at rest");
    }
}

#[test]
fn the_sine_is_the_one_of_the_repository() {
    let bench = Bench::new();
    bench.done("trajectory sine --distance 0.5 --duration 0.88 --step 0.001 -o s.csv");
    let text = std::fs::read_to_string(repository("trajectories/sine_0.88s.csv")).unwrap();
    let given = text.lines().filter(|line| !line.starts_with(['#', 't']));
    let given = given.map(|line| line.split(',').nth(1).unwrap().parse::<f64>().unwrap());
    let moving = |samples: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
        samples.filter(|a| a.abs() > 1e-6).collect()
    };
    let own = moving(&mut column(&bench, "s.csv", "acceleration").into_iter());
    let given = moving(&mut given.into_iter());
    assert_eq!(own.len(), given.len());
    for (a, b) in own.iter().zip(&given) {
        // The samples add up to 0.5 m here, there the curve between them does: 4e-6 apart.
        assert!((a / b - 1.0).abs() < 1e-5, "{a} is not {b}");
    }
}

#[test]
fn rest_stands_before_and_after() {
    let bench = Bench::new();
    let rested = "--duration 0.88 --step 0.002 --rest-before 0.1 --rest-after 0.2 -o m.csv";
    bench.silent(&format!("trajectory septic --distance -0.5 {rested}"));
    let columns = bench.table("m.csv");
    let (time, acceleration) = (&columns[0].1, &columns[1].1);
    assert_eq!(time.len(), 50 + 440 + 1 + 100);
    assert!((time[time.len() - 1] - 1.18).abs() < 1e-12);
    assert!(acceleration[..=50].iter().chain(&acceleration[490..]).all(|a| *a == 0.0));
    assert!(acceleration[51] < 0.0 && acceleration[489] > 0.0, "backwards, as asked for");
}

#[test]
fn the_shortest_duration_within_a_limit_is_found_to_the_step() {
    let bench = Bench::new();
    let (_, told) = fitted(&bench, LINK, "0.002", "--fit-limit torque=1");
    let text = bench.read("fit.csv");
    let within = "the shortest duration within torque=1 N m";
    let remark = text.lines().next().unwrap().strip_prefix("# septic: ").unwrap();
    let duration = remark.strip_suffix(&format!(" s, {within}")).unwrap();
    let duration: f64 = duration.parse().unwrap();
    // The same is told beside the file, with the limit that binds and by how much.
    let note = format!("note: {duration} s, {within}; limits.torque binds: ");
    let rest = told.strip_prefix(&note).unwrap_or_else(|| panic!("{told}"));
    let (found, rest) = rest.split_once(" N m of 1 N m, ").unwrap();
    let (below, _) = rest.split_once(" % below it with its error of ").unwrap();
    let (found, below): (f64, f64) = (found.parse().unwrap(), below.parse().unwrap());
    assert!((100.0 * (1.0 - found) - below).abs() < 0.02, "{told}");
    assert!(peak_n_m(&bench, duration - 0.002, "0.002") > 1.0, "{duration} s");
    assert!(peak_n_m(&bench, duration, "0.002") <= 1.0, "{duration} s");
    assert!(text.ends_with(&bench.read("exact.csv")));
}

/// The peak torque of a septic motion of 0.5 m.
fn peak_n_m(bench: &Bench, duration_s: f64, step: &str) -> f64 {
    bench.done(&format!("{SEPTIC} --step {step} --duration {duration_s:.6} -o exact.csv"));
    number(
        &super::json_of(&bench.run(&format!("solve {LINK} exact.csv --json"))),
        "results/peak_torque_n_m",
    )
}

/// `--fit-limit` of a septic motion of 0.5 m.
fn fitted(bench: &Bench, link: &str, step: &str, more: &str) -> (Option<i32>, String) {
    let output = bench.run(&format!("{SEPTIC} --step {step} --link {link} {more} -o fit.csv"));
    (output.status.code(), stderr(&output))
}

#[test]
fn all_limits_that_hold_are_named_and_the_one_that_binds() {
    let bench = Bench::new();
    let text = std::fs::read_to_string(repository(LINK)).unwrap();
    bench.write("limited.toml", &format!("{text}\n[limits]\nhub_rate = 2.0\n"));
    let (code, told) = fitted(&bench, "limited.toml", "0.01", "--fit-limit torque=5");
    assert_eq!(code, Some(0), "{told}");
    let within = " s, the shortest duration within torque=5 N m, hub_rate=2 rad/s";
    assert!(told.contains(&format!("{within}; limits.hub_rate binds: ")), "{told}");
    assert!(bench.read("fit.csv").lines().next().unwrap().ends_with(within));
    // Those of the file are enough.
    let (code, told) = fitted(&bench, "limited.toml", "0.01", "");
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains(" s, the shortest duration within hub_rate=2 rad/s; "), "{told}");
    // One of the motor, with a drive.
    let drive = "joint_stiffness = 1000\nrotor_inertia = '2 kg cm^2'\ngear_ratio = 100";
    bench.write("driven.toml", &format!("{text}\n[drive]\n{drive}\n"));
    let (code, told) = fitted(&bench, "driven.toml", "0.01", "--fit-limit motor_torque=0.4");
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains("limits.motor_torque binds: "), "{told}");
}

#[test]
fn no_limit_binds_where_the_profile_has_no_fewer_steps() {
    let (_, told) = fitted(&Bench::new(), LINK, "0.1", "--fit-limit torque=1e300");
    let note = "note: 0.4 s, the shortest duration within torque=1e300 N m; no limit binds: the \
                profile has no fewer steps\n";
    assert!(told.starts_with(note), "{told}");
}

#[test]
fn a_search_among_very_many_durations_says_how_many_it_tried() {
    let (code, told) = fitted(&Bench::new(), LINK, "2e-4", "--fit-limit torque=0.9");
    assert_eq!(code, Some(0), "{told}");
    let (_, rest) = told.split_once(" s, within torque=0.9 N m; ").unwrap();
    let (tried, rest) = rest.split_once(" of the ").unwrap();
    let (shorter, rest) = rest.split_once(" shorter durations were tried, none fits; ").unwrap();
    let (tried, shorter): (usize, usize) = (tried.parse().unwrap(), shorter.parse().unwrap());
    assert!(tried < shorter && shorter > 1024 && rest.starts_with("limits.torque binds"), "{told}");
}

#[test]
fn warnings_of_the_motion_that_fits_are_told_and_do_not_lengthen_it() {
    let bench = Bench::new();
    let (code, told) = fitted(&bench, LINK, "0.01", "--fit-limit torque=4");
    assert_eq!(code, Some(0), "{told}");
    let note = "note: 0.42 s, the shortest duration within torque=4 N m; ";
    assert!(told.starts_with(note), "{told}");
    assert!(told.contains("\nwarning: large deflections and centrifugal stiffening"), "{told}");
    // Every step from the profile's own fewest was tried: a shorter one needs more.
    assert!(peak_n_m(&bench, 0.41, "0.01") > 4.0);
    // A warning is an error where it is denied.
    std::fs::remove_file(bench.path("fit.csv")).unwrap();
    let (code, told) = fitted(&bench, LINK, "0.01", "--fit-limit torque=4 --deny-warnings");
    assert_eq!(code, Some(4), "{told}");
    let warnings = told.matches("\nwarning: ").count();
    let error = format!("error: --deny-warnings: warnings = {warnings}, but must be none");
    assert!(warnings > 0 && told.contains(&error), "{told}");
    assert!(bench.path("fit.csv").exists());
}

#[test]
fn lengths_times_and_angles_have_units() {
    let bench = Bench::new();
    let made = |arguments: &[&str]| bench.printed(&with("trajectory septic", arguments));
    let plain = bench.printed(&format!("{SEPTIC} --duration 0.8 --step 0.001 --rest-after 0.1"));
    let units = ["--distance", "50 cm", "--duration", "800 ms", "--step", "1 ms"];
    assert!(made(&[&units[..], &["--rest-after", "100 ms"]].concat()) == plain);
    // The tip of the paper's link lies 1.5 m from its axis, that of the longer one 3 m.
    let times = ["--duration", "0.8", "--step", "0.01"];
    let turn = [&["--distance", "-0.5 rad", "--link", LINK], &times[..]].concat();
    assert!(made(&turn) == made(&[&["--distance", "-0.75"], &times[..]].concat()));
    let longer = made(&[&turn[..], &["--set", "segments.0.length*=2"]].concat());
    assert!(longer != made(&turn));
    bench.write("longer.csv", &longer);
    bench.run(&format!("solve {LINK} longer.csv --set segments.0.length*=2"));
    let [length_m, travel_m] =
        ["link/length_m", "motion/travel_m"].map(|path| bench.number("out", path));
    assert!((travel_m + 0.5 * length_m).abs() < 1e-9, "{travel_m} {length_m}");
}

#[test]
fn the_best_profile_is_the_shortest_and_each_is_told() {
    let bench = Bench::new();
    let fixed = format!("--distance 0.5 --step 0.02 --link {LINK} --fit-limit");
    let told = bench.told(&format!("trajectory best {fixed} torque=2 -o best.csv"));
    let notes: Vec<&str> =
        told.lines().filter_map(|line| line.strip_prefix("note: ")).take(8).collect();
    let mut own_notes = Vec::new();
    for profile in PROFILES {
        let own = stderr(&bench.run(&format!("trajectory {profile} {fixed} torque=2 -o own.csv")));
        let (duration, rest) = own.strip_prefix("note: ").unwrap().split_once(" s, ").unwrap();
        let (_, binding) = rest.split_once("; ").unwrap();
        let kinds = [
            ("\nwarning: the tip strays by", "tip_missed"),
            ("\nwarning: large deflections", "inexact_model"),
            ("\nremark: the acceleration jumps", "jumps"),
        ];
        let kinds = kinds.iter().filter(|(told, _)| own.contains(told)).map(|(_, kind)| *kind);
        let kinds = kinds.collect::<Vec<_>>().join(", ");
        let warned = if kinds.is_empty() { kinds } else { format!(" ({kinds})") };
        let note =
            format!("{profile:<9}  {duration} s{warned}; {}", binding.lines().next().unwrap());
        let duration_s: f64 = duration.parse().unwrap();
        own_notes.push(((!warned.is_empty(), duration_s), note));
    }
    own_notes.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap());
    let own_notes: Vec<&str> = own_notes.iter().map(|(_, note)| &note[..]).collect();
    assert_eq!(notes, own_notes);
    // The versine is shorter, at a step that is too long for its jumps, and the septic bends the link too far.
    let best =
        "note: the best without a warning or jump is gaussian: 1.5 s, the shortest duration within";
    assert!(told.contains(best), "{told}");
    assert!(own_notes.iter().any(|note| note.starts_with("versine    0.58 s (")));
    assert!(bench.read("best.csv").starts_with("# gaussian: 1.5 s, "));
    // Limits that no profile keeps.
    let none = bench.error(4, &format!("trajectory best {fixed} torque=1e-9"));
    let message = "no duration from 0.08 to 5242.88 s keeps the limits (17 tried)";
    assert!(none.starts_with(&format!("note: sine       none: {message}")), "{none}");
    assert!(none.contains(&format!("\nerror: {message}")), "{none}");
}

#[test]
fn a_cycle_repeats_and_its_torque_in_the_mean_is_told() {
    let bench = Bench::new();
    let cycle = format!(
        "trajectory min-jerk --distance 0.5 --step 0.01 --link {LINK} --cycle --dwell 0.3 -o cycle.csv"
    );
    let told = bench.told(&format!("{cycle} --duration 0.8"));
    assert_eq!(column(&bench, "cycle.csv", "time").len(), 220);
    let torque = told.strip_prefix("note: a cycle of 2.2 s takes a torque of ").unwrap();
    let (rms, rest) = torque.split_once(" N m rms, ").unwrap();
    let (highest, rest) = rest.split_once(" N m at its peak\n").unwrap();
    assert_eq!(rest, "");
    bench.run(&format!("solve {LINK} cycle.csv --periodic -o out"));
    let torque = column(&bench, "out/torque.csv", "torque_n_m");
    let mean = torque.iter().map(|own| own * own).sum::<f64>() / torque.len() as f64;
    let [rms, highest] = [rms, highest].map(|number| number.parse::<f64>().unwrap());
    assert!((mean.sqrt() - rms).abs() < 1e-3 * rms, "{} {rms}", mean.sqrt());
    assert!((peak(&torque) - highest).abs() < 1e-2 * highest, "{} {highest}", peak(&torque));
    // Within a limit of the torque in the mean: the cycle's, not that of the outward motion.
    let told = stderr(&bench.run(&format!("{cycle} --fit-limit rms_torque=0.5")));
    assert!(told.contains("within rms_torque=0.5 N m; limits.rms_torque binds: 0.49"), "{told}");
    assert!(told.contains(" s each way, the shortest duration "), "{told}");
    assert!(told.contains(" s takes a torque of 0.49"), "{told}");
    // A limit of the file that a given duration exceeds.
    let limited = "--duration 0.62 --set limits.torque=1 --deny-warnings";
    let told = bench.error(4, &format!("{cycle} {limited}"));
    assert!(told.starts_with("note: a cycle of 1.84 s takes a torque of "), "{told}");
    let exceeded = "\nwarning: limits.torque = 1 N m is exceeded at the hub: ";
    assert!(told.contains(exceeded), "{told}");
}

#[test]
fn a_cycle_whose_ends_are_nearly_equal_is_written_and_solved() {
    let bench = Bench::new();
    let cycle = "trajectory gaussian --distance 0.1 --duration 1 --step 0.002 --cycle -o cycle.csv";
    // The bell's first and last samples are nearly equal, but its last is not its first one again.
    bench.done(&format!("{cycle} --link {LINK}"));
    bench.done(cycle);
    bench.done(&format!("solve {LINK} cycle.csv --periodic -q"));
}

#[test]
fn a_tip_stops_on_its_way() {
    let bench = Bench::new();
    let way = "trajectory sine --distance 0.6 --duration 1.2 --step 0.002 --dwell 0.2 -o stops.csv";
    bench.done(&with(way, &["--via", "10 cm", "--via=-0.3"]));
    bench.done(&format!("solve {LINK} stops.csv -o out"));
    // Moves of 0.1, 0.4 and 0.9 m take 0.2, 0.4 and 0.6 s, with 0.2 s of rest between them.
    let [times_s, tip_m] =
        ["time_s", "tip_displacement_m"].map(|name| column(&bench, "out/tip.csv", name));
    for (time_s, at_m) in [(0.0, 0.0), (0.3, 0.1), (0.9, -0.3), (1.6, 0.6)] {
        let row = times_s.iter().position(|own| (own - time_s).abs() < 1e-9).unwrap();
        assert!((tip_m[row] - at_m).abs() < 2e-6, "{} at {time_s}", tip_m[row]);
    }
}
