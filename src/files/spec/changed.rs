//! The values of a link file with its changes, and its text with them.

use serde::{Serialize, Serializer};

use super::document::LinkDocument;
use super::error::{Fault, SpecError};
use super::free::{is_close, rewritten};
use super::overrides::Override;
use super::tree::{Kind, Node};

impl Serialize for Node {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.kind {
            Kind::Text(text) | Kind::Date(text) => serializer.serialize_str(text),
            Kind::Integer(number) => serializer.serialize_i64(*number),
            Kind::Number(number) => serializer.serialize_f64(*number),
            Kind::Boolean(truth) => serializer.serialize_bool(*truth),
            Kind::List(items) => serializer.collect_seq(items),
            Kind::Table(entries) => {
                serializer.collect_map(entries.iter().map(|(key, node)| (key, node)))
            }
        }
    }
}

impl LinkDocument {
    /// The values of the file with the changes applied, in JSON: numbers in SI, texts with their units.
    ///
    /// # Errors
    /// [`SpecError`] for a change that does not fit the file.
    pub fn values(&self, changes: &[Override]) -> Result<String, SpecError> {
        Ok(serde_json::to_string(&self.changed(changes)?).unwrap_or_default())
    }
}

/// The text of a link file with the changes in it, which reads back to the same values.
///
/// Changes that replace values of the text leave its comments, its order and all else. After a change that adds or
/// removes a key the text is new, without comments. `is_new` asks for a new text in any case.
///
/// # Errors
/// [`SpecError`] for a change that does not fit the file.
pub fn changed_text(
    name: &str,
    text: &str,
    changes: &[Override],
    is_new: bool,
) -> Result<String, SpecError> {
    if !is_new && let Ok((text, _)) = rewritten((name, text), changes, None) {
        return Ok(text);
    }
    let tree = LinkDocument::read(name, text)?.changed(changes)?;
    let refused = |why: String| Fault::new("", why).at(name.to_owned());
    let written = toml::to_string(&tree).map_err(|error| refused(error.to_string()))?;
    let again = LinkDocument::read(name, &written)?.changed(&[])?;
    if has_all(&again, &tree) { Ok(written) } else { Err(refused("is no TOML".to_owned())) }
}

/// True if two trees have the same values, the keys in any order.
fn has_all(a: &Node, b: &Node) -> bool {
    match (&a.kind, &b.kind) {
        (Kind::Table(own), Kind::Table(others)) => {
            let is_same =
                |(key, node): &(String, Node)| b.get(key).is_some_and(|other| has_all(node, other));
            own.len() == others.len() && own.iter().all(is_same)
        }
        (Kind::List(own), Kind::List(others)) => {
            own.len() == others.len() && own.iter().zip(others).all(|(a, b)| has_all(a, b))
        }
        _ => is_close(a, b, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINK: &str = "# A strip.\n[[segments]]\nname = 'root' # stiff\nlength = '15 cm'\nE = '200 GPa'\n\
        I = 1e-11 # by hand\ndensity = 7800\narea = 1e-5\n\n[payload]\nmass = '50 g'\n";

    fn changed(changes: &[&str]) -> String {
        let changes: Vec<Override> = changes.iter().map(|own| own.parse().unwrap()).collect();
        let text = changed_text("l.toml", LINK, &changes, false).unwrap();
        let document = LinkDocument::read("l.toml", LINK).unwrap();
        let tree = document.changed(&changes).unwrap();
        let read = LinkDocument::read("l.toml", &text).unwrap().changed(&[]).unwrap();
        assert!(has_all(&read, &tree), "{text}");
        text
    }

    #[test]
    fn a_changed_value_keeps_all_digits_and_comments_stay() {
        let text = changed(&["payload.mass*=0.123456789123", "segments.0.name=tip"]);
        assert!(text.contains("\"6.17283945615 g\"") && text.contains("name = \"tip\" # stiff"));
        assert_eq!(changed(&[]), LINK);
    }

    #[test]
    fn an_added_key_makes_a_new_text_with_the_same_values() {
        let text = changed(&["hub.inertia=0.1", "segments.0.EI=5", "title=a \"b\" = c"]);
        assert!(text.contains("[hub]\ninertia = 0.1") && text.contains("[[segments]]"), "{text}");
    }
}
