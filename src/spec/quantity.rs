//! The values of the link file: quantities, numbers, counts.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Unexpected, Visitor};

use super::error::Fault;
use crate::link::{ParameterError, Taper};
use crate::numeric::{Dimension, UnitError, excerpt, parse_quantity};

/// A number in SI, or a string with its unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Quantity {
    Number(f64),
    Text(String),
}

impl Default for Quantity {
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl Quantity {
    /// The value in SI; `path` is its place, for errors.
    pub(super) fn si(&self, path: &str, dimension: Dimension) -> Result<f64, Fault> {
        match self {
            Self::Number(number) => Ok(*number),
            Self::Text(text) => parse_quantity(text, dimension).map_err(|error| {
                let hint = match error {
                    UnitError::NotANumber => Some(example(dimension)),
                    UnitError::UnknownUnit { .. } => error.hint().or(Some(example(dimension))),
                    _ => error.hint(),
                };
                Fault::new(path, format!("{path} = {:?} {error}", excerpt(text))).hinting(hint)
            }),
        }
    }
}

/// The value in SI, if one is given; `path` is its place, for errors.
pub(super) fn optional_si(
    path: &str,
    value: Option<&Quantity>,
    dimension: Dimension,
) -> Result<Option<f64>, Fault> {
    value.map(|value| value.si(path, dimension)).transpose()
}

fn example(dimension: Dimension) -> String {
    let name = dimension.name().unwrap_or("a number");
    format!("{name} is wanted, such as \"1 {}\"", dimension.si_unit())
}

/// One quantity along a segment, or those at its inner and outer end.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Tapered {
    Constant(Quantity),
    Linear([Quantity; 2]),
}

impl Tapered {
    /// The values in SI; `path` is their place, for errors.
    pub(super) fn si(&self, path: &str, dimension: Dimension) -> Result<Taper, Fault> {
        match self {
            Self::Constant(value) => Ok(Taper::constant(value.si(path, dimension)?)),
            Self::Linear([inner, outer]) => {
                Ok(Taper { inner: inner.si(path, dimension)?, outer: outer.si(path, dimension)? })
            }
        }
    }
}

/// A quantity that may be infinite.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unbounded(pub(super) Quantity);

/// A pure number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Real(pub(super) f64);

/// A number of elements or modes, or the number of a mode.
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

/// Refuses a taper unless both ends are above 0.
pub(super) fn positive(path: &str, taper: Taper, unit: &str) -> Result<Taper, Fault> {
    let refused = [taper.inner, taper.outer].into_iter().find(|value| *value <= 0.0);
    refused.map_or(Ok(taper), |value| {
        Err(ParameterError::new(path, value, unit, "must be above 0").into())
    })
}

/// A value that is no table, as the file gives it.
enum Value {
    Integer(i64),
    Number(f64),
    Text(String),
    List(Vec<Quantity>),
}

impl Value {
    fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(number) => Some(*number as f64),
            Self::Number(number) => Some(*number),
            Self::Text(_) | Self::List(_) => None,
        }
    }

    fn count(&self) -> Option<Count> {
        let Self::Integer(number) = self else { return None };
        let count = usize::try_from(*number).ok()?;
        (1..=Count::MOST).contains(&count).then_some(Count(count))
    }

    fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Text(text) => Some(Quantity::Text(text)),
            number => number.number().map(Quantity::Number),
        }
    }

    fn taper(self) -> Option<Tapered> {
        match self {
            Self::List(ends) => <[Quantity; 2]>::try_from(ends).ok().map(Tapered::Linear),
            constant => constant.quantity().map(Tapered::Constant),
        }
    }

    fn elements(self) -> Option<Elements> {
        match self {
            Self::Text(word) => (word == "auto").then_some(Elements::Auto),
            number => number.count().map(Elements::Total),
        }
    }
}

/// Reads any value that is no table; refusals say `what` must be there.
struct Wanted {
    what: &'static str,
    takes_list: bool,
}

impl<'de> Visitor<'de> for Wanted {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.what)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Integer(number))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        if !self.takes_list {
            return Err(A::Error::invalid_type(Unexpected::Seq, &self));
        }
        let mut values = Vec::new();
        while let Some(value) = items.next_element()? {
            values.push(value);
        }
        Ok(Value::List(values))
    }
}

const QUANTITY: Wanted =
    Wanted { what: "a number in SI or a string with its unit", takes_list: false };
const TAPER: Wanted = Wanted {
    what: "a number in SI, a string with its unit, or two of them [inner, outer]",
    takes_list: true,
};
const REAL: Wanted = Wanted { what: "a number", takes_list: false };
const COUNT: Wanted = Wanted { what: "a whole number from 1 to 100000", takes_list: false };
const ELEMENTS: Wanted =
    Wanted { what: "a whole number from 1 to 100000, or \"auto\"", takes_list: false };

impl Wanted {
    /// Reads a value and converts it; `None` from `of` refuses it.
    fn read<'de, D: Deserializer<'de>, T>(
        self,
        deserializer: D,
        of: impl FnOnce(Value) -> Option<T>,
    ) -> Result<T, D::Error> {
        let what = self.what;
        let value = deserializer.deserialize_any(self)?;
        of(value).ok_or_else(|| D::Error::custom(format!("must be {what}")))
    }
}

/// Implements `Deserialize` by a conversion of a value.
macro_rules! read {
    ($($type:ident: $wanted:ident by $of:expr;)+) => {
        $(impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $wanted.read(deserializer, $of)
            }
        })+
    };
}

read! {
    Quantity: QUANTITY by Value::quantity;
    Tapered: TAPER by Value::taper;
    Real: REAL by |value| value.number().map(Real);
    Count: COUNT by |value| value.count();
    Elements: ELEMENTS by Value::elements;
}

impl<'de> Deserialize<'de> for Unbounded {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // The reader accepts an infinite number only where `f64` is asked for.
        let value = deserializer.deserialize_f64(QUANTITY)?;
        value.quantity().map(Self).ok_or_else(|| D::Error::custom("must be a quantity"))
    }
}

#[cfg(test)]
mod tests {
    use super::super::raw::RawMesh;
    use super::super::tree::Node;
    use super::*;

    #[test]
    fn a_number_is_si_and_text_has_its_unit() {
        let si = |value: Quantity| value.si("hub.inertia", Dimension::ROTARY_INERTIA);
        assert_eq!(si(Quantity::Number(0.1)), Ok(0.1));
        assert_eq!(si(Quantity::Text("1000 kg cm^2".into())), Ok(0.1));
        let fault = si(Quantity::Text("heavy".into())).unwrap_err();
        let message = "hub.inertia = \"heavy\" does not begin with a decimal number";
        let hint = "a rotary inertia is wanted, such as \"1 kg m^2\"".to_owned();
        assert_eq!(fault, Fault::new("hub.inertia", message).hinting(hint));
    }

    #[test]
    fn each_end_of_a_taper_may_have_its_own_unit() {
        let ends = [Quantity::Text("10 cm^2".into()), Quantity::Number(5e-4)];
        let taper = Tapered::Linear(ends).si("segments.0.area", Dimension::AREA);
        assert_eq!(taper, Ok(Taper { inner: 1e-3, outer: 5e-4 }));
    }

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
