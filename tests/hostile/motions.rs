//! Tables of numbers as other programs write them, times that are none, and extreme motions.

use super::{Bench, LARGE, NOT_SOLVABLE, REFUSED, SOLVE, motion, succeeded, text};

fn seconds(k: i32) -> String {
    (0.01 * f64::from(k)).to_string()
}

fn with(table: &str) -> Bench {
    let bench = Bench::new();
    bench.write("motion.csv", table);
    bench
}

#[track_caller]
fn refused(table: &str, code: i32, message: &str) {
    with(table).refuses(SOLVE, code, message);
}

#[track_caller]
fn warnings(table: &str) -> String {
    with(table).solves("")
}

#[test]
fn tables_of_other_countries_are_read_with_a_note() {
    let semicolons = motion(seconds, |a| a.to_string()).replace(',', ";").replace('.', ",");
    let note = "note: motion.csv: read ; as delimiter, decimal comma, time from column 1, \
                acceleration from column 2 in m/s^2\n";
    assert!(warnings(&semicolons).starts_with(note), "{}", warnings(&semicolons));
}

#[test]
fn a_number_of_millions_of_digits_is_told_by_its_first() {
    let digits = "1".repeat(2_000_000);
    let message =
        format!("motion.csv:2: acceleration = \"{}…\", but must be a finite", &digits[..60]);
    refused(&motion(seconds, |_| digits.clone()), REFUSED, &message);
}

#[test]
fn seconds_since_1970_are_times() {
    let since = |k: i32| (1.7e9 + 0.01 * f64::from(k)).to_string();
    let note = "note: motion.csv: read time in s since 1700000000 s in line 2\n";
    assert_eq!(warnings(&motion(since, |a| a.to_string())), note);
}

#[test]
fn a_step_that_drifts_by_1e_9_is_uniform_and_by_1e_6_is_told() {
    let drifting = |rate: f64| {
        let time = |k: i32| (0.01 * f64::from(k) * (1.0 + rate * f64::from(k))).to_string();
        motion(time, |a| a.to_string())
    };
    assert_eq!(warnings(&drifting(1e-9)), "");
    let output = with(&drifting(1e-6)).run(SOLVE);
    succeeded(&1e-6, &output);
    let told = text(&output.stderr);
    assert!(told.starts_with("remark: the times are off a uniform grid"), "{told}");
}

#[test]
fn motions_beyond_what_can_be_squared_are_refused_and_smaller_ones_solved() {
    let scaled = |by: f64| motion(seconds, |a| (a * by).to_string());
    let range = "N m, but must lie from 1e-100 to 1e100 N m\nhint: check the units";
    for by in [1e300, 1e110, 1e-110] {
        refused(&scaled(by), NOT_SOLVABLE, range);
    }
    let small =
        "m/s^2, but must reach 1e-120 m/s^2: squares of smaller numbers vanish\nhint: check";
    for by in [1e-125, 1e-310, 5e-324] {
        refused(&scaled(by), REFUSED, small);
    }
    // However heavy the link is.
    let heavy = format!("{SOLVE} --set hub.inertia=1e240");
    with(&scaled(1e-322)).refuses(&heavy, REFUSED, small);
    refused(&scaled(1e307), REFUSED, "the motion reaches beyond double precision");
    assert_eq!(warnings(&scaled(1e-80)), "");
    let told = warnings(&scaled(1e80));
    assert!(told.contains(LARGE), "{told}");
}

#[test]
fn steps_far_from_the_links_times_are_refused_or_solved() {
    let slow = motion(|k| (1e12 * f64::from(k)).to_string(), |a| (1e-26 * a).to_string());
    assert_eq!(warnings(&slow), "", "a link that moves as a rigid one");
    for (step_s, samples) in [(1e-9, "samples"), (1e-100, "e"), (1e-300, "e19 or more samples")] {
        let bench = with(&motion(|k| (step_s * f64::from(k)).to_string(), |a| a.to_string()));
        let mut output = bench.run(SOLVE);
        let told = text(&output.stderr);
        assert!(told.starts_with("remark: the tip moves for "), "{told}");
        output.stderr.drain(..told.find("error: ").unwrap());
        bench.is_refusal(&output, REFUSED, samples);
        let hint = "but must be at most 16777216\nhint: name the unit in the column's heading";
        bench.is_refusal(&output, REFUSED, hint);
    }
}

#[test]
fn a_step_too_coarse_for_the_first_mode_is_told_where_the_motion_reaches_its_end() {
    // The first period is about 0.5 s.
    let coarse = "time,acceleration\n0,0\n1,1\n2,0\n3,-1\n4,0\n";
    let told = warnings(coarse);
    assert!(told.contains("the motion's step is too long, 0.0077 s would do"), "{told}");
    let smooth = motion(|k| k.to_string(), |a| (1e-3 * a).to_string());
    assert_eq!(warnings(&smooth), "", "slow enough to need no mode");
}
