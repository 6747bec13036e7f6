//! The inversion of arms from sampled paths: against an independent program, against rigid arms, and what it states.

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::elastica::SecondOrder;
use flexlink::inverse::{
    Analysis, InversionError, Resources, Solution, SolutionWarning, Warning, invert_motion,
};
use flexlink::link::{
    Arm, ArmLink, ArmParts, Damping, Elbow, Link, LinkParts, LumpedMass, Segment,
};
use flexlink::motion::{ArmPath, Motion, PathColumn, PathColumns, Profile, Recording};
use flexlink::response::{MovedJoint, Played, SimulationError, move_arm};

use super::prototype::{PROTOTYPE, bounds};
use super::two_links;
use crate::elastica::Turn;

pub(super) fn arm(parts: &[LinkParts], gravity_m_s2: [f64; 2]) -> Arm {
    let link = |parts: &LinkParts| Link::new(parts.clone()).expect("a link");
    let links = parts.iter().map(|parts| ArmLink { name: None, link: link(parts) }).collect();
    let elbow = Some(Elbow::Left);
    Arm::new(ArmParts { title: String::new(), links, gravity_m_s2, elbow, carriage: None })
        .expect("an arm")
}

pub(super) fn plans(arm: &Arm, count: ElementCount) -> Vec<MeshPlan> {
    let plan = |own: &ArmLink| {
        let each = vec![None; own.link.segments().len()];
        MeshPlan::new(&own.link, &each, Some(count), 1e-6).expect("a plan")
    };
    arm.links().iter().map(plan).collect()
}

/// Samples of a share that goes from 0 to 1 in a time, with half a second of rest on either side.
pub(super) fn sampled(duration_s: f64, steps_per_s: u32) -> (Vec<f64>, Vec<f64>) {
    let share = Turn { from_rad: 0.0, by_rad: 1.0, duration_s };
    let per_s = f64::from(steps_per_s);
    let rows = (0..u16::MAX).map(|k| f64::from(k) / per_s - 0.5);
    let time_s: Vec<f64> = rows.take_while(|t| *t < duration_s + 0.5 + 0.5 / per_s).collect();
    let shares = time_s.iter().map(|t| share.at(*t)[0]).collect();
    (time_s, shares)
}

pub(super) fn column(name: &str, shares: &[f64], from: f64, by: f64) -> PathColumn {
    let values = shares.iter().map(|share| from + by * share).collect();
    PathColumn { name: name.to_owned(), values, recording: Recording::default() }
}

pub(super) fn line(arm: &Arm, duration_s: f64) -> ArmPath {
    let (time_s, shares) = sampled(duration_s, 512);
    let tip = [column("x", &shares, 0.9, -0.4), column("y", &shares, -0.5, 1.3)];
    path(arm, PathColumns { time_s, tip: Some(tip), angles: vec![], carriage: None })
}

pub(super) fn path(arm: &Arm, columns: PathColumns) -> ArmPath {
    ArmPath::new(columns, &arm.lengths_m()).expect("a path")
}

pub(super) fn solved(
    arm: &Arm,
    path: &ArmPath,
    count: ElementCount,
    analysis: &Analysis,
) -> Solution {
    let motion = Motion::Path(path.clone());
    invert_motion(arm, &plans(arm, count), &motion, analysis, &Resources::default())
        .expect("a solution")
}

pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most: f64, value| if value.is_nan() { value } else { most.max(value.abs()) })
}

