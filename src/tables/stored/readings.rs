use std::fmt;

use serde::Deserialize as Derived;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};

/// Numbers of a JSON object by name, in the order in which they stand there, those of an object in it
/// by both names; null is no number.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Readings(pub(super) Vec<(String, f64)>);

impl Readings {
    /// The number of this name.
    pub(super) fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, number)| *number)
    }

    /// The same numbers with names that begin so.
    pub(super) fn prefixed(self, prefix: &str) -> impl Iterator<Item = (String, f64)> {
        self.0.into_iter().map(move |(name, number)| (format!("{prefix}{name}"), number))
    }
}

impl<'de> Deserialize<'de> for Readings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

/// What stands at a name.
#[derive(Derived)]
#[serde(untagged)]
enum Reading {
    Number(Option<f64>),
    /// Of one thing, and by name again.
    Inner(Readings),
}

struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = Readings;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("numbers by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Readings, A::Error> {
        let mut readings = Readings::default();
        while let Some((name, reading)) = map.next_entry()? {
            match reading {
                Reading::Number(number) => readings.0.extend(number.map(|number| (name, number))),
                Reading::Inner(inner) => readings.0.extend(inner.prefixed(&format!("{name}_"))),
            }
        }
        Ok(readings)
    }
}
