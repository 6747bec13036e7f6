//! Natural frequencies of the uniform link with hub inertia and point payload.

use flexlink::modal::{held_frequencies, natural_frequencies};

use super::closed_form::{UniformLink, roots};

/// (η, μ) and b₁ … b₅, ω = b²√(EI/m̄L⁴); the last row's link is that of ASME DETC2007-35511.
const PUBLISHED: [(f64, f64, [f64; 5]); 4] = [
    (0.0, 0.0, [3.926_602_312, 7.068_582_746, 10.210_176_12, 13.351_768_78, 16.493_361_43]),
    (1.0 / 27.0, 0.0, [3.116_156_922, 4.970_050_622, 7.912_340_048, 11.016_150_54, 14.146_796_42]),
    (0.1, 1.0, [2.326_474_278, 4.184_594_707, 7.161_872_009, 10.265_909_9, 13.391_926_53]),
    (
        0.0,
        5.2,
        [3.171_011_466_89, 6.298_221_426_56, 9.434_866_134_38, 12.573_959_496_8, 15.714_044_953_7],
    ),
];

/// b₁ … b₅ of a unit link, where a free hub needs no torque.
fn frequency_roots(link: &UniformLink) -> Vec<f64> {
    roots(5, |b| link.solve(b.powi(4).into()).torque())
}

/// Left side of the frequency equation over cosh b:
/// `(cos b sinh b − sin b cosh b) − 2μb sin b sinh b − ηb³[1 + cos b cosh b + μb(…)] = 0`.
fn frequency_equation(b: f64, eta: f64, mu: f64) -> f64 {
    let tilt = b.cos() * b.tanh() - b.sin();
    let clamped = b.cosh().recip() + b.cos();
    tilt - 2.0 * mu * b * b.sin() * b.tanh() - eta * b.powi(3) * (clamped + mu * b * tilt)
}

#[test]
fn the_closed_form_has_the_published_roots() {
    for (eta, mu, published) in PUBLISHED {
        let roots = frequency_roots(&UniformLink::unit(eta, mu));
        assert_eq!(roots.len(), 5);
        for (root, b) in roots.into_iter().zip(published) {
            assert!((root / b - 1.0).abs() < 1e-9, "η = {eta}, μ = {mu}: {root} is not {b}");
            // The equation changes its sign between two numbers a hair to either side.
            let beside = [1.0 - 1e-12, 1.0 + 1e-12].map(|f| frequency_equation(root * f, eta, mu));
            assert!(beside[0] * beside[1] < 0.0, "η = {eta}, μ = {mu}: {beside:?} at {root}");
        }
    }
}

#[test]
fn natural_frequencies_are_the_roots_of_the_frequency_equation() {
    for (eta, mu, published) in PUBLISHED {
        let link = UniformLink::unit(eta, mu);
        let found = natural_frequencies(&link.mesh(1000), 5);
        assert_eq!(found.len(), 5);
        for ((omega, root), b) in found.into_iter().zip(frequency_roots(&link)).zip(published) {
            assert!((omega.sqrt() / b - 1.0).abs() < 1e-9, "{omega} is not {b}²");
            assert!((omega.sqrt() / root - 1.0).abs() < 1e-10, "{omega} is not {root}²");
        }
    }
}

/// 1 + cos b cosh b = 0: the hub's inertia does not matter, for it does not move.
#[test]
fn a_clamped_hub_leaves_the_frequencies_of_the_cantilever() {
    let cantilever = [1.875_104_068_712, 4.694_091_132_974, 7.854_757_438_238];
    for eta in [0.0, 0.1] {
        let mesh = UniformLink::unit(eta, 0.0).mesh(1000);
        let found = held_frequencies(&mesh, f64::INFINITY, 3);
        assert_eq!(found.len(), 3);
        for (omega, b) in found.into_iter().zip(cantilever) {
            assert!((omega.sqrt() / b - 1.0).abs() < 1e-11, "η = {eta}: {omega} is not {b}²");
        }
    }
}

/// Relative error (βh)⁴/1440 · κ. κ is the share that the beam itself has in the kinetic energy of
/// the mode, 1 where neither hub nor payload moves a mass: only the beam's own is discretised.
#[test]
fn a_frequency_is_too_high_by_the_fourth_power_of_the_phase_per_element_over_1440() {
    for (eta, mu, _) in PUBLISHED {
        let link = UniformLink::unit(eta, mu);
        let roots = frequency_roots(&link);
        for elements in [20, 40, 80, 160] {
            let found = natural_frequencies(&link.mesh(elements), 5);
            for (omega, b) in found.into_iter().zip(&roots) {
                let share = link.solve(b.powi(4).into()).beam_share_of_kinetic_energy();
                let phase = b / elements as f64;
                let law = phase.powi(4) / 1440.0 * share;
                let error = omega / (b * b) - 1.0;
                // The next term of the series is of order (βh)⁶, round-off of order 1e-14.
                let off = (error / law - 1.0).abs();
                assert!(
                    off < 0.01 + 0.08 * phase * phase && error > 0.0,
                    "η = {eta}, μ = {mu}, {elements} elements, b = {b}: {error:e} is not {law:e}"
                );
            }
        }
    }
}

#[test]
fn a_mesh_is_halved_until_frequencies_are_exact_to_a_tolerance_or_it_has_thousands_of_elements() {
    let link = UniformLink::unit(0.0, 0.0);
    let highest = frequency_roots(&link)[4].powi(2);
    for tolerance in [1e-3, 1e-6] {
        let mesh = link.mesh(3).resolving(highest, tolerance);
        let error =
            |elements: usize| natural_frequencies(&link.mesh(elements), 5)[4] / highest - 1.0;
        let elements = mesh.elements().len();
        assert!(error(elements) < 1.01 * tolerance, "{elements} elements for {tolerance:e}");
        assert!(error(elements / 2) > 0.9 * tolerance, "{elements} elements for {tolerance:e}");
    }
    assert_eq!(link.mesh(5).resolving(1e9, 1e-12).elements().len(), 5 << 10);
}
