//! Bending moments of a run that did not write them.

use super::view::{View, inside, nearest};
use crate::beam::Mesh;
use crate::numeric::largest;
use crate::result::{StoredNodes, StoredRun};

/// Times of a map that a figure can show; accelerations are taken over no longer steps than these.
const COLUMNS: usize = 680;

/// Fewest nodes from which moments are made.
const FEWEST: usize = 5;

/// Largest step of the accelerations, over the first period.
const COARSEST: f64 = 0.05;

/// How far the largest moment at the root may be off what the summary says of it.
const TRUSTED: f64 = 0.1;

/// Bending moments in N m, and where they are from.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report) struct Moments {
    /// At the nodes and times of what they are made from.
    pub(in crate::report) nodes: StoredNodes,
    /// Whether the run wrote them; estimated otherwise.
    pub(in crate::report) is_written: bool,
}

/// The bending moments written, or those that the displacements written ask for: what lies outboard
/// of a node is accelerated by force and moment there.
///
/// ```text
/// m(x) = ∫ₓᴸ m̄ (s − x) v̈ ds + Σ [m (x_m − x) v̈ + J φ̈] + payload     (d'Alembert; v of Bayo 1987, eq 1)
/// ```
///
/// v̈ from second differences over time, linear between nodes: for colours, not for design. None
/// where the nodes, the moments or the digits written do not suffice.
pub(in crate::report) fn bending_moments(view: &View) -> Option<Moments> {
    let run = view.run;
    if let Some(nodes) = run.moments_n_m.clone().filter(|nodes| nodes.times_s.len() > 1) {
        return Some(Moments { nodes, is_written: true });
    }
    let deflections = view.deflections()?;
    let step_s = deflections.times_s[1] - deflections.times_s[0];
    let (from_s, until_s) = view.span_s();
    let apart = (inside(&deflections.times_s, from_s, until_s).len() / COLUMNS).max(1);
    let period_s = view.period_s.unwrap_or(f64::INFINITY);
    let is_fine = apart as f64 * step_s < COARSEST * period_s;
    if deflections.nodes.len() < FEWEST || deflections.times_s.len() < 3 || !is_fine {
        return None;
    }
    let stretches = Stretch::between(&run.mesh, &deflections.nodes);
    let turns: Vec<f64> =
        deflections.times_s.iter().map(|t| run.hub_angle_rad[nearest(&run.times_s, *t)]).collect();
    let mut histories = vec![Vec::with_capacity(turns.len()); deflections.nodes.len()];
    for k in 0..turns.len() {
        let accelerations = accelerations(run, &deflections, &turns, (k, apart, step_s));
        let moments = moments(run, &deflections, &stretches, &accelerations);
        histories.iter_mut().zip(moments).for_each(|(history, moment)| history.push(moment));
    }
    let known = run.readings.iter().find(|(name, _)| name == "peak_root_moment_n_m");
    let is_right =
        known.is_none_or(|(_, peak)| (largest(&histories[0]) / peak - 1.0).abs() < TRUSTED);
    let nodes = StoredNodes { histories, ..deflections };
    is_right.then_some(Moments { nodes, is_written: false })
}

/// Length in m and mass in kg between two neighbours of the nodes written.
struct Stretch {
    length_m: f64,
    mass_kg: f64,
}

impl Stretch {
    fn between(mesh: &Mesh, nodes: &[usize]) -> Vec<Self> {
        let of = |pair: &[usize]| {
            let elements = &mesh.elements()[pair[0]..pair[1]];
            let mass = elements.iter().map(|e| e.length_m * e.mass_per_length_kg_m.mean());
            Self { length_m: elements.iter().map(|e| e.length_m).sum(), mass_kg: mass.sum() }
        };
        nodes.windows(2).map(of).collect()
    }
}

