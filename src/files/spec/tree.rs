//! The link file as a tree of values, each with the line or `--set` that wrote it; serde reads the raw form from this
//! tree.

use std::cell::Cell;
use std::ops::Range;

use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Unexpected,
    Visitor,
};
use serde::forward_to_deserialize_any;
use toml::de::{DeTable, DeValue};

use super::error::{Fault, Misfit, SpecError};
use crate::text::excerpt;

/// Origin of a value; later places are greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Place {
    /// The whole file.
    File,
    /// Line of the file, from 1.
    Line(usize),
    /// Number of the `--set`, from 0.
    Override(usize),
}

/// A value of the link file, and its origin.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub(super) place: Place,
    pub(super) kind: Kind,
}

/// A value of the link file.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kind {
    Text(String),
    Integer(i64),
    Number(f64),
    Boolean(bool),
    Date(String),
    List(Vec<Node>),
    /// Entries in the order of the file.
    Table(Vec<(String, Node)>),
}

impl Node {
    /// Reads a TOML document; errors call it `name`.
    ///
    /// # Errors
    /// The line, and the message of the TOML parser.
    pub(super) fn document(name: &str, text: &str) -> Result<Self, SpecError> {
        let line_ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let line = |span: Range<usize>| line_ends.partition_point(|at| *at < span.start) + 1;
        let root = DeTable::parse(text).map_err(|error| {
            let place = error.span().map_or(name.to_owned(), |at| format!("{name}:{}", line(at)));
            let message = match (error.message(), error.span()) {
                ("duplicate key", Some(at)) => format!("duplicate key `{}`", excerpt(&text[at])),
                (message, _) => message.to_owned(),
            };
            Fault::new("", message).at(place)
        })?;
        let kind = table(root.get_ref(), &|span| Place::Line(line(span)));
        Ok(Self { place: Place::File, kind })
    }

    /// Reads one TOML value, written at `place`. Other text is a string, because a shell removes the quotes.
    pub(super) fn value(text: &str, place: Place) -> Self {
        let kind = DeValue::parse(text).map_or_else(
            |_| Kind::Text(text.to_owned()),
            |value| kind(value.get_ref(), &|_| place),
        );
        Self { place, kind }
    }

    /// The value at a key of a table or at a number of a list.
    pub(super) fn get(&self, step: &str) -> Option<&Self> {
        match &self.kind {
            Kind::Table(entries) => {
                let entry = entries.iter().find(|(key, _)| key == step);
                entry.map(|(_, node)| node)
            }
            Kind::List(items) => items.get(step.parse::<usize>().ok()?),
            _ => None,
        }
    }

    /// Origin of the value at a dotted path, or of the innermost value that encloses it.
    pub(super) fn place_of(&self, path: &str) -> Place {
        let mut node = self;
        for step in path.split('.') {
            match node.get(step) {
                Some(inner) => node = inner,
                None => break,
            }
        }
        node.place
    }

    /// Text of the value in messages.
    pub(super) fn shown(&self) -> String {
        match &self.kind {
            Kind::Text(text) => format!("{:?}", excerpt(text)),
            Kind::Integer(number) => number.to_string(),
            Kind::Number(number) => format!("{number:?}"),
            Kind::Boolean(truth) => truth.to_string(),
            Kind::Date(date) => date.clone(),
            Kind::List(items) => {
                // Each item takes at least two characters of the excerpt.
                let shown: Vec<String> = items.iter().take(30).map(Self::shown).collect();
                let more = if items.len() > shown.len() { ", …" } else { "" };
                format!("[{}{more}]", excerpt(&shown.join(", ")))
            }
            Kind::Table(_) => "a table".into(),
        }
    }
}

fn table(entries: &DeTable<'_>, place: &impl Fn(Range<usize>) -> Place) -> Kind {
    let mut entries: Vec<_> = entries.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let nodes = entries.into_iter().map(|(key, value)| {
        let node = Node { place: place(value.span()), kind: kind(value.get_ref(), place) };
        (key.get_ref().to_string(), node)
    });
    Kind::Table(nodes.collect())
}

fn kind(value: &DeValue<'_>, place: &impl Fn(Range<usize>) -> Place) -> Kind {
    match value {
        DeValue::String(text) => Kind::Text(text.to_string()),
        DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix())
            .map_or_else(
                // Beyond 64 bits: no count, but a sufficient size of a quantity.
                |_| Kind::Number(digits.as_str().parse().unwrap_or(f64::INFINITY)),
                Kind::Integer,
            ),
        DeValue::Float(digits) => Kind::Number(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(truth) => Kind::Boolean(*truth),
        DeValue::Datetime(date) => Kind::Date(date.to_string()),
        DeValue::Array(items) => Kind::List(
            items
                .iter()
                .map(|item| Node { place: place(item.span()), kind: kind(item.get_ref(), place) })
                .collect(),
        ),
        DeValue::Table(entries) => table(entries, place),
    }
}

