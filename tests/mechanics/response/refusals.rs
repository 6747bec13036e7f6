//! What is refused, and what is warned about.

use std::f64::consts::PI;

use super::{link, peak, plan_of, played, simulate, times};
use flexlink::link::{Damping, Link, Segment, Taper};
use flexlink::response::{
    Feedback, HubReference, Play, SimulationError, SimulationWarning, Torque,
};

fn bayo() -> Link {
    link(|_| ())
}

/// Half a period of a sine in 0.4 s, or of a cosine that begins and ends in the middle.
fn torque(of: impl Fn(f64) -> f64) -> Torque {
    super::torque(0.01, 40, |t| of(PI * t / 0.4))
}

#[track_caller]
fn refusal(link: &Link, play: &Play) -> SimulationError {
    simulate(link, &plan_of(link, 5), play).map(|found| found.grid).unwrap_err()
}

fn warned(link: &Link, torque: &Torque) -> Vec<SimulationWarning> {
    played(link, &plan_of(link, 5), &Play::of(torque)).warnings
}

#[test]
fn no_torque_is_refused() {
    let error = refusal(&bayo(), &Play::of(&torque(|_| 0.0)));
    assert_eq!(error, SimulationError::NoTorque);
}

#[test]
fn an_end_before_that_of_the_torque_is_refused() {
    let torque = torque(f64::sin);
    for until_s in [0.25, f64::NAN] {
        let error = refusal(&bayo(), &Play { until_s: Some(until_s), ..Play::of(&torque) });
        assert!(matches!(error, SimulationError::EndsEarly { .. }), "{error}");
    }
}

#[test]
fn an_end_far_too_late_is_refused() {
    let torque = torque(f64::sin);
    for until_s in [1e6, f64::INFINITY] {
        let error = refusal(&bayo(), &Play { until_s: Some(until_s), ..Play::of(&torque) });
        assert!(matches!(error, SimulationError::TooLong { .. }), "{error}");
    }
}

#[test]
fn more_numbers_than_can_be_held_are_refused_with_their_size() {
    let torque = torque(f64::sin);
    // The most samples that there may be, of the rigid rotation, eight modes and their residual one.
    let until_s = Some(0.01 * f64::from((1 << 24) - 1));
    let memory_bytes = Some(1_000_000_000);
    let error = refusal(&bayo(), &Play { until_s, memory_bytes, ..Play::of(&torque) });
    assert_eq!(
        error.to_string(),
        "16777216 samples of 10 modes would need 5.9 GB of memory, but must fit in the 1.0 GB available"
    );
    assert_eq!(error.hint(), Some("use an earlier end, or a torque with a longer step"));
}

#[test]
fn a_motion_is_played_up_to_the_end_of_double_precision_and_not_beyond_its_power() {
    let played = |peak: f64| {
        let torque = super::torque(0.001, 40, |t| peak * (PI * t / 0.04).sin());
        simulate(&bayo(), &plan_of(&bayo(), 5), &Play::of(&torque)).map(|found| found.grid.len)
    };
    assert_eq!(played(1e154), Ok(41));
    assert!(matches!(played(1e160), Err(SimulationError::NotFinite { .. })), "its power is not");
}

#[test]
fn the_grid_covers_the_end_asked_for() {
    let torque = torque(f64::sin);
    let link = bayo();
    for (until_s, samples) in [(0.4, 41), (0.4 - 1e-9, 41), (0.401, 42), (0.5, 51)] {
        let play = Play { until_s: Some(until_s), ..Play::of(&torque) };
        let found = played(&link, &plan_of(&link, 5), &play);
        assert_eq!((found.grid.len, found.driven), (samples, 41), "until {until_s} s");
    }
}

#[test]
fn damping_that_feeds_energy_in_is_refused() {
    let series = Damping::Caughey { modes: vec![1, 2, 3], ratios: vec![0.02; 3] };
    let link = link(|parts| parts.damping = series);
    let error = refusal(&link, &Play::of(&torque(f64::sin)));
    assert!(error.to_string().starts_with("damping.ratios give mode "), "{error}");
    assert!(error.hint().is_some());
}

#[test]
fn a_hub_that_moves_no_mass_is_refused() {
    let root =
        Segment { mass_per_length_kg_m: Taper::constant(0.0), ..bayo().segments()[0].clone() };
    let massless = link(|parts| {
        parts.hub.inertia_kg_m2 = 0.0;
        parts.segments[0] = root.clone();
    });
    let torque = torque(f64::sin);
    let error = refusal(&massless, &Play::of(&torque));
    assert_eq!(
        error.to_string(),
        "the hub moves no mass: hub.inertia = 0, and the link has no mass at its root"
    );
    assert_eq!(error.hint(), Some("set hub.inertia above 0, however small"));
}

#[test]
fn a_torque_beyond_double_precision_is_refused_with_its_time() {
    let huge = torque(|x| 1.5e308 * x.sin());
    let error = refusal(&bayo(), &Play::of(&huge));
    assert!(matches!(error, SimulationError::NotFinite { .. }), "{error}");
}

