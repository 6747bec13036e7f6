//! Values of the link file: quantities, counts, and their JSON Schema.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, Error, SeqAccess, Unexpected, Visitor,
};
use serde_json::{Value, json};

use crate::link::Taper;
use crate::numeric::{Dimension, UnitError, parse_quantity, quantity_pattern};
use crate::text::visible;

/// A quantity in SI; the file has a number or text with a unit. The parameters are the exponents of mass, length, time
/// and electric current.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Si<const M: i8, const L: i8, const T: i8, const I: i8 = 0>(f64);

pub(super) type Length = Si<0, 1, 0>;
pub(super) type Mass = Si<1, 0, 0>;
pub(super) type RotaryInertia = Si<1, 2, 0>;
pub(super) type Density = Si<1, -3, 0>;
pub(super) type Pressure = Si<1, -1, -2>;
pub(super) type ViscousFriction = Si<1, 2, -1>;
pub(super) type SlidingFriction = Si<1, 0, -1>;
pub(super) type Time = Si<0, 0, 1>;
pub(super) type Rate = Si<0, 0, -1>;
pub(super) type Acceleration = Si<0, 1, -2>;
pub(super) type Angle = Si<0, 0, 0>;
pub(super) type Resistance = Si<1, 2, -3, -2>;
pub(super) type TorqueConstant = Si<1, 2, -2, -1>;

impl<const M: i8, const L: i8, const T: i8, const I: i8> Si<M, L, T, I> {
    pub(super) fn si(self) -> f64 {
        self.0
    }
}

/// A quantity along a segment: one value, or two at its inner and outer end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tapered<const M: i8, const L: i8, const T: i8>(pub(super) Taper);

pub(super) type BendingStiffness = Tapered<1, 3, -2>;
pub(super) type MassPerLength = Tapered<1, -1, 0>;
pub(super) type ShearStiffness = Tapered<1, 1, -2>;
pub(super) type RotaryInertiaPerLength = Tapered<1, 1, 0>;
pub(super) type SecondMoment = Tapered<0, 4, 0>;
pub(super) type Area = Tapered<0, 2, 0>;

/// Reads a quantity, or two if `takes_two`.
pub(super) struct Ends {
    pub(super) dimension: Dimension,
    pub(super) takes_two: bool,
}

impl<'de> DeserializeSeed<'de> for Ends {
    type Value = Taper;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Taper, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Ends {
    type Value = Taper;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.takes_two {
            "a number in SI, a string with its unit, or two of them [inner, outer]"
        } else {
            "a number in SI or a string with its unit"
        })
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Taper, E> {
        Ok(Taper::constant(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Taper, E> {
        Ok(Taper::constant(number as f64))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Taper, E> {
        let dimension = self.dimension;
        let value = parse_quantity(text, dimension).map_err(|error| {
            let wanted = || {
                let name = dimension.name().unwrap_or("a number");
                Some(format!("{name} is wanted, such as \"1 {}\"", dimension.si_unit()))
            };
            let hint = match error {
                UnitError::NotANumber => wanted(),
                UnitError::UnknownUnit { .. } => error.hint().or_else(wanted),
                _ => error.hint(),
            };
            let lines = std::iter::once(error.to_string()).chain(hint);
            let lines: Vec<String> = lines.map(|line| visible(&line).into_owned()).collect();
            E::custom(lines.join("\n"))
        });
        value.map(Taper::constant)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Taper, A::Error> {
        if !self.takes_two {
            return Err(A::Error::invalid_type(Unexpected::Seq, &self));
        }
        let dimension = self.dimension;
        let mut next = || items.next_element_seed(Self { dimension, takes_two: false });
        match (next()?, next()?, next()?) {
            (Some(inner), Some(outer), None) => {
                Ok(Taper { inner: inner.inner, outer: outer.inner })
            }
            _ => Err(A::Error::invalid_length(0, &self)),
        }
    }
}

impl<'de, const M: i8, const L: i8, const T: i8, const I: i8> Deserialize<'de> for Si<M, L, T, I> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let dimension = Dimension::electric(M, L, T, I);
        Ok(Self(Ends { dimension, takes_two: false }.deserialize(deserializer)?.inner))
    }
}

impl<'de, const M: i8, const L: i8, const T: i8> Deserialize<'de> for Tapered<M, L, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let dimension = Dimension::new(M, L, T);
        Ends { dimension, takes_two: true }.deserialize(deserializer).map(Self)
    }
}

/// A stiffness that may be infinite; the reader recognises this type by its name.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
pub(super) struct Unbounded(pub(super) Stiffness);

/// Stiffness of a joint: a torque per angle, or a force per length.
pub(super) type Stiffness = OfJoint<1, 2, -2, 0>;
/// Friction of a joint: a torque or a force.
pub(super) type Friction = OfJoint<1, 2, -2, 1>;
/// Rate of a joint: an angle or a length per time.
pub(super) type JointRate = OfJoint<0, 0, -1, 1>;

/// A quantity of a joint in SI. The parameters are the exponents of mass, length and time of a hub, and that of length of
/// a carriage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OfJoint<const M: i8, const L: i8, const T: i8, const S: i8> {
    pub(super) si: f64,
    /// True in the unit of a carriage, false in that of a hub; `None` without a unit.
    pub(super) slides: Option<bool>,
}

