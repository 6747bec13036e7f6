//! Links whose numbers lie at the ends of what can be written.

use super::{Bench, NOT_SOLVABLE, REFUSED, link, text};

#[track_caller]
fn refused(change: &str, code: i32, message: &str) {
    let arguments = ["solve", "link.toml", "motion.csv", "--set", change];
    Bench::new().refuses(&arguments, code, message);
}

/// What is told of the link with this change, where it is solved.
#[track_caller]
fn warnings(change: &str) -> String {
    Bench::new().solves(&["--set", change])
}

/// A link of two segments, each of these keys.
fn segments(first: &str, second: &str) -> Bench {
    let bench = Bench::new();
    let (_, rest) = link("").split_once('\n').map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    bench.write("link.toml", format!("segments = [{{ {first} }}, {{ {second} }}]\n{rest}"));
    bench
}

#[test]
fn stiffness_may_span_all_orders_between_segments() {
    let with = |ei: &str| format!("length = 0.75, EI = {ei}, mass_per_length = 0.8");
    for stiff in ["5e12", "5e200", "1e300"] {
        for [first, second] in [[stiff, "5.0"], ["5.0", stiff]] {
            assert_eq!(segments(&with(first), &with(second)).solves(&[]), "", "{first}, {second}");
        }
    }
    // So soft that no ten elements hold its waves.
    let told = segments(&with("5e6"), &with("5e-6")).solves(&["--nodes", "0"]);
    assert!(told.contains("the mesh changes the displacement by"), "{told}");
}

#[test]
fn a_length_of_nothing_is_refused_and_a_short_one_solved() {
    let message = "segments.0.length = 0 m, but must be finite and above 0";
    refused("segments.beam.length=0", REFUSED, message);
    let inertia =
        "kg m^2, but the link and all it carries must have a finite rotary inertia above 0";
    let bench = Bench::new();
    bench.write("link.toml", "segments = [{ length = 1e-300, EI = 5, mass_per_length = 1 }]");
    bench.refuses(&["solve", "link.toml", "motion.csv"], REFUSED, inertia);
    refused("segments.beam.length=1e300", REFUSED, inertia);
    let long = "length = 1.5, EI = 5, mass_per_length = 0.8";
    let short = |length: &str| segments(long, &long.replace("1.5", length));
    assert_eq!(short("1e-12").solves(&[]), "");
    let arguments = ["solve", "link.toml", "motion.csv"];
    short("1e-300").refuses(&arguments, NOT_SOLVABLE, "= not a finite number, but must be one");
}

#[test]
fn stiffness_towards_nothing_and_towards_everything() {
    refused("segments.beam.EI=0", REFUSED, "segments.0.EI = 0 N m^2, but must be");
    for ei in ["5e-324", "1e-30", "1e-12"] {
        let message = "samples, but must be at most 16777216\n";
        refused(&format!("segments.beam.EI={ei}"), NOT_SOLVABLE, message);
    }
    let told = warnings("segments.beam.EI=0.005");
    assert!(
        told.contains(
            "large deflections and centrifugal stiffening, which the linear model leaves out"
        ),
        "{told}"
    );
    for ei in ["1e6", "1e15", "1e300"] {
        assert_eq!(warnings(&format!("segments.beam.EI={ei}")), "", "{ei}: rigid");
    }
}

/// Its torque is that of a rigid link, which ends where the motion does: what is played between the
/// samples then matters.
#[test]
fn the_torque_of_a_link_next_to_rigid_is_verified() {
    let bench = Bench::new();
    let profile =
        ["trajectory", "min-jerk", "--distance", "0.5", "--duration", "1", "--step", "0.01"];
    let output = bench.run(&[&profile[..], &["-o", "min-jerk.csv"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    for motion in ["motion.csv", "min-jerk.csv"] {
        for ei in ["1e6", "1e7", "1e15"] {
            let set = format!("segments.beam.EI={ei}");
            let output = bench.run(&["verify", "link.toml", motion, "--set", &set]);
            assert_eq!(output.status.code(), Some(0), "{motion}, {ei}: {}", text(&output.stdout));
        }
    }
}

#[test]
fn a_payload_a_million_times_heavier_than_the_link() {
    let told = warnings("payload.mass=1.2e6");
    assert!(
        told.contains(
            "large deflections and centrifugal stiffening, which the linear model leaves out"
        ),
        "{told}"
    );
    let told = warnings("payload={ mass = 1.2e6, inertia = 1e6 }");
    assert!(told.contains("no torque moves the tip (rotary inertia, shear or payload)"), "{told}");
    let range = "but must lie from 1e-100 to 1e100 N m";
    refused("hub.inertia=1e200", NOT_SOLVABLE, range);
}

#[test]
fn damping_of_nothing_and_next_to_critical() {
    for model in ["hysteretic", "modal"] {
        let with = |ratio: &str| format!("damping={{ model = \"{model}\", ratio = {ratio} }}");
        assert_eq!(warnings(&with("0")), "", "{model}");
        assert_eq!(warnings(&with("1e-300")), "", "{model}");
        let told = warnings(&with("0.99"));
        // Every mode damped, the torque grows with frequency, and hangs on where the band ends.
        let is_modal = model == "modal";
        assert_eq!(
            told.contains("the peak torque depends on analysis.tip_tolerance"),
            is_modal,
            "{told}"
        );
        // The kinks at both ends of the sine, which its samples do not tell, count for more.
        assert!(told.contains("leave the torque uncertain"), "{told}");
        refused(&with("1"), REFUSED, "damping.ratio = 1, but must lie in [0, 1)");
    }
}

#[test]
fn a_segment_without_mass_is_a_spring_and_a_link_without_inertia_is_none() {
    let with = |mass: &str| format!("length = 0.75, EI = 5, mass_per_length = {mass}");
    assert_eq!(segments(&with("0"), &with("0.8")).solves(&[]), "");
    assert_eq!(segments(&with("0.8"), &with("0")).solves(&[]), "");
    let bench = Bench::new();
    bench.write("link.toml", "segments = [{ length = 1, EI = 5, mass_per_length = 0 }]");
    let message =
        "link.toml:1: segments = a total of 0 kg m^2, but the link and all it carries must";
    bench.refuses(&["solve", "link.toml", "motion.csv"], REFUSED, message);
}

#[test]
fn a_million_elements_are_refused_and_ten_thousand_segments_read() {
    let message =
        "mesh.elements = 1000000, but must be a whole number from 1 to 100000, or \"auto\"";
    refused("mesh.elements=1000000", REFUSED, message);
    let bench = Bench::new();
    let segment = "[[segments]]\nlength = 1e-4\nEI = 5\nmass_per_length = 0.8\nelements = 1\n";
    bench.write("link.toml", segment.repeat(10_000));
    let output = bench.run(&["modes", "link.toml", "--count", "1"]);
    assert_eq!(output.status.code(), Some(0), "{}", super::text(&output.stderr));
    bench.solves(&["--nodes", "0,10000"]);
}
