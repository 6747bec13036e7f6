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

use flexlink::beam::MeshPlan;
use flexlink::inverse::{Analysis, InversionError, Solution, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, Segment};
use flexlink::motion::TipMotion;

use super::common::{Smooth, accelerated, displaced, peak, plan_of, sine, whole_band};

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

fn solved(link: &Link, elements: usize, motion: &TipMotion) -> Solution {
    invert(link, &plan_of(link, elements), motion, &whole_band(Analysis::default())).unwrap()
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