impl<const M: i8, const L: i8, const T: i8, const S: i8> OfJoint<M, L, T, S> {
    /// False in the unit of the other kind of joint.
    pub(super) fn suits(self, slides: bool) -> bool {
        self.slides.is_none_or(|own| own == slides)
    }
}

impl<'de, const M: i8, const L: i8, const T: i8, const S: i8> Deserialize<'de>
    for OfJoint<M, L, T, S>
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Value<const M: i8, const L: i8, const T: i8, const S: i8>(Ends);
        impl<const M: i8, const L: i8, const T: i8, const S: i8> Visitor<'_> for Value<M, L, T, S> {
            type Value = OfJoint<M, L, T, S>;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.expecting(formatter)
            }

            fn visit_f64<E: Error>(self, si: f64) -> Result<Self::Value, E> {
                Ok(OfJoint { si, slides: None })
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
                self.visit_f64(number as f64)
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                let along = parse_quantity(text, Dimension::new(M, S, T));
                let slides = Some(along.is_ok());
                let si = along.or_else(|_| self.0.visit_str(text).map(|own| own.inner))?;
                Ok(OfJoint { si, slides })
            }
        }
        let turning = Ends { dimension: Dimension::new(M, L, T), takes_two: false };
        deserializer.deserialize_any(Value(turning))
    }
}

/// Accelerations along the axes of a plane.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "Vec<Acceleration>")]
pub(super) struct AlongAxes(pub(super) [f64; 2]);

impl TryFrom<Vec<Acceleration>> for AlongAxes {
    type Error = String;

    fn try_from(parts: Vec<Acceleration>) -> Result<Self, String> {
        match parts[..] {
            [x, y] => Ok(Self([x.si(), y.si()])),
            _ => Err("must hold two accelerations, [along x, along y]".into()),
        }
    }
}

/// A direction along the axes of a plane.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "Vec<f64>")]
pub(super) struct Axis(pub(super) [f64; 2]);

impl TryFrom<Vec<f64>> for Axis {
    type Error = String;

    fn try_from(parts: Vec<f64>) -> Result<Self, String> {
        let parts = parts.try_into().map(Self);
        parts.map_err(|_| "must hold two numbers, [along x, along y]".into())
    }
}

/// A number of elements or modes, or the number of a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct Count(pub(super) usize);

impl Count {
    const MOST: usize = 100_000;
    pub(super) const WORDS: &str = "a whole number from 1 to 100000";
}

impl TryFrom<i64> for Count {
    type Error = String;

    fn try_from(number: i64) -> Result<Self, String> {
        let count = usize::try_from(number).ok().filter(|count| (1..=Self::MOST).contains(count));
        count.map(Self).ok_or_else(|| format!("must be {}", Self::WORDS))
    }
}

