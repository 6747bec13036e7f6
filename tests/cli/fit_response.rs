//! `flexlink fit` to responses whose tables leave the unit of the phase out, or have rows below 0 Hz.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::process::Output;

use serde_json::Value;

use super::{Bench, ended, refusal, repository, stderr, succeeded};

/// Frequencies in Hz, sizes and phases in rad of the tip's acceleration per torque of a link with a tenth more
/// stiffness than its file has.
fn response(bench: &Bench) -> Vec<[f64; 3]> {
    let link = repository("specs/bayo1987_example1.toml");
    let arguments = ["frf", &link, "--set", "segments.*.EI*=1.1", "--points", "90", "--json"];
    let found: Value = serde_json::from_slice(&bench.run(&arguments).stdout).unwrap();
    let number = |name: &str, k: usize| found[name][k].as_f64().unwrap();
    let row = |k: usize| {
        let size = number("torque_per_tip_acceleration_kg_m_magnitude", k);
        let phase = number("torque_per_tip_acceleration_kg_m_phase_rad", k);
        [number("frequency_hz", k), 1.0 / size, -phase]
    };
    (0..found["frequency_hz"].as_array().unwrap().len()).map(row).collect()
}

/// Fits the file's stiffness to a table.
fn fit(bench: &Bench, table: &str) -> Output {
    bench.write("frf.csv", table);
    let measured =
        "[[response]]\nfile = 'frf.csv'\ntransfer = 'tip_acceleration'\nuncertainty = 0.01\n";
    bench.write("measured.toml", measured);
    let link = repository("specs/bayo1987_example1.toml");
    bench.run(&["fit", &link, "measured.toml", "--free", "segments.*.EI", "-o", "fitted.toml"])
}

/// The fitted factor on the stiffness is the right one, and each of the words is told.
fn check(bench: &Bench, table: &str, told: &[&str]) {
    let out = succeeded(fit(bench, table));
    let record = bench.json("fitted.json");
    let factor = record["values"][0]["factor"].as_f64().unwrap();
    assert!((factor / 1.1 - 1.0).abs() < 1e-5, "{factor}");
    for words in told {
        assert!(stderr(&out).contains(words), "{words}: {}", stderr(&out));
    }
}

fn polar(rows: &[[f64; 3]], heading: &str, phase: impl Fn(f64) -> f64) -> String {
    let mut text = format!("{heading}\n");
    for [hertz, size, own] in rows {
        writeln!(text, "{hertz},{size},{}", phase(*own)).unwrap();
    }
    text
}

#[test]
fn a_phase_without_a_unit_is_in_radians_unless_it_cannot_be() {
    let bench = Bench::new();
    let rows = response(&bench);
    let bare = "frequency,gain,phase";
    check(&bench, &polar(&rows, bare, |phase| phase), &["note: frf.csv: read phase in radians"]);
    let turn = |phase: f64| phase.rem_euclid(TAU);
    check(&bench, &polar(&rows, bare, turn), &["read phase in radians"]);
    let degrees = |phase: f64| phase * 180.0 / PI;
    check(&bench, &polar(&rows, bare, degrees), &["note: frf.csv: read phase in degrees"]);
    let out = fit(&bench, &polar(&rows, "frequency,gain,phase [deg]", degrees));
    assert!(out.status.success() && !stderr(&out).contains("read phase"), "{}", stderr(&out));
}

fn two_sided(rows: &[[f64; 3]], conjugate: f64) -> String {
    let mut text = "frequency,real,imaginary\n".to_owned();
    for [hertz, size, phase] in rows.iter().rev() {
        let (re, im) = (size * phase.cos(), conjugate * size * phase.sin());
        writeln!(text, "{},{re},{im}", -hertz).unwrap();
    }
    for [hertz, size, phase] in rows {
        writeln!(text, "{hertz},{},{}", size * phase.cos(), size * phase.sin()).unwrap();
    }
    text
}

#[test]
fn rows_below_0_hz_are_held_against_the_others_and_left_out() {
    let bench = Bench::new();
    let rows = response(&bench);
    let count = rows.len();
    let told = format!("read without its {count} rows below 0 Hz, {count} of them conjugates");
    check(&bench, &two_sided(&rows, -1.0), &[&told]);
    let told = stderr(&ended(3, fit(&bench, &two_sided(&rows, 1.0))));
    for words in
        ["frf.csv:2: frequency = \"-", "the conjugate of the value above 0 Hz", "below 0 Hz"]
    {
        assert!(told.contains(words), "{words}: {told}");
    }
    let all = two_sided(&rows, -1.0);
    let below: Vec<&str> = all.lines().take(count).collect();
    refusal(3, fit(&bench, &(below.join("\n") + "\n")), "must be above 0");
}