impl<'de> Deserializer<'de> for &'de Node {
    type Error = Misfit;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match &self.kind {
            Kind::Text(text) => visitor.visit_borrowed_str(text),
            Kind::Integer(number) => visitor.visit_i64(*number),
            Kind::Number(number) if !number.is_finite() => Err(Misfit::custom("must be finite")),
            Kind::Number(number) => visitor.visit_f64(*number),
            Kind::Boolean(truth) => visitor.visit_bool(*truth),
            Kind::Date(_) => Err(Misfit::invalid_type(Unexpected::Other("date"), &visitor)),
            Kind::List(items) => visitor.visit_seq(Items(items.iter().enumerate())),
            Kind::Table(entries) => {
                visitor.visit_map(Entries { entries: entries.iter(), value: None })
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_some(self)
    }

    /// Accepts only a table, not a list in the order of the fields.
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

    /// Gives the first of two structs the entries that it knows, and the second one all others.
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _len: usize,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        match &self.kind {
            Kind::Table(entries) => {
                visitor.visit_seq(Parts { entries, known: Cell::default(), is_second: false })
            }
            _ => Err(Misfit::invalid_type(Unexpected::Map, &visitor)),
        }
    }

    /// Accepts one word.
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        match &self.kind {
            Kind::Text(word) => visitor.visit_enum(word.as_str().into_deserializer()),
            _ => Err(Misfit::custom("must be a string")),
        }
    }

    /// Accepts an infinite number as `Unbounded`, and only a list of tables as `Tables`.
    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        let is_table = |node: &Node| matches!(node.kind, Kind::Table(_));
        match &self.kind {
            Kind::Number(number) if name == "Unbounded" && number.is_infinite() => {
                visitor.visit_newtype_struct(number.into_deserializer())
            }
            Kind::List(items) if name == "Tables" && items.iter().all(is_table) => {
                visitor.visit_newtype_struct(self)
            }
            _ if name == "Tables" => Err(Misfit::not_tables()),
            _ => visitor.visit_newtype_struct(self),
        }
    }

    forward_to_deserialize_any! {
        bool u8 u16 u32 u64 i8 i16 i32 i64 f32 f64 char str string seq bytes byte_buf map unit
        ignored_any unit_struct tuple identifier
    }
}

/// A table for two structs.
struct Parts<'de> {
    entries: &'de [(String, Node)],
    /// Keys of the first one.
    known: Cell<&'static [&'static str]>,
    is_second: bool,
}

impl<'de> SeqAccess<'de> for Parts<'de> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        let part = seed.deserialize(&*self).map_err(|misfit| misfit.knowing(self.known.get()));
        self.is_second = true;
        part.map(Some)
    }
}

impl<'de> Deserializer<'de> for &Parts<'de> {
    type Error = Misfit;

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        if !self.is_second {
            self.known.set(fields);
        }
        let known = self.known.get();
        let own = |(key, _): &&(String, Node)| known.contains(&key.as_str()) != self.is_second;
        visitor.visit_map(Entries { entries: self.entries.iter().filter(own), value: None })
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misfit> {
        Err(Misfit::invalid_type(Unexpected::Map, &visitor))
    }

    forward_to_deserialize_any! {
        bool u8 u16 u32 u64 i8 i16 i32 i64 f32 f64 char str string seq bytes byte_buf map unit
        ignored_any unit_struct tuple tuple_struct newtype_struct enum option identifier
    }
}

struct Items<'de>(std::iter::Enumerate<std::slice::Iter<'de, Node>>);

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        let Some((number, node)) = self.0.next() else { return Ok(None) };
        seed.deserialize(node)
            .map(Some)
            .map_err(|misfit| misfit.below(number.to_string(), || node.shown()))
    }
}

struct Entries<'de, I> {
    entries: I,
    value: Option<&'de (String, Node)>,
}

impl<'de, I: Iterator<Item = &'de (String, Node)>> MapAccess<'de> for Entries<'de, I> {
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misfit> {
        self.value = self.entries.next();
        let Some((key, _)) = self.value else { return Ok(None) };
        let key: StrDeserializer<'_, Misfit> = key.as_str().into_deserializer();
        seed.deserialize(key).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Misfit> {
        let Some((key, node)) = self.value.take() else {
            return Err(Misfit::custom("must follow its key"));
        };
        seed.deserialize(node).map_err(|misfit| misfit.below(key.clone(), || node.shown()))
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::super::raw::RawSpecification;
    use super::*;

    fn fault(text: &str) -> Fault {
        let tree = Node::document("link.toml", text).unwrap();
        RawSpecification::deserialize(&tree).unwrap_err().into()
    }

    #[test]
    fn a_misfit_names_its_path_through_tables_and_lists() {
        let text = "[[segments]]\nlength = 1\n[[segments]]\nlength = 1\nI = [1, {}]\n";
        let must = "must be a number in SI or a string with its unit";
        let message = format!("segments.1.I.1 = a table, but {must}");
        assert_eq!(fault(text), Fault::new("segments.1.I.1", message));
    }

    #[test]
    fn a_table_is_not_read_from_a_list() {
        let message = "payload = [1, 0, 0], but must be a table";
        assert_eq!(fault("payload = [1, 0, 0]"), Fault::new("payload", message));
    }

    #[test]
    fn a_path_leads_to_its_line_or_to_that_of_the_enclosing_header() {
        let text = "title = 'a'\n\n[[segments]]\nlength = 1\n[[segments]]\nEI = [\n 5,\n 4]\n";
        let tree = Node::document("link.toml", text).unwrap();
        for (path, line) in [
            ("title", 1),
            ("segments", 3),
            ("segments.0.length", 4),
            ("segments.1.length", 5),
            ("segments.1.EI", 6),
            ("segments.1.EI.1", 8),
        ] {
            assert_eq!(tree.place_of(path), Place::Line(line), "{path}");
        }
        assert_eq!(tree.place_of("hub.inertia"), Place::File);
    }

    #[test]
    fn a_value_without_its_quotes_is_a_string() {
        let value = |text| Node::value(text, Place::Override(0)).kind;
        assert_eq!(value("50 g"), Kind::Text("50 g".into()));
        assert_eq!(value("\"50 g\""), Kind::Text("50 g".into()));
        assert_eq!(value("auto"), Kind::Text("auto".into()));
        assert_eq!(value("1e3"), Kind::Number(1000.0));
        assert_eq!(value("0x1F"), Kind::Integer(31));
        assert_eq!(value("123456789012345678901"), Kind::Number(1.234_567_890_123_456_8e20));
    }
}