/// Elements of the whole link: a total, or the word for an automatic number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(untagged, expecting = "must be a whole number from 1 to 100000, or \"auto\"")]
pub(super) enum Elements {
    Total(Count),
    Word(Auto),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Auto {
    Auto,
}

/// List of tables; the reader recognises this type by its name.
#[derive(serde::Deserialize)]
struct Tables<T>(Vec<T>);

/// Reads a list of tables. It refuses `[segments]` in place of `[[segments]]`, an easy slip, in words of the link file.
pub(super) fn tables<'de, D, T>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    Tables::deserialize(deserializer).map(|Tables(tables)| tables)
}

/// Keyword of a quantity's schema that contains its SI unit until [`describe`] removes it.
const UNIT: &str = "unit";

impl<const M: i8, const L: i8, const T: i8, const I: i8> JsonSchema for Si<M, L, T, I> {
    fn schema_name() -> Cow<'static, str> {
        format!("Si{M}{L}{T}{I}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        quantity(Dimension::electric(M, L, T, I))
    }
}

impl<const M: i8, const L: i8, const T: i8, const S: i8> JsonSchema for OfJoint<M, L, T, S> {
    fn schema_name() -> Cow<'static, str> {
        format!("OfJoint{M}{L}{T}{S}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        quantity(Dimension::new(M, L, T))
    }
}

/// Schema of a quantity.
pub(super) fn quantity(dimension: Dimension) -> Schema {
    json_schema!({ "type": ["number", "string"], UNIT: dimension.si_unit() })
}

impl<const M: i8, const L: i8, const T: i8> JsonSchema for Tapered<M, L, T> {
    fn schema_name() -> Cow<'static, str> {
        format!("Tapered{M}{L}{T}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": ["number", "string", "array"],
            "items": { "type": ["number", "string"] },
            "minItems": 2,
            "maxItems": 2,
            UNIT: Dimension::new(M, L, T).si_unit(),
        })
    }
}

impl JsonSchema for AlongAxes {
    fn schema_name() -> Cow<'static, str> {
        "AlongAxes".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "array",
            "items": { "type": ["number", "string"] },
            "minItems": 2,
            "maxItems": 2,
            UNIT: Dimension::ACCELERATION.si_unit(),
        })
    }
}

impl JsonSchema for Unbounded {
    fn schema_name() -> Cow<'static, str> {
        "Unbounded".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        // TOML tools write an infinite number as null to JSON.
        let number = json!({ "type": ["number", "string"] });
        json_schema!({ "oneOf": [number, { "type": "null" }], UNIT: Dimension::TORQUE.si_unit() })
    }
}

impl JsonSchema for Count {
    fn schema_name() -> Cow<'static, str> {
        "Count".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "minimum": 1, "maximum": Self::MOST })
    }
}

impl JsonSchema for Elements {
    fn schema_name() -> Cow<'static, str> {
        "Elements".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [Count::json_schema(generator), { "const": "auto" }] })
    }
}

/// Restricts the schema of a quantity to values above 0.
pub(super) fn above_zero(schema: &mut Schema) {
    schema.insert("exclusiveMinimum".into(), json!(0));
}

/// Restricts the schema of a quantity to values of at least 0.
pub(super) fn at_least_zero(schema: &mut Schema) {
    schema.insert("minimum".into(), json!(0));
}

/// Words before the unit in the description of a quantity.
pub(super) const IN_UNIT: &str = "A number in ";

/// Adds to a quantity's schema its unit and range: in words, and as the pattern of its text. A text of 0 passes even if
/// the value must be above 0: the schema cannot know its value.
pub(super) fn describe(schema: &mut Schema) {
    let Some(Value::String(unit)) = schema.remove(UNIT) else { return };
    let ranges = [("minimum", ", at least 0"), ("exclusiveMinimum", ", above 0")];
    let range = ranges.into_iter().find(|(keyword, _)| schema.get(*keyword).is_some());
    let what = schema.get("description").and_then(Value::as_str).unwrap_or_default();
    let words = range.map_or("", |(_, words)| words);
    let example = example(&unit);
    let si = if unit.is_empty() { "rad" } else { unit.as_str() };
    let text = format!("{what}\n\n{IN_UNIT}{si}, or text with its unit{words}: \"{example}\".");
    schema.insert("description".into(), text.into());
    let pattern = quantity_pattern(if range.is_some() { r"\+?" } else { "[+-]?" });
    // Each keyword applies only to its type.
    if let Some(Value::Object(items)) = schema.get_mut("items") {
        items.insert("pattern".into(), pattern.clone().into());
        items.extend(range.map(|(keyword, _)| (keyword.into(), json!(0))));
    }
    schema.insert("pattern".into(), pattern.into());
}

