//! The shortest motion within limits, against a scan over every number of steps.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod resolved;

use std::ops::Range;
use std::slice::from_ref;

use flexlink::inverse::{QuantityErrors, Solution, invert};
use flexlink::motion::{Course, Ends, Profile, TipMotion};
use flexlink::result::{
    Along, Fit, FitError, FitProblem, Limits, Metrics, OpenMotion, shortest_fit,
};
use flexlink::spec::{Override, Specification, read_specification};

/// The uniform link of 1.5 m, 5 N m², 0.8 kg/m on a hub of 0.1 kg m², on a fixed mesh.
const UNIFORM: &str = "
hub.inertia = 0.1
damping = { model = 'hysteretic', ratio = 0.02 }
mesh.elements = 10
[[segments]]
length = 1.5
EI = 5
mass_per_length = 0.8
";

fn link(settings: &[&str]) -> Specification {
    let overrides: Vec<Override> = settings.iter().map(|set| set.parse().unwrap()).collect();
    read_specification("link.toml", UNIFORM, &overrides).unwrap()
}

/// A move of open duration.
#[derive(Clone, Copy)]
struct Open {
    profile: Profile,
    distance_m: f64,
    step_s: f64,
}

fn open(profile: Profile, distance_m: f64, step_s: f64) -> Open {
    Open { profile, distance_m, step_s }
}

fn fitted(link: &Specification, limits: Limits, motion: Open) -> Result<Fit, FitError> {
    fitted_along(link, limits, motion, &Course::to(motion.distance_m))
}

fn fitted_along(
    link: &Specification,
    limits: Limits,
    Open { profile, step_s, .. }: Open,
    course: &Course,
) -> Result<Fit, FitError> {
    let (analysis, link, mesh) = (&link.analysis, link.link(), link.mesh());
    let (along, durations) = (Along::Arc(course), None);
    let motion = OpenMotion { law: &profile.into(), along, step_s, durations };
    let arm = &link.clone().into();
    let (plans, limits, memory_bytes) = (from_ref(mesh), from_ref(&limits), None);
    shortest_fit(&FitProblem { arm, plans, analysis, memory_bytes, limits, motion })
}

fn torque(limit_n_m: f64) -> Limits {
    Limits::new([("torque", limit_n_m)]).unwrap()
}

fn motor_torque(limit_n_m: f64) -> Limits {
    Limits::new([("motor_torque", limit_n_m)]).unwrap()
}

fn solved(link: &Specification, motion: Open, steps: usize) -> Option<Solution> {
    let (analysis, link, mesh) = (&link.analysis, link.link(), link.mesh());
    let Open { profile, distance_m, step_s } = motion;
    let motion = TipMotion::new(profile.sampled(distance_m, step_s, steps, [0, 0])).ok()?;
    invert(link, mesh, &motion, analysis).ok()
}

fn with_errors(value: f64, errors: QuantityErrors) -> f64 {
    value * (1.0 + errors.mesh + errors.window + errors.step.unwrap_or(0.0))
}

/// Peak torque at the hub in N m, its measured errors added.
fn hub_peak(solution: &Solution) -> f64 {
    with_errors(Metrics::of(solution).hub().peak_torque_n_m.value, solution.hub().errors.torque)
}

/// The same of the motor.
fn motor_peak(solution: &Solution) -> f64 {
    let motor = Metrics::of(solution).hub().motor.unwrap();
    with_errors(motor.peaks.peak_torque_n_m.value, solution.hub().errors.motor_torque.unwrap())
}

/// A peak of every number of steps from 4 on; none where it cannot be solved.
fn scan(
    link: &Specification,
    motion: Open,
    steps: Range<usize>,
    peak: fn(&Solution) -> f64,
) -> Vec<Option<f64>> {
    steps.map(|steps| solved(link, motion, steps).map(|solution| peak(&solution))).collect()
}

/// The first number of steps within a limit, by looking at all of them.
fn first_within(peaks: &[Option<f64>], limit: f64) -> usize {
    4 + peaks.iter().position(|peak| peak.is_some_and(|peak| peak <= limit)).unwrap()
}

/// What halving finds that begins with 32 steps and takes the torque to fall with the duration.
fn by_halving(peaks: &[Option<f64>], limit: f64) -> usize {
    let fits = |steps: usize| peaks[steps - 4].is_some_and(|peak| peak <= limit);
    let mut fitting = 32;
    while !fits(fitting) {
        fitting *= 2;
    }
    let mut too_fast = if fitting == 32 { 31 } else { fitting / 2 };
    while fitting - too_fast > 1 {
        let middle = usize::midpoint(fitting, too_fast);
        if fits(middle) { fitting = middle } else { too_fast = middle }
    }
    fitting
}

