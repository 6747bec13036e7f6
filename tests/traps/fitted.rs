//! The shortest motions within a limit: held against the exact solution of the link.

use std::fs;
use std::process::Command;

use super::case::{Case, Mesh};
use super::judge::judged;
use super::link::{Damping, Link};
use super::motion::{Motion, Profile};
use super::run::{Nodes, Outcome, solved};

/// What the peaks of truth and program between rows are known to.
const BETWEEN_ROWS: f64 = 4e-3;

const STEP_S: f64 = 0.01;

const DISTANCE_M: f64 = 0.5;

struct Fitted {
    link: Link,
    profile: Profile,
    /// As the program takes it, and what the summary calls its value.
    limit: (&'static str, f64),
    key: &'static str,
}

fn cases() -> [Fitted; 4] {
    let torque = |link, profile, limit| {
        let key = "peak_torque_n_m";
        Fitted { link, profile, limit: ("torque", limit), key }
    };
    let mut blocked = Link::paper();
    blocked.payload.mass_kg = 0.3;
    blocked.payload.inertia_kg_m2 = 0.05;
    let mut modal = Link::paper();
    modal.damping = Damping::Modal(vec![0.02]);
    let limit = ("motor_torque", 4.0);
    let motor = Fitted {
        limit,
        key: "peak_motor_torque_n_m",
        ..torque(Link::rome(), Profile::Septic, 4.0)
    };
    [
        torque(Link::paper(), Profile::Septic, 2.0),
        torque(blocked, Profile::Gaussian, 3.0),
        torque(modal, Profile::Septic, 2.0),
        motor,
    ]
}

impl Fitted {
    fn case(&self, duration_s: f64) -> Case {
        let motion = Motion::new(self.profile, DISTANCE_M, duration_s, STEP_S);
        Case::new("fitted", self.link.clone(), motion, Mesh::Elements(20))
    }

    /// Duration in s that the program finds.
    fn found_s(&self) -> f64 {
        let folder = tempfile::tempdir().expect("a place for files");
        fs::write(folder.path().join("link.toml"), self.case(1.0).toml()).expect("a link file");
        let profile = if self.profile == Profile::Septic { "septic" } else { "gaussian" };
        let (distance, step) = (DISTANCE_M.to_string(), STEP_S.to_string());
        let limit = format!("{}={}", self.limit.0, self.limit.1);
        let mut program = Command::new(env!("CARGO_BIN_EXE_flexlink"));
        program.current_dir(folder.path()).args(["trajectory", profile, "--distance", &distance]);
        program.args(["--step", &step, "--link", "link.toml", "--fit-limit", &limit]);
        let output = program.output().expect("a program that starts");
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{told}");
        let table = String::from_utf8(output.stdout).expect("text");
        let last = table.lines().last().and_then(|row| row.split(',').next());
        last.and_then(|time| time.parse().ok()).expect("a time")
    }

    /// The limited value of a motion that lasts so long, as the exact solution has it.
    fn truth(&self, duration_s: f64) -> f64 {
        let case = self.case(duration_s);
        let samples = case.motion.samples();
        let Outcome::Written(written) = solved(&case, &samples, &Nodes::of(&case, &samples)) else {
            panic!("refused at {duration_s} s");
        };
        let peaks = judged(&case, &samples, &written).peaks;
        peaks.into_iter().find(|peak| peak.key == self.key).expect("the limited peak").truth
    }
}

#[test]
fn the_shortest_motion_keeps_its_limit_in_truth_and_two_steps_shorter_ones_do_not() {
    for fitted in cases() {
        let (name, limit) = fitted.limit;
        let duration_s = fitted.found_s();
        let truth = fitted.truth(duration_s);
        println!("{name} {limit}: {truth} in {duration_s} s");
        assert!(truth <= limit * (1.0 + BETWEEN_ROWS), "{name}: {truth} in {duration_s} s");
        for steps in [1.0, 2.0] {
            let truth = fitted.truth(duration_s - steps * STEP_S);
            let least = limit * (1.0 - BETWEEN_ROWS);
            assert!(truth > least, "{name}: {truth} {steps} steps before {duration_s} s");
        }
    }
}
