//! Links whose numbers lie at the ends of what can be written.

use super::{Bench, LARGE, link};

/// What is told of the link with this change, where it is solved.
#[track_caller]
fn warnings(change: &str) -> String {
    Bench::new().solves(&format!("--set {change}"))
}

/// A link of two segments, each of these keys.
fn segments(first: &str, second: &str) -> Bench {
    let bench = Bench::new();
    let link = link("");
    let (_, rest) = link.split_once('\n').unwrap();
    bench.write("link.toml", format!("segments = [{{ {first} }}, {{ {second} }}]\n{rest}"));
    bench
}

#[test]
fn stiffness_may_span_all_orders_between_segments() {
    let with = |ei: &str| format!("length = 0.75, EI = {ei}, mass_per_length = 0.8");
    for stiff in ["5e12", "5e200", "1e300"] {
        for [first, second] in [[stiff, "5.0"], ["5.0", stiff]] {
            assert_eq!(segments(&with(first), &with(second)).solves(""), "", "{first}, {second}");
        }
    }
    // So soft that no ten elements hold its waves.
    let told = segments(&with("5e6"), &with("5e-6")).solves("--nodes 0");
    assert!(told.contains("the mesh changes the displacement by"), "{told}");
    // A segment without mass is a spring, and one may be as short as a picometre.
    let full = with("5");
    for (first, second) in
        [(full.replace("0.8", "0"), &full), (full.clone(), &full.replace("0.8", "0"))]
    {
        assert_eq!(segments(&first, second).solves(""), "", "{first}, {second}");
    }
    let long = "length = 1.5, EI = 5, mass_per_length = 0.8";
    assert_eq!(segments(long, &long.replace("1.5", "1e-12")).solves(""), "");
}

#[test]
fn stiffness_towards_nothing_and_towards_everything() {
    let told = warnings("segments.beam.EI=0.005");
    assert!(told.contains(LARGE), "{told}");
    for ei in ["1e6", "1e15", "1e300"] {
        assert_eq!(warnings(&format!("segments.beam.EI={ei}")), "", "{ei}: rigid");
    }
}

/// Its torque is that of a rigid link, which ends where the motion does: what is played between the
/// samples then matters.
#[test]
fn the_torque_of_a_link_next_to_rigid_is_verified() {
    let bench = Bench::new();
    bench.done("trajectory min-jerk --distance 0.5 --duration 1 --step 0.01 -o min-jerk.csv");
    for motion in ["motion.csv", "min-jerk.csv"] {
        for ei in ["1e6", "1e7", "1e15"] {
            bench.done(&format!("verify link.toml {motion} --set segments.beam.EI={ei}"));
        }
    }
}

#[test]
fn a_payload_a_million_times_heavier_than_the_link() {
    let told = warnings("payload.mass=1.2e6");
    assert!(told.contains(LARGE), "{told}");
    let told = warnings("payload={mass=1.2e6,inertia=1e6}");
    assert!(told.contains("no torque moves the tip (rotary inertia, shear or payload)"), "{told}");
}

#[test]
fn damping_of_nothing_and_next_to_critical() {
    for model in ["hysteretic", "modal"] {
        let with = |ratio: &str| warnings(&format!("damping={{model=\"{model}\",ratio={ratio}}}"));
        assert_eq!((with("0"), with("1e-300")), (String::new(), String::new()), "{model}");
        let told = with("0.99");
        // Every mode damped, the torque grows with frequency, and hangs on where the band ends.
        let depends = told.contains("the peak torque depends on analysis.tip_tolerance");
        assert_eq!(depends, model == "modal", "{told}");
        // The kinks at both ends of the sine, which its samples do not tell, count for more.
        assert!(told.contains("leave the torque uncertain"), "{told}");
    }
}

#[test]
fn ten_thousand_segments_are_read() {
    let bench = Bench::new();
    let segment = "[[segments]]\nlength = 1e-4\nEI = 5\nmass_per_length = 0.8\nelements = 1\n";
    bench.write("link.toml", segment.repeat(10_000));
    bench.done("modes link.toml --count 1");
    bench.solves("--nodes 0,10000");
}