#[test]
fn fewer_than_32_steps_are_tried_down_to_the_profiles_own_4() {
    let motion = open(Profile::Septic, 0.5, 0.02);
    let link = link(&[]);
    let peaks = scan(&link, motion, 4..40, hub_peak);
    let limit = 1.001 * peaks[17 - 4].unwrap();
    assert_eq!(by_halving(&peaks, limit), 32, "0.64 s");
    let fit = fitted(&link, torque(limit), motion).unwrap();
    assert_eq!(fit.steps, first_within(&peaks, limit));
    assert_eq!((fit.steps, fit.is_shortest()), (17, true), "0.34 s");
    let fit = fitted(&link, torque(1e6), motion).unwrap();
    assert_eq!((fit.steps, fit.shorter_tried), (4, 0));
}

#[test]
fn where_the_torque_jumps_with_every_step_the_first_that_fits_is_found() {
    // Constant acceleration for a third of the time, which is a whole number of steps or is not.
    let motion = open(Profile::Trapezoid, 0.5, 0.005);
    let link = link(&[]);
    let peaks = scan(&link, motion, 4..68, hub_peak);
    let mut halving_misses = 0;
    for limit in [24.0, 19.0, 16.5, 13.0] {
        let fit = fitted(&link, torque(limit), motion).unwrap();
        assert_eq!(fit.steps, first_within(&peaks, limit), "{limit} N m");
        assert!(fit.is_shortest());
        halving_misses += usize::from(by_halving(&peaks, limit) != fit.steps);
    }
    assert!(halving_misses > 0, "these limits say nothing");
}

#[test]
fn where_the_tip_is_blocked_the_first_that_fits_is_found() {
    // A payload's inertia and next to no damping: a zero on the real frequency axis.
    let settings = ["payload.mass=0.3", "payload.inertia=0.05", "damping.ratio=0.002"];
    let link = link(&settings);
    let motion = open(Profile::BangBang, 0.5, 0.005);
    let peaks = scan(&link, motion, 4..68, hub_peak);
    let mut halving_misses = 0;
    for steps in [18, 38] {
        let limit = 1.001 * peaks[steps - 4].unwrap();
        let fit = fitted(&link, torque(limit), motion).unwrap();
        assert_eq!(fit.steps, first_within(&peaks, limit), "{limit} N m");
        halving_misses += usize::from(by_halving(&peaks, limit) != fit.steps);
    }
    assert!(halving_misses > 0, "these limits say nothing");
}

#[test]
fn with_modal_damping_and_an_automatic_mesh_the_shortest_is_found_too() {
    let link = link(&["damping.model='modal'", "mesh.elements='auto'"]);
    let motion = open(Profile::Septic, 0.5, 0.001);
    let fit = fitted(&link, torque(2.0), motion).unwrap();
    assert!(fit.is_shortest() && (620..=640).contains(&fit.steps), "{} steps", fit.steps);
    // Shorter ones are looked at on the mesh that the plan asks for, not on a coarser one.
    let shorter = fit.steps - 12..fit.steps;
    for (steps, peak) in shorter.clone().zip(scan(&link, motion, shorter, hub_peak)) {
        assert!(peak.is_none_or(|peak| peak > 2.0), "{steps} steps: {peak:?} N m");
    }
    assert!(hub_peak(&fit.solution) <= 2.0);
}

#[test]
fn a_mesh_too_coarse_to_skip_a_trial_skips_none_that_fits() {
    let link = link(&["mesh.elements='auto'"]);
    for (profile, limit) in [(Profile::Septic, 5.0), (Profile::BangBang, 20.0)] {
        let motion = open(profile, 0.5, 0.005);
        let peaks = scan(&link, motion, 4..132, hub_peak);
        let fit = fitted(&link, torque(limit), motion).unwrap();
        assert_eq!(fit.steps, first_within(&peaks, limit), "{profile}");
    }
}

#[test]
fn a_trial_that_cannot_be_solved_does_not_end_the_search() {
    // Finer than the finest mesh of which all modes are found, for the fastest motions.
    let link = link(&["damping.model='modal'", "mesh.elements='auto'", "mesh.tolerance=1e-8"]);
    let motion = open(Profile::Septic, 0.5, 0.02);
    let first_solved = (4..20).find(|steps| solved(&link, motion, *steps).is_some());
    let first_solved = first_solved.expect("some motion is solved");
    assert!(first_solved > 8, "4 and 8 steps, which are tried first, are solved, too");
    let fit = fitted(&link, torque(1e9), motion).unwrap();
    assert_eq!(fit.steps, first_solved);
}

