//! Solutions of links under gravity: their ends, what they say of their own errors, and laws.

use std::num::NonZeroUsize;

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::elastica::SecondOrder;
use flexlink::inverse::{Analysis, InversionError, Solution, Warning, invert};
use flexlink::link::{Damping, Drive, Gravity, Hub, Link, LinkParts, Segment};
use flexlink::motion::{Profile, TipMotion};

use super::arm;
use crate::common::{self, peak, plan_of};

const DOWN: [f64; 2] = [0.0, -9.81];

fn under(acceleration_m_s2: [f64; 2], start_angle_rad: f64, parts: LinkParts) -> LinkParts {
    LinkParts {
        gravity: Some(Gravity { acceleration_m_s2, start_angle_rad: Some(start_angle_rad) }),
        ..parts
    }
}

/// From -1.2 to 0.5 rad.
fn motion() -> TipMotion {
    Profile::Septic.motion(1.7 * 1.1, 1.2, 600).expect("a motion")
}

fn solved_with(parts: &LinkParts, analysis: &Analysis, elements: Option<usize>) -> Solution {
    let link = Link::new(parts.clone()).expect("a link");
    let count = elements.map(ElementCount::Total);
    let plan = MeshPlan::new(&link, &[None], count, 1e-6).expect("a plan");
    invert(&link, &plan, &motion(), analysis).expect("a solution")
}

fn solved(parts: &LinkParts) -> Solution {
    solved_with(parts, &Analysis::default(), None)
}

fn range(history: &[f64]) -> f64 {
    let largest = history.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest - history.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Largest difference of two histories at the same times.
fn apart(a: (&Solution, &[f64]), b: (&Solution, &[f64])) -> f64 {
    let shift = a.0.grid.first - b.0.grid.first;
    let at = |k: usize| {
        let other = i64::try_from(k).expect("few samples") + shift;
        usize::try_from(other).ok().and_then(|other| b.1.get(other))
    };
    let pairs = a.1.iter().enumerate().filter_map(|(k, a)| Some((a - at(k)?).abs()));
    pairs.fold(0.0, f64::max)
}

fn torque_apart(a: &Solution, b: &Solution) -> f64 {
    apart((a, &a.hub().torque_n_m), (b, &b.hub().torque_n_m)) / range(&b.hub().torque_n_m)
}

#[test]
fn a_link_that_hardly_bends_takes_the_torque_of_the_rigid_one() {
    let mut parts = under(DOWN, -1.2, arm());
    parts.segments[0] = Segment::uniform(1.1, 2e6, 0.5);
    let found = solved(&parts);
    let rigid = apart((&found, &found.hub().torque_n_m), (&found, &found.hub().rigid_torque_n_m));
    assert!(rigid < 1e-5 * range(&found.hub().torque_n_m), "{rigid:e}");
    // m g L/2 and the payload's weight, at both ends: closed form.
    let held = |angle: f64| 9.81 * (0.5 * 1.1 * 0.55 + 0.2 * 1.1) * f64::cos(angle);
    let ends = [found.hub().torque_n_m[0], *found.hub().torque_n_m.last().expect("samples")];
    for (torque, angle) in ends.into_iter().zip([-1.2, 0.5]) {
        assert!((torque / held(angle) - 1.0).abs() < 1e-5, "{torque} at {angle}");
    }
    let last_rad = found.hub().angle_rad.last().expect("samples");
    assert!((found.hub().angle_rad[0] + 1.2).abs() < 1e-5 && (last_rad - 0.5).abs() < 1e-5);
}

#[test]
fn a_turned_plane_takes_the_same_torques_and_turns_the_hub_angle() {
    let found = solved(&under(DOWN, -1.2, arm()));
    let (sine, cosine) = 2.1_f64.sin_cos();
    let turned = solved(&under([9.81 * sine, -9.81 * cosine], 0.9, arm()));
    assert!(torque_apart(&turned, &found) < 1e-9, "{:e}", torque_apart(&turned, &found));
    let turned_rad: Vec<f64> = turned.hub().angle_rad.iter().map(|angle| angle - 2.1).collect();
    assert!(apart((&turned, &turned_rad), (&found, &found.hub().angle_rad)) < 1e-9);
}

/// The stated errors of mesh and window against a solution on a far finer mesh, with a far tighter tolerance.
#[test]
fn stated_errors_are_those_against_a_finer_mesh_and_a_longer_period() {
    for damping in
        [Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 3e-4 }, Damping::Hysteretic { ratio: 0.02 }]
    {
        let parts = under(DOWN, -1.2, LinkParts { damping, ..arm() });
        let tight = Analysis::new(1e-8, None, None).expect("an analysis");
        let exact = solved_with(&parts, &tight, Some(48));
        let finer = range(&exact.hub().torque_n_m);
        for elements in [4, 8] {
            let found = solved_with(&parts, &Analysis::default(), Some(elements));
            assert!(found.warnings.is_empty(), "{:?}", found.warnings);
            let errors = &found.hub().errors;
            let torque =
                apart((&found, &found.hub().torque_n_m), (&exact, &exact.hub().torque_n_m)) / finer;
            let stated = |errors: &flexlink::inverse::QuantityErrors| {
                errors.mesh + errors.window + errors.iteration.expect("an iteration")
            };
            let said = stated(&errors.torque);
            assert!(torque < 1.3 * said, "{torque:e} of {said:e}");
            // Where the mesh is what counts, it is known.
            let share = torque / errors.torque.mesh;
            assert!(elements > 4 || (0.7..1.3).contains(&share), "{share}");
            let turn = apart((&found, &found.hub().angle_rad), (&exact, &exact.hub().angle_rad));
            let turn = turn / range(&exact.hub().angle_rad);
            let said = stated(&errors.hub_angle);
            assert!(turn < 1.3 * said, "{turn:e} of {said:e}");
        }
    }
}

