//! Cycles of arms that repeat: against one move alone, and against Lagrange's equations in their steady state.

use std::f64::consts::TAU;

use flexlink::beam::ElementCount;
use flexlink::inverse::{Analysis, InversionError, RefusedEnds, Resources, invert_motion};
use flexlink::motion::{ArmPath, Ends, Motion, PathColumns};
use flexlink::response::{MovedJoint, move_arm};

use super::inversion::{arm, column, largest, plans, solved};
use super::two_links;
use crate::elastica::Turn;

const STEPS_PER_S: u32 = 256;

/// Share of a move that starts after 1.25 s and comes back after 3.5 s, each within a second, at the rows of 5 s.
fn there_and_back(rows: u32) -> (Vec<f64>, Vec<f64>) {
    let turn = Turn { from_rad: 0.0, by_rad: 1.0, duration_s: 1.0 };
    let time_s: Vec<f64> = (0..rows).map(|k| f64::from(k) / f64::from(STEPS_PER_S)).collect();
    let share = |t: &f64| turn.at(t - 1.25)[0] - turn.at(t - 3.5)[0];
    let shares = time_s.iter().map(share).collect();
    (time_s, shares)
}

/// The move there and back of two links, prescribed by the tip or by both angles.
fn path(by_tip: bool, ends: Ends) -> ArmPath {
    let rows = 5 * STEPS_PER_S + u32::from(ends == Ends::AtRest);
    let (time_s, shares) = there_and_back(rows);
    let turns = [("angle1", -1.0, 0.9), ("angle2", 0.2, 0.6)];
    let angles = turns.map(|(name, from, by)| Some(column(name, &shares, from, by))).into();
    let columns = if by_tip {
        let tip = [column("x", &shares, 0.9, -0.4), column("y", &shares, -0.5, 0.9)];
        PathColumns { time_s, tip: Some(tip), angles: vec![], carriage: None }
    } else {
        PathColumns { time_s, tip: None, angles, carriage: None }
    };
    let lengths_m = arm(&two_links(), [0.0; 2]).lengths_m();
    ArmPath::with_ends(columns, &lengths_m, ends).expect("a path")
}

/// A cycle with long rests takes the torques of its move alone, which another period and the chords' return solve.
#[test]
fn a_cycle_of_moves_and_rests_takes_the_torques_of_the_move_alone() {
    for by_tip in [true, false] {
        let arm = arm(&two_links(), [0.0, -9.81]);
        let solve = |ends| {
            let path = path(by_tip, ends);
            // The cut-offs of both motions differ. The bound is the tolerance of the analysis.
            let analysis = Analysis::default().with_tip_tolerance(1e-9).expect("a tolerance");
            solved(&arm, &path, ElementCount::Total(4), &analysis)
        };
        let (alone, cycle) = (solve(Ends::AtRest), solve(Ends::Periodic));
        assert_eq!((cycle.grid.first, cycle.grid.len), (0, 5 * 256));
        let before = usize::try_from(-alone.grid.first).expect("a lead");
        for (own, expected) in cycle.joints.iter().zip(&alone.joints) {
            for (own, expected) in [
                (&own.torque_n_m, &expected.torque_n_m),
                (&own.angle_rad, &expected.angle_rad),
                (&own.rate_rad_s, &expected.rate_rad_s),
            ] {
                let size = largest(expected.iter().copied());
                let pairs = own.iter().zip(&expected[before..]);
                let off = largest(pairs.map(|(a, b)| a - b)) / size;
                assert!(off < 1e-6, "tip {by_tip}: {off:e}");
            }
        }
    }
}

/// A tip that goes around the first joint, which turns by a whole turn in each cycle. Lagrange's equations, moved by the
/// joint angles cycle after cycle until they repeat, lead the tip along the circle with the torques of the solution.
#[test]
fn a_tip_goes_around_the_first_joint_cycle_after_cycle() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let (time_s, turned): (Vec<f64>, Vec<f64>) =
        (0..200_u32).map(|k| (0.01 * f64::from(k), TAU * f64::from(k) / 200.0)).unzip();
    let [x, y]: [Vec<f64>; 2] =
        [f64::cos, f64::sin].map(|of| turned.iter().map(|a| of(*a)).collect());
    let tip = [column("x", &x, 0.05, 0.9), column("y", &y, 0.0, 0.9)];
    let columns = PathColumns { time_s, tip: Some(tip), angles: vec![], carriage: None };
    let path = ArmPath::with_ends(columns, &arm.lengths_m(), Ends::Periodic).expect("a path");
    let found = solved(&arm, &path, ElementCount::Total(8), &Analysis::default());
    let angle = &found.joints[0].angle_rad;
    let turn = angle[199] + (angle[1] - angle[0]) - angle[0];
    assert!((turn / TAU - 1.0).abs() < 1e-3, "{turn}");
    let joints = found.joints.iter().map(|joint| MovedJoint {
        angle_rad: joint.angle_rad[0],
        rate_rad_s: joint.rate_rad_s[0],
        accelerations_rad_s2: joint.acceleration_rad_s2.as_ref().expect("an acceleration"),
    });
    let joints: Vec<MovedJoint<'_>> = joints.collect();
    let played = move_arm(&arm, &joints, &found.grid, (TAU * 20.0, 1e-7), true).expect("a motion");
    for (axis, wanted) in [&x, &y].into_iter().enumerate() {
        let from = [0.05, 0.0][axis];
        let pairs = played.tip[axis].displacement_m.iter().zip(wanted);
        let off = largest(pairs.map(|(a, share)| a - (from + 0.9 * share))) / found.tip_travel_m();
        assert!(off < 1e-6, "{off:e}");
    }
    for (own, played) in found.joints.iter().zip(&played.joints) {
        let off = largest(own.angle_rad.iter().zip(&played.angle_rad).map(|(a, b)| a - b));
        assert!(off < 1e-6, "{off:e} rad");
        let size = largest(played.torque_n_m.iter().copied());
        let off = largest(own.torque_n_m.iter().zip(&played.torque_n_m).map(|(a, b)| a - b)) / size;
        assert!(off < 2e-6, "{off:e}");
    }
    let bent = played.bent().expect("bent links");
    let energy_j = |k: usize| bent.kinetic_j[k] + bent.potential_j[k];
    let size = largest(bent.work_j.iter().copied());
    for k in 0..200 {
        let off = (bent.work_j[k] - (energy_j(k) - energy_j(0)) - bent.lost_j[k]) / size;
        assert!(off.abs() < 1e-6, "{off:e} at {k}");
    }
}

#[test]
fn ends_that_move_and_leads_of_cycles_are_refused() {
    let arm = arm(&two_links(), [0.0; 2]);
    let plans = plans(&arm, ElementCount::Total(4));
    let refused = |path: ArmPath, analysis: &Analysis| {
        let motion = Motion::Path(path);
        invert_motion(&arm, &plans, &motion, analysis, &Resources::default())
            .err()
            .expect("a refusal")
    };
    let moving = refused(path(false, Ends::Moving), &Analysis::default());
    assert!(matches!(moving, InversionError::Ends(RefusedEnds::Bent)), "{moving}");
    let led = Analysis::new(1e-6, Some(0.5), None).expect("a lead");
    let refusal = refused(path(true, Ends::Periodic), &led);
    assert!(matches!(refusal, InversionError::Ends(RefusedEnds::Edges)), "{refusal}");
}
