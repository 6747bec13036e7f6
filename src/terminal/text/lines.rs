//! Lines about the link that several commands print.

use std::fmt::Write as _;

use flexlink::beam::Mesh;
use flexlink::link::{Damping, Link};
use flexlink::modal::DampingLaw;
use flexlink::numeric::{significant, visible};
use flexlink::result::Peak;

/// The link's title, then a line for each label that has content.
pub(crate) fn labelled(link: &Link, lines: &[(&str, String)]) -> String {
    let mut text = title(link);
    for (label, content) in lines.iter().filter(|(_, content)| !content.is_empty()) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{label:<8} {content}");
    }
    text
}

/// The link's title on a line of its own, if it has one.
pub(crate) fn title(link: &Link) -> String {
    if link.title().is_empty() { String::new() } else { format!("{}\n", visible(link.title())) }
}

/// Length, mesh and rigid inertia.
pub(crate) fn link_line(link: &Link, mesh: &Mesh) -> String {
    format!(
        "{} m, {} elements, rigid inertia {} kg m²",
        significant(link.length_m(), 4),
        mesh.elements().len(),
        significant(link.rigid_inertia_kg_m2(), 4)
    )
}

/// The damping law in words.
pub(crate) fn damping_line(link: &Link, law: &DampingLaw) -> String {
    match (link.damping(), law) {
        (Damping::None | Damping::Hysteretic { ratio: 0.0 }, _) => "none".into(),
        (_, DampingLaw::Rayleigh { alpha_per_s, beta_s }) => {
            let (alpha, beta) = (significant(*alpha_per_s, 3), significant(*beta_s, 3));
            format!("rayleigh, alpha {alpha} 1/s, beta {beta} s")
        }
        (Damping::Hysteretic { ratio }, _) => format!("hysteretic, ratio {ratio}"),
        (Damping::Modal { ratios }, _) if ratios.len() == 1 => {
            format!("modal, ratio {}", ratios[0])
        }
        (damping, _) => format!("{}, all modes of the mesh", damping.name()),
    }
}

/// Damping ratios of the modes, where they are not all one; empty otherwise.
pub(crate) fn ratios_line(law: &DampingLaw, frequencies_rad_s: &[f64]) -> String {
    let ratios = law.modal_ratios(frequencies_rad_s);
    let first = ratios.first().map_or(0, |ratio| ratio.to_bits());
    let are_one = ratios.iter().all(|ratio| ratio.to_bits() == first);
    if are_one { String::new() } else { list(&ratios, 2) }
}

/// What the hub does at most: angle in rad, rate in rad/s, power in W.
pub(crate) fn hub_line(angle: Peak, rate: Peak, power: Peak) -> String {
    format!(
        "turns by up to {} rad; peaks {} rad/s, {} W",
        significant(angle.value, 4),
        significant(rate.value, 4),
        significant(power.value, 4)
    )
}

/// Several numbers with `digits` significant digits each.
pub(crate) fn list(values: &[f64], digits: usize) -> String {
    if values.is_empty() {
        return "none".into();
    }
    values.iter().map(|value| significant(*value, digits)).collect::<Vec<_>>().join(" ")
}

/// A number of things, in singular or plural.
pub(crate) fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}
