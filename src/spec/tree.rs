use std::ops::Range;

use toml::de::{DeTable, DeValue, Error};

use crate::numeric::excerpt;

/// Where a value was written; later places are greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Place {
    /// The file as a whole.
    File,
    /// Line of the file, from 1.
    Line(usize),
    /// Number of the `--set`, from 0.
    Override(usize),
}

/// A value of the link file and where it was written.
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
    /// In the order of the file.
    Table(Vec<(String, Node)>),
}

impl Node {
    /// Reads a TOML document.
    ///
    /// # Errors
    /// The place and the TOML parser's own words.
    pub(super) fn document(text: &str) -> Result<Self, (Place, String)> {
        let line_ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let line =
            |span: Range<usize>| Place::Line(line_ends.partition_point(|at| *at < span.start) + 1);
        let root = DeTable::parse(text).map_err(|error| complaint(&error, text, line))?;
        let kind = table(root.get_ref(), &line);
        Ok(Self { place: Place::File, kind })
    }

    /// Reads one TOML value, written at `place`; other text is a string, since a shell removes the quotes.
    pub(super) fn value(text: &str, place: Place) -> Self {
        let kind = DeValue::parse(text).map_or_else(
            |_| Kind::Text(text.to_owned()),
            |value| kind(value.get_ref(), &|_| place),
        );
        Self { place, kind }
    }

    /// The value at a key of a table or a number of a list.
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

    /// The value at a dotted path, or the innermost value that encloses it.
    pub(super) fn deepest(&self, path: &str) -> &Self {
        let mut node = self;
        for step in path.split('.') {
            match node.get(step) {
                Some(inner) => node = inner,
                None => break,
            }
        }
        node
    }

    /// The value as messages quote it.
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

fn complaint(error: &Error, text: &str, line: impl Fn(Range<usize>) -> Place) -> (Place, String) {
    let Some(span) = error.span() else {
        return (Place::File, error.message().to_owned());
    };
    let message = match error.message() {
        "duplicate key" => format!("duplicate key `{}`", excerpt(&text[span.clone()])),
        message => message.to_owned(),
    };
    (line(span), message)
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
                // Beyond 64 bits: no count, and as a quantity its size suffices.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_leads_to_its_line_or_to_that_of_the_enclosing_header() {
        let text = "title = 'a'\n\n[[segments]]\nlength = 1\n[[segments]]\nEI = [\n 5,\n 4]\n";
        let tree = Node::document(text).unwrap();
        for (path, line) in [
            ("title", 1),
            ("segments", 3),
            ("segments.0.length", 4),
            ("segments.1.length", 5),
            ("segments.1.EI", 6),
            ("segments.1.EI.1", 8),
        ] {
            assert_eq!(tree.deepest(path).place, Place::Line(line), "{path}");
        }
        assert_eq!(tree.deepest("hub.inertia").place, Place::File);
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
