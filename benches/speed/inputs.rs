//! Links, motions and numbers that the subjects share.

use std::f64::consts::TAU;

use flexlink::beam::{ElementCount, Mesh, MeshPlan};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment, Taper};
use flexlink::motion::{MotionColumns, TipMotion};
use num_complex::Complex64;

/// Bayo's link without its stiff root.
pub(crate) fn link(damping: Damping) -> Link {
    Link::new(LinkParts {
        title: String::new(),
        segments: vec![Segment {
            name: None,
            length_m: 1.5,
            bending_stiffness_n_m2: Taper::constant(5.0),
            mass_per_length_kg_m: Taper::constant(0.8),
            cross_section: None,
            timoshenko: None,
        }],
        hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
        carriage: None,
        root_stiffness_n_m_rad: None,
        output_m: None,
        masses: vec![],
        payload: Payload::default(),
        damping,
        drive: None,
        gravity: None,
    })
    .unwrap()
}

const DAMPED: Damping = Damping::Hysteretic { ratio: 0.02 };

/// The link as most files describe it.
pub(crate) fn damped_link() -> Link {
    link(DAMPED)
}

pub(crate) fn plan(link: &Link, elements: usize) -> MeshPlan {
    MeshPlan::new(link, &[None], Some(ElementCount::Total(elements)), 1e-6).unwrap()
}

pub(crate) fn mesh(elements: usize) -> Mesh {
    let link = damped_link();
    Mesh::new(&link, &plan(&link, elements)).unwrap()
}

/// `count` frequencies up to 130 Hz, of a link with hysteretic damping of this ratio.
pub(crate) fn lambdas(count: u32, ratio: f64) -> Vec<Complex64> {
    let omega = |k: u32| TAU * 130.0 * f64::from(k) / f64::from(count);
    let stiffness = Complex64::new(1.0, 2.0 * ratio);
    (0..count).map(|k| Complex64::from(omega(k).powi(2)) / stiffness).collect()
}

/// One period of a sine acceleration over 1 s.
pub(crate) fn motion() -> TipMotion {
    let time_s: Vec<f64> = (0..=1000).map(|k| 1e-3 * f64::from(k)).collect();
    let sine = time_s.iter().map(|t| 3.0 * (TAU * t).sin()).collect();
    let columns = MotionColumns { time_s, acceleration_m_s2: Some(sine), ..Default::default() };
    TipMotion::new(columns).unwrap()
}

/// Samples of two sines, of all sizes below 1.3.
pub(crate) fn waves(len: usize) -> Vec<f64> {
    let wave = |k: usize| {
        let t = 1e-3 * k as f64;
        (2.0 * t).sin() + 0.3 * (11.0 * t).sin()
    };
    (0..len).map(wave).collect()
}
