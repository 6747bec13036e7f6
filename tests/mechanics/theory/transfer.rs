//! Transfers from the tip: the recursion against the closed form, from 0.01 to 400 rad/s.

use std::f64::consts::TAU;

use flexlink::beam::{Mesh, MeshPlan, nodal_transfer};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment};
use flexlink::model::{FrequencyResponse, KeptModes, model_of};
use num_complex::Complex64;

use super::closed_form::UniformLink;
use super::published::assert_published;

const ELEMENTS: [usize; 7] = [10, 20, 40, 80, 160, 1000, 4000];
const OMEGAS_RAD_S: [f64; 9] = [0.01, 0.1, 1.0, 3.3, 12.0, 47.0, 150.0, 250.0, 400.0];

/// Below it round-off takes over from discretisation, for any mesh here.
const FLOOR: f64 = 1e-11;

/// No payload, a point, a point with rotary inertia, all of it beyond the tip.
fn links() -> [UniformLink; 4] {
    let payload = |mass_kg, inertia_kg_m2, offset_m| UniformLink {
        payload: Payload { mass_kg, inertia_kg_m2, offset_m },
        ..UniformLink::BAYO
    };
    [
        payload(0.0, 0.0, 0.0),
        payload(0.3, 0.0, 0.0),
        payload(0.3, 0.02, 0.0),
        payload(0.3, 0.02, 0.1),
    ]
}

/// λ = ω²/(1 + 2iξ) with the paper's ξ = 0.02.
fn lambda(omega_rad_s: f64) -> Complex64 {
    Complex64::from(omega_rad_s * omega_rad_s) / Complex64::new(1.0, 0.04)
}

/// Errors of T/a, θ/v, deflections and moments at nodes; the last two relative to the largest.
fn errors(link: &UniformLink, omega_rad_s: f64, elements: usize) -> [f64; 4] {
    let lambda = lambda(omega_rad_s);
    let exact = link.solve(lambda);
    let mesh = link.mesh(elements);
    let found = nodal_transfer(&mesh, lambda);
    let at_nodes = |found: &[Complex64], exact: &dyn Fn(f64) -> Complex64| {
        let peak = found.iter().fold(0.0_f64, |peak, z| peak.max(z.norm()));
        let pairs = found.iter().zip(mesh.nodes_m()).step_by(elements / 10);
        let error = |(z, x): (&Complex64, &f64)| (z - exact(*x)).norm() / peak;
        pairs.map(error).fold(0.0_f64, f64::max)
    };
    [
        (found.tip.inertia_kg_m / exact.inertia_kg_m() - 1.0).norm(),
        (found.tip.angle_rad_m / exact.angle_rad_m() - 1.0).norm(),
        at_nodes(&found.deflections_s2, &|x| exact.deflection_s2(x)),
        at_nodes(&found.moments_kg_m, &|x| exact.moment_kg_m(x)),
    ]
}

/// The closed form and the recursion both round to the published decimals; the recursion with 1000
/// elements is off by 3e-15 at 0.5 Hz and by 3e-11 at 20 Hz.
#[test]
fn closed_form_and_recursion_give_the_published_transfer() {
    let mesh = UniformLink::BAYO.mesh(1000);
    let exact = |hz: f64| UniformLink::BAYO.solve(lambda(TAU * hz)).inertia_kg_m();
    let found = |hz: f64| nodal_transfer(&mesh, lambda(TAU * hz)).tip.inertia_kg_m;
    assert_published(exact);
    assert_published(found);
    for hz in [0.5, 1.0, 2.0, 5.0, 10.0, 20.0] {
        assert!((found(hz) - exact(hz)).norm() < 1e-10, "{hz} Hz");
    }
}

#[test]
fn every_error_falls_with_the_fourth_power_of_element_length() {
    let mut rates = 0;
    for link in links() {
        for omega in OMEGAS_RAD_S {
            let of = |elements| errors(&link, omega, elements);
            for pair in ELEMENTS.windows(2) {
                if link.resolution(lambda(omega), pair[0]) > 1.0 {
                    // A wavelength of six elements or fewer: not yet in the asymptotic range.
                    continue;
                }
                let refinement = (pair[1] as f64 / pair[0] as f64).ln();
                for (coarse, fine) in of(pair[0]).into_iter().zip(of(pair[1])) {
                    if fine < 3.0 * FLOOR {
                        continue;
                    }
                    let order = (coarse / fine).ln() / refinement;
                    assert!(
                        (3.9..4.1).contains(&order),
                        "{link:?} at {omega} rad/s, {pair:?} elements: order {order}"
                    );
                    rates += 1;
                }
            }
        }
    }
    assert!(rates > 400, "only {rates} rates were above the floor");
}

#[test]
fn fine_meshes_lose_no_digit_to_round_off() {
    for link in links() {
        for omega in OMEGAS_RAD_S {
            for (elements, highest) in [(1000, 47.0), (4000, 400.0)] {
                let errors = errors(&link, omega, elements);
                assert!(
                    omega > highest || errors.iter().all(|e| *e < FLOOR),
                    "{link:?} at {omega} rad/s, {elements} elements: {errors:?}"
                );
            }
        }
    }
}

/// Factorising the assembled H = M − K*/ω² is wrong by 690 % at 1000 elements and 0.01 rad/s.
#[test]
fn four_thousand_elements_are_exact_to_thirteen_digits_at_a_hundredth_radian_per_second() {
    for link in links() {
        for elements in [160, 1000, 4000] {
            let errors = errors(&link, 0.01, elements);
            assert!(errors.iter().all(|e| *e < 1e-13), "{elements} elements: {errors:?}");
        }
    }
}

/// `T/a = (I/L)(1 + α/(iω)) + b/(iωL)`, `θ/v = 1/L` and `v/T = −1/(ω² T/a)`, bending left out.
#[test]
fn the_frequency_response_of_a_stiff_link_is_that_of_the_rigid_one_with_drag_and_friction() {
    let link = Link::new(LinkParts {
        segments: vec![Segment::uniform(1.3, 1e13, 0.8)],
        hub: Hub { inertia_kg_m2: 0.1, viscous_friction_n_m_s_rad: 0.7, radius_m: 0.0 },
        damping: Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 0.0 },
        ..LinkParts::default()
    })
    .expect("a valid link");
    let plan = MeshPlan::new(&link, &[Some(4)], None, 1e-6).expect("a valid plan");
    let model = model_of(&link, Mesh::new(&link, &plan).unwrap(), KeptModes::All);
    let model = model.expect("damping that can be");
    for frequency_hz in [0.05, 0.3, 2.0] {
        let found = FrequencyResponse::at(&*model, frequency_hz);
        let rate = Complex64::new(0.0, TAU * frequency_hz);
        let inertia = 0.1 + 0.8 * 1.3_f64.powi(3) / 3.0;
        let torque = inertia / 1.3 * (1.0 + 0.4 / rate) + 0.7 / (rate * 1.3);
        let close = |found: Complex64, exact: Complex64| {
            assert!((found / exact - 1.0).norm() < 1e-9, "{frequency_hz} Hz: {found}, {exact}");
        };
        close(found.torque_per_tip_acceleration_kg_m, torque);
        close(found.hub_angle_per_tip_displacement_rad_m, (1.0 / 1.3).into());
        close(found.tip_displacement_per_torque_1_n, 1.0 / (torque * rate * rate));
        assert!((found.frequency_hz / frequency_hz - 1.0).abs() < 1e-15);
    }
}
