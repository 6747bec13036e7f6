//! `flexlink fit` to responses whose tables leave the unit of the phase out, or have rows below 0 Hz.

use std::f64::consts::TAU;
use std::process::Output;

use super::{Bench, LINK, ended, number, refusal, stderr, succeeded};

/// Frequencies in Hz, sizes and phases in rad of the tip's acceleration per torque of a link with a tenth more
/// stiffness than its file has.
pub(super) fn response(bench: &Bench, points: u32) -> Vec<[f64; 3]> {
    let json =
        bench.reply(&format!("frf {LINK} --set segments.*.EI*=1.1 --points {points} --json"));
    let transfer = "torque_per_tip_acceleration_kg_m";
    let row = |k: usize| {
        let [hertz, size, phase] =
            ["frequency_hz", &format!("{transfer}_magnitude"), &format!("{transfer}_phase_rad")]
                .map(|name| number(&json[name], &k.to_string()));
        [hertz, 1.0 / size, -phase]
    };
    (0..json["frequency_hz"].as_array().unwrap().len()).map(row).collect()
}

/// Fits the file's stiffness to a table.
fn fit(bench: &Bench, heading: &str, rows: &[[f64; 3]]) -> Output {
    let rows = rows.iter().map(|row| row.map(|number| number.to_string()).join(",") + "\n");
    bench.write("frf.csv", &format!("{heading}\n{}", rows.collect::<String>()));
    let measured =
        "[[response]]\nfile = 'frf.csv'\ntransfer = 'tip_acceleration'\nuncertainty = 0.01\n";
    bench.write("measured.toml", measured);
    bench.run(&format!("fit {LINK} measured.toml --free segments.*.EI -o fitted.toml"))
}

/// The fitted factor on the stiffness is the right one; returns what is told.
fn check(bench: &Bench, heading: &str, rows: &[[f64; 3]]) -> String {
    let told = stderr(&succeeded(fit(bench, heading, rows)));
    let factor = number(&bench.json("fitted.json"), "values/0/factor");
    assert!((factor / 1.1 - 1.0).abs() < 1e-5, "{factor}");
    told
}

#[test]
fn a_phase_without_a_unit_is_in_radians_unless_it_cannot_be() {
    let bench = Bench::new();
    let rows = response(&bench, 90);
    let bare = "frequency,gain,phase";
    let degrees = |[hertz, size, phase]: [f64; 3]| [hertz, size, phase.to_degrees()];
    let of_degrees: Vec<_> = rows.iter().copied().map(degrees).collect();
    let turned: Vec<_> = rows.iter().map(|[f, a, phase]| [*f, *a, phase.rem_euclid(TAU)]).collect();
    for (rows, unit) in [(&rows, "radians"), (&turned, "radians"), (&of_degrees, "degrees")] {
        let told = check(&bench, bare, rows);
        assert!(told.contains(&format!("note: frf.csv: read phase in {unit}")), "{told}");
    }
    let told = check(&bench, "frequency,gain,phase [deg]", &of_degrees);
    assert!(!told.contains("read phase"), "{told}");
}

/// Rows of real and imaginary parts, first those of the frequencies below 0.
fn two_sided(rows: &[[f64; 3]], conjugate: f64) -> Vec<[f64; 3]> {
    let below = rows
        .iter()
        .rev()
        .map(|[hertz, size, phase]| [-hertz, size * phase.cos(), conjugate * size * phase.sin()]);
    let above =
        rows.iter().map(|[hertz, size, phase]| [*hertz, size * phase.cos(), size * phase.sin()]);
    below.chain(above).collect()
}

#[test]
fn rows_below_0_hz_are_held_against_the_others_and_left_out() {
    let bench = Bench::new();
    let rows = response(&bench, 90);
    let parts = "frequency,real,imaginary";
    let count = rows.len();
    let told = check(&bench, parts, &two_sided(&rows, -1.0));
    let words = format!("read without its {count} rows below 0 Hz, {count} of them conjugates");
    assert!(told.contains(&words), "{told}");
    let told = stderr(&ended(3, fit(&bench, parts, &two_sided(&rows, 1.0))));
    for words in
        ["frf.csv:2: frequency = \"-", "the conjugate of the value above 0 Hz", "below 0 Hz"]
    {
        assert!(told.contains(words), "{words}: {told}");
    }
    let below = &two_sided(&rows, -1.0)[..count - 1];
    refusal(3, fit(&bench, parts, below), "must be above 0");
}
