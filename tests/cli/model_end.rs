//! What a user is told where the model ends, and where a number is probably in another unit.

use super::{Bench, Words, link_files, number, stderr, stdout, with};

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
    bench.done("trajectory septic --distance 0.2 --duration 1 --step 0.002 -o move.csv");
    bench
}

/// Lines that begin so.
fn lines(text: &str, kind: &str) -> Vec<String> {
    text.lines().filter(|line| line.starts_with(kind)).map(str::to_owned).collect()
}

#[test]
fn a_thick_link_is_told_with_the_share_of_its_frequencies_wherever_they_are_used() {
    let bench = bench();
    let modes = bench.run("modes bar.toml --count 2");
    assert!(stdout(&modes).contains("4007.6"), "{}", stdout(&modes));
    let told = "warning: shear and rotary inertia, which the theory leaves out, lower natural frequencies by \
                about 20 % (mode 1) to 41 % (mode 2)\n\
                hint: set theory = \"timoshenko\" to include them; solve reports their effect on the torque\n";
    assert!(stderr(&modes).ends_with(told), "{}", stderr(&modes));
    for arguments in ["solve", "verify", "sweep --vary payload.mass=0,0.1 -o sweep.csv"] {
        let warned =
            lines(&stderr(&bench.run(&format!("{arguments} bar.toml move.csv"))), "warning");
        // The section's own inertia about the hub, thickness over length squared, over four.
        let of_it = |line: &&String| line.contains("change the torque by about 3 % (rms)");
        assert_eq!(warned.iter().filter(of_it).count(), 1, "{arguments:?}: {warned:?}");
    }
    // A third as thick: its modes tell, a motion far below them does not.
    let thin = "bar.toml --set segments.0.section.thickness=0.03";
    let modes = stderr(&bench.run(&format!("modes {thin} --count 1")));
    assert!(modes.contains("about 3 % (mode 1)"), "{modes}");
    let solved = stderr(&bench.run(&format!("solve {thin} move.csv")));
    assert_eq!(lines(&solved, "warning"), [""; 0]);
    bench.silent("modes strip.toml --count 3");
}

/// 3222 and 7936 Hz, as in `mechanics`; with them nothing is left out, and nothing is warned about.
#[test]
fn with_the_theory_of_timoshenko_a_thick_link_is_computed_without_a_warning() {
    let bench = bench();
    let theory = "bar.toml --set theory=timoshenko --set segments.0.poisson_ratio=0.33";
    let modes = bench.silent(&format!("modes {theory} --count 2"));
    assert!(modes.contains("3221.58") && modes.contains("7935.98"), "{modes}");
    for (command, more) in [
        ("solve", "move.csv"),
        ("simulate", "out/torque.csv --target out/tip.csv -o sim"),
        ("verify", "move.csv"),
        ("sweep", "move.csv --vary segments.0.poisson_ratio=0.2,0.3 -o sweep.csv"),
    ] {
        bench.silent(&format!("{command} {theory} {more}"));
    }
}

#[test]
fn an_unknown_section_is_told_where_it_could_matter_alone() {
    let bench = bench();
    let unknown = |stiffness: f64| {
        let segment = "segments = [{ length = 0.3, mass_per_length = 5.4, EI = ";
        bench.write("link.toml", &format!("{segment}{stiffness} }}]\n"));
        stderr(&bench.run("modes link.toml --count 1"))
    };
    // The bar, given by its stiffness and mass.
    let short = unknown(116_666.7);
    assert!(short.starts_with("remark: the link's section is not known everywhere"), "{short}");
    assert_eq!(unknown(10.0), "");
}

#[test]
fn large_deflections_are_told_and_verify_fails_of_them() {
    let soft = ["--set", "segments.0.E=\"1 GPa\"", "--scale-distance", "20"];
    let output = bench().ends(4, &with("verify strip.toml move.csv", &soft));
    let text = stderr(&output);
    assert!(text.contains("large deflections and centrifugal stiffening"), "{text}");
    let row = lines(&stdout(&output), "tip with all terms");
    assert!(row[0].ends_with("the tip's travel  FAILS"), "{row:?}");
}

