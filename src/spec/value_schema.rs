//! The JSON Schema of a value: its kind, and what its key says of it: unit, range, default.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema, transform::Transform};
use serde_json::{Value, json};

use super::quantity::{Count, Elements, Quantity, Real, Tapered, Unbounded};
use crate::numeric::{Dimension, quantity_pattern};

/// Allowed range of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Range {
    Any,
    AtLeastZero,
    AboveZero,
}

impl Range {
    /// Pattern of the sign of a text. A text of 0 passes even if the value must be above 0: the schema
    /// cannot know its value.
    fn sign(self) -> &'static str {
        match self {
            Self::Any => "[+-]?",
            Self::AtLeastZero | Self::AboveZero => r"\+?",
        }
    }

    fn keyword(self) -> Option<&'static str> {
        match self {
            Self::Any => None,
            Self::AtLeastZero => Some("minimum"),
            Self::AboveZero => Some("exclusiveMinimum"),
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Any => "",
            Self::AtLeastZero => ", at least 0",
            Self::AboveZero => ", above 0",
        }
    }
}

/// A number in SI or text with its unit.
#[derive(Debug)]
pub(super) struct QuantityKey {
    dimension: Dimension,
    range: Range,
    default: Option<u8>,
}

/// Describes a key by dimension and range.
pub(super) fn quantity(dimension: Dimension, range: Range) -> QuantityKey {
    QuantityKey { dimension, range, default: None }
}

impl QuantityKey {
    /// Adds the default value.
    pub(super) fn or(self, default: u8) -> Self {
        Self { default: Some(default), ..self }
    }

    /// Limits numbers and texts; each keyword applies to its own type only.
    fn limit(&self, schema: &mut Schema) {
        schema.insert("pattern".into(), quantity_pattern(self.range.sign()).into());
        if let Some(keyword) = self.range.keyword() {
            schema.insert(keyword.into(), json!(0));
        }
    }
}

impl Transform for QuantityKey {
    fn transform(&mut self, schema: &mut Schema) {
        let unit = self.dimension.si_unit();
        let words = self.range.words();
        let what = schema.get("description").and_then(Value::as_str).unwrap_or_default();
        let description = format!(
            "{what}\n\nA number in {unit}, or text with its unit{words}: {}.",
            example(unit)
        );
        schema.insert("description".into(), description.into());
        self.limit(schema);
        let items = schema.get_mut("items").and_then(|items| <&mut Schema>::try_from(items).ok());
        if let Some(items) = items {
            self.limit(items);
        }
        if let Some(default) = self.default {
            schema.insert("default".into(), json!(default));
        }
    }
}

/// An example of a quantity with this SI unit, as text.
fn example(unit: &str) -> &'static str {
    match unit {
        "m" => "\"150 cm\"",
        "N m^2" => "\"5e4 N cm^2\"",
        "Pa" => "\"70 GPa\"",
        "m^4" => "\"0.25e-2 cm^4\"",
        "kg/m" => "\"8 g/cm\"",
        "kg/m^3" => "\"2.7 g/cm^3\"",
        "m^2" => "\"1 cm^2\"",
        "kg m^2" => "\"1000 kg cm^2\"",
        "kg" => "\"50 g\"",
        "s" => "\"500 ms\"",
        "1/s" => "\"30 rpm\"",
        "N m" => "\"500 N cm\"",
        "N m s/rad" => "\"15 mN m s\"",
        _ => "\"20 W\"",
    }
}

/// A number from 0 to below 1.
pub(super) fn a_share(schema: &mut Schema) {
    schema.insert("minimum".into(), json!(0));
    schema.insert("exclusiveMaximum".into(), json!(1));
}

/// A list of numbers from 0 to below 1, at least one.
pub(super) fn shares(schema: &mut Schema) {
    schema.insert("minItems".into(), json!(1));
    if let Some(Ok(items)) = schema.get_mut("items").map(<&mut Schema>::try_from) {
        a_share(items);
    }
}

/// A number from `least` to `most`.
pub(super) fn within(least: f64, most: f64) -> impl Transform {
    move |schema: &mut Schema| {
        schema.insert("minimum".into(), json!(least));
        schema.insert("maximum".into(), json!(most));
    }
}

/// Implements `JsonSchema` by a constant schema.
macro_rules! kind {
    ($type:ident, $($schema:tt)+) => {
        impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($($schema)+)
            }
        }
    };
}

kind!(Quantity, { "type": ["number", "string"] });
// TOML tools write an infinite number as null to JSON.
kind!(Unbounded, { "oneOf": [{ "type": ["number", "string"] }, { "type": "null" }] });
kind!(Tapered, {
    "type": ["number", "string", "array"],
    "items": { "type": ["number", "string"] },
    "minItems": 2,
    "maxItems": 2,
});
kind!(Real, { "type": "number" });
kind!(Count, { "type": "integer", "minimum": 1, "maximum": Count::MOST });
kind!(Elements, {
    "anyOf": [{ "type": "integer", "minimum": 1, "maximum": Count::MOST }, { "const": "auto" }],
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::parse_quantity;

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
        ] {
            let text = example(dimension.si_unit()).trim_matches('"');
            assert!(parse_quantity(text, dimension).is_ok(), "{text}");
        }
    }
}
