//! What `simulate` promises: torque in, motion out, against closed forms, an independent integrator,
//! the inversion and published numbers.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod after;
mod channels;
mod cycle;
mod feedback;
mod free;
mod held;
mod large;
mod modes;
mod newmark;
mod play_error;
mod refusals;
mod replay;
mod robustness;
mod round_trip;
mod state;

use flexlink::beam::MeshPlan;
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment};
use flexlink::motion::TipMotion;
use flexlink::response::{Play, Played, SimulationError, Torque};

use super::common::{Smooth, difference, peak, plan_of, sine, whole_band};
use super::dense::{assembly, damping};

/// Bayo's link, undamped: 1.5 m with a stiff root, its rigid inertia 1 kg m².
fn bayo() -> LinkParts {
    let segment = |length_m, stiffness| Segment::uniform(length_m, stiffness, 0.8);
    LinkParts {
        segments: vec![segment(0.15, 50.0), segment(1.35, 5.0)],
        hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
        ..LinkParts::default()
    }
}

/// That link with some of its parts changed.
fn link(change: impl FnOnce(&mut LinkParts)) -> Link {
    let mut parts = bayo();
    change(&mut parts);
    Link::new(parts).unwrap()
}

/// A link with all that a link can have. Rotary inertia away from the hub puts a zero of
/// torque → tip on the real frequency axis: an undamped link cannot be inverted there.
fn loaded(damping: Damping) -> Link {
    let turns = if damping == Damping::None { 0.0 } else { 1.0 };
    link(|parts| {
        parts.hub = Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.05 };
        parts.masses = vec![LumpedMass { at_m: 0.8, mass_kg: 0.2, inertia_kg_m2: 1e-3 * turns }];
        parts.payload =
            Payload { mass_kg: 0.1, inertia_kg_m2: 2e-4 * turns, offset_m: 0.02 * turns };
        parts.damping = damping;
    })
}

/// Times from 0 on, one more than there are steps.
fn times(step_s: f64, steps: u32) -> Vec<f64> {
    (0..=steps).map(|k| step_s * f64::from(k)).collect()
}

fn solved(link: &Link, plan: &MeshPlan, motion: &TipMotion, tolerance: f64) -> Solution {
    invert(link, plan, motion, &whole_band(Analysis::new(tolerance, None, None).unwrap())).unwrap()
}

/// A torque of time, from 0 on.
fn torque(step_s: f64, steps: u32, of: impl Fn(f64) -> f64) -> Torque {
    let time_s = times(step_s, steps);
    Torque::new(&time_s, time_s.iter().map(|t| of(*t)).collect()).unwrap()
}

/// A torque of the inversion, to be played.
pub(crate) fn torque_of(solution: &Solution) -> Torque {
    let time_s: Vec<f64> = (0..solution.grid.len).map(|k| solution.grid.time_s(k)).collect();
    Torque::new(&time_s, solution.hub().torque_n_m.clone()).unwrap()
}

/// Plays on one link.
pub(crate) fn simulate(
    link: &Link,
    plan: &MeshPlan,
    play: &Play,
) -> Result<Played, SimulationError> {
    let plans = std::slice::from_ref(plan);
    flexlink::response::simulate(&link.clone().into(), plans, play, &|_| {})
}

fn played(link: &Link, plan: &MeshPlan, play: &Play) -> Played {
    simulate(link, plan, play).unwrap()
}

/// A motion of the tip, 0.5 m in 0.88 s as the sine, that samples say all of.
fn smooth(steps: u32) -> TipMotion {
    Smooth { duration_s: 0.88, steps, ..Smooth::MOVE }.motion()
}
