//! Every published rig through the commands that a user runs on it.

use super::{Bench, MOTION, link_files};

#[test]
fn every_rig_is_solved_verified_and_has_its_modes() {
    let bench = Bench::new();
    for rig in link_files() {
        // The arm with 49 kg at its tip would deflect by more than its length.
        let slower = if rig.contains("nasa_jsc") { "10" } else { "1" };
        let moved = [&rig, MOTION, "--scale-duration", slower];

        let out = ["-o", "out", "--verify", "--every", "10"];
        bench.done(&[&["solve"], &moved[..], &out].concat());
        let summary = bench.json("out/summary.json");
        let checks = summary["verification"].as_array().unwrap();
        assert!(checks.len() >= 9, "{rig}: {checks:?}");
        for check in checks {
            let (found, bound) = (check["found"].as_f64(), check["bound"].as_f64());
            assert!(found.unwrap() <= bound.unwrap(), "{rig}: {check}");
            assert_eq!(check["passes"], true, "{rig}: {check}");
        }

        bench.done(&["modes", &rig, "--count", "4", "-o", "modes"]);
        let periods = summary["periods_s"].as_array().unwrap();
        for (listed, period) in bench.numbers("modes/modes.csv", "period_s").iter().zip(periods) {
            assert!((listed / period.as_f64().unwrap() - 1.0).abs() < 1e-9, "{rig}: {listed}");
        }

        let text = bench.printed(&[&["verify"], &moved[..]].concat());
        assert!(text.lines().count() >= 10 && !text.contains("FAILS"), "{text}");
    }
}
