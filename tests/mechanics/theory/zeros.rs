//! Zeros of torque → tip of the uniform link.

use flexlink::link::Payload;
use flexlink::modal::{real_frequency_zeros, torque_zeros};

use super::closed_form::{UniformLink, roots};

/// x of the first `count` roots of the tip's motion at λ = `sign`·x⁴, ascending.
fn tip_roots(link: &UniformLink, sign: f64, count: usize) -> Vec<f64> {
    roots(count, |x| link.solve((sign * x.powi(4)).into()).tip_motion())
}

#[test]
fn zeros_do_not_depend_on_the_hub_nor_on_a_point_payload() {
    let published = [11.186_642_72, 60.451_695_86, 149.277_767_6];
    for (eta, mu) in [(0.0, 0.0), (0.1, 0.0), (7.0, 0.0), (0.0, 2.0), (1.0 / 27.0, 5.2)] {
        let link = UniformLink::unit(eta, mu);
        let found = torque_zeros(&link.mesh(1000), 3);
        assert_eq!(found.len(), 3);
        for ((z, x), printed) in found.iter().zip(tip_roots(&link, -1.0, 3)).zip(published) {
            assert!((x * x / printed - 1.0).abs() < 1e-9, "{x}² is not {printed}");
            assert!((z / (x * x) - 1.0).abs() < 1e-9, "η = {eta}, μ = {mu}: {z} is not {x}²");
        }
    }
}

#[test]
fn four_times_the_stiffness_doubles_every_zero_exactly() {
    for (elements, doublings) in [(1, 1), (10, 1), (77, 1), (10, 30), (10, -30)] {
        let (factor, soft) = (2.0_f64.powi(doublings), UniformLink::BAYO);
        let bending_stiffness_n_m2 = factor * factor * soft.bending_stiffness_n_m2;
        let stiff = UniformLink { bending_stiffness_n_m2, ..soft };
        let zeros = torque_zeros(&soft.mesh(elements), 5);
        assert!(zeros.len() > 1, "{zeros:?} on {elements} elements");
        let doubled: Vec<f64> = zeros.iter().map(|z| factor * z).collect();
        assert_eq!(torque_zeros(&stiff.mesh(elements), 5), doubled, "{doublings} doublings");
    }
}

/// sinh b + sin b = εb³(cosh b − cos b) with `ε = J_t/m̄L³`.
#[test]
fn a_payload_with_rotary_inertia_puts_a_zero_on_the_real_frequencies() {
    for (epsilon, printed) in [(0.001, 9.999_58), (0.01, 4.607_14), (0.1, 2.174_52)] {
        for mass_kg in [0.0, 0.7] {
            let link = UniformLink {
                payload: Payload { mass_kg, inertia_kg_m2: epsilon, offset_m: 0.0 },
                ..UniformLink::unit(0.1, 0.0)
            };
            let b = tip_roots(&link, 1.0, 1)[0];
            let (left, right) = (b.sinh() + b.sin(), epsilon * b.powi(3) * (b.cosh() - b.cos()));
            assert!((left / right - 1.0).abs() < 1e-13, "ε = {epsilon}: {left} is not {right}");
            assert!((b - printed).abs() < 1e-5, "ε = {epsilon}: {b} is not {printed}");
            let found = real_frequency_zeros(&link.mesh(1000), 400.0);
            assert!((found[0].sqrt() / b - 1.0).abs() < 1e-8, "{found:?} is not {b}²");
        }
    }
}
