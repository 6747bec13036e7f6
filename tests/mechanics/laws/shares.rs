//! How elements are shared among the pieces of a link.

use flexlink::beam::Piece;
use flexlink::link::{Link, LinkParts, LumpedMass, Segment, Taper};
use proptest::prelude::*;

use super::links::any_parts;
use crate::common::plan_of;

/// Pieces and their elements where no segment has a number of its own.
fn shares(link: &Link, elements: usize) -> Vec<(Piece, usize)> {
    plan_of(link, elements).shares().to_vec()
}

/// Phase of a bending wave over a piece, ∫(m̄/EI)^¼ dx up to a factor, by Simpson's rule; of a link
/// without mass its length.
fn phase(link: &Link, piece: &Piece, has_mass: bool) -> f64 {
    let segment = &link.segments()[piece.segment];
    let density =
        |at: f64| segment.mass_per_length_kg_m.at(at) / segment.bending_stiffness_n_m2.at(at);
    let wave_number = |at: f64| if has_mass { density(at).powf(0.25) } else { 1.0 };
    let ends = wave_number(piece.from) + wave_number(piece.to);
    let middle = wave_number(0.5 * (piece.from + piece.to));
    segment.length_m * (piece.to - piece.from) * (ends + 4.0 * middle) / 6.0
}

proptest! {
    /// The longest element, measured in wavelengths, is as short as so many elements allow.
    #[test]
    fn no_element_would_serve_better_in_another_piece(
        mut parts in any_parts(),
        elements in 20_usize..300,
        has_mass in any::<bool>(),
    ) {
        if !has_mass {
            for segment in &mut parts.segments {
                segment.mass_per_length_kg_m = Taper::constant(0.0);
                segment.timoshenko = None;
            }
            parts.payload.mass_kg = 1.0;
        }
        let link = Link::new(parts)?;
        let shares = shares(&link, elements);
        prop_assert_eq!(shares.iter().map(|(_, count)| count).sum::<usize>(), elements);
        let phase = |piece: &Piece| phase(&link, piece, has_mass);
        let longest = shares.iter().map(|(p, count)| phase(p) / *count as f64).fold(0.0, f64::max);
        for (piece, count) in shares.iter().filter(|(_, count)| *count > 1) {
            let without = phase(piece) / (count - 1) as f64;
            // The program takes the middle of a piece for the whole of it.
            prop_assert!(without > 0.98 * longest, "{:?}: {} of {}", piece, without, longest);
        }
    }
}

#[test]
fn a_mass_within_a_billionth_of_the_length_of_a_border_needs_no_node_of_its_own() {
    for length_m in [0.01, 100.0] {
        let pieces = |share: f64| {
            let segment = || Segment::uniform(length_m, 5.0, 0.8);
            let at_m = length_m + share * 2.0 * length_m;
            let link = Link::new(LinkParts {
                segments: vec![segment(), segment()],
                masses: vec![LumpedMass { at_m, mass_kg: 0.1, inertia_kg_m2: 0.0 }],
                ..LinkParts::default()
            });
            shares(&link.expect("a valid link"), 9).len()
        };
        assert_eq!([-1.1e-9, -0.9e-9, 0.9e-9, 1.1e-9].map(pieces), [3, 2, 2, 3], "{length_m} m");
    }
}
