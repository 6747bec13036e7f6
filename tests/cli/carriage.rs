//! A link on a carriage: its files, its words, and what refuses it.

use super::{Bench, column, ended, stderr, stdout, succeeded};

const MAST: &str = "specs/carriages/stacker_mast.toml";

/// A bench with the motion of the mast.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.done("trajectory septic --distance 2 --duration 2 --step 0.002 -o move.csv");
    bench
}

#[test]
fn the_force_of_a_mast_is_that_of_a_program_written_separately() {
    let bench = bench();
    let text = stdout(&succeeded(bench.run(&format!("solve {MAST} move.csv -o out"))));
    let peak_n = bench.number("out", "results/peak_force_n");
    for words in ["force    peak 4849 N at ", "carriage moves by up to ", " m/s, ", " N m"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    for words in ["torque", "hub", "rad"] {
        assert!(!text.contains(words), "{words}: {text}");
    }
    let force = column(&bench, "out/force.csv", "force_n");
    let largest = force.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    // Forty Hermite elements and an FFT of 8192 samples, in another language; the peak lies between two samples.
    assert!((largest / 4848.576 - 1.0).abs() < 2e-6, "{largest}");
    assert!((1.0..1.0 + 1e-5).contains(&(peak_n / largest)), "{largest} {peak_n}");
    let of = |name: &str| column(&bench, "out/carriage.csv", name);
    let place = of("carriage_m");
    // The slow tail of hysteretic damping is left over at both ends.
    let (first_m, last_m) = (place[0], place[place.len() - 1]);
    assert!(first_m.abs() < 1e-5 && (last_m - 2.0).abs() < 1e-5, "{first_m} {last_m}");
    for name in ["carriage_velocity_m_s", "carriage_acceleration_m_s2", "rigid_carriage_m"] {
        assert_eq!(of(name).len(), force.len(), "{name}");
    }
    let moment = of("root_moment_n_m").iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let peak_n_m = bench.number("out", "results/peak_root_moment_n_m");
    assert!((moment / peak_n_m - 1.0).abs() < 1e-3, "{moment} {peak_n_m}");
    let rigid = column(&bench, "out/rigid_force.csv", "rigid_force_n");
    assert_eq!(rigid.len(), force.len());
}

#[test]
fn the_force_is_verified_in_words_of_a_carriage() {
    let bench = bench();
    let text = stdout(&succeeded(bench.run(&format!("verify {MAST} move.csv"))));
    assert!(text.contains("F/a_tip by assembled matrices"), "{text}");
    assert!(!text.contains("torque") && !text.contains("hub"), "{text}");
}

#[test]
fn modes_are_those_with_the_carriage_free_and_held() {
    let bench = bench();
    let text = stdout(&succeeded(bench.run(&format!("modes {MAST}"))));
    assert!(text.contains("carriage free\n") && text.contains("carriage held\n"), "{text}");
    assert!(!text.contains("hub"), "{text}");
}

#[test]
fn what_a_carriage_does_not_take_is_refused_in_words() {
    let bench = bench();
    let refused = |words: &str| stderr(&ended(3, bench.run(words)));
    bench.write("angle.csv", "time,angle\n0,0\n0.1,0\n0.2,0.1\n0.3,0.2\n0.4,0.2\n");
    let cases = [
        (format!("solve {MAST} angle.csv"), "displacement, velocity or acceleration"),
        (
            format!("solve {MAST} move.csv --set hub.inertia=1"),
            "hub must not be there beside [carriage]",
        ),
        (format!("solve {MAST} move.csv --set gravity=[0,-9.81]"), "gravity = set, but must not"),
        (format!("solve {MAST} move.csv --set gravity=[0,0]"), "gravity = set, but must not"),
        (format!("solve {MAST} move.csv --set limits.motor_rate=2"), "is a limit of a hub"),
        (format!("solve {MAST} move.csv --set drive.gear_ratio=2"), "drive = set, but must not"),
        (
            format!("solve {MAST} move.csv --set limits.torque=2"),
            "limits.torque is a limit of a hub",
        ),
        (format!("solve {MAST} move.csv --report -o out"), "[carriage] is new"),
        (format!("solve {MAST} move.csv --write force.csv"), "[carriage] is new"),
        (format!("simulate {MAST} move.csv"), "[carriage] is new"),
        (format!("frf {MAST}"), "[carriage] is new"),
        (format!("modes {MAST} --at 0"), "[carriage] is new"),
        (format!("sweep {MAST} move.csv --vary payload.mass=1,2 -o s.csv"), "[carriage] is new"),
        (
            format!("trajectory septic --distance 2 --step 0.01 --link {MAST} --fit-limit power=1"),
            "is new",
        ),
    ];
    for (words, expected) in cases {
        let told = refused(&words);
        assert!(told.contains(expected), "{words}: {told}");
    }
    let order = format!("solve {MAST} move.csv --set analysis.second_order=\"full\"");
    let told = stderr(&ended(3, bench.run(&order)));
    assert!(told.contains("second-order terms are not computed yet"), "{told}");
    let mass = format!("solve specs/bayo1987_example1.toml {} --set hub.mass=2", super::MOTION);
    assert!(refused(&mass).contains("hint: a hub that slides is a [carriage]"));
    bench.done(&format!("solve {MAST} move.csv -o run"));
    assert!(refused("report run").contains("is not read back yet"));
}
