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
mod robustness;
mod round_trip;
mod state;

use std::f64::consts::{PI, TAU};

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment};
use flexlink::motion::{MotionColumns, TipMotion};
use flexlink::response::{Play, Played, SimulationError, Torque};

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

/// A mesh of so many elements.
fn mesh_of(link: &Link, elements: usize) -> MeshPlan {
    let own = vec![None; link.segments().len()];
    MeshPlan::new(link, &own, Some(ElementCount::Total(elements)), 1e-6).unwrap()
}

/// Times from 0 on, one more than there are steps.
fn times(step_s: f64, steps: u32) -> Vec<f64> {
    (0..=steps).map(|k| step_s * f64::from(k)).collect()
}

/// One period of a sine acceleration that carries the tip 0.5 m in 0.88 s: Bayo's motion as
/// reconstructed.
fn sine(steps: u32) -> TipMotion {
    let time_s = times(0.88 / f64::from(steps), steps);
    let peak = TAU * 0.5 / (0.88 * 0.88);
    let acceleration_m_s2 = time_s.iter().map(|t| peak * (TAU * t / 0.88).sin()).collect();
    let acceleration_m_s2 = Some(acceleration_m_s2);
    TipMotion::new(MotionColumns { time_s, acceleration_m_s2, ..Default::default() }).unwrap()
}

fn solved(link: &Link, plan: &MeshPlan, motion: &TipMotion, tolerance: f64) -> Solution {
    invert(link, plan, motion, &whole_band(Analysis::new(tolerance, None, None).unwrap())).unwrap()
}

/// A torque of the inversion, to be played.
fn torque_of(solution: &Solution) -> Torque {
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

fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Largest difference of two histories over the peak of the second.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / peak(b)
}

/// A motion of the tip, 0.5 m in 0.88 s as the sine, whose velocity rises and falls as sin⁶: its
/// spectrum ends far below the Nyquist frequency, so that samples say all of it.
fn smooth(steps: u32) -> TipMotion {
    let time_s = times(0.88 / f64::from(steps), steps);
    let peak = 3.2 * 6.0 * PI * 0.5 / (0.88 * 0.88);
    let at = |t: &f64| {
        let phase = PI * t / 0.88;
        peak * phase.sin().powi(5) * phase.cos()
    };
    let acceleration_m_s2 = Some(time_s.iter().map(at).collect());
    TipMotion::new(MotionColumns { time_s, acceleration_m_s2, ..Default::default() }).unwrap()
}

/// The analysis with every frequency of the samples, where a law is to hold to the last digits.
fn whole_band(analysis: Analysis) -> Analysis {
    analysis.with_tip_tolerance(0.0).unwrap()
}
