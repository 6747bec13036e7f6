//! What a value that is set takes the place of.

use super::tree::{Kind, Node};

/// Removes what the value that is set at `step` takes the place of.
///
/// A product takes the place of its factors, and of the section if nothing else needs it; one ratio
/// in every mode and a ratio for each mode take each other's.
pub(super) fn make_room(entries: &mut Vec<(String, Node)>, step: &str) {
    let (replaced, section_serves): (&[&str], _) = match step {
        "EI" => (&["E", "I"], Some("density")),
        "mass_per_length" => (&["density", "area"], Some("E")),
        "ratio" => (&["ratios", "modes"], None),
        "ratios" => (&["ratio"], None),
        _ => (&[], None),
    };
    let is_idle = |other: &str| entries.iter().all(|(key, _)| key != other);
    let section = section_serves.filter(|other| is_idle(other)).map(|_| "section");
    entries.retain(|(key, _)| !replaced.contains(&key.as_str()) && Some(key.as_str()) != section);
}

/// Removes the elements of single segments: a number for the whole link takes their place.
pub(super) fn remove_own_elements(tree: &mut Node) {
    let Kind::Table(entries) = &mut tree.kind else { return };
    let segments = entries.iter_mut().filter(|(key, _)| key == "segments");
    for (_, segments) in segments {
        let Kind::List(segments) = &mut segments.kind else { continue };
        for segment in segments {
            if let Kind::Table(entries) = &mut segment.kind {
                entries.retain(|(key, _)| key != "elements");
            }
        }
    }
}
