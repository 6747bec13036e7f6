//! `flexlink fit` with a `[[decay]]`, as a logger would have written it.

use std::f64::consts::{PI, TAU};

use super::{Bench, ended, repository, stderr, stdout, succeeded};

const LINK: &str = "[[segments]]\nlength = 0.42\nEI = 0.15\nmass_per_length = 0.155\n\
                    [hub]\ninertia = 0.0018\n[damping]\nmodel = 'hysteretic'\nratio = 0.02\n";

const DECAY: &str = "[[decay]]\nfile = 'pluck.csv'\nhub = 'held'\nmode = [1, 2]\n";

/// Frequencies in Hz of a clamped uniform beam, `(βl)² √(EI/(m l⁴))`, with 0.18 N m².
fn frequencies_hz() -> [f64; 2] {
    [1.875_104_068_711_961_f64, 4.694_091_132_974_175]
        .map(|root| root * root * (0.18_f64 / (0.155 * 0.42_f64.powi(4))).sqrt() / TAU)
}

/// A pluck of a clamped link with 0.18 N m² and a ratio of 0.012, released at 0.4 s, in mV about 2.5 V: with the hum of
/// the mains, the angle of the clamped hub, and rounded to a hundredth.
fn write_pluck(bench: &Bench) {
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
}

fn fit(bench: &Bench, measured: &str, more: &[&str]) -> std::process::Output {
    bench.write("measured.toml", measured);
    let arguments = ["fit", "link.toml", "measured.toml", "--free", "segments.0.EI"];
    bench.run(&[&arguments[..], &["--free", "damping.ratio"], more].concat())
}

#[test]
fn a_pluck_gives_stiffness_and_damping() {
    let bench = Bench::new();
    write_pluck(&bench);
    let measured = format!("{DECAY}from = '0.4 s'\n");
    let out = succeeded(fit(&bench, &measured, &["-o", "fitted.toml", "--report"]));
    let record = bench.json("fitted.json");
    for (k, exact) in [0.18, 0.012].into_iter().enumerate() {
        let value = &record["values"][k];
        let (found, error) = (&value["after"], &value["relative_standard_error"]);
        let off = found.as_f64().unwrap() / exact - 1.0;
        assert!(off.abs() < 3.0 * error.as_f64().unwrap() && off.abs() < 5e-3, "{value}");
    }
    let decay = &record["decays"][0];
    assert_eq!((&decay["name"], &decay["column"]), (&"pluck.csv".into(), &"tip".into()));
    assert_eq!(decay["samples"], 2300);
    for (k, hertz) in frequencies_hz().into_iter().enumerate() {
        let frequency = &decay["modes"][k]["frequency"];
        let off = frequency["value"].as_f64().unwrap() - hertz;
        assert!(off.abs() < 4.0 * frequency["uncertainty"].as_f64().unwrap(), "{frequency}");
    }
    let hum = decay["others_hz"][0].as_f64().unwrap();
    assert!((hum - 50.0).abs() < 0.01, "{decay}");
    let text = stdout(&out);
    for line in ["decay pluck.csv: tip ", "  frequency 1, hub held ", "50.00 Hz"] {
        assert!(text.contains(line), "{text}");
    }
    let page = bench.read("fitted.html");
    assert!(page.contains("id=\"fig-decay-1\"") && page.contains("pluck.csv: tip, decay"));
}

/// Before the release the link is held: the whole file is no decay.
#[test]
fn a_decay_that_begins_before_the_release_is_refused() {
    let bench = Bench::new();
    write_pluck(&bench);
    let out = ended(3, fit(&bench, &DECAY.replace("[1, 2]", "1"), &[]));
    for told in ["its uncertainty must be below half of it", "begin after the release with from"] {
        assert!(stderr(&out).contains(told), "{}", stderr(&out));
    }
}

#[test]
fn values_without_uncertainty_beside_a_decay_are_refused() {
    let bench = Bench::new();
    write_pluck(&bench);
    let measured =
        format!("{DECAY}from = 0.4\n[[frequency]]\nmode = 3\nhub = 'held'\nvalue = 60\n");
    let out = ended(3, fit(&bench, &measured, &[]));
    let told = "frequency 3, hub held: uncertainty is missing, but others have one\nhint: the values of a \
                [[decay]] have uncertainties from its samples";
    assert!(stderr(&out).contains(told), "{}", stderr(&out));
}

#[test]
fn a_record_of_a_decay_is_led_to_the_right_entry() {
    let bench = Bench::new();
    write_pluck(&bench);
    let record = "[[record]]\nfile = 'pluck.csv'\ninput = 'hub_angle'\n[[record.channel]]\n\
                  sensor = 'tip_deflection'\ngain = 'free'\n";
    let record = record.replace("input", "columns = ['deflection=tip']\ninput");
    let out = ended(3, fit(&bench, &record, &[]));
    let told = "pluck.csv: the input is the same in all samples, but must change\nhint: [[decay]] with file";
    assert!(stderr(&out).contains(told), "{}", stderr(&out));
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
    let arm = repository("specs/arms/quanser_serial.toml");
    let (inertia, spring) = ("links.shoulder.tip.inertia", "links.elbow.drive.joint_stiffness");
    let set = [format!("{inertia}=0.02"), format!("{spring}=30")];
    let set = ["--set", &set[0], "--set", &set[1], "--free", inertia, "--free", spring];
    let text = stdout(&bench.done(&[&["fit", &arm, "m.toml"], &set[..]].concat()));
    // As docs/arms.md has them of the frequencies, whose damped ones are these over √(1 − ζ²).
    for (path, factor) in [(inertia, 2.4821), (spring, 2.2356)] {
        let line = text.lines().find(|line| line.starts_with(path)).unwrap();
        let found: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!((found / factor - 1.0).abs() < 5e-3, "{line}");
    }
}