/// The spin-up of Kane, Ryan and Banerjee (1987), whose beam is softer without centrifugal stiffening.
#[test]
fn a_hub_that_turns_fast_is_told_by_simulate_and_by_sweeps_of_it() {
    let bench = bench();
    let beam = "segments = [{ length = 10, EI = 1.4e4, mass_per_length = 1.2, elements = 20 }]\n";
    bench.write("beam.toml", beam);
    bench.sampled("hub.csv", "time,hub_angle", 0..=1000, |k| {
        let (t, risen) = (0.02 * k, (0.02 * k).min(15.0));
        let turn = std::f64::consts::TAU / 15.0;
        let up = 0.4 * (risen * risen / 2.0 + ((turn * risen).cos() - 1.0) / (turn * turn));
        [t, up + 6.0 * (t - risen)]
    });
    let play = |set: &str| {
        bench.done(&format!("simulate beam.toml hub.csv --input hub-angle -o out {set}"));
        let summary = bench.json("out/summary.json");
        let kinds = summary["warnings"].as_array().unwrap().iter().map(|w| w["kind"].clone());
        let peak_m = number(&summary, "results/peak_deflection_m");
        (kinds.collect::<Vec<_>>(), peak_m, summary["errors"]["deflection"]["model"].as_f64())
    };
    let (kinds, linear_m, claimed) = play("");
    assert_eq!(kinds, ["inexact_model"]);
    let (kinds, all_m, none) = play("--set analysis.second_order=\"full\"");
    assert_eq!((kinds.len(), none), (0, None));
    // A linear model with the stiffening of the rotating beam gives 0.5744 m.
    assert!((all_m / 0.5744 - 1.0).abs() < 2e-3, "{all_m} m");
    let factor = claimed.unwrap() / (linear_m / all_m - 1.0);
    assert!((0.5..30.0).contains(&factor), "{claimed:?} for {linear_m} and {all_m} m");
}

/// Remarks of a command that succeeds.
#[track_caller]
fn remarks(bench: &Bench, arguments: &(impl Words + ?Sized)) -> Vec<String> {
    lines(&bench.told(arguments), "remark")
}

const OTHER_DENSITY: &str =
    "remark: segments.0.density = 2.7 kg/m^3, where solids have 25 to 25000: probably another unit";

#[test]
fn a_number_that_is_probably_in_another_unit_is_told_and_nothing_is_refused() {
    let bench = bench();
    let solve = |more: &str| remarks(&bench, &format!("solve strip.toml move.csv {more}"));
    assert_eq!(solve(""), [""; 0]);
    assert_eq!(solve("--set segments.0.density=2.7"), [OTHER_DENSITY]);
    // Where they are hidden, the record keeps them.
    assert_eq!(solve("--set segments.0.density=2.7 -q"), [""; 0]);
    let remark = &bench.json("out/summary.json")["remarks"][0];
    assert_eq!(remark["kind"], "density");
    assert_eq!(remark["hint"], "write the unit beside the number, as in \"2.7 g/cm^3\"");

    assert_eq!(
        solve("--scale-duration 1000 --set analysis.tolerance=1e-4"),
        ["remark: the tip moves for 1000 s, where motions take 0.001 to 500.0: probably time in \
          another unit"]
    );
    assert_eq!(
        solve("--scale-distance 540"),
        ["remark: the tip moves by 108.0 m, 17.2 turns of a link of 1.000 m: probably length in \
          another unit"]
    );
    let modes = |set: &str| remarks(&bench, &format!("modes strip.toml --count 2 {set}"));
    let soft = modes("--set segments.0.E=90000");
    assert_eq!(
        soft[0],
        "remark: segments.0.E = 90000.0 Pa, where solids have 1e6 to 2e12: probably another unit"
    );
    let heavy = modes("--set segments.0.E=2e6 --set payload.mass=20 --set hub.inertia=1e6");
    assert!(heavy[0].starts_with("remark: the first natural frequency is 0.0"), "{heavy:?}");
    // A factor is no slip of units, and the value before it is judged.
    assert_eq!(modes("--set segments.0.E*=40"), [""; 0]);
    let slip = modes("--set segments.0.density=2.7 --set segments.0.density*=1000");
    assert_eq!(slip, [OTHER_DENSITY]);
}

#[test]
fn a_strip_that_lies_on_its_edge_is_told() {
    let bench = Bench::new();
    let text = "[[segments]]\nlength = 1\nE = '70 GPa'\ndensity = 2700\n\
                section = { shape = 'rectangle', width = '3 mm', thickness = '40 mm' }\n[hub]\ninertia = 0.01\n";
    bench.write("edge.toml", text);
    let told = |set: &[&str]| {
        let remarks = remarks(&bench, &with("modes edge.toml --count 1", set));
        remarks.into_iter().filter(|line| line.contains("section")).collect::<Vec<_>>()
    };
    let edge = "remark: segments.0.section: thickness = 0.0400000 m is above width = 0.00300000 m: the link \
                bends across its stiffer side";
    assert_eq!(told(&[]), [edge]);
    assert_eq!(told(&["--set", "segments.0.section.thickness='3 mm'"]), [""; 0]);
}

#[test]
fn no_published_rig_has_a_remark() {
    for rig in link_files() {
        Bench::new().silent(&["modes", &rig, "--count", "3"]);
    }
}