#[test]
fn a_motion_along_an_arc_is_of_one_link_and_a_path_of_several() {
    let two = arm(&two_links(), [0.0; 2]);
    let one = Arm::from(two.links()[0].link.clone());
    let arc = Motion::Tip(Profile::Septic.motion(0.3, 0.8, 200).expect("a motion"));
    let along = Motion::Path(line(&two, 1.0));
    let inverted = |arm: &Arm, motion: &Motion, count: usize| {
        let plans = vec![plans(&one, ElementCount::Total(4))[0].clone(); count];
        invert_motion(arm, &plans, motion, &Analysis::default(), &Resources::default()).err()
    };
    assert_eq!(inverted(&two, &arc, 2), Some(InversionError::OtherMotion { links: 2 }));
    assert_eq!(inverted(&one, &along, 1), Some(InversionError::OtherMotion { links: 1 }));
    assert_eq!(inverted(&one, &arc, 2), Some(InversionError::Plans { plans: 2, links: 1 }));
    assert_eq!(inverted(&one, &arc, 1), None);
}

#[test]
fn torques_and_angles_of_a_sampled_path_are_those_of_an_independent_program() {
    let exact =
        Analysis::new(1e-9, Some(0.0), Some(0.0)).and_then(|own| own.with_tip_tolerance(1e-11));
    let exact = exact.expect("an analysis");
    for expected in &PROTOTYPE {
        let arm = arm(&two_links(), expected.gravity_m_s2);
        let analysis = exact.with_second_order(expected.second_order);
        let found = solved(&arm, &line(&arm, 1.5), ElementCount::Total(6), &analysis);
        let [torque_bound, angle_bound] = bounds(expected.second_order);
        for joint in 0..2 {
            let range = expected.range_n_m[joint];
            for k in 0..9 {
                let sample = 128 * (k + 1);
                let own = &found.joints[joint];
                let off = (own.torque_n_m[sample] - expected.torque_n_m[joint][k]) / range;
                assert!(
                    off.abs() < torque_bound,
                    "{off:e} {joint} {k} {:?}",
                    expected.second_order
                );
                let off = own.angle_rad[sample] - expected.joint_angle_rad[joint][k];
                assert!(off.abs() < angle_bound, "{off:e} {joint} {k}");
                let off = found.shapes().nth(joint).unwrap().chord[0][sample]
                    - expected.chord_angle_rad[joint][k];
                assert!(off.abs() < angle_bound, "{off:e} {joint} {k}");
            }
        }
    }
}

/// The tip that the bent links lead to, their angles, rates and accelerations, and the errors that are stated.
#[test]
fn the_tip_follows_the_path_and_errors_are_measured() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let path = line(&arm, 1.5);
    let found = solved(&arm, &path, ElementCount::Auto, &Analysis::default());
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let share = Turn { from_rad: 0.0, by_rad: 1.0, duration_s: 1.5 };
    let [x, y] = [0, 1].map(|axis: usize| {
        let tip = &found.tip[axis];
        [&tip.displacement_m, &tip.velocity_m_s, &tip.acceleration_m_s2]
    });
    // What a cut-off leaves out of the tip, 1e-6 of its travel, counts with its frequency in rates and accelerations.
    for (order, bound) in [1.4e-6, 1e-4, 4e-3].into_iter().enumerate() {
        for k in 0..found.grid.len {
            let s = share.at(found.grid.time_s(k))[order];
            let rest = if order == 0 { [0.9, -0.5] } else { [0.0; 2] };
            let off = [x[order][k] - rest[0] + 0.4 * s, y[order][k] - rest[1] - 1.3 * s];
            let off = largest(off.into_iter());
            assert!(off < bound, "{off:e} of order {order} at {}", found.grid.time_s(k));
        }
    }
    let last = found.shapes().nth(1).unwrap().positions_m.last().expect("nodes");
    assert!(largest(last[0].iter().zip(x[0]).map(|(a, b)| a - b)) < 1e-9);
    assert!(found.tip_error < 1e-6 && found.tip_error > 1e-9, "{:e}", found.tip_error);
    let mesh = found.worst(|own| own.mesh);
    let finer = solved(&arm, &path, ElementCount::Total(64), &Analysis::default());
    for (own, fine) in found.joints.iter().zip(&finer.joints) {
        let range = largest(fine.torque_n_m.iter().copied());
        let pairs = own.torque_n_m.iter().zip(&fine.torque_n_m);
        let off = largest(pairs.map(|(a, b)| a - b)) / range;
        assert!(off < 4.0 * mesh + 1e-9, "{off:e} of stated {mesh:e}");
    }
    assert!(mesh < 1e-6 && found.worst(|own| own.window) < 1e-6);
}

