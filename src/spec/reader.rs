use std::fmt::Display;

use serde::de::{
    DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, Visitor, value::StrDeserializer,
};
use serde::forward_to_deserialize_any;
use thiserror::Error as ThisError;

use super::error::{Fault, listed, nearest};
use super::tree::{Kind, Node};
use crate::numeric::excerpt;

/// Why a value does not fit the raw form, and the path to it, innermost step last.
#[derive(Debug, ThisError)]
#[error("{reason:?}")]
pub(super) struct Misfit {
    steps: Vec<String>,
    reason: Reason,
}

#[derive(Debug)]
enum Reason {
    /// Another kind of value must be there; [`Misfit::below`] fills in `found`.
    Kind {
        found: Option<String>,
        must: String,
    },
    Unknown {
        key: String,
        known: &'static [&'static str],
    },
    Missing {
        key: &'static str,
    },
}

impl Misfit {
    fn new(reason: Reason) -> Self {
        Self { steps: Vec::new(), reason }
    }

    fn must(must: String) -> Self {
        Self::new(Reason::Kind { found: None, must })
    }

    /// Adds the step that led to `node`.
    fn below(mut self, step: String, node: &Node) -> Self {
        self.steps.insert(0, step);
        if let Reason::Kind { found, .. } = &mut self.reason {
            found.get_or_insert_with(|| node.shown());
        }
        self
    }
}

impl Error for Misfit {
    fn custom<T: Display>(message: T) -> Self {
        Self::must(message.to_string())
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        // Serde calls a list a sequence.
        let expected = expected.to_string().replace("a sequence", "a list");
        Self::must(format!("must be {expected}"))
    }

    fn invalid_value(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::must(format!("must be {expected}"))
    }

    fn invalid_length(_: usize, expected: &dyn Expected) -> Self {
        Self::must(format!("must be {expected}"))
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Self {
        let key = key.to_owned();
        Self::new(Reason::Unknown { key, known })
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new(Reason::Missing { key })
    }
}

impl From<Misfit> for Fault {
    fn from(misfit: Misfit) -> Self {
        let path = misfit.steps.join(".");
        let inner = |key: &str| {
            let dot = if path.is_empty() { "" } else { "." };
            format!("{path}{dot}{key}")
        };
        match misfit.reason {
            Reason::Kind { found, must } => {
                let found = found.unwrap_or_default();
                Self::new(path.clone(), format!("{} = {found}, but {must}", excerpt(&path)))
            }
            Reason::Unknown { key, known } => {
                let place = if path.is_empty() { String::new() } else { format!(" in {path}") };
                let hint = match nearest(&key, known.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("known here: {}", listed(known, "and")),
                };
                Self::new(inner(&key), format!("unknown key `{}`{place}", excerpt(&key)))
                    .hinting(hint)
            }
            Reason::Missing { key } => Self::new(inner(key), format!("{} is missing", inner(key))),
        }
    }
}

impl<'de> Deserializer<'de> for &'de Node {
    type Error = Misfit;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match &self.kind {
            Kind::Text(text) => visitor.visit_borrowed_str(text),
            Kind::Integer(number) => visitor.visit_i64(*number),
            Kind::Number(number) if !number.is_finite() => {
                Err(Misfit::must("must be finite".into()))
            }
            Kind::Number(number) => visitor.visit_f64(*number),
            Kind::Boolean(truth) => visitor.visit_bool(*truth),
            Kind::Date(_) => Err(Misfit::invalid_type(Unexpected::Other("date"), &visitor)),
            Kind::List(items) => visitor.visit_seq(Items { items: items.iter().enumerate() }),
            Kind::Table(entries) => {
                visitor.visit_map(Entries { entries: entries.iter(), value: None })
            }
        }
    }

    /// Accepts an infinite number too.
    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.kind {
            Kind::Number(number) if number.is_infinite() => visitor.visit_f64(number),
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_some(self)
    }

    /// Accepts a table only, no list in the order of the fields.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        match self.kind {
            Kind::Table(_) => self.deserialize_any(visitor),
            _ => Err(Misfit::invalid_type(Unexpected::Map, &visitor)),
        }
    }

    forward_to_deserialize_any! {
        bool u8 u16 u32 u64 i8 i16 i32 i64 f32 char str string seq bytes byte_buf map unit
        newtype_struct ignored_any unit_struct tuple_struct tuple enum identifier
    }
}

struct Items<'de> {
    items: std::iter::Enumerate<std::slice::Iter<'de, Node>>,
}

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        let Some((number, node)) = self.items.next() else {
            return Ok(None);
        };
        seed.deserialize(node).map(Some).map_err(|misfit| misfit.below(number.to_string(), node))
    }
}

struct Entries<'de> {
    entries: std::slice::Iter<'de, (String, Node)>,
    value: Option<&'de (String, Node)>,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misfit> {
        self.value = self.entries.next();
        let Some((key, _)) = self.value else {
            return Ok(None);
        };
        let key: StrDeserializer<'_, Misfit> = key.as_str().into_deserializer();
        seed.deserialize(key).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Misfit> {
        let Some((key, node)) = self.value.take() else {
            return Err(Misfit::custom("must follow its key"));
        };
        seed.deserialize(node).map_err(|misfit| misfit.below(key.clone(), node))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use super::super::raw::RawSpecification;
    use serde::Deserialize;

    #[test]
    fn a_misfit_names_its_path_through_tables_and_lists() {
        let text = "[[segments]]\nlength = 1\n[[segments]]\nlength = 1\nI = [1, {}]\n";
        let tree = Node::document(text).unwrap();
        let fault = Fault::from(RawSpecification::deserialize(&tree).unwrap_err());
        let must = "must be a number in SI or a string with its unit";
        let message = format!("segments.1.I.1 = a table, but {must}");
        assert_eq!(fault, Fault::new("segments.1.I.1", message));
    }

    #[test]
    fn a_table_is_not_read_from_a_list() {
        let tree = Node::document("payload = [1, 0, 0]").unwrap();
        let fault = Fault::from(RawSpecification::deserialize(&tree).unwrap_err());
        let message = "payload = [1, 0, 0], but must be a table";
        assert_eq!(fault, Fault::new("payload", message));
    }
}