#[test]
fn a_torque_that_begins_or_ends_with_a_jump_is_warned_about_with_its_numbers() {
    assert_eq!(warned(&bayo(), &torque(|x| 0.2 * x.sin())), []);
    let jump = warned(&bayo(), &torque(|x| 0.25 * (0.5 * x).cos()));
    let kinds: Vec<_> = jump.iter().map(SimulationWarning::kind).collect();
    assert_eq!(kinds, ["begins_with_jump"]);
    let cut = warned(&bayo(), &torque(|x| 0.2 * (x.sin() - 0.002 * x / PI)));
    assert_eq!(cut.len(), 1, "{cut:?}");
    let within = warned(&bayo(), &torque(|x| 0.2 * (x.sin() - 0.0009 * x / PI)));
    assert_eq!(within, [], "below a thousandth of the peak");
}

#[test]
fn a_step_that_hides_the_first_mode_is_warned_about() {
    // 0.526 s is the period of the first mode.
    let coarse = |step_s: f64| {
        let torque = super::torque(step_s, 40, |t| (PI * t / (40.0 * step_s)).sin());
        let link = bayo();
        let warnings = played(&link, &plan_of(&link, 10), &Play::of(&torque)).warnings;
        let of = |kind| warnings.iter().find(|w| w.kind() == kind).map(ToString::to_string);
        of("coarse_step")
    };
    assert_eq!(coarse(0.065), None, "8.1 steps");
    assert!(coarse(0.1).is_some(), "5.3 steps");
}

#[test]
fn a_link_bent_or_turned_beyond_the_linear_model_is_warned_about() {
    let told = |size: f64| {
        let found = warned(&bayo(), &torque(|x| size * x.sin()));
        match found[..] {
            [] => None,
            [SimulationWarning::InexactModel { tip, deflection }] => Some([tip, deflection]),
            _ => panic!("{found:?}"),
        }
    };
    assert_eq!(told(0.3), None);
    let [tip, deflection] = told(12.0).unwrap();
    assert!(tip > 1e-2 && deflection > 0.2, "{tip}, {deflection}");
}

fn reference(step_s: f64, first_s: f64, steps: u32) -> HubReference {
    let time_s: Vec<f64> = times(step_s, steps).iter().map(|t| first_s + t).collect();
    HubReference::new(&time_s, vec![0.0; time_s.len()], None).unwrap()
}

#[test]
fn gains_below_zero_and_such_as_are_no_numbers_are_refused() {
    for (kp, kd) in [(-1.5, 0.0), (0.0, -0.1), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        assert!(Feedback::new(kp, kd, reference(0.01, 0.0, 40)).is_err(), "{kp}, {kd}");
    }
    assert!(Feedback::new(0.0, 0.0, reference(0.01, 0.0, 40)).is_ok());
}

#[test]
fn a_reference_at_other_times_is_refused_with_both() {
    let torque = torque(f64::sin);
    let link = bayo();
    let played = |reference| {
        let feedback = Feedback::new(1.0, 0.1, reference).unwrap();
        let play = Play { feedback: std::slice::from_ref(&feedback), ..Play::of(&torque) };
        simulate(&link, &plan_of(&link, 5), &play).map(|found| found.grid.len)
    };
    let error = played(reference(0.02, 0.25, 20)).unwrap_err();
    assert!(matches!(error, SimulationError::OtherTimes { .. }));
    assert!(played(reference(0.01, 0.001, 40)).is_err(), "a tenth of a step late");
    assert_eq!(played(reference(0.01, 1e-7, 40)), Ok(41), "a file with few digits");
    assert!(played(reference(0.0101, 0.0, 40)).is_err(), "another end");
    assert!(played(reference(0.0101, -0.004, 40)).is_err(), "another start");
    assert!(played(reference(0.02, 0.0, 20)).is_err(), "half as many samples");
}

#[test]
fn a_reference_drives_the_link_if_a_gain_lets_it() {
    let rest = torque(|_| 0.0);
    let link = bayo();
    let played = |kp, kd| {
        let time_s = times(0.01, 40);
        let angle = time_s.iter().map(|t| 0.1 * (1.0 - (PI * t / 0.4).cos())).collect();
        let feedback = Feedback::new(kp, kd, HubReference::new(&time_s, angle, None).unwrap());
        let feedback = feedback.unwrap();
        let play = Play { feedback: std::slice::from_ref(&feedback), ..Play::of(&rest) };
        simulate(&link, &plan_of(&link, 5), &play)
            .map(|found| peak(&found.tip[0].displacement_m) > 0.0)
    };
    assert_eq!(played(0.0, 0.0), Err(SimulationError::NoTorque));
    assert_eq!([played(2.0, 0.0), played(0.0, 2.0), played(2.0, 2.0)], [const { Ok(true) }; 3]);
}
