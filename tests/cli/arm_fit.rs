//! `flexlink fit` of an arm of several links.

use super::{Bench, refusal, repository, stderr, stdout, succeeded};

const QUANSER: &str = "specs/arms/quanser_serial.toml";
const MEASURED: &str = "measurements/quanser_serial.toml";

/// Fits Quanser's arm on elbow springs of 30 N m/rad at first.
fn fitted(bench: &Bench, more: &[&str]) -> std::process::Output {
    let files = [repository(QUANSER), repository(MEASURED)];
    let elbow = "links.elbow.drive.joint_stiffness";
    let start = format!("{elbow}=30");
    bench.run(&[&["fit", &files[0], &files[1], "--free", elbow, "--set", &start], more].concat())
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
    let springs = ["--set", "links.shoulder.drive.joint_stiffness=30", "--free", shoulder];
    refusal(4, fitted(&bench, &springs), "links.elbow.drive.joint_stiffness lies on its bound");

    let inertia = "links.shoulder.tip.inertia";
    let set = format!("{inertia}=0.02");
    let found = stdout(&succeeded(fitted(&bench, &["--set", &set, "--free", inertia, "--report"])));
    assert!((0.02 * factor(&found, inertia) / 0.0502 - 1.0).abs() < 0.02, "{found}");
    let stiffness = 30.0 * factor(&found, "links.elbow.drive.joint_stiffness");
    assert!((62.0..77.0).contains(&stiffness), "{found}");
    let page = bench.read("fit.html");
    assert!(page.contains("frequency 2, joints held, at 0°, 0°"));
}

#[test]
fn the_arm_file_is_written_with_its_comments_and_fits() {
    let bench = Bench::new();
    let spring = "  drive = { joint_stiffness = '30 N m/rad', gear_ratio = 50.0 } # the elbow's\n";
    let text = std::fs::read_to_string(repository(QUANSER)).unwrap();
    let text = text.replace("drive = { gear_ratio = 50.0 }\n", spring);
    let text = text.replace("mass = 1.578", "mass = 1.578, inertia = 0.0502");
    bench.write("arm.toml", &text);
    let measured = repository(MEASURED);
    let free = ["--free", "links.elbow.drive.joint_stiffness"];
    bench.done(&[&["fit", "arm.toml", &measured, "-o", "new.toml"], &free[..]].concat());
    let record = bench.json("new.json");
    let second = &record["residuals"][1]["observable"];
    assert_eq!((&second["kind"], &second["joints"]), (&"arm_frequency".into(), &"held".into()));
    let after = record["replaced"][0]["after"].as_str().unwrap();
    assert_eq!(bench.read("new.toml"), text.replace("'30 N m/rad'", after));
    let again = bench.run(&[&["fit", "new.toml", &measured], &free[..]].concat());
    let found = stdout(&again);
    assert!((factor(&found, free[1]) - 1.0).abs() < 1e-4, "{found}");
}

#[test]
fn a_swing_without_gravity_has_no_frequency() {
    let bench = Bench::new();
    bench.write("m.toml", "[[frequency]]\nmode = 2\nat = [0, '45 deg']\nvalue = '0.5 Hz'\n");
    let out =
        bench.ends(3, &["fit", &repository(QUANSER), "m.toml", "--free", "links.*.segments.*.E"]);
    let told =
        "error: frequency 2, joints free, at 0°, 45° was measured, but this mode does not vibrate";
    assert!(stderr(&out).contains(told), "{}", stderr(&out));
}

#[test]
fn what_is_no_mode_of_the_arm_is_refused() {
    let bench = Bench::new();
    let head = "at = [0, 0.5]\n";
    let cases = [
        (
            "[[frequency]]\nmode = 1\njoints = 'held'\nat = [1e5, 0]\nvalue = 2\n",
            "at most 1e4 in size",
        ),
        ("", "hint: [[frequency]] with mode, value, joints and at"),
    ];
    for (text, told) in cases {
        bench.write("m.toml", &format!("{head}{text}"));
        let free = "links.*.segments.*.E";
        bench.refuses(3, &["fit", &repository(QUANSER), "m.toml", "--free", free], told);
    }
}