/// A payload's inertia rings long after the motion: what is left is measured over a cycle, not where it may be 0.
#[test]
fn what_rings_at_the_ends_is_within_what_is_stated() {
    let mut parts = under(DOWN, 0.0, arm());
    parts.payload.inertia_kg_m2 = 0.02;
    parts.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1.4e-4 };
    let link = Link::new(parts).expect("a link");
    let plan = plan_of(&link, 8);
    let motion = Profile::Septic.motion(1.0, 1.2, 600).expect("a motion");
    let analysis = Analysis::new(1e-5, None, None).expect("an analysis");
    let found = invert(&link, &plan, &motion, &analysis).expect("a solution");
    let errors = &found.hub().errors;
    // About half a second at either end, several cycles of what rings.
    let ends = |history: &[f64]| {
        let (first, last) = (&history[..250], &history[history.len() - 250..]);
        let swing = |part: &[f64]| 0.5 * range(part);
        swing(first).max(swing(last)) / range(history)
    };
    let told = found.warnings.iter().any(|w| ["wrap_around", "inexact_window"].contains(&w.kind()));
    let rate = ends(&found.hub().rate_rad_s);
    assert!(rate < 3.0 * errors.hub_rate.window, "{rate:e} of {:e}", errors.hub_rate.window);
    let torque = ends(&found.hub().torque_n_m);
    assert!(torque < 3.0 * errors.torque.window, "{torque:e} of {:e}", errors.torque.window);
    assert!(told || errors.torque.window <= 1e-5, "{:?}", found.warnings);
}

#[test]
fn the_last_node_moves_as_the_tip_and_the_first_moment_is_the_roots() {
    let found = solved(&under(DOWN, -1.2, arm()));
    let last = found.links[0].mesh().nodes_m().len() - 1;
    let every = NonZeroUsize::MIN;
    let nodes = found.displacements(&[0, last], every).expect("nodes").histories();
    let tip = apart((&found, &nodes.samples[1]), (&found, &found.tip[0].displacement_m));
    assert!(tip < 1e-12, "{tip:e}");
    assert!(nodes.samples[0].iter().all(|root| root.abs() < 1e-15));
    let moments = found.moments(&[0, last], every).expect("nodes").histories();
    let root = apart((&found, &moments.samples[0]), (&found, &found.links[0].root_moment_n_m));
    assert!(root < 1e-12 * range(&found.links[0].root_moment_n_m), "{root:e}");
    // The payload has a small inertia of its own, but no offset.
    assert!(range(&moments.samples[1]) < 1e-2 * range(&moments.samples[0]));
    // The tip's deflection from the hub's tangent line, by two ways.
    let bent = found.deflections(&[last], every).expect("a node").histories();
    assert!(apart((&found, &bent.samples[0]), (&found, &found.tip_deflection_m(0))) < 1e-12);
    let turned = found.hub().angle_rad.iter().zip(&found.hub().rigid_angle_rad);
    let steepest = turned.map(|(hub, rigid)| (hub - rigid).abs()).fold(0.0, f64::max);
    let most = peak(&bent.samples[0]);
    assert!(most < 1.1 * steepest.sin() && most > 0.98 * 1.1 * steepest.sin(), "{most}");
}

#[test]
fn a_motor_follows_the_hub_and_holds_the_weight_behind_its_gear() {
    let drive = Drive {
        joint_stiffness_n_m_rad: 400.0,
        rotor_inertia_kg_m2: 1e-5,
        gear_ratio: 50.0,
        ..Drive::DIRECT
    };
    let found = solved(&under(DOWN, -1.2, LinkParts { drive: Some(drive), ..arm() }));
    let motor = found.hub().motor.as_ref().expect("a motor");
    for k in [0, found.grid.len - 1] {
        assert!((motor.torque_n_m[k] * 50.0 / found.hub().torque_n_m[k] - 1.0).abs() < 1e-5);
        let twisted = found.hub().angle_rad[k] + found.hub().torque_n_m[k] / 400.0;
        assert!((motor.angle_rad[k] / 50.0 - twisted).abs() < 1e-9);
    }
    assert!(found.hub().errors.motor_torque.is_some() && found.warnings.is_empty());
}

