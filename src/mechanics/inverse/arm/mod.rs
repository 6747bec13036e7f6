//! From the path of an arm's tip, or the directions of its chords, to the torques of all joints.
//!
//! The chords lie along the links of a rigid arm. The solver takes each link on its chord, from the last one inward
//! ([`elastica`](crate::elastica)). Period, padding, mesh, window and errors follow the rules of one link, for all
//! joints at once.

mod answer;
mod evidence;
mod problem;
mod solve;
mod window;

pub use problem::check_reach;
pub(super) use problem::{ArmProblem, BYTES};
pub(super) use solve::{Solver, diverged, invert_arm};
