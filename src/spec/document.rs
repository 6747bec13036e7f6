use serde::Deserialize;

use super::error::{Fault, SpecError};
use super::overrides::{Override, apply};
use super::raw::RawSpecification;
use super::specification::{Specification, convert};
use super::tree::{Kind, Node, Place};

/// Reads the text of a link file and applies the `overrides` in their order.
///
/// `name` is what errors call the file.
///
/// # Errors
/// [`SpecError`] names the line, or the `--set`, and the wrong value.
pub fn read_specification(
    name: &str,
    text: &str,
    overrides: &[Override],
) -> Result<Specification, SpecError> {
    LinkDocument::read(name, text)?.specification(name, overrides)
}

/// The text of a link file, parsed once for many sets of overrides; nothing of it is checked yet.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkDocument {
    tree: Node,
}

impl LinkDocument {
    /// Parses the text of a link file, which errors call `name`.
    ///
    /// # Errors
    /// [`SpecError`] names the line that is no TOML.
    pub fn read(name: &str, text: &str) -> Result<Self, SpecError> {
        let tree = Node::document(text)
            .map_err(|(place, message)| SpecError::new(shown(name, place, &[]), &message, None))?;
        Ok(Self { tree })
    }

    /// The specification with the `overrides` applied in their order.
    ///
    /// # Errors
    /// As [`read_specification`].
    pub fn specification(
        &self,
        name: &str,
        overrides: &[Override],
    ) -> Result<Specification, SpecError> {
        let mut tree = self.tree.clone();
        for (number, change) in overrides.iter().enumerate() {
            apply(&mut tree, number, change)?;
        }
        read(&tree).map_err(|fault| {
            let place = shown(name, fault.place(&tree), overrides);
            fault.at(place)
        })
    }
}

/// A place as errors name it.
fn shown(name: &str, place: Place, overrides: &[Override]) -> String {
    match place {
        Place::File => name.to_owned(),
        Place::Line(line) => format!("{name}:{line}"),
        Place::Override(number) => overrides[number].place(),
    }
}

fn read(tree: &Node) -> Result<Specification, Fault> {
    for list in ["segments", "masses"] {
        check_list_of_tables(tree, list)?;
    }
    convert(RawSpecification::deserialize(tree)?)
}

/// Refuses `[segments]` for `[[segments]]`, an easy slip, in words of the link file.
pub(super) fn check_list_of_tables(tree: &Node, list: &str) -> Result<(), Fault> {
    let is_table = |node: &Node| matches!(node.kind, Kind::Table(_));
    match tree.get(list) {
        None => Ok(()),
        Some(node) => match &node.kind {
            Kind::List(items) if items.iter().all(is_table) => Ok(()),
            _ => {
                let must = format!("must be tables headed [[{list}]]");
                Err(Fault::new(list, format!("{list} = {}, but {must}", node.shown())))
            }
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_placed_in_the_file_the_line_or_the_setting() {
        let place = |text: &str, set: &str| {
            let error = read_specification("link.toml", text, &[set.parse().unwrap()]);
            let message = error.unwrap_err().to_string();
            message.split_once(": ").unwrap().0.to_owned()
        };
        assert_eq!(place("", "hub.inertia=1"), "link.toml");
        assert_eq!(place("\n\nlimits = 1", "hub.inertia=1"), "link.toml:3");
        assert_eq!(place("", "hub.x=1"), "--set 'hub.x=1'");
    }
}