/// An example of a quantity with this SI unit, as text.
fn example(unit: &str) -> &'static str {
    match unit {
        "m" => "150 cm",
        "N m^2" => "5e4 N cm^2",
        "Pa" => "70 GPa",
        "m^4" => "0.25e-2 cm^4",
        "kg/m" => "8 g/cm",
        "kg/m^3" => "2.7 g/cm^3",
        "m^2" => "1 cm^2",
        "kg m^2" => "1000 kg cm^2",
        "kg" => "50 g",
        "s" => "500 ms",
        "1/s" => "30 rpm",
        "N m" => "500 N cm",
        "N m s/rad" => "15 mN m s",
        "N s/m" => "0.15 kN s/m",
        "m/s^2" => "-981 cm/s^2",
        "" => "90 deg",
        _ => "20 W",
    }
}

#[cfg(test)]
mod tests {
    use super::super::error::Fault;
    use super::super::raw::{RawHub, RawMesh, RawSegment};
    use super::super::tree::Node;
    use super::*;

    #[test]
    fn a_number_is_si_and_text_has_its_unit() {
        let inertia = |value: &str| {
            let tree = Node::document("", &format!("inertia = {value}")).unwrap();
            RawHub::deserialize(&tree).map(|hub| hub.inertia.si()).map_err(Fault::from)
        };
        assert_eq!(inertia("0.1"), Ok(0.1));
        assert_eq!(inertia("'1000 kg cm^2'"), Ok(0.1));
        let message = "inertia = \"heavy\" does not begin with a number such as 1.5 or 2e-3";
        let hint = "a rotary inertia is wanted, such as \"1 kg m^2\"".to_owned();
        assert_eq!(inertia("'heavy'"), Err(Fault::new("inertia", message).hinting(hint)));
    }

    #[test]
    fn each_end_of_a_taper_may_have_its_own_unit() {
        let area = |value: &str| {
            let tree = Node::document("", &format!("length = 1\narea = {value}")).unwrap();
            RawSegment::deserialize(&tree).map(|raw| raw.area).map_err(Fault::from)
        };
        let taper = Taper { inner: 1e-3, outer: 5e-4 };
        assert_eq!(area("['10 cm^2', 5e-4]"), Ok(Some(Tapered(taper))));
        let message = "area.1 = \"1 m\" is a length, but must be an area such as m^2";
        assert_eq!(area("[1, '1 m']"), Err(Fault::new("area.1", message)));
    }

    #[test]
    fn a_mesh_counts_its_elements_or_leaves_them_to_the_program() {
        let elements = |text: &str| {
            let tree = Node::document("", text).unwrap();
            RawMesh::deserialize(&tree).map(|mesh| mesh.elements).ok()
        };
        let total = |count| Some(Some(Elements::Total(Count(count))));
        assert_eq!(elements("elements = 100000"), total(100_000));
        assert_eq!(elements("elements = 'auto'"), Some(Some(Elements::Word(Auto::Auto))));
        assert_eq!(elements(""), Some(None));
        for text in ["elements = 100001", "elements = -1", "elements = 1.5", "elements = '5'"] {
            assert_eq!(elements(text), None, "{text}");
        }
    }

    #[test]
    fn every_example_is_of_its_dimension() {
        for dimension in [
            Dimension::LENGTH,
            Dimension::BENDING_STIFFNESS,
            Dimension::PRESSURE,
            Dimension::SECOND_MOMENT,
            Dimension::MASS_PER_LENGTH,
            Dimension::DENSITY,
            Dimension::AREA,
            Dimension::ROTARY_INERTIA,
            Dimension::MASS,
            Dimension::TIME,
            Dimension::RATE,
            Dimension::TORQUE,
            Dimension::VISCOUS_FRICTION,
            Dimension::POWER,
            Dimension::ACCELERATION,
            Dimension::NONE,
        ] {
            let text = example(dimension.si_unit());
            assert!(parse_quantity(text, dimension).is_ok(), "{text}");
        }
    }
}
