//! Links of any make.

use flexlink::beam::Mesh;
use flexlink::link::{Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper, Timoshenko};
use flexlink::modal::natural_frequencies;
use num_complex::Complex64;
use proptest::prelude::*;

use crate::common::mesh_of;

/// One to four tapered segments, up to three lumped masses, a payload with inertia and offset,
/// with or without a hub radius.
pub(crate) fn any_parts() -> impl Strategy<Value = LinkParts> {
    let segments = prop::collection::vec(any_segment(), 1..=4);
    // Segment, eighths of its length, mass and rotary inertia.
    let mass = (0_usize..4, 0_u8..=8, 0.0..0.5, 0.0..0.01);
    let masses = prop::collection::vec(mass, 0..=3);
    (segments, masses, any_hub(), any_payload()).prop_map(|(segments, masses, hub, payload)| {
        let place = |(segment, eighths, mass_kg, inertia_kg_m2)| {
            let inner = &segments[..segment % segments.len()];
            let length_m = segments[inner.len()].length_m;
            let inner_m: f64 = inner.iter().map(|s: &Segment| s.length_m).sum();
            LumpedMass {
                at_m: hub.radius_m + inner_m + length_m * f64::from(eighths) / 8.0,
                mass_kg,
                inertia_kg_m2,
            }
        };
        LinkParts {
            masses: masses.into_iter().map(place).collect(),
            segments,
            hub,
            payload,
            ..LinkParts::default()
        }
    })
}

fn any_segment() -> impl Strategy<Value = Segment> {
    let taper = |mean: std::ops::Range<f64>| {
        (mean, 0.5..2.0_f64).prop_map(|(inner, ratio)| Taper { inner, outer: inner * ratio })
    };
    let theory = prop_oneof![
        Just(None),
        (taper(1e2..1e4), taper(1e-4..1e-2)).prop_map(|(shear, rotary)| Some(Timoshenko {
            shear_stiffness_n: shear,
            rotary_inertia_per_length_kg_m: rotary,
        })),
    ];
    (0.2..1.0_f64, taper(1.0..20.0), taper(0.1..2.0), theory).prop_map(
        |(length_m, stiffness, mass, timoshenko)| Segment {
            name: None,
            length_m,
            bending_stiffness_n_m2: stiffness,
            mass_per_length_kg_m: mass,
            cross_section: None,
            timoshenko,
        },
    )
}

fn any_hub() -> impl Strategy<Value = Hub> {
    let radius = prop_oneof![Just(0.0), 0.01..0.2];
    (0.0..0.5, radius).prop_map(|(inertia_kg_m2, radius_m)| Hub {
        inertia_kg_m2,
        radius_m,
        viscous_friction_n_m_s_rad: 0.0,
    })
}

fn any_payload() -> impl Strategy<Value = Payload> {
    let body = (0.0..1.0, 0.0..0.02, -0.05..0.1);
    let body = body.prop_map(|(mass_kg, inertia_kg_m2, offset_m)| Payload {
        mass_kg,
        inertia_kg_m2,
        offset_m,
    });
    prop_oneof![Just(Payload::default()), body]
}

/// A frequency, from half the first natural frequency of a link to twenty times it, and ξ.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Excitation {
    ratio: f64,
    pub(crate) xi: f64,
}

pub(crate) fn any_excitation() -> impl Strategy<Value = Excitation> {
    (-0.3..1.3_f64, 0.005..0.1)
        .prop_map(|(decades, xi)| Excitation { ratio: 10.0_f64.powf(decades), xi })
}

impl Excitation {
    /// Angular frequency ω in rad/s for the link at hand.
    pub(crate) fn omega_rad_s(&self, mesh: &Mesh) -> f64 {
        self.ratio * natural_frequencies(mesh, 1)[0]
    }

    /// `λ = ω²/(1 + 2iξ)`.
    pub(crate) fn lambda(&self, mesh: &Mesh) -> Complex64 {
        Complex64::from(self.omega_rad_s(mesh).powi(2)) / Complex64::new(1.0, 2.0 * self.xi)
    }
}

/// The link in `elements` elements.
pub(crate) fn mesh(parts: &LinkParts, elements: usize) -> Mesh {
    let link = Link::new(parts.clone()).expect("a valid link");
    mesh_of(&link, elements)
}
