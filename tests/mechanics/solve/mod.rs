//! What `invert` promises: laws of the physics, the period, the mesh, warnings and refusals.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod auto_mesh;
mod ends;
mod energy;
mod errors;
mod laws;
mod limits;
mod modal;
mod model;
mod motor;
mod nodal;
mod period;
mod progress;
mod rayleigh;
mod threads;
mod warnings;

use std::f64::consts::PI;

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::{Analysis, InversionError, Solution, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, Segment};
use flexlink::motion::{MotionColumns, TipMotion};

/// The uniform link of 1.5 m, 5 N m², 0.8 kg/m on a hub of 0.1 kg m²: Bayo's without its stiff
/// root, its rigid inertia 1 kg m².
fn uniform() -> LinkParts {
    LinkParts {
        segments: vec![Segment::uniform(1.5, 5.0, 0.8)],
        hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
        damping: Damping::Hysteretic { ratio: 0.02 },
        ..LinkParts::default()
    }
}

/// That link with some of its parts changed.
fn link(change: impl FnOnce(&mut LinkParts)) -> Link {
    let mut parts = uniform();
    change(&mut parts);
    Link::new(parts).unwrap()
}

/// A mesh of so many elements.
fn mesh_of(link: &Link, elements: usize) -> MeshPlan {
    let own = vec![None; link.segments().len()];
    MeshPlan::new(link, &own, Some(ElementCount::Total(elements)), 1e-6).unwrap()
}

/// Tip velocity that rises and falls as sin⁶ over a time: five continuous derivatives of the
/// acceleration, so that its spectrum ends far below the Nyquist frequency.
#[derive(Debug, Clone, Copy)]
struct Smooth {
    travel_m: f64,
    duration_s: f64,
    /// Steps of the motion itself.
    steps: u32,
    /// Samples of rest before and after it.
    rest: [u32; 2],
}

impl Smooth {
    /// A move that bends the link little.
    const SHORT: Self = Self { travel_m: 0.2, ..Self::MOVE };
    const MOVE: Self = Self { travel_m: 0.5, duration_s: 1.0, steps: 256, rest: [0, 0] };

    fn step_s(&self) -> f64 {
        self.duration_s / f64::from(self.steps)
    }

    /// Phase πt/T of every sample, 0 and π in the rest, and its time; the motion starts at 0 s.
    fn phases(&self) -> Vec<(f64, f64)> {
        let [before, after] = self.rest.map(i64::from);
        let steps = i64::from(self.steps);
        let samples = -before..=steps + after;
        let at = |k: i64| {
            let phase = PI * k.clamp(0, steps) as f64 / steps as f64;
            (k as f64 * self.step_s(), phase)
        };
        samples.map(at).collect()
    }

    fn time_s(&self) -> Vec<f64> {
        self.phases().into_iter().map(|(time_s, _)| time_s).collect()
    }

    /// a = (16/5)(D/T)(6π/T) sin⁵ cos.
    fn acceleration_m_s2(&self) -> Vec<f64> {
        let peak = 3.2 * 6.0 * PI * self.travel_m / self.duration_s.powi(2);
        let at = |(_, phase): (f64, f64)| peak * phase.sin().powi(5) * phase.cos();
        self.phases().into_iter().map(at).collect()
    }

    /// v = (16/5) D ∫sin⁶.
    fn displacement_m(&self) -> Vec<f64> {
        let at = |(_, x): (f64, f64)| {
            let waves = -15.0 * (2.0 * x).sin() + 3.0 * (4.0 * x).sin() - (6.0 * x).sin() / 3.0;
            3.2 * self.travel_m * (5.0 * x / 16.0 + waves / 64.0) / PI
        };
        self.phases().into_iter().map(at).collect()
    }

    fn motion(&self) -> TipMotion {
        accelerated(self.time_s(), self.acceleration_m_s2())
    }
}

fn accelerated(time_s: Vec<f64>, acceleration_m_s2: Vec<f64>) -> TipMotion {
    let acceleration_m_s2 = Some(acceleration_m_s2);
    TipMotion::new(MotionColumns { time_s, acceleration_m_s2, ..Default::default() }).unwrap()
}

fn displaced(time_s: Vec<f64>, displacement_m: Vec<f64>) -> TipMotion {
    let displacement_m = Some(displacement_m);
    TipMotion::new(MotionColumns { time_s, displacement_m, ..Default::default() }).unwrap()
}

/// One period of a sine acceleration: Bayo's motion as reconstructed.
fn sine(travel_m: f64, duration_s: f64, steps: u32) -> TipMotion {
    let turn = |k: u32| f64::from(k) / f64::from(steps);
    let peak = 2.0 * PI * travel_m / duration_s.powi(2);
    let time_s = (0..=steps).map(|k| duration_s * turn(k)).collect();
    accelerated(time_s, (0..=steps).map(|k| peak * (2.0 * PI * turn(k)).sin()).collect())
}

fn solved(link: &Link, elements: usize, motion: &TipMotion) -> Solution {
    invert(link, &mesh_of(link, elements), motion, &whole_band(Analysis::default())).unwrap()
}

fn refused(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
) -> InversionError {
    invert(link, plan, motion, analysis)
        .map(|solution| solution.hub().torque_n_m.len())
        .unwrap_err()
}

fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Torque at sample `k` of the trajectory's own numbering; outside the window it is nothing.
fn torque_at(solution: &Solution, k: i64) -> f64 {
    let index = usize::try_from(k - solution.grid.first).ok();
    index.and_then(|index| solution.hub().torque_n_m.get(index)).copied().unwrap_or(0.0)
}

/// Samples of the trajectory's own numbering that a window covers.
fn samples(solution: &Solution) -> std::ops::Range<i64> {
    solution.grid.first..solution.grid.first + i64::try_from(solution.grid.len).unwrap()
}

/// Largest difference of two torques, the samples of `b` numbered `shift` higher, over the peak of
/// `a`.
fn torque_difference(a: &Solution, b: &Solution, shift: i64) -> f64 {
    let (a_samples, b_samples) = (samples(a), samples(b));
    let from = a_samples.start.min(b_samples.start - shift);
    let until = a_samples.end.max(b_samples.end - shift);
    let differences = (from..until).map(|k| torque_at(a, k) - torque_at(b, k + shift));
    differences.fold(0.0_f64, |m, d| m.max(d.abs())) / peak(&a.hub().torque_n_m)
}

/// The analysis with every frequency of the samples, where a law is to hold to the last digits.
fn whole_band(analysis: Analysis) -> Analysis {
    analysis.with_tip_tolerance(0.0).unwrap()
}
