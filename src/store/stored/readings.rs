use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};

/// Numbers of a JSON object by name, in the order in which they stand there; null is no number, and a
/// number of an inner object has the names of both, `torque_mesh`.
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

/// What stands behind a name.
#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Number(f64),
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
        while let Some((name, entry)) = map.next_entry::<String, Option<Entry>>()? {
            match entry {
                Some(Entry::Number(number)) => readings.0.push((name, number)),
                Some(Entry::Inner(inner)) => readings.0.extend(inner.prefixed(&format!("{name}_"))),
                None => {}
            }
        }
        Ok(readings)
    }
}
