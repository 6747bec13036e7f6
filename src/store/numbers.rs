//! Numbers by name, as an object in JSON.

use std::fmt;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::{SerializeMap as _, Serializer};
use serde::{Deserialize, Serialize};

/// Numbers of a JSON object by name, in their order there; some are null, and some are such objects
/// themselves.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Numbers(Vec<(String, Entry)>);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Entry {
    Number(f64),
    Inner(Numbers),
    Null,
}

impl Numbers {
    pub(super) fn of<const N: usize>(numbers: [(&str, f64); N]) -> Self {
        numbers.into_iter().fold(Self::default(), |all, (name, number)| all.with(name, number))
    }

    /// Adds an entry; nothing becomes null.
    pub(super) fn with(mut self, name: &str, entry: impl Into<Entry>) -> Self {
        self.0.push((name.to_owned(), entry.into()));
        self
    }

    /// Adds an entry if there is one.
    pub(super) fn with_some(self, name: &str, entry: Option<impl Into<Entry>>) -> Self {
        match entry {
            Some(entry) => self.with(name, entry),
            None => self,
        }
    }

    /// The number of this name.
    pub(super) fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find_map(|(own, entry)| match entry {
            Entry::Number(number) if own == name => Some(*number),
            _ => None,
        })
    }

    /// All finite numbers with names that begin so; one of an inner object has the names of both,
    /// `torque_mesh`.
    pub(super) fn prefixed(&self, prefix: &str) -> Vec<(String, f64)> {
        let numbers = |(name, entry): &(String, Entry)| match entry {
            Entry::Number(number) if number.is_finite() => {
                vec![(format!("{prefix}{name}"), *number)]
            }
            Entry::Inner(inner) => inner.prefixed(&format!("{prefix}{name}_")),
            Entry::Number(_) | Entry::Null => Vec::new(),
        };
        self.0.iter().flat_map(numbers).collect()
    }
}

impl From<f64> for Entry {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<Numbers> for Entry {
    fn from(numbers: Numbers) -> Self {
        Self::Inner(numbers)
    }
}

impl<T: Into<Entry>> From<Option<T>> for Entry {
    fn from(entry: Option<T>) -> Self {
        entry.map_or(Self::Null, Into::into)
    }
}

impl Serialize for Numbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, entry) in &self.0 {
            map.serialize_entry(name, entry)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = Numbers;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("numbers by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Numbers, A::Error> {
        let mut numbers = Numbers::default();
        while let Some(entry) = map.next_entry()? {
            numbers.0.push(entry);
        }
        Ok(numbers)
    }
}
