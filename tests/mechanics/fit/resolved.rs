//! The shortest motion, solved again at an eighth of its step on a mesh four times as fine.

use flexlink::inverse::{Solution, invert};
use flexlink::motion::{Profile, TipMotion};
use flexlink::result::{Fit, Limits, Reached, reached};

use super::{Open, fitted, link, motor_torque, open, solved, torque};

/// A measured error tells about as much as the true one.
const TELLS: f64 = 1.5;

/// What is left at a fixed tip tolerance of 1e-6: the band of other samples ends elsewhere.
const OF_THE_BAND: f64 = 2e-5;

struct Case {
    name: &'static str,
    settings: &'static [&'static str],
    limits: Limits,
    profile: Profile,
}

/// A heavy payload with inertia: no torque moves the tip at one frequency.
const BLOCKED: &[&str] = &["payload.mass=0.3", "payload.inertia=0.05"];

const GEARED: &[&str] =
    &["drive={joint_stiffness=1000, rotor_inertia='2 kg cm^2', gear_ratio=100}"];

fn cases() -> [Case; 7] {
    let deflection = Limits::new([("deflection", 0.1)]).unwrap();
    let rate = Limits::new([("motor_rate", 80.0)]).unwrap();
    let case = |name, settings, limits, profile| Case { name, settings, limits, profile };
    [
        case("torque", &[], torque(2.0), Profile::Septic),
        case("deflection", &[], deflection, Profile::Sine),
        case("blocked tip", BLOCKED, torque(2.5), Profile::Septic),
        case("blocked tip, bell", BLOCKED, torque(3.0), Profile::Gaussian),
        case("motor torque", GEARED, motor_torque(0.4), Profile::Septic),
        case("motor rate", GEARED, rate, Profile::Septic),
        case("modal damping", &["damping.model='modal'"], torque(2.0), Profile::Septic),
    ]
}

/// The limited value that comes closest to its limit.
fn closest(limits: &Limits, solution: &Solution) -> Reached {
    let reached = reached(solution, &[*limits]).into_iter();
    reached.max_by(|a, b| a.share().total_cmp(&b.share())).unwrap()
}

/// What the samples of a motion say, at an eighth of the step and on elements a quarter as long.
fn finer(settings: &[&str], motion: Open, steps: usize) -> Solution {
    let settings = [settings, &["mesh.elements=40"]].concat();
    let own = link(&settings);
    let (analysis, link, mesh) = (own.analysis, own.link().clone(), own.mesh().clone());
    let Open { profile, distance_m, step_s } = motion;
    let mut motion = TipMotion::new(profile.sampled(distance_m, step_s, steps, [0, 0])).unwrap();
    for _ in 0..3 {
        motion = motion.twice_as_often().unwrap();
    }
    invert(&link, &mesh, &motion, &analysis).unwrap()
}

#[test]
fn the_shortest_motion_keeps_its_limit_when_solved_more_finely_and_no_shorter_one_does() {
    for Case { name, settings, limits, profile } in cases() {
        let link = link(settings);
        let motion = open(profile, 0.5, 0.01);
        let Fit { steps, solution, binding, .. } = fitted(&link, limits, motion).unwrap();
        let Reached { value, error } = binding.unwrap();
        let found = closest(&limits, &finer(settings, motion, steps)).value.found;
        let off = (found / value.found - 1.0).abs();
        assert!(off <= TELLS * error + OF_THE_BAND, "{name}: {off:.1e} off, {error:.1e} claimed");
        let most = value.limit * (1.0 + OF_THE_BAND);
        assert!(found <= most, "{name}: {found} beyond {}", value.limit);
        assert!(closest(&limits, &solution).share() <= 1.0, "{name}");
        for shorter in [steps - 1, steps - 2] {
            let share = solved(&link, motion, shorter).map(|s| closest(&limits, &s).share());
            assert!(share.is_none_or(|share| share > 1.0), "{name}: {shorter} steps, {share:?}");
            // Its error does not exclude it either.
            let found = closest(&limits, &finer(settings, motion, shorter)).value.found;
            assert!(found > value.limit * (1.0 - 2.0 * error), "{name}: {shorter} steps, {found}");
        }
    }
}
