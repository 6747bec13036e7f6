use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

/// A whole number of elements or modes, or that of a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Count(pub(super) usize);

impl Count {
    pub(super) const MOST: usize = 100_000;
}

/// Elements of the whole link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Elements {
    /// `"auto"`
    Auto,
    /// A total.
    Total(Count),
}

/// Expects a count, or also the word `auto`.
struct CountVisitor {
    wanted: &'static str,
}

impl CountVisitor {
    fn count<E: Error>(&self, number: i64) -> Result<Count, E> {
        match usize::try_from(number) {
            Ok(count) if (1..=Count::MOST).contains(&count) => Ok(Count(count)),
            _ => Err(E::custom(format!("must be {}", self.wanted))),
        }
    }
}

impl Visitor<'_> for CountVisitor {
    type Value = Elements;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.wanted)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Elements, E> {
        self.count(number).map(Elements::Total)
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Elements, E> {
        match word {
            "auto" => Ok(Elements::Auto),
            _ => Err(E::custom(format!("must be {}", self.wanted))),
        }
    }
}

const A_COUNT: &str = "a whole number from 1 to 100000";

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match deserializer.deserialize_any(CountVisitor { wanted: A_COUNT })? {
            Elements::Total(count) => Ok(count),
            Elements::Auto => Err(D::Error::custom(format!("must be {A_COUNT}"))),
        }
    }
}

impl<'de> Deserialize<'de> for Elements {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CountVisitor {
            wanted: "a whole number from 1 to 100000, or \"auto\"",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::raw::RawMesh;
    use super::super::tree::Node;
    use super::*;

    #[test]
    fn a_mesh_counts_its_elements_or_leaves_them_to_the_program() {
        let elements = |text: &str| {
            let tree = Node::document(text).unwrap();
            RawMesh::deserialize(&tree).map(|mesh| mesh.elements).ok()
        };
        let total = |count| Some(Some(Elements::Total(Count(count))));
        assert_eq!(elements("elements = 100000"), total(100_000));
        assert_eq!(elements("elements = 'auto'"), Some(Some(Elements::Auto)));
        assert_eq!(elements(""), Some(None));
        for text in ["elements = 100001", "elements = -1", "elements = 1.5", "elements = '5'"] {
            assert_eq!(elements(text), None, "{text}");
        }
    }
}
