use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

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
    /// The value in SI of the quantity that stands at `path`.
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
    /// The values in SI of the taper that stands at `path`.
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

impl<'de> Deserialize<'de> for Unbounded {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Asked for a number outright, the reader lets an infinite one pass.
        deserializer.deserialize_f64(QuantityVisitor).map(Self)
    }
}

/// A pure number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Real(pub(super) f64);

/// Refuses a taper unless both ends are above 0.
pub(super) fn positive(path: &str, taper: Taper, unit: &str) -> Result<Taper, Fault> {
    let refused = [taper.inner, taper.outer].into_iter().find(|value| *value <= 0.0);
    refused.map_or(Ok(taper), |value| {
        Err(ParameterError::new(path, value, unit, "must be above 0").into())
    })
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(QuantityVisitor)
    }
}

struct QuantityVisitor;

impl Visitor<'_> for QuantityVisitor {
    type Value = Quantity;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number in SI or a string with its unit")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Quantity, E> {
        Ok(Quantity::Number(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Quantity, E> {
        Ok(Quantity::Number(number as f64))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Quantity, E> {
        Ok(Quantity::Text(text.to_owned()))
    }
}

impl<'de> Deserialize<'de> for Tapered {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TaperedVisitor)
    }
}

struct TaperedVisitor;

impl<'de> Visitor<'de> for TaperedVisitor {
    type Value = Tapered;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number in SI, a string with its unit, or two of them [inner, outer]")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Tapered, E> {
        QuantityVisitor.visit_f64(number).map(Tapered::Constant)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Tapered, E> {
        QuantityVisitor.visit_i64(number).map(Tapered::Constant)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Tapered, E> {
        QuantityVisitor.visit_str(text).map(Tapered::Constant)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Tapered, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = items.next_element()? {
            values.push(value);
        }
        let count = values.len();
        let ends: Result<[Quantity; 2], _> = values.try_into();
        ends.map(Tapered::Linear).map_err(|_| A::Error::invalid_length(count, &self))
    }
}

impl<'de> Deserialize<'de> for Real {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RealVisitor)
    }
}

struct RealVisitor;

impl Visitor<'_> for RealVisitor {
    type Value = Real;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Real, E> {
        Ok(Real(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Real, E> {
        Ok(Real(number as f64))
    }
}

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
