//! What the tests of several files solve.

use super::{Analysis, Solution, invert};
use crate::beam::{ElementCount, MeshPlan};
use crate::link::{Damping, Link, LinkParts, uniform};
use crate::motion::{MotionColumns, TipMotion};

/// A motion of this many steps, smooth, so that its band is narrow where they are many.
pub(crate) fn solution(steps: u32) -> Solution {
    let damping = Damping::Hysteretic { ratio: 0.02 };
    let link = Link::new(LinkParts { damping, ..uniform() }).unwrap();
    let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(40)), 1e-4).unwrap();
    let share = |k: u32| (2.0 * f64::from(k) / f64::from(steps) - 1.0) * 6.0;
    let time_s = (0..=steps).map(|k| 1.2 * f64::from(k) / f64::from(steps)).collect();
    let bell = (0..=steps).map(|k| -share(k) * (-share(k).powi(2)).exp()).collect();
    let columns = MotionColumns { time_s, acceleration_m_s2: Some(bell), ..Default::default() };
    let motion = TipMotion::new(columns).unwrap();
    invert(&link, &plan, &motion, &Analysis::default()).unwrap()
}
