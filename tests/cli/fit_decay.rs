//! `flexlink fit` with a `[[decay]]`, as a logger would have written it.

use std::f64::consts::{PI, TAU};

use super::{Bench, number, refusal, stdout, succeeded};

const LINK: &str = "[[segments]]\nlength = 0.42\nEI = 0.15\nmass_per_length = 0.155\n\
                    [hub]\ninertia = 0.0018\n[damping]\nmodel = 'hysteretic'\nratio = 0.02\n";

const DECAY: &str = "[[decay]]\nfile = 'pluck.csv'\nhub = 'held'\nmode = [1, 2]\n";

/// Frequencies in Hz of a clamped uniform beam, `(βl)² √(EI/(m l⁴))`, with 0.18 N m².
fn frequencies_hz() -> [f64; 2] {
    [1.875_104_068_711_961_f64, 4.694_091_132_974_175]
        .map(|root| root * root * (0.18_f64 / (0.155 * 0.42_f64.powi(4))).sqrt() / TAU)
}

/// The link, and a pluck of it clamped with 0.18 N m² and a ratio of 0.012, released at 0.4 s, in mV about 2.5 V: with the
/// hum of the mains, the angle of the clamped hub, and rounded to a hundredth.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("link.toml", LINK);
    let [first, second] = frequencies_hz();
    let vibration = |hertz: f64, t: f64| {
        (-0.012 * TAU * hertz * t).exp()
            * (TAU * hertz * (1.0_f64 - 0.012 * 0.012).sqrt() * t).cos()
    };
    let row = |k: i32| {
        let t = 0.002 * f64::from(k) - 0.4;
        let moved = if t < 0.0 { 1.1 } else { vibration(first, t) + 0.1 * vibration(second, t) };
        let value = 2500.0 + 100.0 * moved + 0.5 * (TAU * 50.0 * t).sin();
        format!("{};0;{value:.2}\n", 2 * k)
    };
    let rows: String = (0..2500).map(row).collect();
    bench.write("pluck.csv", &format!("Zeit (ms);hub_angle [deg];tip [mV]\n{rows}"));
    bench
}

fn fit(bench: &Bench, measured: &str, more: &str) -> std::process::Output {
    bench.write("measured.toml", measured);
    let free = "--free segments.0.EI --free damping.ratio";
    bench.run(&format!("fit link.toml measured.toml {free} {more}"))
}

#[test]
fn a_pluck_gives_stiffness_and_damping() {
    let bench = bench();
    let measured = format!("{DECAY}from = '0.4 s'\n");
    let text = stdout(&succeeded(fit(&bench, &measured, "-o fitted.toml --report")));
    let record = bench.json("fitted.json");
    for (value, exact) in record["values"].as_array().unwrap().iter().zip([0.18, 0.012]) {
        let off = number(value, "after") / exact - 1.0;
        let error = number(value, "relative_standard_error");
        assert!(off.abs() < 3.0 * error && off.abs() < 5e-3, "{value}");
    }
    let decay = &record["decays"][0];
    assert_eq!((&decay["name"], &decay["column"]), (&"pluck.csv".into(), &"tip".into()));
    assert_eq!(decay["samples"], 2300);
    for (k, hertz) in frequencies_hz().into_iter().enumerate() {
        let frequency = &decay["modes"][k]["frequency"];
        let off = number(frequency, "value") - hertz;
        assert!(off.abs() < 4.0 * number(frequency, "uncertainty"), "{frequency}");
    }
    assert!((number(decay, "others_hz/0") - 50.0).abs() < 0.01, "{decay}");
    for line in ["decay pluck.csv: tip ", "  frequency 1, hub held ", "50.00 Hz"] {
        assert!(text.contains(line), "{text}");
    }
    let page = bench.read("fitted.html");
    assert!(page.contains("id=\"fig-decay-1\"") && page.contains("pluck.csv: tip, decay"));
}

#[test]
fn what_does_not_go_with_a_pluck_is_refused() {
    let bench = bench();
    // Before the release the link is held: the whole file is no decay.
    let whole = DECAY.replace("[1, 2]", "1");
    for words in ["its uncertainty must be below half of it", "begin after the release with from"] {
        refusal(3, fit(&bench, &whole, ""), words);
    }
    let beside = "[[frequency]]\nmode = 3\nhub = 'held'\nvalue = 60\n";
    let words = "frequency 3, hub held: uncertainty is missing, but others have one\nhint: the values of a \
                 [[decay]] have uncertainties from its samples";
    refusal(3, fit(&bench, &format!("{DECAY}from = 0.4\n{beside}"), ""), words);
    let record = "[[record]]\nfile = 'pluck.csv'\ncolumns = ['deflection=tip']\ninput = 'hub_angle'\n\
                  [[record.channel]]\nsensor = 'tip_deflection'\ngain = 'free'\n";
    let words = "pluck.csv: the input is the same in all samples, but must change\nhint: [[decay]] with file";
    refusal(3, fit(&bench, record, ""), words);
}

/// Two frequencies of an arm as decays lead where the frequencies themselves do.
#[test]
fn an_arm_is_fitted_to_decays_in_a_pose() {
    let bench = Bench::new();
    let row = |k: i32| {
        let t = 0.01 * f64::from(k);
        let part =
            |hertz: f64| (-0.02 * TAU * hertz * t).exp() * (TAU * hertz * t + 0.1 * PI).cos();
        format!("{t:.2},{:.4}\n", part(1.8) + part(5.45))
    };
    let rows: String = (0..1500).map(row).collect();
    bench.write("pluck.csv", &format!("time,strain\n{rows}"));
    let values =
        "[[decay]]\nfile = 'pluck.csv'\nmode = [1, 2]\njoints = 'held'\nonly = 'frequency'\n";
    bench.write("m.toml", &format!("at = [0, 0]\n{values}"));
    let (inertia, spring) = ("links.shoulder.tip.inertia", "links.elbow.drive.joint_stiffness");
    let free = format!("--set {inertia}=0.02 --set {spring}=30 --free {inertia} --free {spring}");
    let text = bench.printed(&format!("fit specs/arms/quanser_serial.toml m.toml {free}"));
    // As docs/arms.md has them of the frequencies, whose damped ones are these over √(1 − ζ²).
    for (path, factor) in [(inertia, 2.4821), (spring, 2.2356)] {
        let line = text.lines().find(|line| line.starts_with(path)).unwrap();
        let found: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!((found / factor - 1.0).abs() < 5e-3, "{line}");
    }
}
