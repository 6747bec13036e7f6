//! Damping mode by mode against the matrix that it stands for: `(K + iωC − ω²M) x = e_θ T`
//! with C = M Φ diag(2ζω) Φᵀ M (Bayo 1987, eqs 11 and 12).

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use flexlink::beam::Mesh;
use flexlink::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};
use flexlink::modal::natural_frequencies;
use flexlink::model::{KeptModes, model_of};

use super::assembly::Assembly;
use super::damping;
use crate::common::{complex_difference, mesh_of};

const RATIOS: [f64; 4] = [0.03, 0.0, 0.1, 0.01];

const SERIES: [(usize, f64); 3] = [(1, 0.01), (2, 0.02), (4, 0.2)];

/// A link with tapers and bodies on it.
fn arm(damping: Damping) -> LinkParts {
    let segment = |length_m, stiffness: (f64, f64), mass: (f64, f64)| Segment {
        bending_stiffness_n_m2: Taper { inner: stiffness.0, outer: stiffness.1 },
        mass_per_length_kg_m: Taper { inner: mass.0, outer: mass.1 },
        ..Segment::uniform(length_m, 1.0, 1.0)
    };
    LinkParts {
        segments: vec![segment(0.5, (20.0, 8.0), (0.9, 0.5)), segment(0.8, (8.0, 3.0), (0.5, 0.3))],
        hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.08, viscous_friction_n_m_s_rad: 0.0 },
        masses: vec![LumpedMass { at_m: 0.9, mass_kg: 0.2, inertia_kg_m2: 1e-3 }],
        payload: Payload { mass_kg: 0.3, inertia_kg_m2: 4e-3, offset_m: 0.06 },
        damping,
        ..LinkParts::default()
    }
}

/// The polynomial `2ζω = Σ a_b ω²ᵇ` through the ratios of the modes, in Lagrange's form.
fn series_rate(frequencies: &[f64], omega: f64) -> f64 {
    let square = |mode: usize| frequencies[mode - 1].powi(2);
    let term = |&(mode, ratio): &(usize, f64)| {
        let others = SERIES.iter().filter(|(other, _)| *other != mode);
        let weight: f64 = others
            .map(|(other, _)| (omega * omega - square(*other)) / (square(mode) - square(*other)))
            .product();
        2.0 * ratio * frequencies[mode - 1] * weight
    };
    SERIES.iter().map(term).sum()
}

/// Motion (v, φ) of all nodes under a unit torque, times −ω².
fn accelerations(matrices: &[Mat<f64>; 3], root_m: f64, omega: f64) -> Vec<c64> {
    let [mass, damping, stiffness] = matrices;
    let size = mass.nrows();
    let per_square = -1.0 / (omega * omega);
    let h = Mat::from_fn(size, size, |row, column| {
        let at = (row, column);
        mass[at] + c64::new(stiffness[at], omega * damping[at]) * per_square
    });
    let mut torque = Mat::<c64>::zeros(size, 1);
    torque[(0, 0)] = c64::ONE;
    let a = h.partial_piv_lu().solve(&torque);
    std::iter::once(a[(0, 0)] * root_m).chain((0..size).map(|row| a[(row, 0)])).collect()
}

/// Largest difference between the sum of modes and the dense solve, over torque, hub angle,
/// deflections and moments, each relative to its largest value.
fn difference(link: &Link, mesh: &Mesh, damping: Mat<f64>, omega: f64) -> f64 {
    let model = model_of(link, mesh.clone(), KeptModes::All).expect("a valid law");
    let assembly = Assembly::of_link(link, mesh.nodes_m());
    let [mass, stiffness] = assembly.mass_and_stiffness();
    let a = accelerations(&[mass, damping, stiffness], mesh.nodes_m()[0], omega);
    let (tip, theta) = (a[a.len() - 2], a[1]);
    let found = model.nodal_transfer(omega);
    assert_eq!(found.tip, model.tip_transfer(omega));
    let at_nodes = |found: &[c64], dense: &dyn Fn(usize) -> c64| {
        complex_difference(found, (0..found.len()).map(|k| dense(k) / tip))
    };
    let deflection = |k: usize| (a[2 * k] - theta * mesh.nodes_m()[k]) / (omega * omega);
    let moment = |k: usize| assembly.inertial_moment(k, mesh.nodes_m(), &a);
    [
        (found.tip.inertia_kg_m * tip - 1.0).norm(),
        (found.tip.angle_rad_m * tip / theta - 1.0).norm(),
        (found.tip.deflection_s2 * tip / deflection(mesh.elements().len()) - 1.0).norm(),
        at_nodes(&found.deflections_s2, &deflection),
        at_nodes(&found.moments_kg_m, &moment),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

/// From a tenth of the first natural frequency to beyond the sixth, in rad/s; 14.0 and 36.2 lie on
/// the first two resonances, the second of which is undamped in [`RATIOS`].
const FREQUENCIES: [f64; 10] = [1.5, 5.0, 9.5, 14.0, 20.0, 36.2, 60.0, 95.0, 160.0, 500.0];

/// Measured: 1.3e-10 at most, at 500 rad/s.
#[test]
fn a_ratio_for_each_mode_is_the_damping_matrix_of_these_ratios() {
    let link = Link::new(arm(Damping::Modal { ratios: RATIOS.to_vec() })).expect("a valid link");
    for elements in [4, 8] {
        let mesh = mesh_of(&link, elements);
        let [mass, stiffness] = Assembly::of_link(&link, mesh.nodes_m()).mass_and_stiffness();
        let ratio = |mode: usize, _| RATIOS[(mode - 1).min(RATIOS.len() - 1)];
        for omega in FREQUENCIES {
            let matrix = damping::modal(&mass, &stiffness, ratio);
            let off = difference(&link, &mesh, matrix, omega);
            assert!(off < 1e-9, "{elements} elements, {omega} rad/s: {off:e}");
        }
    }
}

#[test]
fn a_caughey_series_is_the_damping_matrix_of_its_ratios() {
    let (modes, ratios) = SERIES.into_iter().unzip();
    let link = Link::new(arm(Damping::Caughey { modes, ratios })).expect("a valid link");
    for elements in [4, 8] {
        let mesh = mesh_of(&link, elements);
        let frequencies = natural_frequencies(&mesh, 4);
        let [mass, stiffness] = Assembly::of_link(&link, mesh.nodes_m()).mass_and_stiffness();
        let ratio = |_, omega: f64| 0.5 * series_rate(&frequencies, omega) / omega;
        for omega in FREQUENCIES {
            let matrix = damping::modal(&mass, &stiffness, ratio);
            let off = difference(&link, &mesh, matrix, omega);
            assert!(off < 1e-9, "{elements} elements, {omega} rad/s: {off:e}");
        }
    }
}

/// A hub without inertia on a root without mass follows the torque at once: no mode holds that.
#[test]
fn motions_without_mass_answer_beside_the_modes() {
    let mut parts = arm(Damping::Modal { ratios: vec![0.0] });
    parts.segments[0].mass_per_length_kg_m = Taper::constant(0.0);
    parts.hub = Hub::default();
    parts.masses[0].at_m = 0.7;
    let link = Link::new(parts).expect("a valid link");
    let mesh = mesh_of(&link, 6);
    for omega in FREQUENCIES {
        let size = 2 * mesh.elements().len() + 1;
        let off = difference(&link, &mesh, Mat::zeros(size, size), omega);
        assert!(off < 1e-9, "{omega} rad/s: {off:e}");
    }
}
