//! The shape of an arm at rest in a pose.

use nalgebra::DVector;

use super::balance::{Balance, Place};
use super::linkage::Linkage;
use super::shape::{direction, in_parts, settled};
use crate::elastica::reaching;
use crate::link::{Arm, Elbow};

/// Start of an arm at rest.
#[derive(Debug, Clone, Copy)]
pub enum Start<'a> {
    /// Its joints at these angles in rad, from the tip of the link before to each link's root.
    Joints(&'a [f64]),
    /// The chords of its links in these directions in rad against x.
    Chords(&'a [f64]),
    /// The tip of an arm at x and y in m, its elbow on the side that the arm states.
    Tip {
        /// x and y.
        at_m: [f64; 2],
        /// Directions in rad of the chords from the third on.
        outer_rad: &'a [f64],
    },
}

/// Coordinates of an arm at rest, iterated from unbent links. `None` without a shape at rest.
pub(super) fn at_rest(arm: &Arm, chain: &Linkage, start: Start<'_>) -> Option<Vec<f64>> {
    let angles_rad = match start {
        Start::Joints(joints_rad) => joints_rad.to_vec(),
        Start::Chords(chords_rad) => against_each_other(chords_rad),
        Start::Tip { at_m, outer_rad } => against_each_other(&reached(arm, at_m, outer_rad)?),
    };
    let mut straight = vec![0.0; chain.count];
    for (joint, angle_rad) in chain.joints.iter().zip(&angles_rad) {
        straight[*joint] = *angle_rad;
    }
    let rest = vec![0.0; chain.count];
    in_parts(&straight, |share, q| {
        let (chain, mut balance) = (chain.weighing(share), Balance::default());
        settled(q, |q: &[f64]| {
            chain.balance(q, &rest, &mut balance);
            let mut left = DVector::from_column_slice(&balance.force);
            let ends = chain.walk(q, &rest, |_, _| {});
            let away = away(arm, (&ends, start));
            for (number, (joint, angle_rad)) in chain.joints.iter().zip(&angles_rad).enumerate() {
                let held = || angle_rad - q[*joint];
                left[*joint] = away.as_ref().map_or_else(held, |away| away[number]);
            }
            left
        })
    })
}

/// Distance of chords from their directions in rad, or of the tip from its place over the arm's length. `None` for held
/// joints.
fn away(arm: &Arm, (ends, start): (&[Place], Start<'_>)) -> Option<Vec<f64>> {
    let mut from_m = [0.0; 2];
    let mut across = |(end, angle_rad): (&Place, Option<&f64>)| {
        let along_m = [0, 1].map(|axis| end.at_m[axis] - from_m[axis]);
        from_m = end.at_m;
        angle_rad.map(|angle_rad| direction(along_m, *angle_rad) - angle_rad)
    };
    match start {
        Start::Joints(_) => None,
        Start::Chords(chords_rad) => {
            ends.iter().zip(chords_rad.iter().map(Some)).map(across).collect()
        }
        Start::Tip { at_m, outer_rad } => {
            let tip_m = ends.last().map_or([0.0; 2], |end| end.at_m);
            let of = |axis: usize| (tip_m[axis] - at_m[axis]) / arm.length_m();
            let outer = [None, None].into_iter().chain(outer_rad.iter().map(Some));
            let outer: Vec<f64> = ends.iter().zip(outer).filter_map(&mut across).collect();
            Some([&[of(0), of(1)], &outer[..]].concat())
        }
    }
}

/// Angles of joints from directions of links.
fn against_each_other(chords_rad: &[f64]) -> Vec<f64> {
    let before = std::iter::once(&0.0).chain(chords_rad);
    chords_rad.iter().zip(before).map(|(own, before)| own - before).collect()
}

/// Directions of the unbent links that reach a place.
fn reached(arm: &Arm, at_m: [f64; 2], outer_rad: &[f64]) -> Option<Vec<f64>> {
    let lengths_m = arm.lengths_m();
    if lengths_m.len() != outer_rad.len() + 2 {
        return None;
    }
    let is_left = arm.elbow()? == Elbow::Left;
    let outer: Vec<_> =
        outer_rad.iter().map(|angle_rad| [vec![*angle_rad], vec![0.0], vec![0.0]]).collect();
    let chords = reaching(&[[at_m, [0.0; 2], [0.0; 2]]], &lengths_m, &outer, is_left).ok()?;
    Some(chords.iter().map(|chord| chord[0][0]).collect())
}