#[test]
fn no_gravity_in_the_plane_and_no_second_order_is_the_linear_link() {
    let (flat, plain) = (solved(&under([0.0; 2], -1.2, arm())), solved(&arm()));
    assert!(flat.hub().torque_n_m == plain.hub().torque_n_m && flat.second_order.is_none());
    let start = flat.hub().angle_rad[0] - plain.hub().angle_rad[0];
    assert!((start + 1.2).abs() < 1e-12, "{start}");
    // Without weight all terms change little of a link that bends little.
    let all = Analysis::default().with_second_order(SecondOrder::Full);
    let full = solved_with(&arm(), &all, None);
    let change = torque_apart(&full, &plain);
    assert!(change < 1e-2 && change > 1e-4, "{change:e}");
    let said = full.second_order.expect("second order").iteration.second_order_change;
    assert!((said / change - 1.0).abs() < 0.3, "{said:e}");
}

#[test]
fn terms_that_are_left_out_and_count_are_told() {
    let left_out = |level: SecondOrder, parts: &LinkParts| {
        let found = solved_with(parts, &Analysis::default().with_second_order(level), Some(8));
        found.warnings.iter().find_map(|found| match found.warning {
            Warning::SecondOrderLeftOut { share } => Some(share.expect("all terms converge")),
            _ => None,
        })
    };
    let soft = under(DOWN, -1.2, arm());
    let (none, first) = (left_out(SecondOrder::None, &soft), left_out(SecondOrder::First, &soft));
    assert!(none.expect("a warning") > first.unwrap_or(0.0) && none > Some(0.005));
    assert_eq!(left_out(SecondOrder::Full, &soft), None);
    let mut stiff = soft;
    stiff.segments[0] = Segment::uniform(1.1, 2e3, 0.5);
    assert_eq!(left_out(SecondOrder::None, &stiff), None);
}

/// A level link that sags by half a radian: high frequencies do not converge, and what leaving them out costs is told.
/// Without a hub the moment at the root, by equilibrium of the whole motion, is the torque, but for what is left out.
#[test]
fn a_link_that_bends_very_far_is_solved_without_the_terms_that_do_not_converge() {
    let motion = Profile::Septic.motion(0.5, 0.8, 400).expect("a motion");
    let off = |stiffness: f64| {
        let mut parts = under(DOWN, 0.0, LinkParts { hub: Hub::default(), ..arm() });
        parts.segments[0] = Segment::uniform(1.1, stiffness, 0.5);
        let link = Link::new(parts).expect("a link");
        let found = invert(&link, &plan_of(&link, 16), &motion, &Analysis::default());
        let found = found.expect("a solution");
        let off = common::apart(&found.hub().torque_n_m, &found.links[0].root_moment_n_m);
        let told = found.warnings.iter().any(|warning| warning.kind() == "inexact_iteration");
        let error = found.hub().errors.torque.iteration.expect("an iteration");
        (off / range(&found.hub().torque_n_m), error, told)
    };
    let (apart, error, told) = off(5.0);
    assert!(apart < 1e-6 && error < 1e-6 && !told, "{apart:e}, {error:e}");
    let (apart, error, told) = off(3.6);
    assert!(apart < error && apart > 0.05 * error && error < 1e-2, "{apart:e} of {error:e}");
    assert!(told);
}

#[test]
fn what_is_not_known_or_cannot_be_is_refused() {
    let refused = |parts: LinkParts| {
        let link = Link::new(parts).expect("a link");
        let found = invert(&link, &MeshPlan::automatic(&link), &motion(), &Analysis::default());
        found.err().expect("a refusal")
    };
    let gravity = Some(Gravity { acceleration_m_s2: DOWN, start_angle_rad: None });
    let error = refused(LinkParts { gravity, ..arm() });
    assert_eq!(error, InversionError::NoStartAngle);
    let alpha = Damping::Rayleigh { alpha_per_s: 1.0, beta_s: 0.0 };
    let error = refused(under(DOWN, 0.0, LinkParts { damping: alpha, ..arm() }));
    assert!(error.to_string().starts_with("the damping drags every mass"), "{error}");
    assert!(error.hint().is_some());
    let mut soft = under(DOWN, 0.0, arm());
    soft.segments[0] = Segment::uniform(1.1, 0.5, 0.5);
    let error = refused(soft);
    assert!(matches!(error, InversionError::Elastica(_)) && error.hint().is_some(), "{error}");
}
