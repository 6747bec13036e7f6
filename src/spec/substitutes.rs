//! Keys of the link file that replace each other: which keys a `--set` removes, and which key to multiply
//! if the named one is absent.

use super::error::nearest;
use super::tree::{Kind, Node};

/// Removes the keys that a new value at `step` replaces.
///
/// A product replaces its factors, and the section if no other key needs it; `ratio` and `ratios`
/// replace each other.
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

/// Removes the elements of single segments, which a number for the whole link replaces.
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

/// Hint for a factor on the absent key `step`.
pub(super) fn instead(entries: &[(String, Node)], step: &str) -> String {
    let has = |wanted: &str| entries.iter().any(|(key, _)| key == wanted);
    let others: &[&str] = match step {
        "E" | "I" => &["EI", "E"],
        "density" | "area" => &["mass_per_length", "density"],
        "ratio" => &["ratios"],
        "ratios" => &["ratio"],
        _ => &[],
    };
    match others.iter().find(|other| has(other)) {
        Some(other) => format!("the file gives {other} there: multiply that"),
        None => match nearest(step, multiplied(entries)) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "give it a value with `=`".into(),
        },
    }
}

/// The keys that can be multiplied: those of the file, and products of which the file has a factor.
fn multiplied(entries: &[(String, Node)]) -> impl Iterator<Item = &str> {
    let there = || entries.iter().map(|(key, _)| key.as_str());
    let products = [("E", "EI"), ("density", "mass_per_length")];
    let given = move |(factor, _): &(&str, &str)| there().any(|key| key == *factor);
    there().chain(products.into_iter().filter(given).map(|(_, product)| product))
}

#[cfg(test)]
mod tests {
    use super::super::overrides::apply;
    use super::*;

    #[test]
    fn a_slip_in_a_product_of_which_a_factor_is_given_is_asked_about() {
        let text = "[[segments]]\nlength = 1\nE = 2e11\nI = 1e-10\ndensity = 7800\narea = 1e-4\n";
        let mut tree = Node::document(text).unwrap();
        for (slip, meant) in
            [("EII", "EI"), ("mass_per_lenght", "mass_per_length"), ("lenght", "length")]
        {
            let change = format!("segments.*.{slip}*=2").parse().unwrap();
            let error = apply(&mut tree, 0, &change).unwrap_err();
            assert_eq!(error.hint(), Some(format!("did you mean `{meant}`?").as_str()));
        }
    }
}
