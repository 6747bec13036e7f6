//! The kinds of values, as they are before a key says more.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use super::super::count::{Count, Elements};
use super::super::quantity::{Quantity, Real, Tapered, Unbounded};

/// Gives a type the schema that does not depend on where it stands.
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
// TOML tools hand an infinite number to JSON, which has none, as null.
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
