//! `flexlink fit` of an arm of several links.

use std::process::Output;

use super::{Bench, refusal, repository, stdout, succeeded};

const QUANSER: &str = "specs/arms/quanser_serial.toml";

const MEASURED: &str = "measurements/quanser_serial.toml";

const ELBOW: &str = "links.elbow.drive.joint_stiffness";

/// Fits Quanser's arm on elbow springs of 30 N m/rad at first.
fn fitted(bench: &Bench, more: &str) -> Output {
    bench.run(&format!("fit {QUANSER} {MEASURED} --free {ELBOW} --set {ELBOW}=30 {more}"))
}

/// The row of a free value: its path and its factor.
fn factor(out: &str, path: &str) -> f64 {
    let row = out.lines().find(|line| line.starts_with(path)).unwrap();
    row.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// Springs of both joints explain neither frequency; the own inertia of the elbow's drive, 0.0502 kg m² of the data sheet,
/// is found beside the elbow's spring.
#[test]
fn the_two_frequencies_of_the_quanser_arm_are_not_those_of_springs_alone() {
    let bench = Bench::new();
    let shoulder = "links.shoulder.drive.joint_stiffness";
    let springs = fitted(&bench, &format!("--set {shoulder}=30 --free {shoulder}"));
    refusal(4, springs, &format!("{ELBOW} lies on its bound"));

    let inertia = "links.shoulder.tip.inertia";
    let drive = format!("--set {inertia}=0.02 --free {inertia} --report");
    let found = stdout(&succeeded(fitted(&bench, &drive)));
    assert!((0.02 * factor(&found, inertia) / 0.0502 - 1.0).abs() < 0.02, "{found}");
    assert!((62.0..77.0).contains(&(30.0 * factor(&found, ELBOW))), "{found}");
    assert!(bench.read("fit.html").contains("frequency 2, joints held, at 0°, 0°"));
}

#[test]
fn the_arm_file_is_written_with_its_comments_and_fits() {
    let bench = Bench::new();
    let spring = "  drive = { joint_stiffness = '30 N m/rad', gear_ratio = 50.0 } # the elbow's\n";
    let text = std::fs::read_to_string(repository(QUANSER)).unwrap();
    let text = text.replace("drive = { gear_ratio = 50.0 }\n", spring);
    let text = text.replace("mass = 1.578", "mass = 1.578, inertia = 0.0502");
    bench.write("arm.toml", &text);
    bench.done(&format!("fit arm.toml {MEASURED} -o new.toml --free {ELBOW}"));
    let record = bench.json("new.json");
    let second = &record["residuals"][1]["observable"];
    assert_eq!((&second["kind"], &second["joints"]), (&"arm_frequency".into(), &"held".into()));
    let after = record["replaced"][0]["after"].as_str().unwrap();
    assert_eq!(bench.read("new.toml"), text.replace("'30 N m/rad'", after));
    let found = stdout(&bench.run(&format!("fit new.toml {MEASURED} --free {ELBOW}")));
    assert!((factor(&found, ELBOW) - 1.0).abs() < 1e-4, "{found}");
}