/// Angles that joints are told and torques that the rigid arm takes: what stiff links do.
#[test]
fn stiff_links_are_the_rigid_arm() {
    let stiff = |mut parts: LinkParts| {
        parts.segments = parts
            .segments
            .into_iter()
            .map(|own| Segment {
                bending_stiffness_n_m2: own.bending_stiffness_n_m2.scaled(1e7),
                ..own
            })
            .collect();
        parts.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-9 };
        parts.hub.viscous_friction_n_m_s_rad = 0.4;
        parts
    };
    let three = [&two_links()[..], &two_links()[1..]].concat();
    let arm = arm(&three.into_iter().map(stiff).collect::<Vec<_>>(), [2.0, -9.0]);
    let (time_s, shares) = sampled(1.2, 512);
    let angle = |name, from, by| Some(column(name, &shares, from, by));
    let angles =
        vec![angle("angle1", -1.0, 1.6), angle("angle2", 0.4, 2.0), angle("angle3", 2.0, -1.0)];
    let path = path(&arm, PathColumns { time_s, tip: None, angles, carriage: None });
    let found = solved(&arm, &path, ElementCount::Total(4), &Analysis::default());
    for joint in &found.joints {
        let range = largest(joint.rigid_torque_n_m.iter().copied());
        let pairs = joint.torque_n_m.iter().zip(&joint.rigid_torque_n_m);
        let off = largest(pairs.map(|(a, b)| a - b)) / range;
        assert!(off < 1e-6 && range > 1.0, "{off:e} of {range} N m");
        let pairs = joint.angle_rad.iter().zip(&joint.rigid_angle_rad);
        assert!(largest(pairs.map(|(a, b)| a - b)) < 1e-6);
    }
}

#[test]
fn terms_that_are_left_out_and_an_elbow_nearly_stretched_are_told() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let first = Analysis::default().with_second_order(SecondOrder::First);
    let found = solved(&arm, &line(&arm, 1.5), ElementCount::Total(8), &first);
    let left_out = found.second_order.unwrap().left_out.flatten().expect("a share");
    assert!((1e-3..1e-2).contains(&left_out), "{left_out:e}");
    let (level, upright) = (self::arm(&two_links(), [0.0; 2]), &arm);
    let cases =
        [(upright, SecondOrder::First), (upright, SecondOrder::None), (&level, SecondOrder::None)];
    for (arm, order) in cases {
        let all = solved(arm, &line(arm, 1.5), ElementCount::Total(8), &Analysis::default());
        let analysis = Analysis::default().with_second_order(order);
        let own = solved(arm, &line(arm, 1.5), ElementCount::Total(8), &analysis);
        let later = own.grid.first - all.grid.first;
        let changed = own.joints.iter().zip(&all.joints).map(|(own, all)| {
            let at = |k: usize| {
                all.torque_n_m.get(usize::try_from(i64::try_from(k).ok()? + later).ok()?)
            };
            let torques = own.torque_n_m.iter().enumerate();
            let changes = torques.filter_map(|(k, torque)| Some(torque - at(k)?));
            let all = || all.torque_n_m.iter().copied();
            largest(changes) / (all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min))
        });
        let changed = changed.fold(0.0, f64::max);
        let told = own.second_order.unwrap().left_out.flatten().expect("a share");
        assert!((told / changed - 1.0).abs() < 0.05, "{told:e} is told, {changed:e} is changed");
    }
    assert_eq!(found.warnings.len(), 1, "{:?}", found.warnings);
    let (time_s, shares) = sampled(1.5, 512);
    let tip = [column("x", &shares, 0.9, 0.397), column("y", &shares, 0.0, 0.0)];
    let stretching =
        path(&arm, PathColumns { time_s, tip: Some(tip), angles: vec![], carriage: None });
    let slow = solved(&arm, &stretching, ElementCount::Total(8), &first);
    let stretched =
        |warning: &SolutionWarning| matches!(warning.warning, Warning::NearlyStretched { .. });
    assert!(slow.warnings.iter().any(stretched), "{:?}", slow.warnings);
}

