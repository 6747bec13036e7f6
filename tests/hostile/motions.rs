//! Tables of numbers as other programs write them, times that are none, and extreme motions.

use super::{Bench, NOT_SOLVABLE, REFUSED, motion, text};

fn seconds(k: i32) -> String {
    (0.01 * f64::from(k)).to_string()
}

#[track_caller]
fn refused(table: &str, code: i32, message: &str) {
    let bench = Bench::new();
    bench.write("motion.csv", table);
    bench.refuses(&["solve", "link.toml", "motion.csv"], code, message);
}

#[track_caller]
fn warnings(table: &str) -> String {
    let bench = Bench::new();
    bench.write("motion.csv", table);
    bench.solves(&[])
}

#[test]
fn numbers_of_other_countries_are_refused_with_how_they_are_written() {
    let hint = "hint: write a point before decimals, and nothing between thousands";
    let number = |shown: &str| {
        let option = "; --decimal comma reads decimal commas";
        let option = if shown.contains(',') && !shown.contains('.') { option } else { "" };
        format!("motion.csv:2: acceleration = {shown}, but must be a number\n{hint}{option}\n")
    };
    for (written, shown) in [
        ("\"0,5\"", "\"0,5\""),
        ("\"1,234\"", "\"1,234\""),
        ("\"1,234.5\"", "\"1,234.5\""),
        ("1 234.5", "\"1 234.5\""),
        ("1_234", "\"1_234\""),
        ("1\u{202f}234.5", "\"1\\u{202f}234.5\""),
    ] {
        refused(&motion(seconds, |_| written.to_owned()), REFUSED, &number(shown));
    }
    let fields = format!(
        "motion.csv:2: fields = 3, but must be 2, as many as there are columns\n{hint}, and one \
         comma divides two fields\n"
    );
    refused(&motion(seconds, |_| "0,5".to_owned()), REFUSED, &fields);
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
fn a_date_or_a_clock_is_no_time() {
    for time in ["2024-03-01T00:00:01", "00:00:01.5", "01.03.2024", "3/1/2024"] {
        let message = format!(
            "motion.csv:2: time = \"{time}\", but must be a number\nhint: time is a number from any \
             start, 0.25 for a quarter of a second\n"
        );
        refused(&motion(|_| time.to_owned(), |a| a.to_string()), REFUSED, &message);
    }
}

#[test]
fn time_goes_forward_by_one_step() {
    let at = |time: fn(i32) -> f64| motion(|k| time(k).to_string(), |a| a.to_string());
    let message = "motion.csv:3: time = 0.99 s, but must be above 1 s of line 2\n";
    refused(&at(|k| f64::from(100 - k) / 100.0), REFUSED, message);
    let message = "motion.csv:52: time = 0.49 s, but must be above 0.49 s of line 51\n";
    refused(&at(|k| f64::from(if k == 50 { 49 } else { k }) / 100.0), REFUSED, message);
    // At 1e20 s a double knows no hundredths.
    refused(&at(|k| 1e20 + 0.01 * f64::from(k)), REFUSED, "motion.csv:3: time = 1");
    assert_eq!(warnings(&at(|k| 1.7e9 + 0.01 * f64::from(k))), "", "seconds since 1970");
}

#[test]
fn a_step_that_drifts_by_1e_9_is_uniform_by_1e_6_is_told_and_by_1e_4_is_refused() {
    let drifting = |rate: f64| {
        motion(
            |k| (0.01 * f64::from(k) * (1.0 + rate * f64::from(k))).to_string(),
            |a| a.to_string(),
        )
    };
    assert_eq!(warnings(&drifting(1e-9)), "");
    let bench = Bench::new();
    bench.write("motion.csv", drifting(1e-6));
    let output = bench.run(&["solve", "link.toml", "motion.csv", "-o", "out"]);
    assert_eq!(output.status.code(), Some(0));
    let told = text(&output.stderr);
    assert!(told.starts_with("remark: the times are off a uniform grid"), "{told}");
    refused(&drifting(1e-4), REFUSED, "s, but must be");
}

#[test]
fn motions_beyond_what_can_be_squared_are_refused_and_smaller_ones_solved() {
    let scaled = |by: f64| motion(seconds, |a| (a * by).to_string());
    let range = "N m, but must lie from 1e-100 to 1e100 N m\nhint: check the units";
    for by in [1e300, 1e110, 1e-110] {
        refused(&scaled(by), NOT_SOLVABLE, range);
    }
    let small =
        "m/s^2, but must reach 1e-120 m/s^2: what is smaller cannot be squared\nhint: check";
    for by in [1e-125, 1e-310, 5e-324] {
        refused(&scaled(by), REFUSED, small);
    }
    // However heavy the link is.
    let bench = Bench::new();
    bench.write("motion.csv", scaled(1e-322));
    let heavy = ["solve", "link.toml", "motion.csv", "--set", "hub.inertia=1e240"];
    bench.refuses(&heavy, REFUSED, small);
    refused(&scaled(1e307), REFUSED, "the motion reaches beyond double precision");
    assert_eq!(warnings(&scaled(1e-80)), "");
    let told = warnings(&scaled(1e80));
    assert!(
        told.contains(
            "large deflections and centrifugal stiffening, which the linear model leaves out"
        ),
        "{told}"
    );
    let jump = "time,displacement\n0,0\n1,0\n2,5e-324\n3,5e-324\n4,5e-324\n";
    refused(jump, REFUSED, small);
}

#[test]
fn steps_far_from_the_links_times_are_refused_or_solved() {
    let stretched =
        |step_s: f64| motion(|k| (step_s * f64::from(k)).to_string(), |a| a.to_string());
    let slow = motion(|k| (1e12 * f64::from(k)).to_string(), |a| (1e-26 * a).to_string());
    assert_eq!(warnings(&slow), "", "a link that moves as a rigid one");
    for (step_s, samples) in [(1e-9, "samples"), (1e-100, "e"), (1e-300, "e19 or more samples")] {
        let bench = Bench::new();
        bench.write("motion.csv", stretched(step_s));
        let mut output = bench.run(&["solve", "link.toml", "motion.csv"]);
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

#[test]
fn factors_that_leave_no_motion_are_told_by_their_option() {
    for (factor, what) in [
        ("1e-300", "acceleration = NaN, but must be a finite number"),
        ("1e300", "the tip stands still in all samples, but must move"),
    ] {
        let solve = ["solve", "link.toml", "motion.csv", "--scale-duration", factor];
        Bench::new().refuses(&solve, 2, &format!("error: --scale-duration {factor}: {what}\n"));
    }
}
