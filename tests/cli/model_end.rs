//! What a user is told where the model ends, and where a number is probably in another unit.

use super::{Bench, link_files, stderr, stdout};

/// A bar of aluminium, 0.3 m by 0.1 m, that turns about its end.
const BAR: &str = "\
[[segments]]
length = 0.3
E = \"70 GPa\"
density = 2700
section = { shape = \"rectangle\", width = 0.02, thickness = 0.1 }
[damping]
model = \"hysteretic\"
ratio = 0.02
";

/// A slender strip of aluminium, 1 m long.
const STRIP: &str = "\
[[segments]]
length = 1
E = \"70 GPa\"
density = \"2.7 g/cm^3\"
section = { shape = \"rectangle\", width = 0.05, thickness = 0.01 }
[hub]
inertia = 0.1
[damping]
model = \"hysteretic\"
ratio = 0.02
";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("bar.toml", BAR);
    bench.write("strip.toml", STRIP);
    let made = ["trajectory", "septic", "--distance", "0.2", "--duration", "1", "--step", "0.002"];
    bench.done(&[&made[..], &["-o", "move.csv"]].concat());
    bench
}

/// Lines that begin so.
fn lines(text: &str, kind: &str) -> Vec<String> {
    text.lines().filter(|line| line.starts_with(kind)).map(str::to_owned).collect()
}

#[test]
fn a_thick_link_is_told_with_the_share_of_its_frequencies_wherever_they_are_used() {
    let bench = bench();
    let lower = "warning: shear and rotary inertia, which the theory leaves out, lower natural \
                 frequencies by about 20 % (mode 1)";
    let modes = bench.run(&["modes", "bar.toml", "--count", "2"]);
    assert!(stdout(&modes).contains("4007.6"), "{}", stdout(&modes));
    let told = format!(
        "{lower} to 41 % (mode 2)\nhint: set theory = \"timoshenko\" to include them; solve reports their effect on \
         the torque\n"
    );
    assert!(stderr(&modes).ends_with(&told), "{}", stderr(&modes));
    for arguments in [
        &["solve", "bar.toml", "move.csv"][..],
        &["verify", "bar.toml", "move.csv"],
        &["sweep", "bar.toml", "move.csv", "--vary", "payload.mass=0,0.1", "-o", "sweep.csv"],
    ] {
        let output = bench.run(arguments);
        let warned = lines(&stderr(&output), "warning");
        // The section's own inertia about the hub, thickness over length squared, over four.
        let of_it = |line: &&String| line.contains("change the torque by about 3 % (rms)");
        assert_eq!(warned.iter().filter(of_it).count(), 1, "{arguments:?}: {warned:?}");
    }
    // A third as thick: its modes tell, a motion far below them does not.
    let thin = ["bar.toml", "--set", "segments.0.section.thickness=0.03"];
    let modes = bench.run(&[&["modes"], &thin[..], &["--count", "1"]].concat());
    assert!(stderr(&modes).contains("about 3 % (mode 1)"), "{}", stderr(&modes));
    let solved = bench.run(&[&["solve"], &thin[..], &["move.csv"]].concat());
    assert_eq!(lines(&stderr(&solved), "warning"), [""; 0]);
    let slender = bench.run(&["modes", "strip.toml", "--count", "3"]);
    assert_eq!(stderr(&slender), "");
}

/// 3222 and 7936 Hz, as in `mechanics`; with them nothing is left out, and nothing is warned about.
#[test]
fn with_the_theory_of_timoshenko_a_thick_link_is_computed_without_a_warning() {
    let bench = bench();
    let theory = ["--set", "theory=timoshenko", "--set", "segments.0.poisson_ratio=0.33"];
    let with_theory = |arguments: &[&str]| {
        let output = bench.run(&[arguments, &theory].concat());
        assert_eq!(stderr(&output), "", "{arguments:?}");
        stdout(&output)
    };
    let modes = with_theory(&["modes", "bar.toml", "--count", "2"]);
    assert!(modes.contains("3221.58") && modes.contains("7935.98"), "{modes}");
    with_theory(&["solve", "bar.toml", "move.csv"]);
    with_theory(&[
        "simulate",
        "bar.toml",
        "out/torque.csv",
        "--target",
        "out/tip.csv",
        "-o",
        "sim",
    ]);
    with_theory(&["verify", "bar.toml", "move.csv"]);
    let vary = "segments.0.poisson_ratio=0.2,0.3";
    with_theory(&["sweep", "bar.toml", "move.csv", "--vary", vary, "-o", "sweep.csv"]);
}

#[test]
fn an_unknown_section_is_told_where_it_could_matter_alone() {
    let bench = bench();
    let unknown = |name: &str, stiffness: f64| {
        let segment = "segments = [{ length = 0.3, mass_per_length = 5.4, EI = ";
        bench.write(name, &format!("{segment}{stiffness} }}]\n"));
        stderr(&bench.run(&["modes", name, "--count", "1"]))
    };
    // The bar, given by its stiffness and mass.
    let short = unknown("short.toml", 116_666.7);
    assert!(short.starts_with("remark: the link's section is not known everywhere"), "{short}");
    assert_eq!(unknown("slender.toml", 10.0), "");
}

#[test]
fn large_deflections_are_told_and_verify_fails_of_them() {
    let bench = bench();
    let soft = ["--set", "segments.0.E=\"1 GPa\"", "--scale-distance", "20"];
    let output = bench.ends(4, &[&["verify", "strip.toml", "move.csv"], &soft[..]].concat());
    let text = stderr(&output);
    assert!(text.contains("large deflections and centrifugal stiffening"), "{text}");
    let row = lines(&stdout(&output), "tip with all terms");
    assert!(row[0].ends_with("the tip's travel  FAILS"), "{row:?}");
}

/// The spin-up of Kane, Ryan and Banerjee (1987), whose beam is softer without centrifugal stiffening.
#[test]
fn a_hub_that_turns_fast_is_told_by_simulate_and_by_sweeps_of_it() {
    let bench = bench();
    bench.write(
        "beam.toml",
        "segments = [{ length = 10, EI = 1.4e4, mass_per_length = 1.2, elements = 20 }]\n",
    );
    let angle = |t: f64| {
        let turn = std::f64::consts::TAU / 15.0;
        let risen = t.min(15.0);
        let up = 0.4 * (risen * risen / 2.0 + ((turn * risen).cos() - 1.0) / (turn * turn));
        up + 6.0 * (t - risen)
    };
    let rows =
        (0..=1000).map(|k| 0.02 * f64::from(k)).map(|t| format!("{t:.2},{:.12}\n", angle(t)));
    bench.write("hub.csv", &format!("time,hub_angle\n{}", rows.collect::<String>()));
    let play = |set: &[&str]| {
        let command = ["simulate", "beam.toml", "hub.csv", "--input", "hub-angle", "-o", "out"];
        bench.done(&[&command[..], set].concat());
        let summary = bench.json("out/summary.json");
        let kinds = summary["warnings"].as_array().unwrap().iter().map(|w| w["kind"].clone());
        let peak_m = summary["results"]["peak_deflection_m"].as_f64().unwrap();
        (kinds.collect::<Vec<_>>(), peak_m, summary["errors"]["deflection"]["model"].as_f64())
    };
    let (kinds, linear_m, claimed) = play(&[]);
    assert_eq!(kinds, ["inexact_model"]);
    let (kinds, all_m, none) = play(&["--set", "analysis.second_order=\"full\""]);
    assert_eq!((kinds.len(), none), (0, None));
    // A linear model with the stiffening of the rotating beam gives 0.5744 m.
    assert!((all_m / 0.5744 - 1.0).abs() < 2e-3, "{all_m} m");
    let factor = claimed.unwrap() / (linear_m / all_m - 1.0);
    assert!((0.5..30.0).contains(&factor), "{claimed:?} for {linear_m} and {all_m} m");
}

#[test]
fn a_number_that_is_probably_in_another_unit_is_told_and_nothing_is_refused() {
    let bench = bench();
    let solve = |arguments: &[&str]| {
        let output = bench.done(&[&["solve", "strip.toml", "move.csv"], arguments].concat());
        lines(&stderr(&output), "remark")
    };
    let none: [&str; 0] = [];
    assert_eq!(solve(&[]), none);
    assert_eq!(
        solve(&["--set", "segments.0.density=2.7"]),
        [
            "remark: segments.0.density = 2.7 kg/m^3, where solids have 25 to 25000: probably another unit"
        ]
    );
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["remarks"][0]["kind"], "density");
    assert_eq!(
        summary["remarks"][0]["hint"],
        "write the unit beside the number, as in \"2.7 g/cm^3\""
    );

    let slow = ["--scale-duration", "1000", "--set", "analysis.tolerance=1e-4"];
    assert_eq!(
        solve(&slow),
        ["remark: the tip moves for 1000 s, where motions take 0.001 to 500.0: probably time in \
          another unit"]
    );
    let far = ["--scale-distance", "540"];
    assert_eq!(
        solve(&far),
        ["remark: the tip moves by 108.0 m, 17.2 turns of a link of 1.000 m: probably length in \
          another unit"]
    );
    let modes = |set: &[&str]| {
        let output = bench.done(&[&["modes", "strip.toml", "--count", "2", "--set"], set].concat());
        lines(&stderr(&output), "remark")
    };
    let soft = modes(&["segments.0.E=90000"]);
    assert_eq!(
        soft[0],
        "remark: segments.0.E = 90000.0 Pa, where solids have 1e6 to 2e12: probably another unit"
    );
    let heavy =
        modes(&["segments.0.E=2e6", "--set", "payload.mass=20", "--set", "hub.inertia=1e6"]);
    assert!(heavy[0].starts_with("remark: the first natural frequency is 0.0"), "{heavy:?}");
}