pub(super) fn moved(found: &Solution) -> Result<Played, SimulationError> {
    let highest = std::f64::consts::TAU * found.band.cutoff_hz.expect("a cut-off");
    let joints = found.joints.iter().map(|joint| MovedJoint {
        angle_rad: joint.angle_rad[0],
        rate_rad_s: joint.rate_rad_s[0],
        accelerations_rad_s2: joint.acceleration_rad_s2.as_ref().expect("an acceleration"),
    });
    let joints: Vec<MovedJoint<'_>> = joints.collect();
    move_arm(&found.arm, &joints, &found.grid, (highest, 1e-7), false)
}

/// Lagrange's equations of the same arm, which know nothing of the inversion, its chords or its mesh: moved by the joint
/// angles that were found, the tip follows the path, with the torques that were found, and no energy is lost.
#[test]
fn joints_moved_as_found_lead_the_tip_along_its_path() {
    let loaded = |parts: [LinkParts; 2]| {
        parts.map(|mut parts| {
            parts.hub.radius_m = 0.05;
            parts.hub.viscous_friction_n_m_s_rad = 0.2;
            parts.payload.inertia_kg_m2 = 1e-4;
            parts.payload.offset_m = 0.03;
            let at_m = parts.hub.radius_m + 0.3;
            parts.masses = vec![LumpedMass { at_m, mass_kg: 0.2, inertia_kg_m2: 1e-4 }];
            parts
        })
    };
    for (parts, gravity) in
        [(two_links(), [0.0, -9.81]), (two_links(), [0.0; 2]), (loaded(two_links()), [-3.0, -9.0])]
    {
        let arm = arm(&parts, gravity);
        let found = solved(&arm, &line(&arm, 1.5), ElementCount::Auto, &Analysis::default());
        let played = moved(&found).expect("a motion");
        let pairs = |axis: usize| {
            found.tip[axis].displacement_m.iter().zip(&played.tip[axis].displacement_m)
        };
        let off =
            [0, 1].map(|axis| largest(pairs(axis).map(|(a, b)| a - b)) / found.tip_travel_m());
        assert!(largest(off.into_iter()) < 1e-6, "{off:?}, {:e}", played.change()[0]);
        for (joint, own) in found.joints.iter().zip(&played.joints) {
            let torque = &own.torque_n_m;
            let range = largest(torque.iter().copied());
            let off = largest(joint.torque_n_m.iter().zip(torque).map(|(a, b)| a - b)) / range;
            assert!(off < 2e-5, "{off:e}");
        }
        let bent = played.bent().expect("bent links");
        let energy_j = |k: usize| bent.kinetic_j[k] + bent.potential_j[k];
        let size = largest(bent.work_j.iter().copied());
        for k in 0..found.grid.len {
            let held = energy_j(k) - energy_j(0);
            let off = (bent.work_j[k] - held - bent.lost_j[k]) / size;
            assert!(off.abs() < 1e-6, "{off:e} at {k}");
        }
    }
}

#[test]
fn hysteretic_links_are_moved_by_no_equation_in_time() {
    let mut parts = two_links();
    parts[1].damping = Damping::Hysteretic { ratio: 0.02 };
    let arm = arm(&parts, [0.0; 2]);
    let found = solved(&arm, &line(&arm, 1.5), ElementCount::Total(4), &Analysis::default());
    let refused = moved(&found).err().map(|error| error.to_string());
    assert!(refused.is_some_and(|text| text.starts_with("the damping of a link is neither")));
}
