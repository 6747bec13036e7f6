//! Arms of which frequencies and damping ratios were measured in poses.

use std::f64::consts::TAU;

use super::fitted;
use flexlink::fit::{ArmMode, HubEnd, Measured, Measurements, Observable};
use flexlink::response::{PoseMode, arm_modes};
use flexlink::spec::{Specification, read_specification};

const ARM: &str = include_str!("../../../specs/arms/two_links.toml");

fn arm(text: &str) -> Specification {
    read_specification("arm.toml", text, &[]).unwrap()
}

fn measured(observable: Observable, value: f64) -> Measured {
    // Five digits.
    Measured { observable, value: format!("{value:.4e}").parse().unwrap(), uncertainty: None }
}

/// Numbers of the modes with joints held and free in two poses; those below 3 of free joints are swings.
const MODES: [(HubEnd, usize); 4] =
    [(HubEnd::Held, 1), (HubEnd::Held, 2), (HubEnd::Free, 3), (HubEnd::Free, 4)];
const POSES: [[f64; 2]; 2] = [[-1.0, 0.3], [0.5, 1.3]];

/// What the arm of the file has of its modes.
fn of_the_file(observable: fn(ArmMode) -> Observable, value: fn(&PoseMode) -> f64) -> Measurements {
    let own = arm(ARM);
    let in_pose = |at_rad: [f64; 2]| {
        let modes = arm_modes(&own.arm, &at_rad, 3, 1e-9).unwrap();
        MODES.map(|(joints, mode)| {
            let list = if joints == HubEnd::Held { &modes.held } else { &modes.free };
            let mode_of = ArmMode { mode, joints, at_rad: at_rad.to_vec() };
            measured(observable(mode_of), value(&list.modes[mode - 1]))
        })
    };
    Measurements::new(POSES.map(in_pose).concat(), vec![], vec![]).unwrap()
}

/// Fits a file that is wrong by `wrong`, factors on what is free.
fn assert_recovered(measured: &Measurements, free: &[&str], wrong: &[(&str, &str)], exact: &[f64]) {
    let replaced = |text: String, (old, new): &(&str, &str)| {
        assert!(text.contains(old), "{old}");
        text.replace(old, new)
    };
    let text = wrong.iter().fold(ARM.to_owned(), replaced);
    let found = fitted(&text, measured, free).unwrap();
    assert_eq!((&found.misfit, found.undetermined.len()), (&None, 0), "{found:?}");
    for (value, exact) in found.values.iter().zip(exact) {
        assert!((value.factor / exact - 1.0).abs() < 1e-4, "{} {}", value.path, value.factor);
    }
}

#[test]
fn two_values_are_found_from_frequencies_in_two_poses() {
    let hertz = of_the_file(Observable::ArmFrequency, |mode| mode.square_per_s2.sqrt() / TAU);
    let stiffnesses = ["links.upper.segments.*.EI", "links.fore.segments.*.EI"];
    let wrong = [("EI = 60.0", "EI = 90.0"), ("EI = 15.0", "EI = 10.0")];
    assert_recovered(&hertz, &stiffnesses, &wrong, &[60.0 / 90.0, 1.5]);
    let stiffness_and_mass = ["links.upper.segments.*.EI", "links.fore.payload.mass"];
    let wrong = [("EI = 60.0", "EI = 90.0"), ("mass = 0.3", "mass = 0.45")];
    assert_recovered(&hertz, &stiffness_and_mass, &wrong, &[60.0 / 90.0, 0.3 / 0.45]);
}

/// More modes than the first polynomials have coordinates.
#[test]
fn a_high_mode_is_a_measurement_too() {
    let own = arm(ARM);
    let at_rad = POSES[0].to_vec();
    let modes = arm_modes(&own.arm, &at_rad, 15, 1e-9).unwrap();
    let value = modes.held.modes[14].square_per_s2.sqrt() / TAU;
    let mode = ArmMode { mode: 15, joints: HubEnd::Held, at_rad };
    let hertz = vec![measured(Observable::ArmFrequency(mode), value)];
    let hertz = Measurements::new(hertz, vec![], vec![]).unwrap();
    let stiffer = [("EI = 60.0", "EI = 72.0"), ("EI = 15.0", "EI = 18.0")];
    assert_recovered(&hertz, &["links.*.segments.*.EI"], &stiffer, &[1.0 / 1.2]);
}

