//! Bayo's (1987) example played on links that are not quite its own: the torque of the nominal link,
//! hysteretic with ξ = 0.02, for the reconstructed motion (0.5 m in 0.88 s).
//!
//! The paper prints no such numbers. Those called "expected" below come from a study of the example
//! that was made before this program and rounded to one or two digits; where the program differs by
//! more than the rounding, the deviation is stated. Errors are in % of the travel.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use flexlink::beam::MeshPlan;
use flexlink::csv::read_motion_table;
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::Link;
use flexlink::modal::natural_frequencies;
use flexlink::motion::{TipMotion, TipTarget};
use flexlink::numeric::TimeGrid;
use flexlink::response::{Play, Played, Torque};
use flexlink::result::FollowedTarget;
use flexlink::spec::{Override, read_specification};

use super::{played, torque_of, whole_band};

const FIRST: &str = "bayo1987_example1.toml";
const SECOND: &str = "bayo1987_example2.toml";

/// The same ratio as a viscous one in every mode: a law that both directions have.
const VISCOUS: &str = "damping={ model = 'modal', ratios = [0.02] }";

/// When the motion ends, in s.
const END_S: f64 = 0.88;

fn text(folder: &str, name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join(name)).unwrap()
}

/// A link file of this repository with some `--set` applied.
fn example(file: &str, settings: &[&str]) -> (Link, MeshPlan) {
    let overrides: Vec<Override> = settings.iter().map(|set| set.parse().unwrap()).collect();
    let read = read_specification(file, &text("specs", file), &overrides).unwrap();
    (read.link().clone(), read.mesh().clone())
}

fn motion(link: &Link) -> TipMotion {
    let name = "sine_0.88s.csv";
    let text = text("trajectories", name);
    read_motion_table(name, text.as_bytes(), link.length_m())
        .unwrap()
        .into_motion()
        .unwrap()
        .into_tip()
        .unwrap()
}

fn solution(file: &str, settings: &[&str], analysis: &Analysis) -> Solution {
    let (link, plan) = example(file, settings);
    invert(&link, &plan, &motion(&link), analysis).unwrap()
}

/// Largest tip error of a simulation in % of the travel, until a time in s.
fn worst_percent(found: &Played, wanted: &Solution, until_s: f64) -> f64 {
    let all = 0..wanted.grid.len;
    let len = all.filter(|k| wanted.grid.time_s(*k) < until_s + 1e-9).count();
    let displacement_m = wanted.tip[0].displacement_m[..len].to_vec();
    let target = TipTarget::new(TimeGrid { len, ..wanted.grid }, displacement_m);
    // Of the whole travel, though the target may end before it does.
    100.0 * FollowedTarget::of(found, &(&target).into()).unwrap().tip_error.worst_m / 0.5
}

/// Largest tip error in % of the torque of the nominal link on one with some `--set` applied.
fn wrong_link_percent(damping: &[&str], set: &str) -> f64 {
    let wanted = solution(FIRST, damping, &whole_band(Analysis::default()));
    let (wrong, plan) = example(FIRST, &[damping, &[set]].concat());
    let found = played(&wrong, &plan, &Play::of(&torque_of(&wanted)));
    worst_percent(&found, &wanted, f64::INFINITY)
}

#[track_caller]
fn assert_percent(what: &str, found: f64, expected: f64) {
    // Half of the last digit given, and a little for the rounding of the number itself.
    assert!((found - expected).abs() <= 0.006, "{what}: {found:.4} %, not {expected} %");
}

/// The same law in both directions. A tenth stiffer or softer deviates from the expected 1.6 and
/// 2.1 by −0.09 and +0.11; the payloads' 11 and 20 are met.
#[test]
fn a_wrong_link_misses_by_its_own_error_under_the_same_law() {
    assert_percent("EI +10 %", wrong_link_percent(&[VISCOUS], "segments.*.EI*=1.1"), 1.51);
    assert_percent("EI -10 %", wrong_link_percent(&[VISCOUS], "segments.*.EI*=0.9"), 2.21);
    assert_percent("+0.05 kg", wrong_link_percent(&[VISCOUS], "payload.mass=0.05"), 11.03);
    assert_percent("+0.1 kg", wrong_link_percent(&[VISCOUS], "payload.mass=0.1"), 20.14);
}