#[test]
fn a_limit_of_the_motor_holds_for_the_motors_torque() {
    let settings = ["drive={joint_stiffness=1000, rotor_inertia='2 kg cm^2', gear_ratio=100}"];
    let link = link(&settings);
    let motion = open(Profile::Septic, 0.5, 0.01);
    let peaks = scan(&link, motion, 4..132, motor_peak);
    let limit = 0.4;
    let fit = fitted(&link, motor_torque(limit), motion).unwrap();
    assert_eq!(fit.steps, first_within(&peaks, limit));
    let binding = fit.binding.unwrap();
    assert_eq!(binding.value.key, "motor_torque");
    assert!((binding.share() - motor_peak(&fit.solution) / limit).abs() < 1e-12);
    // The hub's share of 40 N m is reached by far faster motions: the rotor's inertia, seen through
    // the gear, is twice the link's.
    let by_hub = fitted(&link, torque(100.0 * limit), motion).unwrap();
    assert!(by_hub.steps < fit.steps, "{} and {} steps", by_hub.steps, fit.steps);
}

#[test]
fn of_two_limits_the_one_that_binds_is_told() {
    let link = link(&[]);
    let motion = open(Profile::Septic, 0.5, 0.01);
    let both = |torque_n_m, deflection_m| {
        let limits = Limits::new([("torque", torque_n_m), ("deflection", deflection_m)]);
        fitted(&link, limits.unwrap(), motion).unwrap().binding.unwrap()
    };
    let [tight, loose] = [both(1.0, 10.0), both(100.0, 0.1)];
    assert_eq!((tight.value.key, loose.value.key), ("torque", "deflection"));
    assert!(tight.share() <= 1.0 && tight.share() > 0.9 && loose.share() <= 1.0);
}

#[test]
fn of_more_steps_than_are_all_tried_the_number_of_those_that_were_is_told() {
    let link = link(&[]);
    // Doubled: 4 · 2¹⁰ steps, of which a thousand are tried.
    let motion = open(Profile::Septic, 0.5, 0.0004);
    let fit = fitted(&link, torque(1.0), motion).unwrap();
    assert!(fit.steps > 2000 && !fit.is_shortest(), "{} steps", fit.steps);
    assert!((500..1100).contains(&fit.shorter_tried), "{} tried", fit.shorter_tried);
    let before = solved(&link, motion, fit.steps - 1).unwrap();
    assert!(hub_peak(&before) > 1.0 && hub_peak(&fit.solution) <= 1.0);
}

#[test]
fn limits_that_no_duration_keeps_are_refused_with_what_was_tried() {
    let motion = open(Profile::Septic, 0.5, 0.01);
    let Err(error) = fitted(&link(&[]), torque(1e-12), motion) else { panic!("fitted") };
    assert_eq!(error.to_string(), "no duration from 0.04 to 2621.44 s keeps the limits (17 tried)");
}

#[test]
fn the_shortest_cycle_within_a_torque_in_the_mean_is_found() {
    let link = link(&[]);
    let motion = open(Profile::MinJerk, 0.4, 0.02);
    let course = Course::to(0.4).there_and_back();
    let rest = Course::through(vec![0.4], 12).unwrap().there_and_back();
    let rms = |course: &Course, steps: usize| {
        let columns = course.sampled(&motion.profile.into(), motion.step_s, steps, [0, 0]).unwrap();
        let motion = TipMotion::with_ends(columns, Ends::Periodic).unwrap();
        let (analysis, link, mesh) = (&link.analysis, link.link(), link.mesh());
        let solution = invert(link, mesh, &motion, analysis).unwrap();
        let torque = &solution.hub().torque_n_m;
        let mean = torque.iter().map(|own| own * own).sum::<f64>() / torque.len() as f64;
        with_errors(mean.sqrt(), solution.hub().errors.torque)
    };
    let limit = 1.001 * rms(&course, 40);
    let limits = Limits::new([("rms_torque", limit)]).unwrap();
    let mut found = Vec::new();
    for course in [&course, &rest] {
        let fit = fitted_along(&link, limits, motion, course).unwrap();
        assert!(fit.is_shortest() && rms(course, fit.steps) <= limit);
        assert!((4..fit.steps).all(|steps| rms(course, steps) > limit), "{}", fit.steps);
        found.push(fit.steps);
    }
    // With rests between, the moves may be faster.
    assert!(found[1] < found[0] && found[0] <= 40, "{found:?}");
}