#[test]
fn a_factor_is_no_slip_of_units_and_the_value_before_it_is_judged() {
    let bench = bench();
    let remarks = |set: &[&str]| {
        let output = bench.done(&[&["modes", "strip.toml", "--count", "1"], set].concat());
        lines(&stderr(&output), "remark")
    };
    let stiff = ["--set", "segments.0.E*=40"];
    assert_eq!(remarks(&stiff), [""; 0]);
    let slip = ["--set", "segments.0.density=2.7", "--set", "segments.0.density*=1000"];
    assert_eq!(
        remarks(&slip),
        [
            "remark: segments.0.density = 2.7 kg/m^3, where solids have 25 to 25000: probably another unit"
        ]
    );
}

#[test]
fn a_strip_that_lies_on_its_edge_is_told() {
    let bench = bench();
    let text = "[[segments]]\nlength = 1\nE = '70 GPa'\ndensity = 2700\n\
                section = { shape = 'rectangle', width = '3 mm', thickness = '40 mm' }\n[hub]\ninertia = 0.01\n";
    bench.write("edge.toml", text);
    let told = |set: &[&str]| {
        let output = bench.done(&[&["modes", "edge.toml", "--count", "1"], set].concat());
        lines(&stderr(&output), "remark: segments.0.section")
    };
    assert_eq!(
        told(&[]),
        [
            "remark: segments.0.section: thickness = 0.0400000 m is above width = 0.00300000 m: the link \
          bends across its stiffer side"
        ]
    );
    assert_eq!(told(&["--set", "segments.0.section.thickness='3 mm'"]), [""; 0]);
}

#[test]
fn quiet_hides_remarks_and_keeps_them_in_the_record() {
    let bench = bench();
    let slip = ["solve", "strip.toml", "move.csv", "--set", "segments.0.density=2.7", "-q"];
    let output = bench.done(&slip);
    assert_eq!(lines(&stderr(&output), "remark"), [""; 0]);
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["remarks"][0]["kind"], "density");
}

#[test]
fn no_published_rig_has_a_remark() {
    let bench = Bench::new();
    for rig in link_files() {
        let output = bench.run(&["modes", &rig, "--count", "3"]);
        assert_eq!(stderr(&output), "", "{rig}");
    }
}