#[test]
fn damping_of_all_links_is_found_from_ratios() {
    let ratios = of_the_file(Observable::ArmDamping, |mode| mode.damping_ratio.unwrap());
    assert_recovered(&ratios, &["links.*.damping.beta"], &[("2e-4", "3e-4")], &[2.0 / 3.0]);
}

const INNER: &str = "length = 0.7, EI = 60, mass_per_length = 0.8";
const OUTER: &str = "length = 0.6, EI = 15, mass_per_length = 0.4";

/// Held on stiff joints, the stretched arm is one link with its elbow's body in the middle, which the recursion solves.
#[test]
fn an_arm_stretched_and_held_is_the_link_of_all_its_segments() {
    let link = format!(
        "segments = [{{ {INNER} }}, {{ {OUTER} }}]\nmasses = [{{ at = 0.7, mass = 0.6 }}]\n\
         payload = {{ mass = 0.3 }}\n"
    );
    let arm = format!(
        "[[links]]\nsegments = [{{ {INNER} }}]\ntip = {{ mass = 0.6 }}\n\
         [[links]]\nsegments = [{{ {OUTER} }}]\npayload = {{ mass = 0.3 }}\n"
    );
    let held = HubEnd::Held;
    let hertz = [(1, 2.4), (2, 6.0), (3, 32.0)];
    let of_link = hertz
        .map(|(mode, value)| measured(Observable::Frequency { mode, hub: held }, value))
        .to_vec();
    let of_arm = hertz
        .map(|(mode, value)| {
            let mode = ArmMode { mode, joints: held, at_rad: vec![0.2; 2] };
            measured(Observable::ArmFrequency(mode), value)
        })
        .to_vec();
    let [of_link, of_arm] =
        [of_link, of_arm].map(|values| Measurements::new(values, vec![], vec![]).unwrap());
    let link = fitted(&link, &of_link, &["segments.0.EI", "segments.1.EI"]).unwrap();
    let free = ["links.0.segments.0.EI", "links.1.segments.0.EI"];
    let arm = fitted(&arm, &of_arm, &free).unwrap();
    for (own, same) in arm.values.iter().zip(&link.values) {
        assert!((own.factor / same.factor - 1.0).abs() < 1e-6, "{arm:?} {link:?}");
        let errors = [own, same].map(|value| value.relative_standard_error.unwrap());
        assert!((errors[0] / errors[1] - 1.0).abs() < 1e-4, "{errors:?}");
    }
    assert!(arm.values.iter().all(|value| (value.factor - 1.0).abs() > 1e-3), "{arm:?}");
}

#[test]
fn an_arm_of_one_link_is_fitted_as_that_link() {
    let keys = format!(
        "segments = [{{ {OUTER} }}]\nhub = {{ inertia = 0.02 }}\npayload = {{ mass = 0.3 }}\n"
    );
    let hertz = [(HubEnd::Held, 1, 1.9), (HubEnd::Held, 2, 40.0), (HubEnd::Free, 1, 17.0)];
    let values =
        hertz.map(|(hub, mode, value)| measured(Observable::Frequency { mode, hub }, value));
    let values = Measurements::new(values.to_vec(), vec![], vec![]).unwrap();
    let link = fitted(&keys, &values, &["payload.mass", "hub.inertia"]).unwrap();
    let free = ["links.0.payload.mass", "links.0.hub.inertia"];
    let arm = fitted(&format!("[[links]]\n{keys}"), &values, &free).unwrap();
    for (own, same) in arm.values.iter().zip(&link.values) {
        assert_eq!(own.factor.to_bits(), same.factor.to_bits(), "{} {}", own.path, own.factor);
        assert!((own.factor - 1.0).abs() > 1e-3, "{} {}", own.path, own.factor);
    }
}
