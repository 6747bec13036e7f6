//! The discretisation error: what is reported is what it is.

use super::{
    Smooth, accelerated, link, peak, plan_of, sine, solved, torque_difference, whole_band,
};
use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::{Damping, Link, LumpedMass, Segment, Taper};
use flexlink::modal::torque_zeros;
use flexlink::motion::TipMotion;

fn automatic(link: &Link, motion: &TipMotion, tolerance: f64) -> Solution {
    let own = vec![None; link.segments().len()];
    let plan = MeshPlan::new(link, &own, Some(ElementCount::Auto), tolerance).unwrap();
    invert(link, &plan, motion, &whole_band(Analysis::default())).unwrap()
}

/// A tapered link of two segments with a lumped mass.
fn tapered() -> Link {
    link(|parts| {
        let taper = Segment {
            bending_stiffness_n_m2: Taper { inner: 5.0, outer: 2.0 },
            mass_per_length_kg_m: Taper { inner: 0.8, outer: 0.5 },
            ..Segment::uniform(0.7, 1.0, 1.0)
        };
        parts.segments[0].length_m = 0.8;
        parts.segments.push(taper);
        parts.masses.push(LumpedMass { at_m: 1.0, mass_kg: 0.05, inertia_kg_m2: 1e-4 });
    })
}

/// Reported over true error, the latter against a mesh of eight times as many elements.
fn reported_over_true(solution: &Solution, link: &Link, motion: &TipMotion) -> f64 {
    let finer = solved(link, 8 * solution.links[0].mesh().elements().len(), motion);
    solution.hub().errors.torque.mesh / torque_difference(solution, &finer, 0)
}

#[test]
fn the_reported_error_of_a_given_mesh_is_the_true_one() {
    for link in [link(|_| ()), tapered()] {
        let motion = Smooth { duration_s: 0.5, steps: 500, ..Smooth::MOVE }.motion();
        for elements in [6, 12, 24] {
            let solution = solved(&link, elements, &motion);
            let ratio = reported_over_true(&solution, &link, &motion);
            assert!((0.5..2.0).contains(&ratio), "{elements} elements: {ratio}");
        }
    }
}

/// Far above the highest mode of a coarse mesh nothing reaches the tip, and the torque there is of any
/// size, or infinite. The round-off of a file's digits is in the band up to the Nyquist frequency.
#[test]
fn an_automatic_mesh_begins_too_coarse_for_its_band() {
    let link = link(|parts| {
        parts.segments[0].length_m = 10.0;
        parts.damping = Damping::Hysteretic { ratio: 0.02 };
    });
    for steps in [14_000, 15_000, 21_000] {
        let slow = Smooth { travel_m: 3.0, duration_s: 21.0, steps, ..Smooth::MOVE };
        let written = slow.acceleration_m_s2().iter().map(|a| (a * 1e12).round() / 1e12).collect();
        let solution = automatic(&link, &accelerated(slow.time_s(), written), 1e-6);
        assert!(solution.hub().errors.torque.mesh < 1e-6);
        assert!(peak(&solution.hub().torque_n_m) < 1.0);
    }
}

#[test]
fn an_automatic_mesh_is_refined_below_its_tolerance_and_no_further() {
    for link in [link(|_| ()), tapered()] {
        let motion = Smooth { duration_s: 0.5, steps: 500, ..Smooth::MOVE }.motion();
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let solution = automatic(&link, &motion, tolerance);
            let worst = |solution: &Solution| solution.hub().errors.of_kind(|e| e.mesh).worst().1;
            let error = worst(&solution);
            assert!(error <= tolerance, "{error:e} for {tolerance:e}");
            let elements = solution.links[0].mesh().elements().len();
            if elements > 8 {
                let coarser = worst(&solved(&link, elements / 2, &motion));
                assert!(coarser > tolerance, "half of {elements} elements would do: {coarser:e}");
            }
            if error > 1e-5 {
                let ratio = reported_over_true(&solution, &link, &motion);
                assert!((0.5..2.0).contains(&ratio), "{elements} elements: {ratio}");
            }
        }
    }
}

#[test]
fn the_error_falls_with_the_fourth_power_of_the_element_length() {
    let link = link(|_| ());
    let motion = Smooth { duration_s: 0.5, steps: 500, ..Smooth::MOVE }.motion();
    let errors = [16, 32, 64].map(|n| solved(&link, n, &motion).hub().errors.torque.mesh);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.9..4.1).contains(&order), "{errors:?}");
    }
}

#[test]
fn a_motion_with_kinks_needs_more_elements_than_a_smooth_one() {
    let link = link(|_| ());
    let smooth = automatic(&link, &Smooth::MOVE.motion(), 1e-4).links[0].mesh().elements().len();
    let kinked = automatic(&link, &sine(0.5, 1.0, 256), 1e-4).links[0].mesh().elements().len();
    assert!(smooth < kinked, "{smooth} and {kinked}");
    let plan = plan_of(&link, kinked);
    assert!(!plan.is_automatic());
}

#[test]
fn a_mesh_that_was_chosen_may_be_finer_than_any_automatic_one() {
    let link = link(|_| ());
    let solution = solved(&link, 5000, &Smooth { steps: 32, ..Smooth::MOVE }.motion());
    assert_eq!(solution.links[0].mesh().elements().len(), 5000);
    assert!(solution.hub().errors.torque.mesh < 1e-9, "{:e}", solution.hub().errors.torque.mesh);
}

#[test]
fn the_zero_that_is_reported_is_that_of_the_refined_mesh() {
    let (link, motion) =
        (tapered(), Smooth { duration_s: 0.3, steps: 300, ..Smooth::SHORT }.motion());
    let solution = automatic(&link, &motion, 1e-7);
    assert!(solution.links[0].mesh().elements().len() > 16, "not refined");
    assert_eq!(
        solution.first_zero_per_s,
        torque_zeros(solution.links[0].mesh(), 1).first().copied()
    );
    let coarse = solved(&link, 8, &motion);
    assert_ne!(coarse.first_zero_per_s, solution.first_zero_per_s);
}

/// 16/15 of what halved elements change, over the peak of the torque on these: also where that is
/// much.
#[test]
fn the_reported_error_is_that_of_the_series_in_the_fourth_power_over_the_better_torque() {
    let link = link(|parts| parts.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 });
    let rested = Smooth { duration_s: 0.5, rest: [512, 511], ..Smooth::SHORT }.motion();
    let [coarse, fine] = [2, 4].map(|elements| solved(&link, elements, &rested));
    let change = torque_difference(&fine, &coarse, 0);
    assert!(change > 0.01, "{change}");
    let expected = 16.0 / 15.0 * change;
    let found = coarse.hub().errors.torque.mesh;
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} is not {expected}");
}

/// Elements half as long err by a sixteenth: fifteen sixteenths of the error are the change, which
/// is told over the peak of the better torque.
#[test]
fn the_reported_error_is_sixteen_fifteenths_of_what_halved_elements_change() {
    let link = link(|_| ());
    let motion = Smooth { duration_s: 0.5, steps: 500, ..Smooth::MOVE }.motion();
    for elements in [2, 3, 5] {
        let (coarse, fine) =
            (solved(&link, elements, &motion), solved(&link, 2 * elements, &motion));
        let expected = 16.0 / 15.0 * torque_difference(&fine, &coarse, 0);
        let off = coarse.hub().errors.torque.mesh / expected - 1.0;
        assert!(off.abs() < 2e-3, "{elements} elements: {off:e} of {expected}");
    }
}
