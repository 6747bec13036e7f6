//! Links whose numbers lie at the ends of what can be written.

use super::{Bench, link, text};

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
fn a_segment_may_be_as_short_as_a_picometre() {
    let long = "length = 1.5, EI = 5, mass_per_length = 0.8";
    assert_eq!(segments(long, &long.replace("1.5", "1e-12")).solves(&[]), "");
}

#[test]
fn stiffness_towards_nothing_and_towards_everything() {
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
    }
}

#[test]
fn a_segment_without_mass_is_a_spring() {
    let with = |mass: &str| format!("length = 0.75, EI = 5, mass_per_length = {mass}");
    assert_eq!(segments(&with("0"), &with("0.8")).solves(&[]), "");
    assert_eq!(segments(&with("0.8"), &with("0")).solves(&[]), "");
}

#[test]
fn ten_thousand_segments_are_read() {
    let bench = Bench::new();
    let segment = "[[segments]]\nlength = 1e-4\nEI = 5\nmass_per_length = 0.8\nelements = 1\n";
    bench.write("link.toml", segment.repeat(10_000));
    let output = bench.run(&["modes", "link.toml", "--count", "1"]);
    assert_eq!(output.status.code(), Some(0), "{}", super::text(&output.stderr));
    bench.solves(&["--nodes", "0,10000"]);
}