/// The hysteretic torque, as the paper has it, brings its own 0.29 % along: it makes up for part of
/// a stiffer link's error and adds to a softer one's.
#[test]
fn a_wrong_link_misses_by_that_and_by_the_law_under_the_papers() {
    assert_percent("EI +10 %", wrong_link_percent(&[], "segments.*.EI*=1.1"), 1.42);
    assert_percent("EI -10 %", wrong_link_percent(&[], "segments.*.EI*=0.9"), 2.31);
    assert_percent("+0.05 kg", wrong_link_percent(&[], "payload.mass=0.05"), 11.10);
    assert_percent("+0.1 kg", wrong_link_percent(&[], "payload.mass=0.1"), 20.19);
}

/// The torque that a rigid link would need, on the flexible one.
fn rigid_torque(file: &str) -> (Solution, Played) {
    let wanted = solution(file, &[], &whole_band(Analysis::default()));
    let time_s: Vec<f64> = (0..wanted.grid.len).map(|k| wanted.grid.time_s(k)).collect();
    let torque = Torque::new(&time_s, wanted.hub().rigid_torque_n_m.clone()).unwrap();
    let (link, plan) = example(file, &[]);
    let found = played(&link, &plan, &Play { until_s: Some(5.5), ..Play::of(&torque) });
    (wanted, found)
}

/// Largest distance of the tip from its goal in % of the travel, over one period of the first mode
/// that begins at a time in s after the motion did.
fn oscillating_percent(found: &Played, from_s: f64) -> f64 {
    let period_s = TAU / natural_frequencies(found.mesh(), 1)[0];
    let samples = found.tip[0].displacement_m.iter().enumerate();
    let within = samples.filter(|(k, _)| {
        let t = found.grid.time_s(*k);
        (from_s..=from_s + period_s).contains(&t)
    });
    within.fold(0.0, |worst, (_, v)| worst.max(100.0 * (v - 0.5).abs() / 0.5))
}

/// Expected: 29 at worst. The paper says "after 4.5 sec … still oscillating heavily", for which 9
/// (EI = 5 N m²) and 0.4 (20 N m²) were expected at 4.5 s. Counted from the start of the motion these
/// are passed 0.7 s earlier, and 7.57 and 0.27 are left at 4.5 s: the deviation.
#[test]
fn a_rigid_links_torque_leaves_the_flexible_one_oscillating() {
    let (wanted, found) = rigid_torque(FIRST);
    assert_percent("worst", worst_percent(&found, &wanted, f64::INFINITY), 29.04);
    let (_, stiffer) = rigid_torque(SECOND);
    for (from_s, percent, stiffer_percent) in
        [(3.8, 9.14, 0.37), (4.0, 8.59, 0.34), (4.5, 7.57, 0.27)]
    {
        let what = format!("from {from_s} s");
        assert_percent(&what, oscillating_percent(&found, from_s), percent);
        assert_percent(&what, oscillating_percent(&stiffer, from_s), stiffer_percent);
    }
}

/// Torque cut away is an impulse lost: the tip drifts on, so that the error grows with the time that
/// is looked at. The expected 20, 5, 1.2 and 0.2 are met when that ends 1 s after the motion.
#[test]
fn a_lead_cut_short_costs_what_the_lost_impulse_does() {
    let rows = [
        (0.1, [10.43, 20.13, 44.88]),
        (0.2, [2.62, 5.14, 11.55]),
        (0.3, [0.69, 1.19, 2.68]),
        (0.4, [0.22, 0.22, 0.42]),
    ];
    for (lead_s, expected) in rows {
        let cut = whole_band(Analysis::new(1e-6, Some(lead_s), None).unwrap());
        let wanted = solution(FIRST, &[], &cut);
        let (link, plan) = example(FIRST, &[]);
        let found = played(&link, &plan, &Play::of(&torque_of(&wanted)));
        // During the motion, until 1 s after it, and on.
        for (until_s, expected) in [END_S, END_S + 1.0, 4.5].into_iter().zip(expected) {
            let what = format!("{lead_s} s of lead, until {until_s} s");
            assert_percent(&what, worst_percent(&found, &wanted, until_s), expected);
        }
    }
}
