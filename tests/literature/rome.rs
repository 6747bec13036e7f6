//! Laboratory link of the University of Rome: De Luca, Romano and Murra, report.
//!
//! | | printed, SI |
//! |---|---|
//! | length | 0.7 m |
//! | bending stiffness | 2.4507 N m² |
//! | mass per length | 2.975 kg/m |
//! | hub inertia | 1.95e-3 kg m² |
//! | payload | 0.117 kg |
//! | joint spring | 1000 N m/rad, here to ground |
//! | ω² | 34.14, 1383.24, 11084.49 rad²/s² |
//!
//! `[drive]` is not supported yet, so the joint spring is made of what there is: a stub of 1 µm
//! with EI = k · 1 µm on a clamped hub bends by M/k, and the hub's inertia is lumped on its outer
//! end. The stub also shifts by M · (1 µm)/2k, a millionth of what matters.

use super::closed_form::{self, Uniform};
use super::{FINE, assert_close, frequencies, specification};
use flexlink::beam::{ElementCount, Mesh, MeshPlan};
use flexlink::link::{Hub, Link, LinkParts, LumpedMass, Segment, Taper};
use flexlink::modal::natural_frequencies;

const FILE: &str = "rome_link.toml";

#[test]
fn the_rigid_inertia_is_that_of_rod_hub_and_payload() {
    let link = specification(FILE, &[]).link;
    let expected = 1.95e-3 + 2.975 * 0.7_f64.powi(3) / 3.0 + 0.117 * 0.49;
    assert!((link.rigid_inertia_kg_m2() / expected - 1.0).abs() < 1e-14);
}

#[test]
fn frequencies_of_the_free_hub_are_those_of_the_closed_form() {
    let link = specification(FILE, &[]).link;
    let numbers = Uniform::of(&link).free_hub_numbers(4);
    let expected = closed_form::frequencies(&link, &numbers);
    assert_close(&frequencies(FILE, &[FINE], 4), &expected, 1e-10);
}

/// The link on a spring between its hub and the ground.
fn on_a_joint_spring(elements: usize) -> Mesh {
    let (stiffness_n_m_rad, stub_m) = (1000.0, 1e-6);
    let link = specification(FILE, &[]).link;
    let stub = Segment {
        name: None,
        length_m: stub_m,
        bending_stiffness_n_m2: Taper::constant(stiffness_n_m_rad * stub_m),
        mass_per_length_kg_m: Taper::constant(0.0),
    };
    let hub = LumpedMass { at_m: stub_m, mass_kg: 0.0, inertia_kg_m2: link.hub().inertia_kg_m2 };
    let sprung = Link::new(LinkParts {
        title: String::new(),
        segments: vec![stub, link.segments()[0].clone()],
        hub: Hub { inertia_kg_m2: 1e12, ..Hub::default() },
        masses: vec![hub],
        payload: *link.payload(),
        damping: link.damping().clone(),
    });
    let sprung = sprung.unwrap();
    let count = Some(ElementCount::Total(elements + 1));
    Mesh::new(&sprung, &MeshPlan::new(&sprung, &[Some(1), None], count, 1e-6).unwrap())
}

/// Exact condition of the link on a joint spring k: v = A (cos − cosh) + B sin + D sinh of bx/L;
/// the hub obeys `EI v″ = (k − I_H ω²) v′`, which gives A from B + D, and the tip's two conditions
/// leave a 2×2 determinant.
fn sprung(b: f64) -> f64 {
    let (length, ei, mass, hub, payload, spring) = (0.7, 2.4507, 2.975, 1.95e-3, 0.117, 1000.0);
    let wave = b / length;
    let square = ei / mass * wave.powi(4);
    let per_slope = -(spring - hub * square) / (2.0 * ei * wave);
    let (sin, cos, sinh, cosh) = (b.sin(), b.cos(), b.sinh(), b.cosh());
    let tip = |b: f64, d: f64| {
        let a = per_slope * (b + d);
        let moment = -a * (cos + cosh) - b * sin + d * sinh;
        let shear = a * (sin - sinh) - b * cos + d * cosh;
        let motion = a * (cos - cosh) + b * sin + d * sinh;
        (moment, shear + payload * wave / mass * motion)
    };
    let ((m1, s1), (m2, s2)) = (tip(1.0, 0.0), tip(0.0, 1.0));
    (m1 * s2 - m2 * s1) / cosh.powi(2)
}

#[test]
fn on_the_joint_spring_the_published_squared_frequencies_appear() {
    let squares: Vec<f64> =
        natural_frequencies(&on_a_joint_spring(200), 3).iter().map(|w| w * w).collect();
    let exact = closed_form::roots(sprung, 3);
    let exact: Vec<f64> = exact.iter().map(|b| 2.4507 / 2.975 * (b / 0.7).powi(4)).collect();
    // The stub of 1 µm costs 1.4e-7 of the third.
    assert_close(&squares, &exact, 2e-7);
    // As printed, to the last of its two decimals.
    for (found, printed) in squares.iter().zip([34.14, 1383.24, 11_084.49]) {
        assert!((found - printed).abs() <= 0.005, "{found} for {printed}");
    }
}

#[test]
fn a_coarser_mesh_misses_the_print_by_its_discretisation_error() {
    // 1.6e-6 of the third with 40 elements, 2 (b/40)⁴/1440: 11084.507.
    let exact = closed_form::roots(sprung, 3)[2];
    let error = 2.0 * (exact / 40.0).powi(4) / 1440.0;
    let third = natural_frequencies(&on_a_joint_spring(40), 3)[2].powi(2);
    assert!((third - 11_084.507).abs() < 0.005, "{third}");
    assert!(((third / 11_084.489_2 - 1.0) / error - 1.0).abs() < 0.2, "{error:e}");
}
