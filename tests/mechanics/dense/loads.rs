//! Links under loads on their nodes and on an axis that moves.

use faer::c64;
use flexlink::beam::{LoadedMotion, Loads, Mesh};
use flexlink::link::{Damping, Link, LinkParts};
use flexlink::model::{Dense, KeptModes, Model, model_of};
use proptest::prelude::*;

use super::assembly::Assembly;
use super::links::{any_parts, mesh};

/// What the recursion and the program's own dense matrices may differ by from those assembled here.
const ROUND_OFF: f64 = 1e-10;

fn any_complex() -> impl Strategy<Value = c64> {
    (-1.0..1.0, -1.0..1.0).prop_map(|(re, im)| c64::new(re, im))
}

/// A force and a tenth as many newton metres on each of so many nodes, and a moving axis and chord.
fn any_loads(nodes: usize) -> impl Strategy<Value = Loads<c64>> {
    let nodal = prop::collection::vec((any_complex(), any_complex()), nodes);
    (nodal, any_complex(), any_complex()).prop_map(|(nodal, axis_m_s2, chord_rad_s2)| Loads {
        axis_m_s2,
        chord_rad_s2,
        nodal: nodal.into_iter().map(|(force, moment)| [force, moment * 0.1]).collect(),
    })
}

/// Largest difference of torque, hub slope and deflections: the torque over the moment of all loads together,
/// slope and deflections over the largest of their kind.
fn difference(
    mesh: &Mesh,
    loads: &Loads<c64>,
    found: &LoadedMotion<c64>,
    exact: &LoadedMotion<c64>,
) -> f64 {
    let off = |part: usize| {
        let largest = exact.deflections.iter().fold(0.0, |most: f64, w| most.max(w[part].norm()));
        let pairs = found.deflections.iter().zip(&exact.deflections);
        pairs.fold(0.0, |most: f64, (a, b)| most.max((a[part] - b[part]).norm())) / largest
    };
    let moments = loads.nodal.iter().zip(mesh.nodes_m());
    let moment: f64 =
        moments.map(|([force, moment], x_m)| force.norm() * x_m + moment.norm()).sum();
    let torque = (found.torque_n_m - exact.torque_n_m).norm() / moment.max(exact.torque_n_m.norm());
    let largest = exact.deflections.iter().fold(0.0, |most: f64, w| most.max(w[1].norm()));
    let slope = (found.hub_slope_rad - exact.hub_slope_rad).norm() / largest;
    [torque, slope, off(0), off(1)].into_iter().fold(0.0, f64::max)
}

/// What the matrices assembled here say.
fn assembled(link: &Link, mesh: &Mesh, omega: f64, loads: &Loads<c64>) -> LoadedMotion<c64> {
    let factors = match *link.damping() {
        Damping::Hysteretic { ratio } => [c64::ONE, c64::new(1.0, 2.0 * ratio)],
        Damping::Rayleigh { alpha_per_s, beta_s } => {
            [c64::new(1.0, -alpha_per_s / omega), c64::new(1.0, omega * beta_s)]
        }
        _ => panic!("a law of this test"),
    };
    let (axis, chord) = (loads.axis_m_s2, loads.chord_rad_s2);
    let assembly = Assembly::of_link(link, mesh.nodes_m());
    let (torque_n_m, motion) =
        assembly.loaded(omega, factors, [axis, chord], &loads.nodal, mesh.length_m());
    let node = |(x_m, motion): (&f64, &[c64])| {
        [motion[0] - axis - chord * *x_m, motion[1] - chord].map(|part| -part / (omega * omega))
    };
    let deflections: Vec<_> = mesh.nodes_m().iter().zip(motion.chunks(2)).map(node).collect();
    LoadedMotion { torque_n_m, hub_slope_rad: deflections[0][1], deflections }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn recursion_and_dense_matrices_answer_to_loads_as_those_assembled_here_do(
        parts in any_parts(),
        loads in any_loads(9),
        omega in 3.0..400.0_f64,
        viscous in any::<bool>(),
    ) {
        let damping = if viscous {
            Damping::Rayleigh { alpha_per_s: 0.8, beta_s: 1e-3 }
        } else {
            Damping::Hysteretic { ratio: 0.03 }
        };
        let parts = LinkParts { damping, ..parts };
        let mesh = mesh(&parts, 8);
        let link = Link::new(parts).expect("a valid link");
        let exact = assembled(&link, &mesh, omega, &loads);
        let recursion = model_of(&link, mesh.clone(), KeptModes::All).expect("a recursion");
        let dense = Dense::assemble(recursion.on_mesh().clone()).expect("few elements");
        let models = [("recursion", &*recursion), ("dense", &dense as &dyn Model)];
        for (name, model) in models {
            let off = difference(&mesh, &loads, &model.loaded_motion(omega, &loads), &exact);
            // What K/ω² costs the matrices of short elements at low frequency.
            let bound = ROUND_OFF.max(dense.round_off(omega));
            prop_assert!(off < bound, "{name}: {off:e} at {omega} rad/s");
        }
    }
}
