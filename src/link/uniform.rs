//! The link that unit tests are made of.

use super::{Damping, Hub, LinkParts, Payload, Segment, Taper};

/// Bayo's link without its stiff root, undamped: 1.5 m, 5 N m² and 0.8 kg/m on a hub of 0.1 kg m²,
/// so that its rigid inertia is 1 kg m².
pub(crate) fn uniform() -> LinkParts {
    LinkParts {
        title: String::new(),
        segments: vec![uniform_segment()],
        hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
        masses: vec![],
        payload: Payload::default(),
        damping: Damping::None,
        drive: None,
    }
}

/// Its one segment.
pub(crate) fn uniform_segment() -> Segment {
    Segment {
        name: None,
        length_m: 1.5,
        bending_stiffness_n_m2: Taper::constant(5.0),
        mass_per_length_kg_m: Taper::constant(0.8),
        cross_section: None,
    }
}