/// v̈ in m/s² of every node written, at one time.
fn accelerations(
    run: &StoredRun,
    nodes: &StoredNodes,
    turns: &[f64],
    (k, apart, step_s): (usize, usize, f64),
) -> Vec<f64> {
    let last = nodes.times_s.len() - 1;
    let apart = apart.min(last / 2);
    let middle = k.clamp(apart, last - apart);
    let square = (apart as f64 * step_s) * (apart as f64 * step_s);
    let history = |(node, w): (&usize, &Vec<f64>)| {
        let x_m = run.mesh.nodes_m()[*node];
        let v = |k: usize| w[k] + x_m * turns[k];
        (v(middle - apart) - 2.0 * v(middle) + v(middle + apart)) / square
    };
    nodes.nodes.iter().zip(&nodes.histories).map(history).collect()
}

/// Moments in N m at the nodes, summed up from the tip inward.
fn moments(run: &StoredRun, nodes: &StoredNodes, stretches: &[Stretch], a: &[f64]) -> Vec<f64> {
    let payload = run.link.payload();
    let tip = a.len() - 1;
    // φ̈ of the chord inboard of a node.
    let turning = |k: usize| {
        let outer = k.max(1);
        (a[outer] - a[outer - 1]) / stretches[outer - 1].length_m
    };
    let mut force = payload.mass_kg * (a[tip] + payload.offset_m * turning(tip));
    let mut moment = payload.offset_m * force + payload.inertia_kg_m2 * turning(tip);
    let lumped = |k: usize| {
        let x_m = run.mesh.nodes_m()[nodes.nodes[k]];
        let here = run.link.masses().iter().filter(|m| (m.at_m - x_m).abs() < 1e-9 * (1.0 + x_m));
        here.fold((0.0, 0.0), |(mass, inertia), m| (mass + m.mass_kg, inertia + m.inertia_kg_m2))
    };
    let mut found = Vec::with_capacity(a.len());
    for k in (0..=tip).rev() {
        if let Some(Stretch { length_m, mass_kg }) = stretches.get(k) {
            // A load that is linear between the two nodes.
            moment += force * length_m + mass_kg * length_m * (a[k] / 6.0 + a[k + 1] / 3.0);
            force += mass_kg * (a[k] + a[k + 1]) / 2.0;
        }
        let (mass_kg, inertia_kg_m2) = lumped(k);
        force += mass_kg * a[k];
        moment += inertia_kg_m2 * turning(k);
        found.push(moment);
    }
    found.reverse();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::{run, solution};

    #[test]
    fn moments_made_from_displacements_are_those_of_the_solution() {
        let run = run();
        let view = View::of(&run);
        let Moments { nodes: found, is_written } = bending_moments(&view).unwrap();
        assert!(!is_written);
        let exact = solution().moments(&found.nodes, 1).histories().samples;
        let peak = exact[0].iter().fold(0.0_f64, |peak, m| peak.max(m.abs()));
        for (node, (found, exact)) in found.histories.iter().zip(&exact).enumerate() {
            for k in view.samples.clone() {
                let error = (found[k] - exact[k]).abs() / peak;
                assert!(error < 0.02, "node {node}, sample {k}: {error}");
            }
        }
    }

    #[test]
    fn moments_written_are_taken_as_they_are() {
        let mut run = run();
        let mut written = run.deflections_m.clone().unwrap();
        written.histories[0][7] = 42.0;
        run.moments_n_m = Some(written.clone());
        let expected = Moments { nodes: written, is_written: true };
        assert_eq!(bending_moments(&View::of(&run)), Some(expected));
    }

    #[test]
    fn an_estimate_that_misses_the_summary_is_none() {
        let mut run = run();
        assert!(bending_moments(&View::of(&run)).is_some());
        let exact = largest(&solution().root_moment_n_m);
        run.readings.push(("peak_root_moment_n_m".to_owned(), exact));
        assert!(bending_moments(&View::of(&run)).is_some());
        // Three digits: their second differences are noise.
        for history in &mut run.deflections_m.as_mut().unwrap().histories {
            for w in history {
                *w = (*w * 1e4).round() * 1e-4;
            }
        }
        assert_eq!(bending_moments(&View::of(&run)), None);
    }
}
