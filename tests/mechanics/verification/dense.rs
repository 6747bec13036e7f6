//! The paper's own solve of a link with everything on it, and what round-off does to it.

use std::sync::Arc;

use flexlink::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};
use flexlink::model::{Dense, KeptModes, Model, model_of};

use crate::common::mesh_of;

/// A metre, a kilogram and a second in other units: powers of two, which cost no digit.
#[derive(Debug, Clone, Copy)]
struct Units {
    length: f64,
    mass: f64,
}

const SI: Units = Units { length: 1.0, mass: 1.0 };

fn model(elements: usize, taper: f64, damping: Damping, units: Units) -> Arc<dyn Model> {
    let Units { length, mass } = units;
    let inertia = mass * length * length;
    let link = Link::new(LinkParts {
        segments: vec![Segment {
            bending_stiffness_n_m2: Taper { inner: 6.0, outer: 6.0 * taper }
                .scaled(inertia * length),
            mass_per_length_kg_m: Taper { inner: 0.9, outer: 0.9 * taper }.scaled(mass / length),
            ..Segment::uniform(1.4 * length, 1.0, 1.0)
        }],
        hub: Hub {
            inertia_kg_m2: 0.1 * inertia,
            radius_m: 0.1 * length,
            viscous_friction_n_m_s_rad: 0.0,
        },
        masses: vec![LumpedMass {
            at_m: 0.8 * length,
            mass_kg: 0.1 * mass,
            inertia_kg_m2: 0.02 * inertia,
        }],
        payload: Payload {
            mass_kg: 0.2 * mass,
            inertia_kg_m2: 0.01 * inertia,
            offset_m: 0.15 * length,
        },
        damping,
        ..LinkParts::default()
    })
    .unwrap();
    model_of(&link, mesh_of(&link, elements), KeptModes::All).unwrap()
}

fn dense(model: &dyn Model) -> Option<Dense> {
    Dense::assemble(model.on_mesh().clone())
}

/// `verify` shows no difference below its bound; this one is held to what round-off leaves.
#[test]
fn the_dense_solve_gives_the_transfer_of_bodies_and_offsets_under_every_law() {
    for damping in [
        Damping::None,
        Damping::Hysteretic { ratio: 0.02 },
        Damping::Rayleigh { alpha_per_s: 0.1, beta_s: 2e-4 },
        Damping::Modal { ratios: vec![0.01, 0.03] },
        Damping::Caughey { modes: vec![1, 2, 4], ratios: vec![0.01, 0.02, 0.2] },
    ] {
        let model = model(8, 0.7, damping.clone(), SI);
        let dense = dense(&*model).unwrap();
        for omega in [0.7, 3.0, 11.0, 47.0, 130.0] {
            let found = dense.tip_transfer(omega).inertia_kg_m;
            let expected = model.tip_transfer(omega).inertia_kg_m;
            let off = (found / expected - 1.0).norm();
            // Round-off in K/ω² costs the slowest one a digit more.
            let allowed = if omega < 1.0 { 1e-9 } else { 1e-10 };
            assert!(off < allowed, "{damping:?} at {omega} rad/s: {off:e}");
        }
    }
}

#[test]
fn two_hundred_elements_are_assembled_and_one_more_is_not() {
    let is_assembled = |elements| dense(&*model(elements, 0.7, Damping::None, SI)).is_some();
    assert!(is_assembled(200) && !is_assembled(201));
}

#[test]
fn round_off_is_no_more_than_estimated_and_not_far_less() {
    let model = model(100, 0.7, Damping::None, SI);
    let dense = dense(&*model).unwrap();
    let mut largest = 0.0_f64;
    for k in 0..40 {
        let omega = 0.01 * 1.1_f64.powi(k);
        let exact = model.tip_transfer(omega).inertia_kg_m;
        let off = (dense.tip_transfer(omega).inertia_kg_m / exact - 1.0).norm();
        let share = off / dense.round_off(omega);
        assert!(share < 1.0, "at {omega} rad/s: {off:e} of {:e}", dense.round_off(omega));
        largest = largest.max(share);
    }
    assert!(largest > 1e-4, "{largest:e}");
}

/// ε √n K/(ω² I): K grows as n³, and the estimate has no unit.
#[test]
fn round_off_grows_with_the_square_of_the_period_and_the_elements_to_three_and_a_half() {
    let round_off = |elements, units, omega: f64| {
        let model = model(elements, 1.0, Damping::None, units);
        dense(&*model).unwrap().round_off(omega)
    };
    let close = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found:e} is not {expected:e}");
    };
    let one = round_off(14, SI, 0.5);
    close(round_off(14, SI, 0.05), 100.0 * one);
    // The stiffest row that moves farthest is that of the last node but the tip.
    close(round_off(56, SI, 0.5), 128.0 * (1.475_f64 / 1.4).powi(2) * one);
    for units in [Units { length: 1024.0, ..SI }, Units { mass: 1024.0, ..SI }] {
        close(round_off(14, units, 0.5), one);
    }
}
